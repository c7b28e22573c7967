"""Kernels of a made-up package, joined and compiled, give what they give as Python."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from physim.contacts import CONTACT_ROW
from physim.joining import joined, modules_of, sources, stamp

HEAD = """
import math
from typing import NamedTuple
import numpy as np
from physim.geometry.shapes import FloatArray, IntArray, Rows2
from {package}.numbers import SHARES
def compiled(function):
    return function
def integers_at(place, count):
    import ctypes
    return (ctypes.c_int64 * count).from_address(place)
class Point(NamedTuple):
    x: float
    y: float
class Piece(NamedTuple):
    start: Point
    end: Point
    closed: bool
class Line(NamedTuple):
    points: Rows2
    count: int
"""
KERNELS = """
@compiled
def piece(line: Line, at: int, share: float = SHARES[1]) -> Piece:
    last = at + 1 == line.count
    a, b = line.points[at], line.points[0 if last else at + 1]
    end = Point(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
    return Piece(Point(a[0], a[1]), end, last)

@compiled
def is_within(point: Point, radius: float) -> bool:
    return math.hypot(point.x, point.y) <= radius

@compiled
def sums(values: FloatArray, count: int) -> FloatArray:
    found = np.zeros(count)
    for k in range(count):
        found[k] = values[k] + (found[k - 1] if k else 0.0)
    return found

@compiled
def one_sum(values: FloatArray, count: int) -> float:
    return sums(values, count)[count - 1]

@compiled
def total(values: FloatArray, count: int, rounds: int) -> tuple[float, int]:
    found = 0.0
    for k in range(rounds):
        found += one_sum(values, count) / (k + 1)
    return found, rounds

@compiled
def weighed(given: FloatArray) -> float:
    rows = np.empty((2, 3))
    for i in range(2):
        for k in range(3):
            rows[i, k] = given[3 * i + k]
    return first_two(rows[0]) + 10.0 * first_two(rows[1])

@compiled
def first_two(row: FloatArray) -> float:
    return row[0] + 100.0 * row[1] + 1000.0 * row[2]

@compiled
def note(place: int, value: int) -> None:
    integers_at(place, 2)[1] = value

@compiled
def put_contacts(rows: ContactRows, count: int) -> None:
    for k in range(count):
        rows[k]["a"], rows[k]["phase"], rows[k]["depth"] = k, 2, 0.5 * k

def of_python(*given):
    return [piece, is_within, total, weighed, note, put_contacts]
"""


def written(folder: Path, kernels: str, name: str = "made") -> dict[str, Path]:
    """A package of one module of kernels and one of constants."""
    package = folder / name
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "numbers.py").write_text("SHARES = (0.25, 0.75)\n")
    head = "from __future__ import annotations\n" + HEAD.format(package=name)
    (package / "kernels.py").write_text(head + kernels)
    return {name: package}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[ModuleType, ModuleType]:
    """The plain kernels, and the compiled ones."""
    folder = tmp_path_factory.mktemp("joined")
    (folder / "made_kernels.pyx").write_text(joined(written(folder, KERNELS)))
    script = (
        "from numpy import get_include\n"
        "from Cython.Build import cythonize\n"
        "from setuptools import Extension, setup\n"
        "one = Extension('made_kernels', ['made_kernels.pyx'], include_dirs=[get_include()])\n"
        "setup(ext_modules=cythonize([one], quiet=True))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, "-q", "build_ext", "-i"],
        cwd=folder, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        return import_module("made.kernels"), import_module("made_kernels")


def test_compiled_kernels_give_what_plain_ones_give(made: tuple[ModuleType, ModuleType]) -> None:
    plain, built = made
    points = np.array([[0.1, 0.2], [3.0, 0.7], [2.5, 4.1]])
    values = np.linspace(0.1, 7.3, 12)
    line = plain.Line(points, 3)
    calls: list[tuple[str, tuple[object, ...]]] = [
        ("piece", (line, 0)), ("piece", (line, 2, 0.1)), ("total", (values, 12, 5)),
        ("is_within", (plain.Point(3.0, 4.0), 5.0)), ("is_within", (plain.Point(3.0, 4.1), 5.0)),
        ("weighed", (values,)),
    ]  # fmt: skip
    for name, given in calls:
        expected, found = getattr(plain, name)(*given), getattr(built, f"call_{name}")(*given)
        assert found == expected, name
        assert type(found) is type(expected) or isinstance(expected, np.floating | np.bool_)
    assert isinstance(built.call_piece(line, 0).end, plain.Point)


def test_contact_rows_are_written_in_place(made: tuple[ModuleType, ModuleType]) -> None:
    plain, built = made
    expected, found = np.zeros(3, CONTACT_ROW), np.zeros(3, CONTACT_ROW)
    plain.put_contacts(expected, 3)
    built.call_put_contacts(found, 3)
    assert found.tolist() == expected.tolist()
    assert found["a"].tolist() == [0, 1, 2]


def test_c_calls_a_kernel_by_its_address(made: tuple[ModuleType, ModuleType]) -> None:
    kind = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64)
    memory = np.zeros(2, np.int64)
    kind(made[1].address_of_note())(memory.ctypes.data, 7)
    assert memory.tolist() == [0, 7]


def test_scratch_memory_is_given_back(made: tuple[ModuleType, ModuleType]) -> None:
    resource = pytest.importorskip("resource")
    values = np.ones(10_000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert made[1].call_total(values, len(values), 5_000)[1] == 5_000  # 400 MB if it were kept
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000


def test_arrays_of_another_kind_are_refused(made: tuple[ModuleType, ModuleType]) -> None:
    plain, built = made
    for points in (np.zeros((3, 3)), np.zeros((3, 2), int), np.zeros((4, 4))[:, ::2], [[0.0, 0.0]]):
        with pytest.raises(TypeError, match=r"Line\.points is"):
            built.call_piece(plain.Line(points, 1), 0)


def test_only_kernels_that_python_names_can_be_called(made: tuple[ModuleType, ModuleType]) -> None:
    assert not hasattr(made[1], "call_one_sum")
    assert not hasattr(made[1], "call_sums")


KERNEL = "\n@compiled\ndef wrong({}) -> float:\n    {}\n"


@pytest.mark.parametrize(
    ("arguments", "body", "said"),
    [
        ("x", "return 1.0", "argument x is of no type: write float"),
        ("x: Shape", "return 1.0", "argument x is Shape: write float"),
        ("x: float, *more: float", "return x", "write plain ones"),
        ("x: FloatArray", "return x[len(x) - 1]", "len: write an argument"),
        ("x: FloatArray", "y = x[1:3]; return y[0]", "1:3: write [a:]"),
        ("x: FloatArray", "return sum([a for a in x])", "sum is no kernel: write @compiled"),
        ("x: FloatArray", "y = [a for a in x]; return y[0]", "write it with if, for"),
        ("x: FloatArray", "return np.median(x)", "np.median is no kernel"),
        ("x: float", "y: Shape = x; return y", "y is Shape: write float"),
        ("x: float", "raise ValueError", "raise ValueError: write it with if, for"),
    ],
)
def test_what_cannot_be_compiled_is_refused(
    tmp_path: Path, arguments: str, body: str, said: str
) -> None:
    folders = written(tmp_path, KERNEL.format(arguments, body))
    with pytest.raises(ValueError, match=r"^\S+kernels\.py:\d+: kernel wrong: ") as caught:
        joined(folders)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_of_one_name_are_refused(tmp_path: Path) -> None:
    kernel = KERNEL.format("x: float", "return x")
    folders = {**written(tmp_path, kernel), **written(tmp_path, kernel, "other")}
    with pytest.raises(ValueError, match=r"kernels\.py has a Point, too: write another name$"):
        joined(folders)


def without_numbers(folder: Path) -> None:
    (folder / "numbers.py").unlink()


@pytest.mark.parametrize(
    "edit",
    [
        lambda folder: (folder / "kernels.py").open("a").write("# more\n"),
        lambda folder: (folder / "numbers.py").write_text("SHARES = (0.5, 0.5)\n"),
        without_numbers,
    ],
)
def test_a_stamp_covers_kernels_and_their_constants(
    tmp_path: Path, edit: Callable[[Path], object]
) -> None:
    folders = written(tmp_path, KERNELS)
    modules = [source.module for source in sources(modules_of(folders))]
    before = stamp(folders, modules)
    assert stamp(folders, modules) == before
    edit(folders["made"])
    assert stamp(folders, modules) != before


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("import physim.joining; physim.joining.stamp = lambda *given: ''", "from other sources"),
        ("sys.modules['physim._kernels'] = None", "are not compiled"),
        ("import physim._kernels; physim._kernels.SOURCES = []", "from other sources"),
    ],
)
def test_kernels_that_are_stale_or_missing_are_told_in_one_line(change: str, said: str) -> None:
    script = (
        f"import sys\n{change}\nfrom physim.cli import main\nsys.exit(main(['run', 'straight']))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert said in done.stderr
    assert "pip install" in done.stderr
    assert done.stderr.count("\n") == 1
