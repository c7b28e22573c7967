"""Damaged and hostile worlds: each gets a verdict or a clean refusal, soon and in little memory."""

from __future__ import annotations

import json
import re
import resource
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim import Simulation, build_scene
from physim.errors import WorldError
from physim.world.checks import Findings, check_world
from physim.world.file import parse_world
from tests.helpers import examples
from tests.world.worlds import CORRIDOR, DRAWN, check

BYTES = 500 * 1024**2


def judged(folder: Path, data: bytes) -> Findings:
    """Check bytes as a file; the findings must be whole, whatever they say."""
    file = folder / "w.yaml"
    file.write_bytes(data)
    found = check_world(file)
    for finding in (*found.errors, *found.warnings):
        assert finding.line is None or finding.line >= 1
        assert str(finding).isprintable()
        assert len(str(finding)) < 1000
    json.dumps(found.as_json(), allow_nan=False)
    return found


@pytest.mark.deep
@pytest.mark.parametrize("text", [CORRIDOR, DRAWN])
def test_a_world_cut_at_any_byte_gets_a_verdict(tmp_path, text):
    data = text.encode()
    verdicts = [judged(tmp_path, data[:end]).ok for end in range(len(data))]
    assert verdicts.count(False) > 0.8 * len(data)
    assert verdicts.count(True) > 3  # cut after the last key that a world needs


SIZES = st.one_of(
    st.sampled_from([0.0, 5.0e-324, 1.0e-20, 1.0e-9, 1.0e-7, 1.0e-3, 1.0, 29.0, 1.0e3]),
    st.floats(-25.0, 3.0).map(lambda power: 10.0**power),
)


@examples(20, deep=60)
@given(long=SIZES, wide=SIZES, is_box=st.booleans())
def test_check_and_run_agree_on_footprints_of_any_size(tmp_path_factory, long, wide, is_box):
    points = [[0.0, 0.0], [long, 0.0], [0.5 * long, wide]]
    footprint = f"{{length: {long!r}, width: {wide!r}}}" if is_box else f"{points!r}"
    text = CORRIDOR.replace("{length: 1.8, width: 1.0}", _in_yaml(footprint), 1)
    found = check(tmp_path_factory.getbasetemp(), text)
    try:
        Simulation(parse_world(text))
    except WorldError:
        assert not found.ok, footprint
    else:
        assert found.ok, footprint


def _in_yaml(text: str) -> str:
    """Numbers as worlds may hold them: with a point before an exponent, and a sign in it."""
    return re.sub(r"(?<![\d.])(\d+)e([-+]?\d+)", r"\1.0e\2", text)


NUMBERS = st.one_of(
    st.floats(-100.0, 100.0).map(lambda x: f"{x:.3f}"),
    st.sampled_from(["0", "0.0", "-1", "1.0e+6", "-1.0e+6", "1.0e-9", "1.0e+300", "3", "30", "4"]),
)


@examples(25, deep=150)
@given(data=st.data())
def test_what_check_passes_is_built_and_what_is_not_built_check_refuses(tmp_path_factory, data):
    """The other way round does not hold: check refuses a path through a wall, a run does not."""
    text = data.draw(st.sampled_from([CORRIDOR, DRAWN]))
    spots = numbers_of(text)
    chosen = data.draw(st.lists(st.sampled_from(spots), max_size=3, unique=True))
    for start, end in sorted(chosen, reverse=True):
        text = text[:start] + data.draw(NUMBERS) + text[end:]
    found = check(tmp_path_factory.getbasetemp(), text)
    try:
        scene = build_scene(parse_world(text))
    except WorldError as error:
        reported = " ".join(finding.message for finding in found.errors)
        refused = [fault.message[:20] for fault in error.faults]
        scene = None
    else:
        refused, reported = [], ""
    is_unit_doubted = any("centimetres" in warning.message for warning in found.warnings)
    left_out = [message for message in refused if message not in reported]
    assert left_out == [] or (found.errors and is_unit_doubted)  # they follow from the wrong unit
    assert scene is None or found.layout.world == scene.world
    assert found.ok <= (scene is not None)


def numbers_of(text: str) -> list[tuple[int, int]]:
    return [match.span() for match in re.finditer(r"-?[0-9]+\.?[0-9]*", text)]


def nested(levels: int) -> str:
    return "name: x\nrobots: " + "[" * levels + "]" * levels + "\n"


HEAD = """\
name: x
time: {step: 0.01, duration: 1.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8}
"""
ROBOT = "{name: r%d, footprint: {length: 0.5, width: 0.4}, pose: [%d, 0, 0], path: {offset: 0}}"

WORST = {
    "deep flow": nested(100_000),
    "deep blocks": "".join(" " * k + "a:\n" for k in range(1500)),
    "laughs": "a: &a [x, x, x, x, x, x, x, x, x]\n"
    + "".join(f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in pairwise("abcdefghij")),
    "quadratic": f"a: &a [{', '.join(['1'] * 5000)}]\nb: [{', '.join(['*a'] * 5000)}]\n",
    "a long key": "? " + "k" * 1_000_000 + "\n: 1\n",
    "many keys": "".join(f"k{k}: 1\n" for k in range(200_000)),
    "a great many points": HEAD.replace(
        "[[0, 0], [30, 0]]", "[" + ", ".join(f"[{k}, 0]" for k in range(100_001)) + "]"
    ),
    "a thousand robots": HEAD.replace("30", "1100")
    + f"robots: [{', '.join(ROBOT % (k, k) for k in range(1000))}]\n",
    "many robots in one place": HEAD
    + f"robots: [{', '.join(ROBOT % (k, 3) for k in range(300))}]\n",
    "a long zigzag": HEAD.replace(
        "[[0, 0], [30, 0]]", f"[{', '.join(f'[{k % 2}, {k // 2}.{k % 7}]' for k in range(3000))}]"
    ),
    "a long road": HEAD.replace("30", "999999")
    + f"robots: [{', '.join(ROBOT % (k, k) for k in range(20))}]\n",
    "a star of boundaries": HEAD.replace("corridor:", "was:")
    + "boundaries:\n"
    + "".join(f"  - [[{k}, -50], [{99 - k}, 50]]\n" for k in range(100))
    + f"reference_path: [[1, 0], [2, 0]]\nrobots: [{ROBOT % (1, 1)}]\n",
    "a footprint like a comb": HEAD
    + "robots: [{name: c, pose: [9, 0, 0], path: {offset: 0}, footprint: ["
    + ", ".join(f"[{k / 500}, {1 if k % 2 else 0.1}]" for k in range(500))
    + ", [1, -1], [0, -1]]}]\n",
}  # fmt: skip


def limit() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (3 * BYTES, 3 * BYTES))  # libraries map more than used
    resource.setrlimit(resource.RLIMIT_CPU, (60, 60))


SCRIPT = """
import json, sys
from physim.world.checks import check_world
for name in sys.argv[1:]:
    found = check_world(name)
    print(json.dumps([name, found.ok, [str(f) for f in found.errors][:3]]), flush=True)
"""


@pytest.mark.deep
def test_the_worst_worlds_are_judged_in_time_and_little_memory(tmp_path):
    for name, text in WORST.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    files = [f"{name}.yaml" for name in WORST]
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *files], cwd=tmp_path, capture_output=True,
        text=True, timeout=120, preexec_fn=limit,
    )  # fmt: skip
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.stderr == ""
    assert [row[0] for row in rows] == files
    accepted = {name for name, ok, _ in rows if ok}
    assert accepted == {"a long road.yaml", "a thousand robots.yaml"}
    for name, ok, errors in rows:
        assert ok or all(len(error) < 1000 for error in errors), name
