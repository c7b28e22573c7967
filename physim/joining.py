"""Join the kernels of all rooms into one module for Cython: what `setup.py` compiles.

Kernels are plain functions, marked ``@compiled``, in the modules of their rooms, and can be used as
such. Here they are copied, in Cython's pure Python mode, into one module, so that the C compiler
sees them all at once: annotations become C types, named tuples of numbers and arrays C structures,
constants numbers, ``x[i, j]`` becomes ``x[i][j]``, what `numpy.empty` and its like make is scratch
memory (`kernels.pxi`). A kernel that is named outside of kernels gets a function that Python can
call, which takes the addresses of arrays and checks their kind and width; when others are called
from Python, as tests do, they run plain.

An array is its address alone: a kernel is told how many rows there are. What kernels may not say is
refused here, with file and line; the rest Cython refuses, at the line of the joined module, above
which the name of the kernel's own module stands.

This file is run when physim is built and reads sources only: of physim it imports
`physim.translation`, which does the same.
"""

from __future__ import annotations

import ast
import hashlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from enum import IntEnum
from pathlib import Path

from physim.translation import (
    ARRAYS,
    CASTS,
    MARKS,
    NUMBERS,
    Translation,
    c_type,
    uninferred,
)

KINDS = {
    "double": "cnp.NPY_DOUBLE", "longlong": "cnp.NPY_INT64", "char": "cnp.NPY_BOOL",
    "ulonglong": "cnp.NPY_UINT64",
}  # fmt: skip
NATIVES = {
    "call2", "call3", "doubles_at", "rows2_at", "integers_at", "int_rows2_at", "put_short",
    "high_product",
}  # fmt: skip
"""Functions of `physim.natives`"""
C_FUNCTIONS = {
    "abs", "asin", "acos", "atan", "atan2", "bool", "ceil", "copysign", "cos", "exp", "floor",
    "hypot", "isfinite", "isinf", "isnan", "log", "max", "min", "nextafter", "pow", "range", "sin",
    "sqrt", "tan", "empty", "zeros", "full", "arange", *CASTS,
}  # fmt: skip
"""Functions of Python, ``math`` and ``np`` that kernels may call"""
STATEMENTS = (
    ast.AnnAssign, ast.Assign, ast.AugAssign, ast.Break, ast.Continue, ast.Expr, ast.For, ast.If,
    ast.Pass, ast.Return, ast.While,
)  # fmt: skip
EXPRESSIONS = (
    ast.Attribute, ast.BinOp, ast.BoolOp, ast.Call, ast.Compare, ast.Constant, ast.IfExp, ast.Name,
    ast.Slice, ast.Subscript, ast.Tuple, ast.UnaryOp,
)  # fmt: skip
IMPORTED = re.compile(r"^ *from \S+ import (\([^)]*\)|.*)", re.MULTILINE)
DIRECTIVES = (
    "language_level=3, boundscheck=False, wraparound=False, initializedcheck=False, "
    "cdivision=True, infer_types=True, cpow=True, nonecheck=False"
)


class Source:
    """One module: its kernels, its named tuples, and the numbers that its names stand for."""

    def __init__(self, module: str, path: Path) -> None:
        self.module, self.path = module, path
        self.tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = (node for node in self.tree.body if isinstance(node, ast.FunctionDef))
        self.kernels = [node for node in functions if "compiled" in _marks(node)]
        self.tuples = {
            node.name: {
                field.target.id: ast.unparse(field.annotation)
                for field in node.body
                if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
            }
            for node in self.tree.body
            if isinstance(node, ast.ClassDef) and "NamedTuple" in map(ast.unparse, node.bases)
        }
        self.names: dict[str, object] = {"math": math, "map": map, "int": int, "range": range}
        self.names |= {"pi": math.pi, "inf": math.inf}

    def imports(self) -> Iterator[tuple[str, str, str]]:
        """(name here, module, name there) of all that is imported from modules."""
        for node in self.tree.body:
            if isinstance(node, ast.ImportFrom):
                above = self.module.split(".")[: -node.level] if node.level else []
                for one in node.names:
                    yield one.asname or one.name, ".".join([*above, node.module or ""]), one.name

    def take_numbers(self) -> None:
        """Take up the numbers, and tuples and enumerations of them, that names are given."""
        for node in self.tree.body:
            if isinstance(node, ast.ClassDef) and "IntEnum" in map(ast.unparse, node.bases):
                given = (one for one in node.body if isinstance(one, ast.Assign))
                members = {ast.unparse(g.targets[0]): ast.literal_eval(g.value) for g in given}
                self.names[node.name] = IntEnum(node.name, members)
            target = node.targets[0] if isinstance(node, ast.Assign) else None
            if isinstance(node, ast.AnnAssign):
                target = node.target
            value = getattr(node, "value", None)
            if target is None or value is None:
                continue
            try:
                found = eval(ast.unparse(value), {"__builtins__": {}}, self.names)
            except Exception:
                continue  # no number
            if isinstance(target, ast.Tuple):
                found = tuple(found)
                names = [ast.unparse(one) for one in target.elts]
                self.names |= dict(zip(names, found, strict=True))
            elif isinstance(found, int | float | tuple):
                self.names[ast.unparse(target)] = found


def _marks(node: ast.FunctionDef) -> list[str]:
    return [ast.unparse(mark) for mark in node.decorator_list]


def modules_of(folders: Mapping[str, Path]) -> dict[str, Path]:
    """Names and files of all modules of some packages."""
    return {
        ".".join((package, *path.relative_to(folder).with_suffix("").parts)): path
        for package, folder in folders.items()
        for path in sorted(folder.rglob("*.py"))
    }


def sources(paths: Mapping[str, Path]) -> list[Source]:
    """Modules of kernels, each behind those whose named tuples and numbers it uses."""
    taken: dict[str, Source] = {}
    needed: set[str] = set()

    def take(module: str) -> Source:
        if module not in taken:
            source = Source(module, paths[module])
            for name, other, original in source.imports():
                if other == "math":
                    source.names[name] = getattr(math, original)
                if other in paths:
                    value = take(other).names.get(original)
                    source.names |= {} if value is None else {name: value}
            source.take_numbers()
            taken[module] = source
        return taken[module]

    def need(source: Source) -> None:
        if source.module not in needed:
            needed.add(source.module)
            for _, other, original in source.imports():
                if other in taken and original in {*taken[other].names, *taken[other].tuples}:
                    need(taken[other])

    for module, path in paths.items():
        if "\n@compiled\n" in path.read_text(encoding="utf-8"):
            take(module)
    for source in taken.values():
        if source.kernels:
            need(source)
    return [source for source in taken.values() if source.module in needed]


def called_by_python(kernels: set[str], found: list[Source], paths: Iterable[Path]) -> set[str]:
    """Kernels that are named outside of kernels in their modules, or imported where none stands."""
    named: set[str] = set()
    for source in found:
        here = {kernel.name for kernel in source.kernels} | {name for name, *_ in source.imports()}
        for node in source.tree.body:
            if node not in source.kernels:
                names = {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
                named |= names & here
    for path in {*paths} - {source.path for source in found}:
        for text in IMPORTED.findall(path.read_text(encoding="utf-8")):
            named.update(re.findall(r"\w+", text))
    return named & kernels


def check(kernel: ast.FunctionDef, source: Source, kinds: set[str], functions: set[str]) -> None:
    """Refuse a kernel that says what cannot be compiled.

    ``kinds`` are the annotations, ``functions`` the names of what it may call.

    Raises ValueError: one line with file, line, kernel, and what to write.
    """

    def refuse(node: ast.expr | ast.stmt | ast.arg, why: str) -> None:
        raise ValueError(f"{source.path}:{node.lineno}: kernel {kernel.name}: {why}")

    def check_kind(node: ast.expr | ast.stmt | ast.arg, what: str, kind: ast.expr | None) -> None:
        text = ast.unparse(kind) if kind else ""
        if not kinds.issuperset(text.removeprefix("tuple[").removesuffix("]").split(", ")):
            refuse(
                node,
                f"{what} is {text or 'of no type'}: write float, int, bool, an array as those of "
                "physim.geometry.shapes, or a named tuple of these",
            )

    given = kernel.args
    if given.posonlyargs or given.kwonlyargs or given.vararg or given.kwarg:
        refuse(kernel, "it takes arguments by *, / or **: write plain ones")
    for one in given.args:
        check_kind(one, f"argument {one.arg}", one.annotation)
    if kernel.returns:
        check_kind(kernel, "what it returns", kernel.returns)
    for node in (inner for statement in kernel.body for inner in ast.walk(statement)):
        if isinstance(node, ast.expr | ast.stmt) and not isinstance(
            node, (*STATEMENTS, *EXPRESSIONS)
        ):
            refuse(node, f"{ast.unparse(node)}: write it with if, for, while and assignments")
        if isinstance(node, ast.AnnAssign):
            check_kind(node, ast.unparse(node.target), node.annotation)
        elif isinstance(node, ast.Slice) and (node.upper or node.step):
            refuse(node, f"{ast.unparse(node)}: write [a:], rows from a on, and count them")
        elif isinstance(node, ast.For) and not ast.unparse(node.iter).startswith(("range(", "(")):
            refuse(node, f"for … in {ast.unparse(node.iter)}: write for … in range(…)")
        elif isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            if name == "len":
                refuse(node, "len: write an argument that says how many rows there are")
            if name not in functions and re.sub(r"^(np|math)\.", "", name) not in C_FUNCTIONS:
                refuse(node, f"{name} is no kernel: write @compiled above it")


def gives_arrays(returns: str, structures: Mapping[str, Source]) -> bool:
    """Whether arrays are among what is returned, also in named tuples."""
    if returns in structures:
        inner = structures[returns].tuples[returns].values()
        return any(gives_arrays(one, structures) for one in inner)
    return returns in ARRAYS


def _kernel(
    kernel: ast.FunctionDef, source: Source, structures: Mapping[str, Source], givers: set[str]
) -> str:
    """A kernel in Cython's pure Python mode; ``givers`` are the kernels that return arrays."""
    arguments = kernel.args.args
    own = {one.arg for one in arguments}
    for node in ast.walk(kernel):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            own.add(node.id)
    translation = Translation(source.names, own)
    defaults = [ast.unparse(translation.visit(one)) for one in kernel.args.defaults]
    head = [f"{a.arg}: {c_type(ast.unparse(a.annotation))}" for a in arguments if a.annotation]
    for k, default in enumerate(defaults, len(head) - len(defaults)):
        head[k] += f" = {default}"
    body = kernel.body[1:] if ast.get_docstring(kernel) else kernel.body
    names = {one.arg for one in arguments}
    lines = [f"{name}: {kind}" for name, kind in uninferred(kernel).items() if name not in names]
    for statement in body:
        changed = ast.fix_missing_locations(translation.visit(statement))
        lines += ast.unparse(changed).split("\n")
    returns = ast.unparse(kernel.returns) if kernel.returns else "None"
    kind = c_type(returns)
    inner = f"({', '.join(head)}) -> {kind}:\n" + "".join(f"    {line}\n" for line in lines)
    called = {one.id for one in ast.walk(kernel) if isinstance(one, ast.Name)}
    takes_scratch = translation.takes_scratch or not givers.isdisjoint(called)
    if not takes_scratch or kernel.name in givers:
        return f"{MARKS}def {kernel.name}{inner}"
    call = f"with_scratch_{kernel.name}({', '.join(one.arg for one in arguments)})"
    return (
        f"{MARKS}def with_scratch_{kernel.name}{inner}\n"
        f"{MARKS}def {kernel.name}({', '.join(head)}) -> {kind}:\n"
        "    mark = scratch_now()\n"
        + (f"    {call}\n" if returns == "None" else f"    result = {call}\n")
        + "    scratch_back(mark)\n"
        + ("" if returns == "None" else "    return result\n")
    )


def _taken(annotation: str, value: str, name: str) -> str:
    """How an argument, or a field of one, is taken from Python."""
    if annotation == "ContactRows":
        return f"<ContactRows>numbers({value}, cnp.NPY_VOID, 0, {name!r})"
    if annotation in ARRAYS:
        number, width = ARRAYS[annotation]
        pointers = {"longlong": "i8*", "ulonglong": "unsigned long long*"}
        kind = pointers.get(number, f"{number}*") if width == 1 else annotation
        return f"<{kind}>numbers({value}, {KINDS[number]}, {width}, {name!r})"
    if annotation in NUMBERS or annotation.startswith("tuple["):
        return value
    return f"take_{annotation}({value})"


def _taker(name: str, fields: Mapping[str, str]) -> str:
    """The function that takes a named tuple from Python."""
    lines = [f"cdef {name} take_{name}(object given) except *:", f"    cdef {name} taken"]
    for k, (field, annotation) in enumerate(fields.items()):
        lines.append(f"    taken.{field} = {_taken(annotation, f'given[{k}]', f'{name}.{field}')}")
    return "\n".join([*lines, "    return taken\n"])


def _given(value: str, kind: str, structures: Mapping[str, Source]) -> str:
    """How an outcome is given to Python: named tuples, and those in them, are what they were."""
    if kind not in structures:
        return value
    fields = structures[kind].tuples[kind].items()
    inner = "".join(f"{_given(f'{value}.{name}', of, structures)}, " for name, of in fields)
    return f"named({structures[kind].module!r}, {kind!r}, ({inner}))"


def _caller(kernel: ast.FunctionDef, source: Source, structures: Mapping[str, Source]) -> str:
    """The function of a kernel that Python calls."""
    arguments = {a.arg: ast.unparse(a.annotation) for a in kernel.args.args if a.annotation}
    returns = ast.unparse(kernel.returns) if kernel.returns else "None"
    head = [f"{a}: {NUMBERS[t]}" if t in NUMBERS else a for a, t in arguments.items()]
    numbers = Translation(source.names, set())
    for k, default in enumerate(kernel.args.defaults, len(head) - len(kernel.args.defaults)):
        head[k] += f" = {ast.unparse(numbers.visit(default))}"
    given = ", ".join(_taken(t, a, a) for a, t in arguments.items())
    lines = [f"def call_{kernel.name}({', '.join(head)}):"]
    call = f"{kernel.name}({given})"
    if returns in structures:
        lines += [f"    found = {call}", f"    return {_given('found', returns, structures)}"]
    elif returns == "bool":
        lines.append(f"    return bool({call})")
    else:
        lines.append(f"    {call}" if returns == "None" else f"    return {call}")
    if returns == "None" and set(arguments.values()) == {"int"}:
        lines += [f"def address_of_{kernel.name}():", f"    return <size_t><void*>{kernel.name}"]
    return "\n".join(lines) + "\n"


def joined(folders: Mapping[str, Path]) -> str:
    """Source of the module that Cython compiles, of kernels in some packages.

    Raises ValueError, in one line, where two kernels, or two of their named tuples, have one name,
    and where a kernel says what cannot be compiled.
    """
    paths = modules_of(folders)
    found = sources(paths)
    structures: dict[str, Source] = {}
    kernels: dict[str, tuple[ast.FunctionDef, Source]] = {}
    for source in found:
        for name, fields in source.tuples.items():
            if not {*NUMBERS, *ARRAYS, *structures}.issuperset(fields.values()):
                continue  # of something else: no kernel can take it
            if name in structures:
                other = structures[name].path
                raise ValueError(f"{source.path}: {other} has a {name}, too: write another name")
            structures[name] = source
        for kernel in source.kernels:
            if kernel.name in kernels:
                other = kernels[kernel.name][1].path
                raise ValueError(
                    f"{source.path}:{kernel.lineno}: kernel {kernel.name}: {other} has one of this "
                    "name, too: write another name"
                )
            kernels[kernel.name] = kernel, source
    kinds = {*NUMBERS, *ARRAYS, *structures, "ContactRows"}
    for kernel, source in kernels.values():
        check(kernel, source, kinds, {*kernels, *structures, *NATIVES})

    givers = {
        name
        for name, (kernel, _) in kernels.items()
        if kernel.returns and gives_arrays(ast.unparse(kernel.returns), structures)
    }
    called = called_by_python(set(kernels), found, paths.values())
    callers = "\n".join(
        _caller(*kernels[name], structures) for name in kernels if name in called - givers
    )
    takers = ""
    for name in reversed(structures):
        if f"take_{name}(" in callers + takers:
            takers = _taker(name, structures[name].tuples[name]) + takers
    modules = [source.module for source in found]
    text = [f"# cython: {DIRECTIVES}", Path(__file__).with_name("kernels.pxi").read_text("utf-8")]
    text += [f"SOURCES = {modules}", f'STAMP = "{stamp(folders, modules)}"']
    for name, (number, width) in ARRAYS.items():
        if width > 1:
            text.append(f"{name} = cython.typedef(cython.pointer(cython.{number}[{width}]))")
    for name, source in structures.items():
        fields = source.tuples[name]
        members = ", ".join(f"{field}={c_type(kind)}" for field, kind in fields.items())
        text.append(f"{name} = cython.struct({members})")
    for kernel, source in kernels.values():
        text += [f"# {source.module}", _kernel(kernel, source, structures, givers)]
    return "\n".join([*text, takers, callers])


def stamp(folders: Mapping[str, Path], modules: Iterable[str]) -> str:
    """Hash of the sources of some modules, as far as they are there, and of what joins them."""
    here, hasher = Path(__file__), hashlib.sha256()
    for name in ("joining.py", "translation.py", "kernels.pxi"):
        hasher.update(here.with_name(name).read_bytes())
    for module in modules:
        package = max((name for name in folders if module.startswith(name + ".")), key=len)
        inner = module.removeprefix(package + ".").split(".")
        path = folders[package].joinpath(*inner).with_suffix(".py")
        hasher.update(path.read_bytes() if path.exists() else b"")
    return hasher.hexdigest()
