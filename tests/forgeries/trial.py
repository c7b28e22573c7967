"""Forge records and ask ``physim validate``; and ask it of records as they are."""

from __future__ import annotations

import io
import shutil
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import h5py

import physim
from physim.cli import main
from tests.forgeries.edits import FORGERIES, Forgery
from tests.forgeries.runs import LANE, UNUSUAL, make_runs

WORLDS = ("straight", "crossing", "merging", "narrowing", "nonconvex", "u_turn", "doorway")
SEEDS = (1, 2)


def validated(path: Path, *arguments: str) -> tuple[int, str]:
    """Exit code of ``physim validate`` and all that it says, in one line."""
    said = io.StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        code = main(["validate", str(path), *arguments])
    return code, " ".join(said.getvalue().split())


def tried(forgery: Forgery, made: dict[str, Path], folder: Path) -> str:
    """Forge a record; empty where it was found by its words, else what was said instead."""
    path = folder / "forged.h5"
    shutil.copyfile(made[forgery.run], path)
    with h5py.File(path, "r+") as file:
        forgery.change(file)
    (folder / "lane.yaml").write_text(LANE, encoding="utf-8")
    arguments = [str(folder / "lane.yaml") if one == "LANE" else one for one in forgery.arguments]
    code, said = validated(path, *arguments)
    if code != forgery.code:
        return f"exit code {code}, not {forgery.code}: {said}"
    lacking = [words for words in forgery.words if words not in said]
    return f"does not say {lacking[0]!r}: {said}" if lacking else ""


def try_all(folder: Path, tell: Callable[[str], None] = print) -> int:
    """Try every forgery; how many were missed."""
    made, missed = make_runs(folder), 0
    for k, forgery in enumerate(FORGERIES, 1):
        wrong = tried(forgery, made, folder)
        missed += bool(wrong)
        tell(f"{k:>3}  {forgery.run:<9} {forgery.name:<45} {wrong or 'found'}")
    tell(f"{len(FORGERIES) - missed} of {len(FORGERIES)} forgeries found")
    return missed


def doubted(path: Path, *arguments: str) -> str:
    """What a true record is doubted for; empty where the checks agree."""
    code, said = validated(path, *arguments)
    return "" if code in (0, 1) and "DISAGREEMENTS: none" in said else f"exit code {code}: {said}"


def null_arm(
    folder: Path,
    worlds: Sequence[str] = WORLDS,
    seeds: Sequence[int] = SEEDS,
    tell: Callable[[str], None] = print,
) -> int:
    """Validate records as they are, and simulate them again; how many were doubted."""
    wrong = 0

    def judge(name: str, path: Path, *arguments: str) -> None:
        nonlocal wrong
        told = doubted(path, *arguments)
        wrong += bool(told)
        tell(f"     {name:<55} {told or 'not doubted'}")

    for name, path in make_runs(folder).items():
        judge(name, path)
        if name != "staged":  # its filter came from Python
            judge(f"{name}, simulated again", path, "--rerun")
    for name, run in UNUSUAL.items():
        path = folder / "unusual.h5"
        path.unlink(missing_ok=True)
        run(path)
        judge(name, path)
    for world in worlds:
        for seed in seeds:
            path = folder / "shipped.h5"
            physim.simulate(physim.load_world(world), seed=seed, path=path, overwrite=True).close()
            judge(f"{world}, seed {seed}, simulated again", path, "--rerun")
    return wrong
