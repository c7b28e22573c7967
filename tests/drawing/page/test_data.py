"""What is packed comes back: poses to their tolerance, decisions, contacts, considered robots."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import physim
from physim.analysis.summary import summarise
from physim.errors import PhysimError
from tests.helpers import examples, inside
from tests.helpers.records import make_record
from tests.helpers.unpacking import unpack

MOST_LINES, Timeline = inside("physim.drawing", "MOST_LINES", "Timeline")
LARGEST, Pack, between = inside("physim.drawing.page", "LARGEST", "Pack", "between")
explanations, find_knots = inside("physim.drawing.page", "explanations", "find_knots")
run_data = inside("physim.drawing.page", "run_data")
arcs = inside("physim.geometry", "arcs")

WHOLE = st.lists(st.integers(-LARGEST // 4 + 1, LARGEST // 4 - 1), max_size=60)
REAL = st.lists(
    st.one_of(st.floats(-1e5, 1e5), st.sampled_from([np.nan, np.inf, -np.inf])), max_size=60
)


@examples(25, deep=200)
@given(WHOLE, REAL, st.sampled_from([1e-3, 0.25]))
def test_numbers_come_back(whole: list[int], real: list[float], quantum: float) -> None:
    pack = Pack()
    pack.whole("whole", whole)
    pack.real("real", real, quantum)
    _, arrays = unpack(pack.to_base64({}))
    assert arrays["whole"].tolist() == whole
    finite = np.isfinite(real)
    error = arrays["real"][finite] - np.array(real)[finite]
    assert (np.abs(error) <= quantum * 0.5 + 1e-9).all()
    assert np.array_equal(arrays["real"][~finite], np.array(real)[~finite], equal_nan=True)


@pytest.mark.parametrize(
    "given",
    [
        [1e9, 1.845, np.nan, -np.inf, 1e300, 0.0, -2.5],  # large numbers, for none
        [np.nan, np.inf, 5.33e6, np.nan, 5.33e6 + 1.845],  # a time of day that begins later
        [np.nan, np.nan],
        5.8e6 + np.linspace(0.0, 250.0, 1000),  # places in a map of a whole country
        -3e8 + np.linspace(0.0, 250.0, 1000),
        1e15 + np.linspace(0.0, 250.0, 1000),
    ],
)
def test_no_number_takes_digits_from_the_others(given: list[float]) -> None:
    """Beyond what floats resolve they keep what is."""
    pack, values = Pack(), np.array(given)
    pack.real("a", values, 1e-3)
    kept = unpack(pack.to_base64({}))[1]["a"]
    step = np.spacing(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    tolerance = max(5.1e-4, 4.0 * float(step)) if step < 1e3 else 5.1e-4
    assert np.allclose(kept, values, rtol=0, atol=tolerance, equal_nan=True)


def test_whole_numbers_far_from_0_are_kept_and_those_too_large_refused() -> None:
    pack, given = Pack(), 5.8e6 + np.linspace(0.0, 250.0, 1000)
    pack.whole("b", np.rint(given / 5e-4), 5e-4, far=True)
    assert np.abs(unpack(pack.to_base64({}))[1]["b"] - given).max() <= 2.6e-4
    with pytest.raises(ValueError, match="fit"):
        pack.whole("a", [LARGEST])


COMMANDS = st.lists(
    st.tuples(st.floats(-1.3, 1.3), st.floats(-1.6, 1.6), st.integers(1, 40)),
    min_size=1,
    max_size=8,
)


@examples(20, deep=200)
@given(COMMANDS, st.sampled_from([0.001, 0.01]))
def test_knots_keep_every_sample_within_the_tolerance(
    commands: list[tuple[float, float, int]], tolerance: float
) -> None:
    pose = [np.array([1.0, -2.0, 3.0])]
    for v, omega, steps in commands:
        for _ in range(steps):
            pose.append(arcs(pose[-1][None], np.array([[v, omega]]), 0.02)[0])
    samples = np.array(pose)
    time = 0.02 * np.arange(len(samples))
    quanta = np.full(3, tolerance / 10.0)
    knots = find_knots(samples[:, None], time, quanta, tolerance, np.array([1.0]))
    row, kept = knots.row, knots.pose * quanta
    at = np.clip(np.searchsorted(row, np.arange(len(samples)), side="right") - 1, 0, len(row) - 2)
    share = (time - time[row[at]]) / (time[row[at + 1]] - time[row[at]])
    error = between(kept[at], kept[at + 1], share) - samples
    assert (np.hypot(error[:, 0], error[:, 1]) + np.abs(error[:, 2])).max() <= tolerance
    assert knots.counts.tolist() == [len(row)]


def test_decisions_and_contacts_come_back(tmp_path: Path) -> None:
    with make_record(tmp_path / "r.h5", 3, 2.5) as record:
        header, arrays = unpack(run_data(record, summarise(record)))
        rows = record.updates[np.lexsort((record.updates["step"], record.updates["robot"]))]
        for name in ("step", "mode", "rule", "considered"):
            assert np.array_equal(arrays[name], rows[name]), name
        assert np.array_equal(arrays["hold"], rows["next_step"] - rows["step"])
        for name in ("station", "formation_error", "deviation", "nominal_v"):
            assert np.allclose(arrays[name], rows[name], rtol=0, atol=5.1e-4), name
        for column in record.declared.columns:
            given, kept = rows[column.name], arrays[f"own:{column.name}"]
            assert np.allclose(kept, given, rtol=0, atol=5.1e-4, equal_nan=True), column.name
        contacts = Timeline(record).contacts
        assert np.allclose(arrays["contact_step"] * record.dt, contacts.began)
        pairs = np.column_stack((arrays["contact_a"], arrays["contact_b"]))
        assert np.array_equal(pairs, contacts.bodies)
        assert [moment["label"] for moment in header["moments"]].count("first contact") == 1
        # bins keep the shortest distance, however few they are
        assert arrays["pair"].min() == pytest.approx(record.clearance.min(), abs=1e-4)
        assert arrays["wall"].min() == pytest.approx(record.boundary_clearance.min(), abs=1e-4)
        check_considered(record, rows, arrays)


@pytest.mark.parametrize("robots", [3, MOST_LINES + 1])
def test_errors_are_those_of_samples_whoever_decided(tmp_path: Path, robots: int) -> None:
    """Robot by robot, and of a crowd with bands of all of them."""
    with make_record(tmp_path / "r.h5", robots, 5.0) as record:
        header, arrays = unpack(run_data(record, summarise(record)))
        course = Timeline(record).curves
        told = header["curves"]["error"]
        assert told == {
            "title": "formation error [m]", "name": "formation_error", "bands": robots > MOST_LINES,
        }  # fmt: skip
        shown = record.steps.searchsorted(arrays["error_step"])
        assert shown[[0, -1]].tolist() == [0, record.samples - 1]
        drawn = arrays["error"].reshape(robots, -1).T
        assert np.allclose(drawn, course.values[shown], rtol=0.0, atol=5.1e-4)
        assert ("bands" in arrays) == told["bands"]


def test_distances_of_now_of_few_samples_are_those_of_the_poses() -> None:
    """In the record they are the least since the sample before."""
    change = ["time.duration=3.0", "expect=null"]
    fine = physim.simulate(physim.load_world("crossing", overrides=change))
    coarse = physim.simulate(
        physim.load_world("crossing", overrides=[*change, "time.record_every=30"])
    )
    arrays = unpack(run_data(coarse, summarise(coarse)))[1]
    rows = np.searchsorted(fine.steps, arrays["now"])
    for name, exact, kept in (
        ("now_pair", fine.clearance, coarse.clearance),
        ("now_wall", fine.boundary_clearance, coarse.boundary_clearance),
    ):
        assert np.allclose(arrays[name], exact[rows].min(axis=1), rtol=0, atol=5.1e-5), name
        assert not np.allclose(kept.min(axis=1), exact[rows].min(axis=1), rtol=0, atol=5.1e-3)


def check_considered(
    record: physim.Record, rows: np.ndarray, arrays: dict[str, np.ndarray]
) -> None:
    """The considered robots of every decision are those of the record."""
    sets = np.cumsum(arrays["others_new"]).astype(int) - 1
    start = np.concatenate(([0], np.cumsum(arrays["others_count"]))).astype(int)
    table = record.considered
    for k, row in enumerate(rows):
        mine = (table["robot"] == row["robot"]) & (table["step"] == row["step"])
        kept = arrays["others"][start[sets[k]] : start[sets[k] + 1]]
        assert kept.tolist() == table["other"][mine].tolist()


def moved(file: Path, shift: tuple[float, float]) -> Path:
    """A record whose scene and robots are elsewhere."""
    with h5py.File(file, "r+") as record:
        for name in ("areas/accessible", "areas/safe", "paths", "reference"):
            record[f"{name}/points"][...] += shift
        record["walls/vertices"][...] += shift
        record["steps/pose"][..., :2] += shift
        for table, columns in (("contacts", ("x", "y")), ("updates", ("target_x", "target_y"))):
            rows = record[table][...]
            for column, by in zip(columns, shift, strict=True):
                rows[column] += by
            record[table][...] = rows
    return file


def test_a_run_far_from_the_origin_is_shown_as_well(tmp_path: Path) -> None:
    make_record(tmp_path / "r.h5", 3, 4.0).close()
    with physim.Record.load(tmp_path / "r.h5") as record:
        near = unpack(run_data(record, summarise(record)))[1]
    shift = (454_000.0, 5_800_000.0)
    with physim.Record.load(moved(tmp_path / "r.h5", shift)) as record:
        far = unpack(run_data(record, summarise(record)))[1]
    for name, by in zip(("knot_x", "knot_y"), shift, strict=True):
        assert np.abs(far[name] - by - near[name]).max() < 1e-3
    for name, by in zip(("own:target_x", "own:target_y"), shift, strict=True):
        assert np.abs(far[name] - by - near[name]).max() < 2e-3


@pytest.mark.parametrize(
    ("column", "far", "told"),
    [
        (0, 3e5, "robots .* apart"),
        (2, 9e7, "headings differ"),
    ],
)
def test_robots_too_far_apart_are_refused_in_a_line(
    tmp_path: Path, column: int, far: float, told: str
) -> None:
    make_record(tmp_path / "r.h5", 2, 1.0).close()
    with h5py.File(tmp_path / "r.h5", "r+") as record:
        record["steps/pose"][5, 0, column] = far
    with (
        physim.Record.load(tmp_path / "r.h5") as record,
        pytest.raises(PhysimError, match=rf"r\.h5: {told}"),
    ):
        physim.page(record)


TINY = """\
name: tiny
time: {step: 0.01, duration: 30.0}
corridor: {centreline: [[0, 0], [1, 0], [1.4, 0.3], [1.4, 1.2]], width: 0.36, end_margin: 0.1}
robots:
  - {name: t1, footprint: {length: 0.06, width: 0.04}, pose: [0.4, 0.05, 0],
     path: {offset: 0.05}, limits: {v: 0.2}}
  - {name: t2, footprint: [[0.03, 0], [-0.02, 0.02], [-0.01, 0], [-0.02, -0.02]],
     pose: [0.25, -0.05, 0], path: {offset: -0.05}, limits: {v: 0.2}}
  - {name: t3, footprint: {length: 0.06, width: 0.04}, pose: [0.1, 0, 0],
     path: {offset: 0.0}, limits: {v: 0.2}}
controller: {type: mode_switching, speed: 0.08, look_ahead: 0.1, safe_distance: 0.05,
  distance_low: 0.02, distance_high: 0.04, boundary_low: 0.008, time_low: 0.7, time_high: 1.4,
  arrival_tolerance: 0.005}
arrival: {tolerance: 0.01}
sensing: {range: 0.5}
"""


def test_the_page_keeps_values_on_their_side_of_the_thresholds() -> None:
    record = physim.simulate(physim.parse_world(TINY))
    (why,) = explanations(record)["drivers"]
    _, arrays = unpack(run_data(record, summarise(record)))
    rows = record.updates[np.lexsort((record.updates["step"], record.updates["robot"]))]
    wrong = 0
    for one in why["thresholds"]:
        exact, shown = rows[one["column"]], arrays[f"own:{one['column']}"]
        assert np.array_equal(shown < one["enter"], exact < one["enter"])
        assert np.array_equal(shown <= one["leave"], exact <= one["leave"])
        wrong += int(
            ((np.rint(exact / 1e-3) * 1e-3 < one["enter"]) != (exact < one["enter"])).sum()
        )
    assert wrong > 0
