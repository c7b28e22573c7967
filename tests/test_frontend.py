"""What numba's front end is spared: results and options stay as they are."""

from __future__ import annotations

import gc
from types import FunctionType
from typing import Any

import numba
import numpy as np
import pytest
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Flags
from numba.core.target_extension import cpu_target, jit_registry

from physim.compiled import Kernel
from physim.frontend import SteadyFlags, without_collector
from tests.helpers import inside

FloatArray, IntArray = inside("physim.geometry", "FloatArray", "IntArray")


def spread(values: FloatArray) -> FloatArray:
    out, order = np.zeros(len(values)), np.arange(len(values))
    for k in range(len(values)):
        out[order[k]] = max(values[k], 0.5)
    return out


def untyped(values: IntArray) -> Any:
    return values.no_such_thing


VALUES = np.array([0.1, 0.7, 1.3, 2.9])


def whole_of(function: Any) -> Any:
    """A dispatcher of a kernel's whole that is not kept on disk, of a copy of the function."""
    whole = Kernel(FunctionType(function.__code__, function.__globals__)).whole
    whole._cache.flush()
    return whole


def test_options_compare_as_those_of_numba() -> None:
    plain, other = Flags(), Flags()
    plain.nrt = other.nrt = True
    other.error_model = "numpy"
    steady, same = SteadyFlags(plain), SteadyFlags(plain).copy()
    assert steady == same == plain == steady
    assert hash(steady) == hash(same) == hash(plain)
    assert steady != SteadyFlags(other)
    assert steady != other
    assert {plain: 1}[steady] == {steady: 1}[plain] == 1
    assert (steady.nrt, steady.error_model) == (plain.nrt, plain.error_model)


def test_nothing_is_collected_meanwhile_and_everything_after() -> None:
    seen: list[str] = []
    gc.callbacks.append(lambda phase, info: seen.append(phase))
    try:
        with without_collector():
            rings = [[] for _ in range(5000)]  # type: ignore[var-annotated]
            for ring in rings:
                ring.append(ring)
            assert not seen
            with without_collector():
                assert not gc.isenabled()
            assert not gc.isenabled()
    finally:
        gc.callbacks.pop()
    assert gc.isenabled()


def test_of_functions_of_numba_no_machine_code_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole alone is optimised; the same functions serve whoever compiles by numba alone."""
    made: list[str] = []
    plain = JITCodeLibrary._finalize_specific

    def noted(library: Any) -> None:
        made.append(library.name)
        plain(library)

    monkeypatch.setattr(JITCodeLibrary, "_finalize_specific", noted)
    assert np.array_equal(whole_of(spread)(VALUES), spread(VALUES))
    assert {"spread"} <= set(made) <= {"spread", "nrt", "_call_allocator"}  # numba's foundations
    assert np.array_equal(numba.njit(spread)(VALUES), spread(VALUES))


def test_numba_is_left_as_it_was_even_by_an_error() -> None:
    before = jit_registry[cpu_target]
    with pytest.raises(numba.TypingError):
        whole_of(untyped)(np.arange(3))
    assert jit_registry[cpu_target] is before
    assert gc.isenabled()
