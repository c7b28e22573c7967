"""Forge a record and ask ``physim validate``; and ask it of records as they are."""

from __future__ import annotations

import shutil
from pathlib import Path

import h5py

from tests.analysis.forgeries.edits import Forgery
from tests.analysis.forgeries.runs import LANE
from tests.helpers import said


def validated(path: Path, *arguments: str) -> tuple[int, str]:
    """Exit code of ``physim validate`` and all that it says, in one line."""
    code, out, err = said("validate", str(path), *arguments)
    return code, " ".join(f"{out} {err}".split())


def tried(forgery: Forgery, made: dict[str, Path], folder: Path) -> str:
    """Forge a record; empty where it was found by its words, else what was said instead."""
    path = folder / "forged.h5"
    shutil.copyfile(made[forgery.run], path)
    with h5py.File(path, "r+") as file:
        forgery.change(file)
    (folder / "lane.yaml").write_text(LANE, encoding="utf-8")
    arguments = [str(folder / "lane.yaml") if one == "LANE" else one for one in forgery.arguments]
    code, text = validated(path, *arguments)
    if code != forgery.code:
        return f"exit code {code}, not {forgery.code}: {text}"
    lacking = [words for words in forgery.words if words not in text]
    return f"does not say {lacking[0]!r}: {text}" if lacking else ""


def doubted(path: Path, *arguments: str) -> str:
    """What a true record is doubted for; empty where the checks agree."""
    code, text = validated(path, *arguments)
    return "" if code in (0, 1) and "DISAGREEMENTS: none" in text else f"exit code {code}: {text}"
