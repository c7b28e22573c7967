"""How numba puts kernels together: the pieces are linked once, and only the whole is optimised.

numba optimises each function with all that it calls and makes machine code of it, then links the
result into every caller and does all this again there: with deep calls, many times over. A piece
skips that. It hands its callers plain code, and the one function that Python calls, the whole, is
optimised with all its pieces. Without fast-math this does not change a bit of any result.

numba counts the references to every array that a function as much as names, and the counters cost
small functions half of their time. A piece that only looks at what its caller holds, and neither
makes an array nor returns one, does without.

This leans on numba's internals, so it serves only the versions in `physim.compiled.LINKED_SERIES`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from numba.core import ir, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.environment import lookup_environment
from numba.core.target_extension import cpu_target, jit_registry
from numba.core.typed_passes import NativeLowering

from physim.frontend import SteadyFlags, without_collector


class PieceLibrary(JITCodeLibrary):
    """Code of one function for linking only: not optimised, and no machine code."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        """Close the library; what it calls is left to be linked by the whole."""
        self._finalize_dynamic_globals()
        for function in self._final_module.functions:
            if not function.is_declaration:
                function.linkage = "linkonce_odr"  # dropped where all calls are inlined
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """The code with all that it calls, for callers that know nothing of pieces."""
        if self._shared_module is None:
            self._ensure_finalized()
            module = self._final_module.clone()
            pieces, others = gathered(self._linking_libraries)
            for library in pieces:
                module.link_in(library._final_module, preserve=True)
            for library in others:
                module.link_in(library._get_module_for_linking(), preserve=True)
            self._shared_module = module
        return self._shared_module

    def get_pointer_to_function(self, name: str) -> int:
        """0: there is no machine code to point to."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        """The library itself, so that `set_env` comes here."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: the whole sets the environments of its pieces."""


class WholeLibrary(JITCodeLibrary):
    """Machine code of one function with all its pieces, which are inlined where called once."""

    def finalize(self) -> None:
        """Link the pieces, optimise everything once, make machine code."""
        pieces, self._linking_libraries = gathered(self._linking_libraries)
        own = {function.name for function in self._final_module.functions}
        for library in pieces:
            self._final_module.link_in(library._final_module, preserve=True)
        for function in self._final_module.functions:
            if not function.is_declaration and function.name not in own:
                # Its arguments may change, so nobody may find it by its name: not even machine
                # code of the same function that was compiled as a whole, or in another process.
                function.linkage = "private"
        super().finalize()


def gathered(libraries: list[Any]) -> tuple[list[PieceLibrary], list[Any]]:
    """Pieces that are needed directly or by others, callers before what they call; other code.

    The order matters: of a piece only that is linked which is called already.
    """
    found: dict[Any, None] = {}

    def visit(library: Any) -> None:
        if library not in found:
            if isinstance(library, PieceLibrary):
                for needed in library._linking_libraries:
                    visit(needed)
            found[library] = None

    for library in libraries:
        visit(library)
    callers_first = list(reversed(found))
    pieces = [library for library in callers_first if isinstance(library, PieceLibrary)]
    return pieces, [one for one in callers_first if not isinstance(one, PieceLibrary)]


BORROWING = (
    "cast", "build_tuple", "exhaust_iter", "getiter", "iternext", "pair_first", "pair_second", "phi"
)  # fmt: skip
"""Expressions that make no array, whatever they are given."""


def only_borrows(state: Any) -> bool:
    """Whether a typed function makes nothing that references are counted of, and returns none."""
    models, typed = state.targetctx.data_model_manager, state.typemap

    def is_counted(kind: Any) -> bool:
        return bool(models[kind].contains_nrt_meminfo())

    def borrows(value: Any) -> bool:
        if not isinstance(value, ir.Expr) or value.op in BORROWING:
            return True
        if value.op == "call":
            return isinstance(typed[value.func.name], types.NamedTupleClass)
        if value.op not in ("getattr", "getitem", "static_getitem"):
            return False
        if not isinstance(typed[value.value.name], types.Array | types.BaseTuple):
            return False
        # an array of indices makes a copy
        return value.op != "getitem" or not is_counted(typed[value.index.name])

    def counts_nothing(statement: Any) -> bool:
        if isinstance(statement, ir.Assign):
            return not is_counted(typed[statement.target.name]) or borrows(statement.value)
        if isinstance(statement, ir.SetItem | ir.StaticSetItem):  # an array may be copied before
            return not is_counted(typed[statement.value.name])
        return True

    statements = (one for block in state.func_ir.blocks.values() for one in block.body)
    return not is_counted(state.return_type) and all(map(counts_nothing, statements))


def without_counters(context: Any) -> Any:
    """Context of code generation in which no references are counted."""
    plain = context.subtarget(enable_nrt=False, cached_internal_func={})
    plain.__dict__.pop("nrt", None)  # what the copy remembers
    return plain


@register_pass(mutates_CFG=True, analysis_only=False)
class PieceLowering(NativeLowering):
    """Lower a function into a `PieceLibrary`."""

    _name = "physim_piece_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower one function."""
        state.library = PieceLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        if only_borrows(state):
            state.targetctx = without_counters(state.targetctx)
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=True, analysis_only=False)
class WholeLowering(NativeLowering):
    """Lower a function with its pieces into machine code."""

    _name = "physim_whole_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower one function, and give its pieces what they need to raise errors."""
        state.library = WholeLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        done = bool(super().run_pass(state))
        if state.flags.no_compile:  # a callback, which raises nothing, and is finished later
            return done
        for variable in state.library._final_module.global_variables:
            if variable.name.startswith("_ZN08NumbaEnv"):
                environment = lookup_environment(variable.name)
                if environment is not None:
                    state.library.codegen.set_env(variable.name, environment)
        return done


@register_pass(mutates_CFG=True, analysis_only=False)
class HelperLowering(NativeLowering):
    """Lower a function of numba's own into a `PieceLibrary`; it counts references as it will."""

    _name = "physim_helper_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower one function."""
        state.library = PieceLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return bool(super().run_pass(state))


class LinkedCompiler(Compiler):
    """numba's compiler with another last pass."""

    lowering: type

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.state.flags = SteadyFlags(self.state.flags)

    def define_pipelines(self) -> list[PassManager]:
        """All passes."""
        return [_with_lowering(passes, self.lowering) for passes in super().define_pipelines()]


class PieceCompiler(LinkedCompiler):
    """numba's compiler with `PieceLowering`."""

    lowering = PieceLowering


class HelperCompiler(LinkedCompiler):
    """numba's compiler with `HelperLowering`."""

    lowering = HelperLowering


class WholeCompiler(LinkedCompiler):
    """numba's compiler with `WholeLowering`."""

    lowering = WholeLowering

    def _compile_core(self) -> Any:
        with without_collector(), helpers_as_pieces():
            return super()._compile_core()


@contextmanager
def helpers_as_pieces() -> Iterator[None]:
    """Let numba compile functions of its own as pieces, too."""
    jit = jit_registry.pop(cpu_target)
    jit_registry[cpu_target] = partial(jit, pipeline_class=HelperCompiler)
    try:
        yield
    finally:
        del jit_registry[cpu_target]
        jit_registry[cpu_target] = jit


def _with_lowering(passes: PassManager, lowering: type) -> PassManager:
    changed = PassManager(passes.pipeline_name)
    for step, text in passes.passes:
        changed.add_pass(lowering if step is NativeLowering else step, text)
    changed.finalize()
    return changed
