"""Make what is kept: what commands print, what pictures show, digests of records, help texts.

Every function returns plain JSON values. What differs from one run to the next, such as
seconds by the clock, versions and folders, is replaced by a mark.
"""

from __future__ import annotations

import atexit
import functools
import io
import json
import re
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest import mock

import matplotlib.figure
import numpy as np
from matplotlib.path import Path as Codes

import physim
from physim.cli import main
from physim.drawing.plots import draw
from physim.drawing.video import frame_at
from tests.helpers import inside
from tests.helpers.unpacking import unpack

ROOM = "physim.drawing.video"
Canvas, sprite = inside(ROOM, "Canvas", "sprite")

RUNS: dict[str, tuple[str, ...]] = {
    "straight": ("straight",),
    "three_robots": ("three_robots",),
    "nonconvex": ("nonconvex",),
    "doorway": ("doorway",),
    "crossing": ("crossing",),
    "deaf": ("three_robots", "--controller", "path_following", "--set", "time.duration=30"),
}
"""World and options of the six runs whose figures and reports are kept"""
TIMES = (0.0, 5.0, 12.0, 24.9)
FRAMES = ("straight", "three_robots", "nonconvex", "doorway", "deaf")
PAGES = ("straight", "nonconvex", "deaf")
PLOTS = "three_robots"
LONG = ("hundred_robots", "thousand_robots", "jam")
"""Worlds of which the first seconds are run, and how many"""
SECONDS = 2.0
COMMANDS = (
    "", "list", "run", "summary", "plot", "video", "page", "validate", "check-controller",
    "crashtest", "new", "import", "check", "preview", "schema", "sweep", "replay", "report",
    "compare", "bear", "falsify", "league", "reproduce",
)  # fmt: skip


def said(*arguments: str) -> dict[str, Any]:
    """Exit code and lines of a command, run in this process."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            code = main(list(arguments))
        except SystemExit as ended:
            code = ended.code  # type: ignore[assignment]
    told = {"exit": code, "out": scrubbed(out.getvalue()), "err": scrubbed(err.getvalue())}
    return {key: value for key, value in told.items() if value != []}


def scrubbed(text: str) -> list[str]:
    """Lines of a text without what differs from run to run."""
    text = re.sub(r"\S*/(tmp\w+)/", "TMP/", text).replace(
        str(Path(physim.__file__).parents[1]), "ROOT"
    )
    text = re.sub(r"(numpy|h5py|shapely|pymunk|physim) \d+(\.\w+)+", r"\1 VERSION", text)
    text = re.sub(r"\b[0-9a-f]{64}\b", "DIGEST", text)
    text = re.sub(r"(real-time factor +)[\d.,]+", r"\1N", text)
    text = re.sub(r"processor \S+", "processor P", text)
    return [line for line in text.splitlines() if not line.startswith("made with")]


def cleaned(value: Any) -> Any:
    """JSON values without seconds by the clock, versions and folders."""
    if isinstance(value, dict):
        left_out = ("versions", "wall_clock", "real_time_factor", "cpu_seconds", "sources")
        return {k: cleaned(v) for k, v in value.items() if k not in left_out}
    if isinstance(value, list):
        return [cleaned(one) for one in value]
    return "\n".join(scrubbed(value)) if isinstance(value, str) else value


@functools.cache
def folder() -> Path:
    """A folder of this process for its runs; it goes with the process."""
    whole = tempfile.mkdtemp(prefix="tmp")
    atexit.register(shutil.rmtree, whole, ignore_errors=True)
    return Path(whole)


@functools.cache
def record(name: str) -> physim.Record:
    """The record of one of `RUNS`, made by the command."""
    target = folder() / name
    said("run", *RUNS[name], "-o", str(target), "--no-video", "--quiet")
    return physim.Record.load(target / "record.h5")


def run_of(name: str) -> dict[str, Any]:
    """All that the commands say of one run."""
    record(name)
    path, world = str(folder() / name / "record.h5"), RUNS[name][0]
    found = folder() / f"{name}.json"
    told = {
        "summary": said("summary", path),
        "validate": said("validate", path, "--json", str(found)),
        "validate --full": said("validate", path, "--full"),
        "check": said("check", world),
    }
    told["validate --json"] = cleaned(json.loads(found.read_text()))
    for command, given in (("summary", path), ("check", world)):
        text = io.StringIO()
        with redirect_stdout(text), redirect_stderr(io.StringIO()):
            main([command, given, "--json"])
        told[f"{command} --json"] = cleaned(json.loads(text.getvalue()))
    return told


def campaign() -> dict[str, Any]:
    """What sweep, report and compare say of twelve runs, of which some have contacts."""
    study, found = str(folder() / "study"), folder() / "found.json"
    told = {
        "sweep": said(
            "sweep", "three_robots", "--seeds", "1:7", "--set", "time.duration=12",
            "--controller", "mode_switching,path_following", "-o", study, "--quiet",
        )
    }  # fmt: skip
    told["report"] = said("report", study, "--no-pictures", "--json", str(found))
    told["report --json"] = cleaned(json.loads(found.read_text()))
    told["compare"] = said("compare", study, "--by", "controller", "--json", str(found), "--force")
    told["compare --json"] = cleaned(json.loads(found.read_text()))
    return told


def digests() -> dict[str, str]:
    """Digest of the record of every shipped world, of the first seconds where it is large."""
    found = {}
    for file in sorted(Path(physim.__file__).parents[1].glob("worlds/*.yaml")):
        world = physim.load_world(file)
        if file.stem in LONG:
            world = physim.load_world(file, overrides=[f"time.duration={SECONDS}"])
        with physim.simulate(world) as one:
            found[file.stem] = one.digest()
    return found


def help_texts() -> dict[str, Any]:
    """What every command says of itself."""
    return {command or "physim": said(*command.split(), "--help") for command in COMMANDS}


def frames(name: str) -> dict[str, Any]:
    """Of some moments of a film: how many shapes of each kind and colour, and all texts."""
    return {f"{time} s": frame(record(name), time) for time in TIMES}


def frame(run: physim.Record, time: float) -> dict[str, Any]:
    shapes: Counter[str] = Counter()
    texts: list[str] = []
    draw_paths, area = Canvas.draw, Canvas.area

    def noted(self: Any, paths: Any, faces: Any = (), edges: Any = (), widths: Any = (1.0,),
              **how: Any) -> None:  # fmt: skip
        for k in range(max(len(paths), len(how.get("at", ())))):
            codes = paths[k % len(paths)].codes
            pieces = 1 if codes is None else int((codes == Codes.MOVETO).sum())
            for kind, colours in (("fill", faces), ("line", edges)):
                if len(colours) and (kind == "fill" or widths[k % len(widths)]):
                    colour = tuple(round(float(one)) for one in colours[k % len(colours)])
                    shapes[f"{kind} {colour}"] += pieces
        draw_paths(self, paths, faces, edges, widths, **how)

    def noted_area(self: Any, *given: Any) -> None:
        shapes[f"area {given[-1]}"] += 1
        area(self, *given)

    def noted_text(text: str, *given: Any, **how: Any) -> Any:
        texts.append(text)
        return sprite(text, *given, **how)

    with ExitStack() as patches:
        patches.enter_context(mock.patch.multiple(Canvas, draw=noted, area=noted_area))
        for name, module in [*sys.modules.items()]:
            if name.startswith(ROOM) and getattr(module, "sprite", None) is sprite:
                patches.enter_context(mock.patch.object(module, "sprite", noted_text))
        image = frame_at(run, min(time, run.steps_run * run.dt))
    return {"size": list(image.shape), "shapes": dict(sorted(shapes.items())), "texts": texts}


def plots() -> dict[str, Any]:
    """Of each plot of a record: every axes, its texts, its curves."""
    found = {}
    with figures() as drawn:
        files = draw(record(PLOTS), folder() / "plots", force=True)
    for file, figure in zip(files, drawn, strict=True):
        found[file.stem] = [axes_of(axes) for axes in figure.axes]
    return found


@contextmanager
def figures() -> Iterator[list[Any]]:
    """Figures that are saved meanwhile."""
    saved: list[Any] = []
    real = matplotlib.figure.Figure.savefig

    def save(figure: Any, *given: Any, **more: Any) -> Any:
        saved.append(figure)
        return real(figure, *given, **more)

    with mock.patch.object(matplotlib.figure.Figure, "savefig", save):
        yield saved


def axes_of(axes: Any) -> dict[str, Any]:
    return {
        "labels": [axes.get_title(), axes.get_xlabel(), axes.get_ylabel()],
        "limits": [*axes.get_xlim(), *axes.get_ylim()],
        "texts": sorted({text.get_text() for text in axes.texts} - {""}),
        "curves": [spread(line.get_xydata(), line.get_label()) for line in axes.lines],
        "others": dict(sorted(Counter(type(one).__name__ for one in axes.collections).items())),
    }


def spread(values: Any, label: str = "") -> list[Any]:
    """What a curve or an array holds, in five numbers, after its label."""
    flat = np.asarray(values, dtype=float).ravel()
    finite = flat[np.isfinite(flat)]
    if not len(finite):
        return [label, len(flat), 0]
    least, most, mean = finite.min(), finite.max(), finite.mean()
    return [label, len(flat), len(finite), *(float(f"{x:.9g}") for x in (least, most, mean))]


def page_of(name: str) -> dict[str, Any]:
    """The header and every packed array of a page."""
    html = physim.page(record(name)).html
    packed = re.findall(r'<script type="text/plain" class="run">([^<]+)', html)
    found = {}
    for k, one in enumerate(packed):
        header, arrays = unpack(one)
        header.pop("arrays")
        found[f"header {k}"] = cleaned(header)
        found[f"arrays {k}"] = {key: spread(value) for key, value in sorted(arrays.items())}
    return found


def everything() -> dict[str, Callable[[], Any]]:
    """What is kept, by the name of its file."""
    return {
        **{f"run_{name}": functools.partial(run_of, name) for name in RUNS},
        **{f"frames_{name}": functools.partial(frames, name) for name in FRAMES},
        **{f"page_{name}": functools.partial(page_of, name) for name in PAGES},
        "plots": plots,
        "campaign": campaign,
        "digests": digests,
        "help": help_texts,
    }
