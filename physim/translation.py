"""A kernel as Cython takes it, in its pure Python mode: types, constants, arrays, scratch memory.

What becomes of what is told at the head of `physim.joining`. Like that file it reads sources only.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping

NUMBERS = {
    "float": "cython.double", "int": "cython.longlong", "bool": "cython.bint",
    "Word": "cython.ulonglong", "None": "cython.void",
}  # fmt: skip
ARRAYS = {
    "FloatArray": ("double", 1), "IntArray": ("longlong", 1), "Flags": ("char", 1),
    "Words": ("ulonglong", 1), **{f"IntRows{n}": ("longlong", n) for n in (2, 3, 8)},
    **{f"Rows{n}": ("double", n) for n in range(2, 11)},
}  # fmt: skip
"""C type of the numbers of an array, and how many stand in a row"""
CASTS = {
    "int": "longlong", "int64": "longlong", "float": "double", "float64": "double",
    "uint64": "ulonglong",
}  # fmt: skip
SCRATCH = {"np.float64": "doubles", "np.int64": "integers", "np.bool_": "flags"}
MARKS = "@cython.cfunc\n@cython.nogil\n@cython.exceptval(check=False)\n"


def expression(text: str) -> ast.expr:
    """An expression as a tree."""
    return ast.parse(text, mode="eval").body


def c_type(annotation: str) -> str:
    """What Cython is told of the type of an annotation."""
    if annotation in NUMBERS:
        return NUMBERS[annotation]
    if annotation in ARRAYS:
        number, width = ARRAYS[annotation]
        return f"cython.p_{number}" if width == 1 else annotation
    if annotation.startswith("tuple["):
        inner = annotation.removeprefix("tuple[").removesuffix("]").split(", ")
        return f"tuple[{', '.join(map(c_type, inner))}]"
    return annotation


class Translation(ast.NodeTransformer):
    """The body of a kernel for Cython."""

    def __init__(self, names: Mapping[str, object], own: set[str]) -> None:
        self.numbers = {
            name: value for name, value in names.items()
            if name not in own and isinstance(value, int | float | tuple)
        }  # fmt: skip
        self.takes_scratch = False

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        """A local variable with its type."""
        node.annotation = expression(c_type(ast.unparse(node.annotation)))
        node.value = self.visit(node.value) if node.value else None
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.AST:
        """An array of a fixed size stands on the stack."""
        call = node.value
        if isinstance(call, ast.Call) and ast.unparse(call.func) == "np.empty":
            kind, sizes = self._shape(call)
            if all(isinstance(size, ast.Constant) for size in sizes):
                shape = "".join(f"[{ast.unparse(size)}]" for size in reversed(sizes))  # of its rows
                number = CASTS[kind.removeprefix("np.")]
                node.value = expression(f"cython.declare(cython.{number}{shape})")
                return node
        return self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        """The outcome of a comparison counts as 0 or 1."""
        self.generic_visit(node)
        if isinstance(node.value, ast.Compare):
            node.value = ast.IfExp(node.value, ast.Constant(1), ast.Constant(0))
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """``x[i, j]``, rows from ``x[i:]``, ``rows[k]["name"]``, and constants that are listed."""
        at = node.slice
        listed = self.numbers.get(ast.unparse(node.value))
        if isinstance(listed, tuple) and isinstance(at, ast.Constant):
            return ast.Constant(listed[at.value])  # type: ignore[index]
        self.generic_visit(node)
        if isinstance(at, ast.Constant) and isinstance(at.value, str):
            return ast.Attribute(node.value, at.value, node.ctx)
        if isinstance(node.slice, ast.Tuple):
            *outer, last = node.slice.elts
            inner = node.value
            for one in outer:
                inner = ast.Subscript(inner, one, ast.Load())
            return ast.Subscript(inner, last, node.ctx)
        if isinstance(node.slice, ast.Slice) and node.slice.lower is not None:
            return ast.BinOp(node.value, ast.Add(), node.slice.lower)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """Functions and constants of ``math`` and ``np`` are those of C."""
        self.generic_visit(node)
        if ast.unparse(node.value) in ("np", "math"):
            return ast.Name({"nan": "NaN", "pi": "M_PI"}.get(node.attr, node.attr), ast.Load())
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """Scratch memory, and changes of the type of a number."""
        called = ast.unparse(node.func)
        if called in ("np.empty", "np.zeros", "np.full", "np.arange"):
            return self._scratch(called, node)
        self.generic_visit(node)
        name = called.removeprefix("np.")
        if name in CASTS:
            return expression(f"cython.cast(cython.{CASTS[name]}, {ast.unparse(node.args[0])})")
        if name == "bool":
            return expression(f"cython.cast(cython.bint, {ast.unparse(node.args[0])})")
        return node

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """A constant."""
        value = self.numbers.get(node.id)
        if not isinstance(value, int | float) or not isinstance(node.ctx, ast.Load):
            return node
        if isinstance(value, float) and math.isinf(value):
            return expression("inf" if value > 0 else "-inf")
        return ast.Constant(value if isinstance(value, float) else int(value))

    def _shape(self, call: ast.Call) -> tuple[str, list[ast.expr]]:
        """Type of the numbers, and sizes."""
        given = [*call.args[1:], *(one.value for one in call.keywords)]
        kinds = [text for text in map(ast.unparse, given) if text in SCRATCH or "uint64" in text]
        size = self.visit(call.args[0])
        return (kinds or ["np.float64"])[0], size.elts if isinstance(size, ast.Tuple) else [size]

    def _scratch(self, called: str, call: ast.Call) -> ast.expr:
        self.takes_scratch = True
        kind, sizes = self._shape(call)
        many = " * ".join(f"({ast.unparse(size)})" for size in sizes)
        value = {"np.zeros": "0"}.get(called, "")
        if called == "np.full":
            value = ast.unparse(self.visit(call.args[1]))
        text = f"full_{SCRATCH[kind]}({many}, {value})" if value else f"{SCRATCH[kind]}({many})"
        if called == "np.arange":
            text = f"counted({many})"
        if len(sizes) == 2:
            rows = "IntRows" if kind == "np.int64" else "Rows"
            text = f"cython.cast({rows}{ast.unparse(sizes[1])}, {text})"
        return expression(text)


def uninferred(kernel: ast.FunctionDef) -> dict[str, str]:
    """Types of the local names whose types Cython does not infer.

    They are given the outcome of a comparison.
    """
    given: list[tuple[ast.expr, ast.expr]] = []
    found: dict[str, str] = {}
    for node in ast.walk(kernel):
        if isinstance(node, ast.Assign):
            target, value = node.targets[0], node.value
            if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
                given += zip(target.elts, value.elts, strict=True)
            given.append((target, value))
    for target, value in given:
        if isinstance(target, ast.Name) and (
            isinstance(value, ast.Compare | ast.BoolOp)
            or (isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.Not))
            or (isinstance(value, ast.Constant) and isinstance(value.value, bool))
        ):
            found[target.id] = "cython.bint"
    return found
