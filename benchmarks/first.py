"""The first minutes: installation, import, first video; and memory, and whole commands."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from benchmarks.environments import PEERS, Environment, size_of
from benchmarks.measuring import FAILED, ROOT, Job, Store, run, runner, table
from tests.checkout import tracked_files

SUBJECT = "first"
MODULES = {"physim": "physim", "navground": "navground.sim", "irsim": "irsim", "pyrvo": "pyrvo"}
NAMES = {"physim": "physim", "navground": "navground", "irsim": "IR-SIM", "pyrvo": "pyrvo"}
SECONDS = 30.0
"""[s] of the video"""
SOURCES = "sources"
FROM_NOTHING = {
    "physim": "physim, wheel", SOURCES: "physim, sources", "navground": "navground",
    "irsim": "IR-SIM",
}  # fmt: skip
"""What is installed anew, in this order"""
COMMANDS = {
    "physim --help": ("--help",),
    "run ten_robots, with record": ("run", "ten_robots", "--no-video", "--quiet"),
    "run ten_robots, with record and video": ("run", "ten_robots", "--quiet"),
}


def groups(
    peers: Mapping[str, Environment], work: Path, quick: bool
) -> tuple[list[Job], list[Job], list[Job]]:
    """Imports in turn, videos, and commands of physim."""
    here = {"physim": sys.executable}
    here.update({n: one.python for n, one in peers.items() if n in MODULES and not one.failed})
    imports = [
        Job(SUBJECT, who, "import", (python, "-c", f"import {MODULES[who]}"), takes_time=True)
        for who, python in here.items()
    ]
    asked = {"what": "video", "robots": 10, "seconds": 6.0 if quick else SECONDS}
    videos = [
        runner(SUBJECT, who, "video", python, f"run_{who}.py", 300.0, **asked)
        for who, python in here.items() if who != "pyrvo"
    ]  # fmt: skip
    if not quick:
        asked.update(robots=1000, seconds=6.0)
        videos.append(
            runner(SUBJECT, "physim", "video-1000", sys.executable, "run_physim.py", 300.0, **asked)
        )
    return imports, videos, [] if quick else _commands(work)


def _commands(work: Path) -> list[Job]:
    """Whole commands; one validates what another has recorded."""
    found = []
    for number, arguments in enumerate(COMMANDS.values()):
        given = (sys.executable, "-m", "physim", *arguments)
        if arguments[0] == "run":
            given = (*given, "--force", "-o", str(work / f"command-{number}"))
        name = f"command-{number}"
        found.append(Job(SUBJECT, "physim", name, given, 300.0, takes_time=True))
    record = str(work / "command-1" / "record.h5")
    command = (sys.executable, "-m", "physim", "validate", record)
    return [*found, Job(SUBJECT, "physim", "validate", command, 300.0, takes_time=True)]


def text(store: Store, peers: Mapping[str, Environment]) -> str:
    """The tables."""
    rows = []
    for who, name in NAMES.items():
        one = peers.get(who)
        if one is not None and one.failed:
            rows.append([name, one.failed, "", "", ""])
            continue
        videos = [r for r in store.results(SUBJECT, who, "video") if FAILED not in r]
        video = store.why_not(SUBJECT, who, "video") or "–"
        if videos:
            video = f"{videos[0]['rate']:.0f} frames/s ({videos[0]['wall']:.0f} by the wall clock)"
        rows.append([
            name, _seconds(store, who, "import"), video,
            f"{videos[0]['seconds']:.1f} s" if videos else "–", _memory(store, who),
        ])  # fmt: skip
    head = ["", "import", "video of ten robots", "whole, with simulation", "memory, 1,000 robots"]
    found = f"## First minutes\n\n{INTRODUCTION}{_from_nothing(store)}{table(head, rows)}\n"
    many = store.values(SUBJECT, "physim", "video-1000")
    if many:
        found += f"Video of 1,000 robots, physim: {many[0]:.0f} frames/s.\n\n"
    if not store.results(SUBJECT, "physim", "command-0"):
        return found
    commands = [
        [name, _seconds(store, "physim", f"command-{k}")] for k, name in enumerate(COMMANDS)
    ]
    commands.append(["validate ten_robots", _seconds(store, "physim", "validate")])
    head = ["physim, whole command", "processor time: median and range of three"]
    return found + table(head, commands) + "\n"


INTRODUCTION = """\
The first table is by the wall clock and depends on the network: a new environment, `pip install`,
and a film of ten robots in the corridor for 30 s, the same for all. From its sources physim
compiles its kernels, too. In the second, seconds are processor time. Frames: H.264, physim
1280 × 720 without the simulation, IR-SIM and navground as they make them, with it.

"""


def _seconds(store: Store, who: str, what: str) -> str:
    failed = store.why_not(SUBJECT, who, what)
    values = store.values(SUBJECT, who, what, "cpu")
    if failed or not values:
        return failed or "–"
    return f"{statistics.median(values):.2f} s ({min(values):.2f}–{max(values):.2f})"


def _memory(store: Store, who: str) -> str:
    kinds = {
        "physim": ("physim", "drive-1000"),
        "navground": ("navground-Dummy", "drive-1000"),
        "irsim": ("irsim-contact", "drive-1000"),
        "pyrvo": ("pyrvo-ORCA", "controller-1000"),
    }
    values = store.values("speed", *kinds[who], "memory")
    return f"{statistics.median(values):.0f} MB" if values else "–"


def from_nothing(who: str, folder: Path, store: Store) -> None:
    """Install one of `FROM_NOTHING` as a stranger would, and make its first film.

    The film is the same for all: ten robots in the corridor for `SECONDS`. physim comes once as a
    wheel, as the peers do, and once from its sources, whose kernels are compiled.
    """
    job = Job(SUBJECT, who, "install", ())
    with tempfile.TemporaryDirectory(dir=folder) as name:
        place = Path(name)
        python = str(place / "env" / "bin" / "python")
        packages = next((one.packages for one in PEERS if one.name == who), ())
        if not packages:
            packages = (str(_sources(place) if who == SOURCES else _wheel(place)),)
        name = "physim" if who == SOURCES else who
        film = runner(SUBJECT, who, "film", python, f"run_{name}.py", 300.0,
                      what="video", robots=10, seconds=SECONDS).command  # fmt: skip
        times = []
        for command in (
            (sys.executable, "-m", "venv", str(place / "env")),
            (python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages),
            film,
        ):
            found = run(Job(SUBJECT, who, "install", command, 900.0, place, takes_time=True))
            if FAILED in found:
                store.put(job, 0, found)
                return
            times.append(found["wall"])
            size = size_of(place / "env")
        store.put(job, 0, {"seconds": times[0] + times[1], "size": size, "film": times[2]})


def _sources(place: Path) -> Path:
    for file in tracked_files(ROOT):
        (place / "source" / file).parent.mkdir(parents=True, exist_ok=True)
        (place / "source" / file).write_bytes((ROOT / file).read_bytes())
    return place / "source"


def _wheel(place: Path) -> Path:
    command = (sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir",
               str(place), str(_sources(place)))  # fmt: skip
    subprocess.run(command, check=True, capture_output=True)
    return next(place.glob("*.whl"))


def _from_nothing(store: Store) -> str:
    """The table of installations, and who made the first film soonest."""
    rows = []
    for who, name in FROM_NOTHING.items():
        if store.results(SUBJECT, who, "install"):
            found = store.results(SUBJECT, who, "install")[0]
            if FAILED in found:
                rows.append([name, found[FAILED], "", "", ""])
                continue
            whole = found["seconds"] + found["film"]
            rows.append([name, f"{found['seconds']:.0f} s", f"{found['size']:.0f} MB",
                         f"{found['film']:.1f} s", f"**{whole:.0f} s**"])  # fmt: skip
    head = ["", "installation", "environment on disk", "first film", "from nothing to the film"]
    return table(head, rows) + "\n" if rows else ""
