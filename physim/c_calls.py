"""Calls from compiled code to functions of a C library, given by their addresses.

Numbers of 64 bits and addresses alone are handed over, nothing comes back: such a call is the same
on every machine with addresses of 64 bits. Structures by value would not be. Where nothing
`compiles`, the same names stand for plain Python by way of ctypes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any, cast

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from physim.compiled import compiles

LONG = ir.IntType(64)


def _call(context: Any, address: Any, arguments: Any) -> Any:
    """Call the function at an address with a tuple of integers or addresses."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        values = cgutils.unpack_tuple(builder, args[1])  # type: ignore[no-untyped-call]
        kind = ir.FunctionType(ir.VoidType(), [LONG] * len(values))
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), values)
        return context.get_dummy_value()

    taken = types.UniTuple(types.int64, len(arguments))  # type: ignore[no-untyped-call]
    return types.void(types.int64, taken), generate


def _pointer(context: Any, address: Any) -> Any:
    """Return an address as what `array_at` takes."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), generate


def _plain_call(address: int, arguments: tuple[int, ...]) -> None:
    """`call` as plain Python."""
    ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * len(arguments))(int(address))(*map(int, arguments))


call: Callable[[int, tuple[Any, ...]], None] = _plain_call
pointer: Callable[[int], Any] = lambda address: ctypes.c_void_p(int(address))  # noqa: E731
array_at: Callable[..., Any] = numba.carray  # type: ignore[attr-defined]
"""(pointer, shape, type) -> array of what lies there"""
if compiles():
    call, pointer = cast(Any, intrinsic(_call)), cast(Any, intrinsic(_pointer))
