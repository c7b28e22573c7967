"""What is packed and then shown is what would be shown of the number itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.analysis.summary import summarise
from physim.drawing.labels import decimal, metres
from physim.drawing.page.data import run_data
from physim.drawing.page.packing import Pack
from physim.drawing.page.rounding import for_decimals, for_unit
from tests.page.unpacking import unpack
from tests.records import make_record


def back(values: object, quantum: float) -> list[float]:
    """Packed and unpacked again."""
    pack = Pack()
    pack.real("a", values, quantum)
    return [float(one) for one in unpack(pack.to_base64({}))[1]["a"]]


TENTHS = st.integers(-10_000_000, 10_000_000).filter(lambda k: k % 10)
"""Lengths in units of 10^-5 m that are in no middle themselves"""


@given(st.lists(TENTHS, min_size=1, max_size=50), st.sampled_from([1e-3, 1e-4]))
def test_lengths_are_shown_as_if_rounded_once(numbers: list[int], quantum: float) -> None:
    lengths = np.array(numbers) * 1e-5
    kept = back(for_unit(lengths, quantum, "m"), quantum)
    assert [metres(one) for one in kept] == [metres(one) for one in lengths.tolist()]
    assert np.abs(kept - lengths).max() <= quantum
    times = back(for_unit(lengths, quantum, "s"), quantum)
    assert [decimal(one, 2) for one in times] == [decimal(one, 2) for one in lengths.tolist()]
    stations = back(for_decimals(lengths, quantum, 1), quantum)
    assert [decimal(one, 1) for one in stations] == [decimal(one, 1) for one in lengths.tolist()]


def test_what_is_no_number_stays_what_it_is() -> None:
    odd = np.array([np.nan, np.inf, -np.inf, 0.0, 1e300])
    for unit in ("m", "s", "-"):
        assert np.array_equal(for_unit(odd, 1e-3, unit), odd, equal_nan=True)


def test_distances_of_a_decision_are_those_of_the_record(tmp_path: Path) -> None:
    """1.40452 m is 1.40 m: not 1.405 m, which would be 1.41 m."""
    with make_record(tmp_path / "r.h5", 4, 5.0) as record:
        rows = record.updates.copy()
        rows["distance"], rows["collision_time"] = 1.40452, 2.34471
        rows["deviation"], rows["formation_error"] = -0.23477, 1.01485
        rows["station"], rows["nominal_v"] = 12.34982, 0.66473
        record.__dict__["updates"] = rows
        arrays = unpack(run_data(record, summarise(record)))[1]
    for name, decimals in {
        "own:distance": 2, "own:collision_time": 2, "deviation": 2, "formation_error": 2,
        "station": 1, "nominal_v": 2,
    }.items():  # fmt: skip
        given = float(rows[name.removeprefix("own:")][0])
        assert decimal(float(arrays[name][0]), decimals) == decimal(given, decimals), name
        assert arrays[name] == pytest.approx(given, abs=1e-3)
