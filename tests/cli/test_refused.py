"""Bad input: exit code 2, one line that says where, what was given and what is allowed.

Nothing is written. What is said is matched by its meaning, not by its words.
"""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import pytest

from physim.drawing.plots import NAMES
from tests.cli.commands import SMALL, physim, tree
from tests.helpers import check_error, inside
from tests.helpers.records import make_record

COMMANDS = inside("physim.cli", "COMMANDS")
REGISTERED = ", ".join(inside("physim.parts", "part_names")(inside("physim.parts", "CONTROLLER")))

DRAWN = """\
name: drawn
time: {step: 0.02, duration: 1.0}  # [s]
corridor:
  random: {length: 80.0, width: [5.0, 8.0], clutter: 12.0, passage: 2.5}
robots:
  - {name: a, footprint: {length: 1.2, width: 0.8}, pose: [6.0, 0.0, random], path: {offset: 0.3}}
"""
SOUND = "tests.testing.broken:Sound"
ADJUSTABLE = "tests.testing.broken:Adjustable"
BELOW_10_15 = "a whole number from 0 to 10^15"
DIGITS = "9" * 5000
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 30 15">'
RIM = '<path id="rim" fill="none" d="M 2,2 L 28,2 L 28,13 L 2,13 Z"/>'


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of all that can stand in the way of a command; none may change it."""
    folder = tmp_path_factory.mktemp("place")
    texts = {
        "small.yaml": SMALL, "taken.yaml": "mine", "file": "mine", "there.html": "mine",
        "earlier/record.h5": "mine", "full/mine": "mine", "text.h5": "no record",
        "small.png": "mine", "drawn.yaml": DRAWN,
        "narrow.yaml": DRAWN.replace("passage: 2.5", "passage: 9.5"),
        "digits.yaml": SMALL.replace("seed: 1", f"seed: {DIGITS}"),
        "rim.svg": f"{HEAD}\n  {RIM}\n</svg>",
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    (folder / "link").symlink_to("nowhere")
    (folder / "full/loop").symlink_to("loop")
    os.mkfifo(folder / "pipe")
    (folder / "a").mkdir()
    make_record(folder / "a/record.h5", 2, 1.0, contacts=False).close()
    whole = (folder / "a/record.h5").read_bytes()
    (folder / "half.h5").write_bytes(whole[: len(whole) // 2])
    return folder


Table = dict[tuple[str, ...], tuple[str, ...]]

OPTIONS: Table = {
    ("walk",): ("physim walk:", ", ".join(COMMANDS)),
    ("none.yaml",): ("physim none.yaml", ", ".join(COMMANDS)),
    ("valdate", "x"): ("physim valdate", '"validate"'),
    ("--seed", "3", "run", "x"): ("--seed", "physim COMMAND ... --seed"),
    ("--versoin",): ("--versoin", '"--version"'),
    ("run",): ("physim run", "WORLD is missing"),
    ("import",): ("physim import", "SOURCE is missing"),
    ("import", "x"): ("physim import", "-o/--output is missing"),
    ("list", "a"): ("a:", "too many", "physim list"),
    ("run", "a", "b c"): ('"b c"', "too many", "physim run"),
    ("validate", "x", "--sede", "3"): ("--sede", "physim validate", '"--seed"'),
    ("video", "x", "--seed", "3"): ("--seed", "physim video", '"--speed"'),
    ("import", "x", "-o", "y", "--untried"): ("--untried", "no such option", "--no-run"),
    ("compare", "x", "--seeds", "1:3"): ("--seeds", "no such option", "physim sweep"),
    ("run", "x", "--fast=3"): ("--fast", "physim run", "physim run --help"),
    ("run", "x", "-q"): ("-q", "physim run"),
    ("run", "x", "--quiet=3"): ("--quiet", "given 3"),
    ("validate", "x", "--s", "3"): ("--s", "no such option"),
    ("check", "x", "--quiet=no"): ("--quiet", "no such option"),
    ("run", "x", "--quiet", "--quiet"): ("--quiet:", "twice"),
    ("validate", "x", "--json", "--quiet"): ("--json", "name of a file", "standard output"),
    ("run", "x", "--set", "--force"): ("--set", "KEY=VALUE is missing"),
    ("run", "x", "-o", "--force"): ("-o/--output", "DIR is missing", "runs/NAME-SEED"),
    ("run", "x", "-o", ""): ('-o/--output ""', "name of a file or folder"),
    ("summary", ""): ('RECORD ""', "name of a file or folder"),
    ("plot", "x", "--format", "pgn"): ("--format pgn", "png, svg, pdf", '"png"'),
    ("video", "x", "--fps", "0"): ("--fps 0", "whole number from 1 to 240"),
    ("video", "x", "--fps", "241"): ("--fps 241", "whole number from 1 to 240"),
    ("video", "x", "--speed", "0"): ("--speed 0", "number from 0.001 to 1000000"),
    ("video", "x", "--speed=nan"): ("--speed nan", "number from 0.001 to 1000000"),
    ("video", "x", "--width", "641"): ("--width 641", "even number from 160 to 1280"),
    ("crashtest", "--cases", "0"): ("--cases 0", "whole number from 1 to 1000000000"),
    ("crashtest", "--cases", ""): ('--cases ""', "whole number from 1 to 1000000000"),
    ("reproduce", "--workers", "1025"): ("--workers 1025", "whole number from 1 to 1024"),
    ("plot", "x", "--width", "0.3"): ("--width 0.3", "column", "page", "from 3.3 to 20"),
    ("plot", "x", "--width", "colum"): ("--width colum", "column", "page", "from 3.3 to 20"),
    ("plot", "x", "--snapshots", "inf"): ("--snapshots inf", "number greater than 0"),
    ("sweep", "x", "--seeds", "3"): ("--seeds 3", "A:B", "whole numbers from 0 to 10^15"),
    ("sweep", "x", "--seeds", "3:3"): ("--seeds 3:3", "A below B"),
    ("import", "x", "-o", "y", "--from", "1"): ("--from 1", "X,Y", "two numbers", "14.5,-3"),
    ("import", "x", "-o", "y", "--start", "-1"): ("--start -1", "number of 0 or more"),
    ("import", "x", "-o", "y", "--lanes", "0"): ("--lanes 0", "whole number from 1 to 10000"),
    ("import", "x", "-o", "y", "--robot", "1,0"): ("--robot 1,0", "LENGTH,WIDTH", "1.8,1.0"),
    ("page", "x.h5", "-o", "a\nb.html"): (r'-o/--output "a\u000ab.html"', "in one line"),
    ("run", "x", "--seed", "1", "--set", "seed=1", "--seed=2"): ("--seed:", "twice"),
    ("run", "x", "-o", "a", "--output", "b"): ("--output:", "twice"),
    ("run", "x", "--set", "robots[0].name=a", "--set", "robots.0.name=b"): (
        "--set robots.0.name", "given twice",
    ),
    ("run", "small.yaml", "--set", "seed=1", "--seed", "2"): ("--set seed:", "twice", "--seed"),
    **{("run", "small.yaml", "--seed", seed): (f"--seed {seed or chr(34) * 2}:", BELOW_10_15)
       for seed in ("x", "-1", "1.5", "", "1e3", "9" * 20, "٣")},
    **{("import", "a.svg", "-o", "w", "--scale", one): (f"--scale {one or chr(34) * 2}:",)
       for one in ("1_0", "١", "1e", "0x1", "1,0", "")},
}  # fmt: skip
"""What the command line itself refuses"""

TOGETHER: Table = {
    ("validate", "ten_robots", "--no-rerun"): ("--no-rerun", "record"),
    ("validate", "ten_robots", "--world", "straight"): ("--world", "record"),
    ("validate", "a/record.h5", "--seed", "3"): ("--seed", "world"),
    ("validate", "a/record.h5", "--set", "seed=3"): ("--set", "--world"),
    ("validate", "a/record.h5", "--no-rerun", "--controller", "constant"): ("--controller",),
    ("schema", "--force"): ("--force", "-o"),
    ("summary",): ("physim summary", "RECORD is missing", "--definitions"),
    ("summary", "--definitions", "r.h5"): ("--definitions:", "record"),
    ("report", "x", "--no-pictures", "--videos"): ("--videos", "--no-pictures"),
    ("report", "x", "--no-pictures", "--pages"): ("--pages", "--no-pictures"),
    ("report", "x", "-o", "x/pages/4f1c.html", "--force"): ("x/pages/4f1c.html", "part of"),
    ("compare", "x", "--by", "controller", "--only", "finish"): ("--only", "given: finish; did"),
    ("plot", "x", "--only", "modes", "--snapshots", "3"): ("--snapshots", "trajectories"),
    ("plot", "a/record.h5", "--only", "mode"): (
        "no figure is called", '"mode"', ", ".join(NAMES), '"modes"',
    ),
    ("reproduce", "--figure", "1", "--study", "alpha"): ("--study", "--figure"),
    ("video", "x", "--at", "5", "-o", "a.mp4"): ("a.mp4", "still", '"a.png"'),
    ("video", "x", "--at", "5", "--to", "7"): ("--to", "--at 5"),
    ("video", "x", "--at", "5", "--fps", "7"): ("--fps", "--at 5"),
    ("video", "x", "-o", "a.png"): ("a.png", "--at T"),
    ("video", "x", "-o", "a.avi"): ("a.avi", ".mp4, .m4v, .gif, .webp"),
    ("video", "x", "-o", "a.gif", "--fps", "30"): ("--fps 30", "GIF", "25"),
    ("run", "ten_robots", "--controller", "path_following", "--set",
     "controller.type=mode_switching"): ("--set controller.type", "path_following", "one of them"),
    ("run", "ten_robots", "--controller", "path_following", "--set",
     "controller={alpha: 1}"): ("--set controller", "path_following"),
    ("sweep", "ten_robots", "--seeds", "1:3", "--set", "seed=7"): ("--set seed", "--seeds"),
    ("sweep", "three_robots", "--seeds", "1:9", "--until", "rate > x"): (
        '--until "rate > x":', "a width above 0 and below 1",
    ),
    ("sweep", "three_robots", "--seeds", "1:9", "--until", "2"): (
        "--until 2:", "0.02", "contact_free",
    ),
    ("sweep", "three_robots", "--until", "0.1"): ("--until:", "--seeds"),
    ("sweep", "three_robots", "--seeds", "1:9", "--until", "0.1", "--shard", "1/2"): (
        "--until:", "--shard",
    ),
    ("new", "b", "--like", "drawn.yaml", "--seed", "1", "--robots", "3"): ("--robots", "--seed"),
    ("new", "b", "--seed", "3"): ("", "straight.yaml", "no corridor.random", "--seed"),
    ("new", "a", "-o", "b", "--project", "c"): ("", "-o", "--project", "one of them"),
}  # fmt: skip
"""Options that would have no effect, or would undo each other"""

INPUTS: Table = {
    ("run", "nope.yaml"): ("nope.yaml:", "no such file"),
    ("run", "smal.yaml"): ("smal.yaml:", "no such file", "small.yaml"),
    ("run", "strait"): ("strait:", "no such file", '"strait"', "straight"),
    ("run", "earlier/"): ("earlier:", "folder"),
    ("run", "a\nb\x1b[0m"): (r"a\u000ab\u001b[0m", "no such file"),
    ("run", "digits.yaml"): ("digits.yaml:2:7:", "seed", "5000 digits"),
    ("run", "small.yaml", "--set", f"seed={DIGITS}"): ("--set seed", "digits"),
    ("run", "small.yaml", "--seed", DIGITS): ("--seed",),
    ("run", "small.yaml", "--set", "seed=0x_"): ("--set seed",),
    ("run", "small.yaml", "--set", "time.step"): ("--set time.step:", '"time.step"', "KEY=VALUE"),
    ("run", "small.yaml", "--set", "time.stp=0.1"): (
        "--set time.stp:", "step, duration, record_every", '"step"',
    ),
    ("run", "small.yaml", "--set", "robots.5.name=x"): (
        "--set robots.5.name:", "no entry 5", "entries 0 to 1",
    ),
    ("run", "small.yaml", "--set", "time.step=abc"): ("--set time.step:", "a number", '"abc"'),
    ("run", "small.yaml", "--set", "time.step=[1"): ("--set time.step:", "YAML"),
    ("run", "small.yaml", "--controller", "nobody"): ("--controller:", '"nobody"', REGISTERED),
    ("run", "small.yaml", "--controller", "own/ctl.py"): ("--controller:", "MODULE:CLASS"),
    ("run", "small.yaml", "--controller", "ctl.Ttc"): ("--controller:", "MODULE:CLASS"),
    ("run", "small.yaml", "--controller", "no_such.module:X"): (
        "--controller:", '"no_such.module:X"', 'no module "no_such.module" in the current folder',
    ),
    ("run", "small.yaml", "--controller", "os:system"): (
        "--controller:", '"os:system"', 'module "os" has no class "system"',
    ),
    ("run", "small.yaml", "--controller", "pathlib:Path"): (
        "--controller:", '"pathlib:Path"', "decide(observation, memory)",
    ),
    ("check-controller", "nosuch"): ("no controller", '"nosuch"', REGISTERED),
    ("check-controller", SOUND, "--world", "strait"): ("strait:", "no such file", "straight"),
    ("check-controller", ADJUSTABLE, "--set", "controller.shares=1"): (
        "--set controller.shares:", "unknown",
    ),
    ("check-controller", ADJUSTABLE, "--set", "controller.share=x"): ("--set controller.share:",),
    ("check-controller", ADJUSTABLE, "--set", "time.step=1"): ("--set time.step:", "no setting"),
    ("check-controller", SOUND, "--set", "controller.type=constant"): ("--set controller.type:",),
    ("check-controller", SOUND, "--set", "controller=constant"): ("--set controller:",),
    ("check-controller", SOUND, "--seconds", "0"): ("--seconds 0:", "from 0.001 to"),
    **{(command, record): (f"{record}:",) for command in ("summary", "video", "page", "plot")
       for record in ("none.h5", "file", "small.yaml", "earlier/record.h5", "half.h5", "text.h5")},
    ("video", "no\nsuch.h5"): (r'RECORD "no\u000asuch.h5"', "in one line"),
    ("video", "a/record.h5", "none.h5", "-o", "c.mp4"): ("none.h5:",),
    ("video", "a/record.h5", "-o", "b.png", "--at", "99"): ("99 s", "from 0 to 1 s"),
    **{("video", "a/record.h5", "-o", "b.mp4", *times): (place, "before the end")
       for *times, place in (("--from", "300", "--to", "2", "from 300 s to 1 s:"),
                             ("--from", "0.5", "--to", "0.5", "from 0.5 s to 0.5 s:"),
                             ("--from", "1", "from 1 s to 1 s:"))},
    ("page", "a/record.h5", "half.h5"): ("half.h5:",),
    ("page", "."): ("record.h5:", "no such file"),
    ("page", *(("a/record.h5",) * 7)): ("a page shows 1 to 6 records", "7"),
    ("page",): ("physim page:", "RECORD", "missing"),
    ("replay", "a\nb:0"): (r'"a\u000ab:0"', "DIR:ROW"),
    ("reproduce", "--figure", "9"): ('--figure "9":', "1, 2, 3, 3a, 4, 6, 7, 8"),
    ("reproduce", "--figure", "5"): ("--figure 5:", "flow chart"),
    ("reproduce", "--study", "bend"): ('--study "bend":', "bends"),
    ("import", "rim.svg", "-o", "o.yaml", "--scale", "1"): (
        "rim.svg:2:", '"rim" (line 2)', '--ignore "rim"',
    ),
    ("new", "b", "--like", "drawn.yaml", "--seed", "-1"): ("--seed", "-1"),
    ("new", "b", "--like", "narrow.yaml", "--seed", "1"): (
        "narrow.yaml:4:69", "corridor.random.passage", "9.5 m",
    ),
    ("new",): ("physim new:", "NAME", "missing"),
    **{("new", name): (f"{shown}:", "cannot name") for name, shown in (
        ("", '""'), ("  ", '"  "'), ("..", ".."), (".hidden", ".hidden"), ("a\nb", r'"a\u000ab"'),
        ("../b", "../b"), ("a/b", "a/b"), ("a\\b", "a\\b"))},
    ("new", "a/b"): ("a/b:", "-o takes a path"),
    ("new", "x" * 101): ("x" * 59, "cannot name", "at most 100"),
    ("new", "a", "--robots", "0", "--like", "jam"): ("--robots 0:", "1 to 20000"),
    ("new", "a", "--robots", "11"): ("--robots 11:", "straight", "one by one"),
    ("new", "a", "--like", "dorway"): ("dorway:", "no such file", '"doorway"'),
    ("preview", "small.yaml", "-o", "a.png", "--set", "robots.0.pose=[1, 2]"): (
        "--set robots.0.pose:",
    ),
}  # fmt: skip
"""Worlds, records, controllers, drawings and names that cannot be"""

OUTPUTS: Table = {
    ("run", "small.yaml", "-o", "earlier"): ("earlier:", "record.h5", "--force", "-o"),
    **{("run", "small.yaml", "-o", name, *more): (f"{name}:", "-o takes a folder")
       for name, *more in (("link",), ("file",), ("file", "--force"), ("pipe",))},
    ("run", "small.yaml", "-o", "file/run"): ("file/run:", "Not a directory"),
    ("run", "small.yaml", "-o", "/proc/none/run"): ("/proc/none/run:", "No such file or directory"),
    **{("video", "a/record.h5", "-o", name): (f"{name}:",)
       for name in ("file/x.mp4", "/proc/none/x.mp4", "none/x.mp4", "earlier")},
    ("crashtest", "--json", "nowhere/x.json"): ("nowhere/x.json:", "no folder nowhere"),
    ("crashtest", "-o", "file"): ("file:", "is a file", "-o takes a folder"),
    ("reproduce", "--force", "-o", "file"): ("file:", "is a file", "-o", "a folder"),
    ("page", "a/record.h5", "-o", "a/record.h5"): ("a/record.h5:", ".html"),
    ("page", "a/record.h5", "-o", "no/run.html"): ("no/run.html:", "folder no"),
    ("page", "a/record.h5", "-o", "there.html"): ("there.html:", "--force"),
    ("preview", "small.yaml"): ("small.png:", "exists", "--force"),
    ("preview", "small.yaml", "-o", "a.pdf"): ("a.pdf:", ".png", ".svg"),
    ("preview", "small.yaml", "-o", "."): (".:", "a folder"),
    ("preview", "small.yaml", "-o", "small.yaml/a.png"): ("small.yaml/a.png:", "cannot be written"),
    ("new", "a", "-o", "no/a.yaml"): ("no/a.yaml:", "no folder no"),
    ("new", "a", "-o", "."): (".:", "is a folder", "-o"),
    ("new", "a", "-o", "text.h5", "--force"): ("text.h5:", ".yaml"),
    ("new", "a", "-o", "world.schema.json"): ("world.schema.json", "the schema"),
    ("new", "taken"): ("taken.yaml:", "exists", "--force", "-o"),
    ("new", "--like", "drawn.yaml", "-o", "drawn.yaml"): ("drawn.yaml", "an input"),
    ("new", "--project", "full"): ("full:", "not empty", "--force"),
    ("new", "--project", "taken.yaml"): ("taken.yaml:", "is a file", "--project", "a folder"),
    ("new", "--project", "taken.yaml/x"): ("taken.yaml/x", "Not a directory"),
    ("new", "--project", "a\x1bb"): (r"a\u001bb:", "cannot name a world", "letters and digits"),
    ("new", "--project", "a\nb"): ("", r"a\u000ab", "in one line"),
    ("new", "--project", "full/loop"): ("full/loop",),
    ("new", "a/b", "--project", "new"): ("a/b:", "takes a path"),
    ("new", "--project", "new", "--robots", "99"): ("--robots 99:", "straight"),
}  # fmt: skip
"""Places that cannot be written, or are taken"""

REFUSED = {**OPTIONS, **TOGETHER, **INPUTS, **OUTPUTS}


@pytest.mark.parametrize("arguments", REFUSED, ids=lambda words: " ".join(words)[:60])
def test_it_is_refused_in_one_line(
    arguments: tuple[str, ...], place: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.chdir(place)
    before = tree(place)
    done = physim(*arguments, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, *REFUSED[arguments])
    assert tree(place) == before


def test_nothing_is_suggested_that_is_not_near(capsys) -> None:
    for arguments in (("run", "x", "--fast"), ("none.yaml",), ("new", "a", "--like", "q")):
        assert "did you mean" not in physim(*arguments, capture=capsys).err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_names_itself_when_it_refuses_an_option(name: str, capsys) -> None:
    needed = {
        "import": ["a", "-o", "b"], "list": [], "schema": [], "crashtest": [], "reproduce": [],
        "branch": ["a", "--at", 1], "judge": ["a", "--world", "b"],
        "bear": ["a", "--vary", "x", "--target", 0.9, "--most", 1], "league": [],
    }.get(name, ["a"])  # fmt: skip
    done = physim(name, *needed, "--no-such-thing", 3, capture=capsys)
    assert (done.code, done.out) == (2, "")
    check_error(done.err, "--no-such-thing:", f"physim {name}", f"physim {name} --help")


WORLDS = {
    "syntax": ("{step: 0.02, duration", "{step: 0.02 duration", "w.yaml:3:"),
    "unknown key": ("formation:", "formatoin:", "w.yaml:14:1: formatoin:", '"formation"'),
    "infinite": ("duration: 2.0", "duration: .inf", "w.yaml:3:30: time.duration:", "finite"),
    "overlap": ("[6.0, 1.0", "[3.5, -1.0", "w.yaml:12:11: robots[1].pose:", '"b" overlaps "a"'),
    "class in a world": (
        "expect:", 'controller: {type: "os:system"}\nexpect:',
        "w.yaml:15:20: controller.type:", '"os:system"', "--controller",
    ),
}  # fmt: skip
"""By fault: what stands in the small world in the place of what; where the error is; what it says.
Every fault of a world is tested in the room of worlds."""


@pytest.mark.parametrize("fault", WORLDS)
def test_a_faulty_world_is_refused_at_its_place(fault: str, here: Path, capsys) -> None:
    old, new, *said = WORLDS[fault]
    assert SMALL.count(old) == 1
    (here / "w.yaml").write_text(SMALL.replace(old, new))
    before = tree(here)
    for command in (("run",), ("preview", "-o", "a.png")):
        done = physim(command[0], "w.yaml", *command[1:], capture=capsys)
        assert (done.code, done.out) == (2, "")
        check_error(done.err, *said)
    assert tree(here) == before


RECORDS = {
    "rows": (lambda file: file["/contacts"].resize(200_000_000, axis=0), "/contacts"),
    "acts": (lambda file: file.attrs.create("version", ACTS), "record version"),
    "not a number": (lambda file: file.attrs.create("dt", float("nan")), "attribute dt is"),
}
ACTS = "r1\x1b[31m\x1b]0;title\x07\x9b2J\u202eevil\nFORGED line"
"""What would act on a terminal"""


@pytest.mark.parametrize("kind", RECORDS)
def test_a_forged_record_is_refused(kind: str, here: Path, capsys) -> None:
    """Before anything of it is read into memory or shown."""
    change, *said = RECORDS[kind]
    make_record(here / "record.h5", seconds=1.0).close()
    with h5py.File(here / "record.h5", "r+") as file:
        change(file)
    done = physim("summary", "record.h5", capture=capsys)
    assert (done.code, done.out, done.err.count("\n")) == (2, "", 1)
    assert done.err[:-1].isprintable()
    assert all(part in done.err for part in said), done.err


def test_nothing_in_a_file_acts_on_the_terminal(here: Path, capsys) -> None:
    (here / "w.yaml").write_text('name: "\\e[31m\\x9b\\u202e"\n"\\e[2J": 1\n')
    (here / "d.svg").write_text(f'{HEAD}<g id="\u202e\x9b\u200b"/></svg>')
    (here / "t.csv").write_text("x_m,y_m,\x1b[2J\n1,2,3\n")
    odd = "\x1b[31m\u202e.yaml"
    (here / odd).write_text("name: 1\n")
    for words in (("check", "w.yaml"), ("import", "d.svg", "-o", "x.yaml", "--scale", 1),
                  ("import", "t.csv", "-o", "x.yaml"), ("check", odd)):  # fmt: skip
        done = physim(*words, capture=capsys)
        assert done.code == 2
        assert (done.out + done.err).replace("\n", "").isprintable()


def test_what_is_odd_but_meant_is_taken(here: Path, capsys) -> None:
    """A negative place after its option."""
    (here / "room.wkt").write_text("POLYGON ((-10 -5, 20 -5, 20 5, -10 5, -10 -5))")
    for form in (("--from", "-6,1"), ("--from=-6,1",)):
        words = ("import", "room.wkt", "-o", "w.yaml", "--force", *form, "--to", "15,0")
        assert physim(*words, capture=capsys)[::2] == (0, "")
