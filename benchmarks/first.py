"""The first minutes: installation, import, first video; and memory, and whole commands."""

from __future__ import annotations

import statistics
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from benchmarks.environments import Environment, size_of
from benchmarks.measuring import FAILED, ROOT, Job, Store, runner, table

SUBJECT = "first"
MODULES = {"physim": "physim", "navground": "navground.sim", "irsim": "irsim", "pyrvo": "pyrvo"}
NAMES = {"physim": "physim", "navground": "navground", "irsim": "IR-SIM", "pyrvo": "pyrvo"}
SECONDS = 30.0
"""[s] of the video"""
RUN = "import sys; from physim.cli import main; sys.exit(main())"
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
            rows.append([name, one.failed, "", "", "", ""])
            continue
        installed = f"{one.seconds:.0f} s, {one.size:.0f} MB" if one is not None else _own(store)
        videos = [r for r in store.results(SUBJECT, who, "video") if FAILED not in r]
        video = store.why_not(SUBJECT, who, "video") or "–"
        if videos:
            video = f"{videos[0]['rate']:.0f} frames/s ({videos[0]['wall']:.0f} by the wall clock)"
        rows.append([
            name, installed, _seconds(store, who, "import"), video,
            f"{videos[0]['seconds']:.1f} s" if videos else "–", _memory(store, who),
        ])  # fmt: skip
    head = ["", "installation, on disk", "import", "video of ten robots", "whole, with simulation",
            "memory, 1,000 robots"]  # fmt: skip
    found = f"## First minutes\n\n{INTRODUCTION}{table(head, rows)}\n"
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
Seconds are processor time but for the installation, which is by the wall clock and depends on the
network. Frames: H.264, physim 1280 × 720 without the simulation, IR-SIM and navground as they make
them, with it. The installation of physim compiles its kernels; the time from there to the first MP4
is in the same row.

"""


def _own(store: Store) -> str:
    found = [r for r in store.results(SUBJECT, "physim", "install") if FAILED not in r]
    if not found:
        return store.why_not(SUBJECT, "physim", "install") or "not measured"
    one = found[0]
    return (
        f"{one['seconds']:.0f} s, {one['size']:.0f} MB; first MP4 after {one['first']:.0f} s more "
        f"({one['cpu']:.0f} s of processor time)"
    )


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


def install(folder: Path, store: Store) -> None:
    """Install physim as a stranger would, and go on to the first video of a run."""
    from benchmarks.measuring import run
    from tests.checkout import tracked_files

    job = Job(SUBJECT, "physim", "install", ())
    with tempfile.TemporaryDirectory(dir=folder) as name:
        place = Path(name)
        for file in tracked_files(ROOT):
            (place / "source" / file).parent.mkdir(parents=True, exist_ok=True)
            (place / "source" / file).write_bytes((ROOT / file).read_bytes())
        python = str(place / "env" / "bin" / "python")
        steps = (
            (sys.executable, "-m", "venv", str(place / "env")),
            (python, "-m", "pip", "install", "--quiet", str(place / "source")),
            *2 * ((python, "-c", RUN, "run", "three_robots", "--quiet", "--force", "-o", "run"),),
        )
        times = []
        for command in steps:
            found = run(Job(SUBJECT, "physim", "install", command, 900.0, place, takes_time=True))
            if FAILED in found:
                store.put(job, 0, found)
                return
            times.append(found)
        is_there = (place / "run" / "video.mp4").exists()
        done = {"seconds": times[0]["wall"] + times[1]["wall"], "size": size_of(place / "env"),
                "first": times[2]["wall"], "cpu": times[2]["cpu"],
                "wait": times[2]["wall"] - times[3]["wall"]}  # fmt: skip
        store.put(job, 0, done if is_there else {FAILED: "no MP4 was written"})
