"""Base of all models of a world: frozen, strict, and refusing in our own words."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from physim.errors import WorldError
from physim.world.faults import faults_of
from physim.world.kinds import plain


class Model(BaseModel):
    """Frozen, hashable, equal by value; an unknown key is refused.

    Making one with bad values raises `physim.errors.WorldError`, which lists every fault. A numpy
    array or number is taken like the list or number it stands for.
    """

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        protected_namespaces=(),
        use_attribute_docstrings=False,
        defer_build=True,  # of parts of a world on their own; the whole one holds theirs
    )

    def __init__(self, /, **values: Any) -> None:
        """Check all values; a model within this one is made without a call of its own."""
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise WorldError(faults_of(error, type(self))) from None

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # so says pydantic's own

    @model_validator(mode="before")
    @classmethod
    def _of_numpy(cls, values: Any) -> Any:
        is_dict = isinstance(values, dict)
        return {key: plain(value) for key, value in values.items()} if is_dict else values

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse, with AttributeError: a world and its parts are made anew instead."""
        if name in type(self).model_fields:
            raise AttributeError(
                f"{type(self).__name__}.{name} is read-only; World.changed(KEY=VALUE) gives a "
                "world with other values"
            )
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        """Refuse like `__setattr__`."""
        self.__setattr__(name, None)
