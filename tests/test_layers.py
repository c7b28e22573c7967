"""The order of the house: who may import whom, no module-level state.

Reads the sources with `ast`, imports inside functions included. What stands under
``if TYPE_CHECKING:`` is exempt: it is never executed, so it ties no module to another, and types
may be named upward (an observer's contract speaks of a `Simulation`).
"""

from __future__ import annotations

import ast
import functools
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path

from tests.helpers import inside

CONTROLLER, part_names = inside("physim.parts", "CONTROLLER", "part_names")
shipped_folder, shipped_worlds, GROUPS = inside(
    "physim.world.file", "shipped_folder", "shipped_worlds", "GROUPS"
)

ROOT = Path(__file__).parents[1]

LAYERS = {
    "physim.escaping": (0, 0),
    "physim.errors": (0, 1),
    "physim.html": (0, 1),
    "physim.blocks": (0, 2),
    "physim.units": (0, 0),
    "physim.tolerances": (0, 0),
    "physim.terminal": (0, 2),
    "physim.files": (0, 2),
    "physim.json_text": (0, 0),
    "physim.translation": (0, 0),
    "physim.joining": (0, 1),
    "physim.compiled": (0, 2),
    "physim._version": (0, 0),
    "physim.installed": (0, 0),
    "physim.worlds": (0, 0),
    "physim.geometry": (0, 4),
    "physim.natives": (0, 5),
    "physim.contacts": (0, 5),
    "physim.randomness": (0, 6),
    "physim.statistics": (0, 7),
    "physim.world": (1, 0),
    "physim.world.scene": (1, 1),
    "physim.parts": (1, 2),
    "physim.world.file": (2, 0),
    "physim.world.layout": (2, 1),
    "physim.world.checks": (2, 2),
    "physim.controllers": (2, 0),
    "physim.disturbances": (2, 0),
    "physim.drives": (2, 0),
    "physim.record": (3, 0),
    "physim.simulation.arrival": (3, 0),
    "physim.simulation.engine": (3, 0),
    "physim.simulation": (3, 1),
    "physim.analysis.metrics": (4, 0),
    "physim.analysis.expectations": (4, 1),
    "physim.analysis.summary": (4, 2),
    "physim.analysis.validation": (4, 3),
    "physim.analysis.crashtest": (4, 0),
    "physim.analysis": (4, 4),
    "physim.testing": (4, 0),
    "physim.drawing.palette": (0, 0),
    "physim.drawing.labels": (0, 5),
    "physim.drawing.crowd": (0, 5),
    "physim.drawing.printed": (0, 0),
    "physim.drawing.scene_model": (5, 0),
    "physim.drawing.drivers": (5, 0),
    "physim.drawing.items": (5, 1),
    "physim.drawing.timeline": (5, 1),
    "physim.drawing.video": (5, 2),
    "physim.drawing.plots": (5, 2),
    "physim.drawing.page": (5, 3),
    "physim.drawing.preview": (5, 3),
    "physim.drawing": (5, 4),
    "physim.authoring": (5, 0),
    "physim.judging": (5, 0),
    "physim.campaigns": (5, 5),
    "physim.learning": (6, 0),
    "physim.reproduction": (6, 0),
    "physim.cli": (7, 0),
    "physim": (8, 0),
    "physim.__main__": (8, 0),
    "physim.metrics": (8, 0),
}
"""Layer of every module and package, and its place among those of the same layer. An import goes
to a lower layer, to a lower place in the same one, or stays within its package."""

FROM_THE_RECORD_ALONE = (
    "physim.analysis.metrics",
    "physim.analysis.expectations",
    "physim.analysis.summary",
    "physim.analysis.validation",
    "physim.drawing.video",
    "physim.drawing.plots",
    "physim.drawing.page",
)
OF_THEIR_OWN = (
    ("physim.analysis.validation.origin", "physim.world.layout.scene_builder"),
    ("physim.analysis.validation.origin", "physim.parts.registry"),
    ("physim.analysis.validation.origin", "physim.simulation.team"),
    ("physim.analysis.validation.recomputed", "physim.parts.registry"),
    ("physim.analysis.validation.recomputed", "physim.simulation.driving"),
    ("physim.analysis.validation.rerun", "physim.simulation.again"),
    ("physim.analysis.validation.undisturbed", "physim.simulation.again"),
    ("physim.analysis.validation.validation", "physim.simulation.again"),
    ("physim.analysis.validation.rerun", "physim.simulation.loop"),
    ("physim.analysis.validation.rerun", "physim.simulation.run"),
    ("physim.analysis.validation.rerun", "physim.simulation.recorder"),
    ("physim.analysis.metrics.registered", "physim.parts.registry"),
    ("physim.drawing.plots.pictures", "physim.parts.registry"),
    ("physim.drawing.drivers", "physim.parts.registry"),
)
"""Modules of these that may, and what they take: those of the validation hold a record against its
own world, make its decisions again and run it again; others find the metrics and plots that
packages registered, the page what settings a controller has by default."""
NOT_FROM_THE_RECORD = (
    "physim.simulation",
    "physim.parts.registry",
    "physim.world.layout",
    "physim.world.checks",
)
"""`physim.simulation.arrival`, which judges recorded motion alike, is a room of its own."""

SOURCES = sorted(
    file for folder in ("physim", "controllers", "worlds") for file in (ROOT / folder).rglob("*.py")
)


def module_of(file: Path) -> str:
    parts = list(file.relative_to(ROOT).with_suffix("").parts)
    if parts[0] in ("controllers", "worlds"):
        parts.insert(0, "physim")
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_of(file): file for file in SOURCES}


@functools.cache
def tree_of(module: str) -> ast.Module:
    return ast.parse(MODULES[module].read_text(encoding="utf-8"))


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def statements(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes below ``node`` that are ever executed."""
    for child in ast.iter_child_nodes(node):
        if is_type_checking(child):
            for other in getattr(child, "orelse", []):
                yield other
                yield from statements(other)
            continue
        yield child
        yield from statements(child)


TEXT_IMPORTERS = ("import_module", "find_spec", "files", "__import__", "_lazy")


@functools.cache
def imports(module: str) -> list[tuple[int, str]]:
    """Line and absolute name of everything that a module imports, by statement or by text."""
    found = []
    is_package = MODULES[module].name == "__init__.py"
    package = module if is_package else module.rpartition(".")[0]
    for node in statements(tree_of(module)):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, *([base] if base else [])])
            for alias in node.names:
                name = f"{base}.{alias.name}"
                found.append((node.lineno, name if name in MODULES else base))
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            text = node.args[0].value
            if isinstance(text, str) and ast.unparse(node.func).split(".")[-1] in TEXT_IMPORTERS:
                found.append((node.lineno, text))
    return found


def room_of(module: str) -> str:
    """The entry of `LAYERS` that a module belongs to; '' if none."""
    parts = module.split(".")
    if len(parts) == 1:
        return module if module in LAYERS else ""
    return next((".".join(parts[:n]) for n in (3, 2) if ".".join(parts[:n]) in LAYERS), "")


def stands_in(module: str, rooms: tuple[str, ...]) -> bool:
    """Whether a module is one of some rooms and modules, or stands in one without its own layer."""
    return module in rooms or room_of(module) in rooms


def test_every_module_has_its_layer() -> None:
    assert [module for module in MODULES if not room_of(module)] == []
    assert [room for room in LAYERS if room not in {room_of(m) for m in MODULES}] == []


def test_imports_go_downward() -> None:
    for module in MODULES:
        room = room_of(module)
        wrong = []
        for line, name in imports(module):
            if not name.startswith("physim") or name == "physim._kernels":  # built from all rooms
                continue
            other = room_of(name)
            assert other, f"{module}:{line} imports {name}, which has no layer"
            if (room, other) == ("physim.compiled", "physim.controllers"):
                continue  # asks where their sources lie; nothing is imported
            if other != room and LAYERS[other] >= LAYERS[room]:
                wrong.append(f"{module}:{line} imports {name}")
        assert wrong == []


def test_third_parties_stay_where_they_belong() -> None:
    allowed = {
        "pymunk": ("physim.simulation.engine",),
        "h5py": ("physim.record", "physim.world.file"),  # the world inside a record
        "svgelements": ("physim.authoring",),
        "lxml": ("physim.authoring",),
        "imageio_ffmpeg": ("physim.drawing.video",),
        "matplotlib": (
            "physim.drawing.video",
            "physim.drawing.plots",
            "physim.drawing.preview",
            "physim.reproduction",
        ),
        "PIL": ("physim.drawing.video", "physim.reproduction", "physim.authoring"),
        "rich": ("physim.cli", "physim.campaigns"),
        "cyclopts": ("physim.cli",),
        "cma": ("physim.campaigns",),
        "pyarrow": ("physim.campaigns",),
        "distributed": ("physim.campaigns",),
        "pandas": ("physim.record",),
        "gymnasium": ("physim.learning",),
        "pettingzoo": ("physim.learning",),
    }
    for module in MODULES:
        for line, name in imports(module):
            rooms = allowed.get(name.split(".")[0])
            assert rooms is None or room_of(module) in rooms, f"{module}:{line} imports {name}"


def test_controllers_see_layers_0_and_1_and_each_other() -> None:
    for module in [m for m in MODULES if m.startswith("physim.controllers")]:
        for line, name in imports(module):
            top = name.split(".")[0]
            where = f"{module}:{line} imports {name}"
            if top != "physim":
                assert top in ("numpy", "pydantic") or top in sys.stdlib_module_names, where
            elif not name.startswith("physim.controllers"):
                assert LAYERS[room_of(name)][0] <= 1, where
        written = [
            node.module
            for node in ast.walk(tree_of(module))
            if isinstance(node, ast.ImportFrom) and not node.level
        ]
        assert [name for name in written if (name or "").startswith("physim.controllers")] == []


def test_physim_reaches_controllers_through_the_registry_alone() -> None:
    for module in [m for m in MODULES if not m.startswith("physim.controllers")]:
        named = [name for _, name in imports(module) if name.startswith("physim.controllers")]
        if module == "physim.compiled":  # finds their sources, without import
            named.remove("physim.controllers")
        assert named == []


def test_figures_and_pictures_come_from_the_record_alone() -> None:
    for module in [m for m in MODULES if m.startswith(FROM_THE_RECORD_ALONE)]:
        for line, name in imports(module):
            if (module, name) in OF_THEIR_OWN:
                continue
            assert not stands_in(name, NOT_FROM_THE_RECORD), f"{module}:{line} imports {name}"


def test_reading_a_record_loads_no_engine_and_no_simulation() -> None:
    script = (
        "import sys, physim.record, physim.analysis.summary, physim.analysis.validation\n"
        "import physim.drawing.plots, physim.drawing.video, physim.drawing.page\n"
        "print([m for m in sys.modules if m.startswith(('pymunk', 'physim.simulation.loop', "
        "'physim.simulation.engine', 'physim.controllers'))])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.strip() == "[]", done.stderr


def mutable(node: ast.expr | None) -> bool:
    """Whether a value is a list, dict or set display, comprehension or constructor."""
    displays = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)
    if isinstance(node, ast.Call):
        name = ast.unparse(node.func).split(".")[-1]
        return name in ("list", "dict", "set", "defaultdict", "deque", "OrderedDict", "Counter")
    return isinstance(node, displays)


def test_no_state_at_module_level() -> None:
    """Tables in capitals may stand there as long as nothing in the module writes to them."""
    for module in MODULES:
        tree = tree_of(module)
        tables = set()
        for node in tree.body:
            if isinstance(node, ast.Assign | ast.AnnAssign) and mutable(node.value):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                names = {ast.unparse(target) for target in targets} - {"__all__"}
                assert all(name.isupper() for name in names), f"{module}:{node.lineno} {names}"
                tables |= names
        for node in ast.walk(tree):
            assert not isinstance(node, ast.Global), f"{module}:{node.lineno} global"
            assert written_name(node) not in tables, f"{module}: writes to {written_name(node)}"


WRITERS = (
    "add", "append", "clear", "discard", "extend", "insert", "pop", "popitem", "remove",
    "setdefault", "sort", "update",
)  # fmt: skip


def written_name(node: ast.AST) -> str:
    """Name of the collection that a statement changes in place; '' if it changes none."""
    if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store | ast.Del):
        return ast.unparse(node.value)
    if isinstance(node, ast.AugAssign):
        return ast.unparse(node.target)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        return ast.unparse(node.func.value) if node.func.attr in WRITERS else ""
    return ""


def test_every_world_on_disk_is_under_contract() -> None:
    """The contract tests run over `shipped_worlds`; nothing on disk may be missing there."""
    files = {file.relative_to(ROOT / "worlds") for file in (ROOT / "worlds").rglob("*.y*ml")}
    on_disk = {str(file.with_suffix("")) for file in files} - {"league/league"}  # no world
    assert shipped_folder() == ROOT / "worlds"
    assert {name for group in ("", *GROUPS) for name in shipped_worlds(group)} == on_disk
    assert on_disk


def test_every_controller_on_disk_is_under_contract() -> None:
    """The contract tests run over the registered ones; every class that decides is registered."""
    deciding = set()
    for module in MODULES:
        if not module.startswith("physim.controllers."):
            continue
        for node in tree_of(module).body:
            methods = {m.name for m in getattr(node, "body", []) if isinstance(m, ast.FunctionDef)}
            if isinstance(node, ast.ClassDef) and methods & {"decide", "decide_all", "avoid"}:
                deciding.add(f"{module}:{node.name}")
    deciding.discard("physim.controllers.navigation:Navigating")  # those built upon it decide
    registered = {entry.value for entry in entry_points(group=CONTROLLER.group)}
    assert deciding == {value for value in registered if value.startswith("physim.controllers.")}
    assert set(part_names(CONTROLLER)) >= {"mode_switching", "path_following"}


def test_tests_import_packages() -> None:
    """So that code may move within a package; `tests.helpers.inside` finds what they hold."""
    deep = {module for module, file in MODULES.items() if file.name != "__init__.py"}
    deep = {module for module in deep if module.count(".") > 1 and module not in LAYERS}
    wrong = []
    for file in sorted((ROOT / "tests").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [f"{node.module}"]
            elif isinstance(node, ast.Import):
                names = [one.name for one in node.names]
            wrong += [f"{file.name}:{node.lineno} {name}" for name in names if name in deep]
    assert wrong == []
