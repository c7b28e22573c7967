"""Base of all models of a world: frozen, strict, and refusing in our own words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from pydantic import BaseModel, ConfigDict, ValidationError

from physim.errors import Fault, WorldError
from physim.world.faults import faults_of

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)


class _Meta(ModelMetaclass):
    """Turns pydantic's error into a `WorldError` with every fault.

    It sits on the call of the class rather than in ``__init__``: a model inside another one is
    made without that call, so that all faults of a world arrive together.
    """

    def __call__(cls, /, *args: Any, **data: Any) -> Any:  # noqa: N805
        try:
            made: Model = super().__call__(*args, **data)
        except ValidationError as error:
            raise WorldError(faults_of(error, cast("type[Model]", cls))) from None
        if faults := made.rule_faults():
            raise WorldError(faults)
        return made


class Model(BaseModel, metaclass=_Meta):
    """Frozen, hashable, equal by value; an unknown key is refused.

    Making one with bad values raises `physim.errors.WorldError`, which lists every fault.
    """

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        protected_namespaces=(),
        use_attribute_docstrings=False,
        defer_build=True,  # of parts of a world on their own; the whole one holds theirs
    )

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

    def rule_faults(self) -> list[Fault]:
        """Faults between several values, which are sound each by itself; nothing by default."""
        return []
