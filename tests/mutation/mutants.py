"""Mutants of a source file, from its syntax tree."""

from __future__ import annotations

import ast
import copy
import hashlib
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

BOUNDS = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
COMPARISONS = {
    ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Gt: ast.Lt, ast.GtE: ast.LtE,
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
    ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
SIGNS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult, ast.Mod: ast.FloorDiv, ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.LShift: ast.RShift, ast.RShift: ast.LShift,
}  # fmt: skip
PAIRS = (
    ("min", "max"), ("minimum", "maximum"), ("argmin", "argmax"), ("nanmin", "nanmax"),
    ("any", "all"), ("floor", "ceil"), ("sin", "cos"),
)  # fmt: skip
EXTREMES = dict(PAIRS) | {b: a for a, b in PAIRS}
DEFAULTS: dict[str, Any] = {"float": 0.0, "int": 0, "bool": False, "str": ""}
"""What a function returns by default, by its annotation; others: None"""
UNSEEN = {"annotation", "returns", "decorator_list", "bases"}
"""Fields of nodes in which nothing is mutated"""


class Mutant(NamedTuple):
    """One small change of a source file: what stands in a field of a node of its tree."""

    file: str
    function: str
    """qualified name; "" outside of functions"""
    operator: str
    number: int
    """which of the changes by this operator in this function"""
    lines: tuple[int, int] | None
    """first and last of the lines that a test executes where it reaches the change; None: import"""
    tree: ast.Module
    parent: ast.AST
    field: str
    place: int | None
    old: Any
    new: ast.AST

    @property
    def change(self) -> str:
        new = "nothing" if isinstance(self.new, ast.Pass) else ast.unparse(self.new)
        return f"{ast.unparse(self.old)}  ->  {new}"

    def __str__(self) -> str:
        return f"{self.file}:{self.old.lineno} {self.function or '(module)'}: {self.change}"

    def text(self) -> str:
        """Source of the mutated file; the tree, which others share, keeps the change."""
        if self.place is None:
            setattr(self.parent, self.field, self.new)
        else:
            getattr(self.parent, self.field)[self.place] = self.new
        return ast.unparse(self.tree)


def mutants_of(file: str, root: Path) -> list[Mutant]:
    """All mutants of a file."""
    tree, count = ast.parse((root / file).read_text(encoding="utf-8")), Counter[tuple[str, str]]()

    def below(
        parent: ast.AST, scope: str, function: ast.FunctionDef | None, stmt: Any
    ) -> Iterator[Mutant]:
        for field, value in ast.iter_fields(parent):
            for place, node in enumerate(value) if isinstance(value, list) else [(None, value)]:
                if field in UNSEEN or not isinstance(node, ast.AST) or is_unseen(node):
                    continue
                at = node if isinstance(node, ast.stmt) and function is not None else stmt
                name = scope if function is not None else ""
                for operator, new in changes(node, field, function):
                    lines = (at.lineno, node.end_lineno) if at else None  # type: ignore[attr-defined]
                    number = count[name, operator]
                    count[name, operator] += 1
                    yield Mutant(
                        file, name, operator, number, lines, tree, parent, field, place, node, new,
                    )  # fmt: skip
                if isinstance(node, ast.FunctionDef | ast.ClassDef):
                    inner = node if isinstance(node, ast.FunctionDef) else function
                    yield from below(node, f"{scope}.{node.name}".lstrip("."), inner, at)
                else:
                    yield from below(node, scope, function, at)

    return list(below(tree, "", None, None))


def drawn(mutants: Iterable[Mutant], seed: int, count: int) -> list[Mutant]:
    """A sample, in which an edit of one function changes the mutants of no other."""

    def order(one: Mutant) -> bytes:
        file = "" if one.function else one.file
        key = f"{seed} {one.function} {one.operator} {one.number} {file}"
        return hashlib.sha256(key.encode()).digest()

    return sorted(mutants, key=order)[:count]


def is_unseen(node: ast.AST) -> bool:
    """Whether it is a message, or for a type checker alone."""
    if isinstance(node, ast.If):
        return "TYPE_CHECKING" in ast.unparse(node.test)
    return isinstance(node, ast.Raise | ast.JoinedStr | ast.Assert)


def changes(
    node: ast.AST, field: str, function: ast.FunctionDef | None
) -> Iterator[tuple[str, ast.AST]]:
    """Operators that apply to a node, and what each puts in its place."""
    match node:
        case ast.Compare():
            for k, op in enumerate(node.ops):
                for operator, table in (("bound", BOUNDS), ("comparison", COMPARISONS)):
                    if type(op) in table:
                        new = copy.copy(node)
                        new.ops = [*node.ops[:k], table[type(op)](), *node.ops[k + 1 :]]
                        yield operator, new
        case ast.BinOp() if not any(map(is_text, (node.left, node.right))):
            if type(node.op) in SIGNS:
                yield "sign", ast.BinOp(node.left, SIGNS[type(node.op)](), node.right)
            if isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.Div):
                yield "dropped term", node.left
            if isinstance(node.op, ast.Add | ast.Mult):
                yield "dropped term", node.right
        case ast.UnaryOp(op=ast.USub()):
            yield "sign", node.operand
        case ast.BoolOp():
            for k in range(len(node.values)):
                rest = node.values[:k] + node.values[k + 1 :]
                yield "dropped term", rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)
        case ast.Constant(value=bool() as known):
            yield "constant", ast.Constant(not known)
        case ast.Constant(value=int() as known):
            yield "constant", ast.Constant(known + 1)
        case ast.Constant(value=float() as known):
            yield "constant", ast.Constant(2.0 * known or 1.0)
        case ast.Name() if node.id in EXTREMES and field == "func":
            yield "extreme", ast.Name(EXTREMES[node.id], node.ctx)
        case ast.Attribute() if node.attr in EXTREMES:
            yield "extreme", ast.Attribute(node.value, EXTREMES[node.attr], node.ctx)
        case ast.Return(value=ast.expr() as result) if (
            function is not None and function.returns is not None
        ):
            default = ast.Constant(DEFAULTS.get(ast.unparse(function.returns)))
            if ast.dump(default) != ast.dump(result):
                yield "returned default", ast.Return(default)
        case ast.Expr(value=ast.Call()) | ast.AugAssign() | ast.Break() | ast.Continue():
            yield "dropped statement", ast.Pass()
        case ast.Assign(targets=[ast.Subscript()]):
            yield "dropped statement", ast.Pass()
    if field in ("test", "ifs"):  # of if, while, conditional expressions and comprehensions
        is_not = isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
        yield "negated", node.operand if is_not else ast.UnaryOp(ast.Not(), node)  # type: ignore


def is_text(node: ast.AST) -> bool:
    """Whether it is a string: to add one is no sum."""
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
