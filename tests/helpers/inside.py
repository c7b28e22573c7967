"""Objects of a package by name, in whichever of its modules they stand."""

from __future__ import annotations

import ast
import functools
import importlib
from importlib.util import find_spec
from pathlib import Path
from typing import Any


def inside(package: str, *names: str) -> Any:
    """What a package defines under these names: one object, or a tuple of several.

    For the oracles of kernels and for classes that users meet but do not import: where a name
    stands within its package is no promise, and tests do not hold it. Private names are not given.
    Raises LookupError for a name that stands nowhere, or in two modules beside
    one another.
    """
    found = []
    for name in names:
        modules = [module for module, defined in _defined(package) if name in defined]
        near = [module for module in modules if module.rpartition(".")[0] == package]
        modules = near or modules
        if len(modules) != 1 or name.startswith("_"):
            raise LookupError(f"{name} stands in {modules or 'no module'} of {package}")
        found.append(getattr(importlib.import_module(modules[0]), name))
    return found[0] if len(found) == 1 else tuple(found)


@functools.cache
def _defined(package: str) -> list[tuple[str, set[str]]]:
    """Every module of a package, with the names that it defines itself."""
    spec = find_spec(package)
    assert spec, package
    assert spec.origin, package
    folder = Path(spec.origin).parent
    if spec.submodule_search_locations is None:
        return [(package, _names(Path(spec.origin)))]
    return [
        (".".join([package, *file.relative_to(folder).with_suffix("").parts]), _names(file))
        for file in sorted(folder.rglob("*.py"))
        if file.name not in ("__init__.py", "__main__.py")
    ]


def _names(file: Path) -> set[str]:
    names = set()
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        targets = getattr(node, "targets", [getattr(node, "target", None)])
        for target in targets:
            parts = target.elts if isinstance(target, ast.Tuple) else [target]
            names |= {part.id for part in parts if isinstance(part, ast.Name)}
    return names
