"""Films, stills and plots are what their names say, or refused in one message.

GIF and WebP play, frames last as long as they should, and two records go in step.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image

from tests.edges.shell import Shell

NUMBER = "pictures"
RUN = ("run", "straight", "--no-video", "--quiet", "--set", "time.duration=3",
       "--set", "expect=null")  # fmt: skip


def record(shell: Shell, name: str = "out", *more: str) -> str:
    """Path of the record of a short run."""
    assert shell.physim(*RUN, "-o", name, *more).code == 0
    return f"{name}/record.h5"


def try_a_film_for_a_slide(shell: Shell) -> None:
    for name in ("part.gif", "part.webp"):
        run = record(shell, name.partition(".")[2])
        done = shell.physim("video", run, "-o", name, "--from", 1, "--to", 2, "--width", 640)
        assert (done.code, done.out.strip()) == (0, name), done.err
        assert size(shell.folder / name) == (640, 360)
        frames, milliseconds = played(shell.folder / name)
        assert frames > 15
        assert abs(milliseconds - 2500) < 100, "one second, and the last picture stays for 1.5 s"


def size(path: Path) -> tuple[int, int]:
    """Width and height."""
    with Image.open(path) as film:
        return film.size


def played(path: Path) -> tuple[int, int]:
    """Frames that differ from the one before, and how long all are seen [ms]."""
    lasts, pictures = 0, []
    with Image.open(path) as film:
        assert film.info["loop"] == 0
        for k in range(film.n_frames):
            film.seek(k)
            pictures.append(np.asarray(film.convert("RGB")))
            lasts += film.info["duration"]
    return 1 + sum(bool((a != b).any()) for a, b in pairwise(pictures)), lasts


def try_a_still(shell: Shell) -> None:
    run = record(shell)
    assert shell.physim("video", run, "--at", 1.5, "-o", "a.png").code == 0
    assert size(shell.folder / "a.png") == (1280, 720)
    shell.physim("video", run, "--at", 1.5, "-o", "a.mp4").refused("--at 1.5", "a.png")
    shell.physim("video", run, "--at", 99, "-o", "b.png").refused("--at 99", "3 s")
    shell.physim("video", run, "--at", 1, "--to", 2, "-o", "b.png").refused("--to", "--at 1")
    shell.physim("video", run, "-o", "b.png").refused("b.png", "--at T")
    assert not (shell.folder / "b.png").exists()


def try_rates_and_sizes_that_cannot_be(shell: Shell) -> None:
    run = record(shell)
    for words, said in (
        (("-o", "a.gif", "--fps", 30), ("--fps 30", "25")),
        (("-o", "a.webp", "--fps", 60), ("--fps 60", "50")),
        (("-o", "a.avi"), ("a.avi", ".gif")),
        (("-o", "a.gif", "--width", 99), ("--width 99", "160")),
        (("-o", "a.gif", "--width", 1280, "--speed", 0.001), ("frames", "--from", ".mp4")),
        (("-o", "a.gif", "--from", 4), ("--from 4", "3 s")),
    ):
        shell.physim("video", run, *words).refused(*said)
    assert not list(shell.folder.glob("a.*"))


def try_two_records_in_step(shell: Shell) -> None:
    one, other = record(shell, "one"), record(shell, "two", "--seed", "3")
    done = shell.physim("video", one, other, "-o", "both.mp4", "--to", 1)
    assert (done.code, done.out.strip()) == (0, "both.mp4"), done.err
    assert shell.physim("video", one, other, "--at", 1, "-o", "both.png").code == 0
    shell.physim("video", one, other, "--beside", one).refused("--beside")
    shell.physim("video", one, "none.h5", "-o", "c.mp4").refused("none.h5")
    assert not (shell.folder / "c.mp4").exists()


def try_plots_of_nothing(shell: Shell) -> None:
    run = record(shell)
    done = shell.physim("plot", run, "-o", "plots")
    assert done.code == 0, done.err
    assert "prediction is left out: no contact" in done.err
    assert "prediction" not in done.out
    assert not (shell.folder / "plots/prediction.png").exists()
    named = shell.physim("plot", run, "-o", "plots", "--only", "prediction")
    assert named.code == 0
    assert (shell.folder / "plots/prediction.png").exists(), "it says why it is empty"


def try_plots_for_a_paper(shell: Shell) -> None:
    run = record(shell)
    wide = ("--only", "distances", "--width", "column", "--no-title")
    assert shell.physim("plot", run, "-o", "plots", *wide).code == 0
    assert size(shell.folder / "plots/distances.png")[0] == 700
    shell.physim("plot", run, "-o", "p", "--width", "colum").refused("--width colum", "column")
