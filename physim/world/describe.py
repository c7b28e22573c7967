"""Find the model or the field that stands at a location, by following the annotations."""

from __future__ import annotations

import types
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag
from pydantic.fields import FieldInfo

from physim.errors import Location

TAGS = frozenset({"<value>", "<word>", "<list>", "<mapping>"})
"""Parts of a location that tell alternatives of a value apart and that no author wrote."""


def model_at(model: type[BaseModel], location: Location) -> type[BaseModel] | None:
    """Return the model whose keys may stand at ``location``, or None.

    A location as pydantic gives it may hold tags (``<box>``) that choose among alternatives.
    """
    found = _walk(model, location)
    for option in _options(found):
        if isinstance(option, type) and issubclass(option, BaseModel):
            return option
    return None


def field_at(model: type[BaseModel], location: Location) -> FieldInfo | None:
    """Return the field of that name at ``location``, with its description, or None."""
    if not location or not isinstance(location[-1], str):
        return None
    holder = model_at(model, location[:-1])
    return holder.model_fields.get(location[-1]) if holder is not None else None


def _walk(model: type[BaseModel], location: Location) -> Any:
    here: Any = model
    for part in location:
        here = _step(here, part)
    return here


def _step(here: Any, part: str | int) -> Any:
    """Annotation one key, index or tag further in; None when there is nothing."""
    if part in TAGS:
        return next(iter(_options(here, tag=part)), None)
    for option in _options(here):
        if isinstance(option, type) and issubclass(option, BaseModel):
            field = option.model_fields.get(str(part))
            if field is not None:
                return field.annotation
        if get_origin(option) is tuple and isinstance(part, int):
            items = get_args(option)
            if len(items) == 2 and items[1] is Ellipsis:
                return items[0]
            return items[part] if part < len(items) else None
    return None


def _options(annotation: Any, tag: str | int | None = None) -> list[Any]:
    """Alternatives of an annotation without ``Annotated``; only those of ``tag`` if given."""
    origin = get_origin(annotation)
    if origin is Annotated:
        inner, *notes = get_args(annotation)
        tags = [note.tag for note in notes if isinstance(note, Tag)]
        if tag is not None and tags:
            return [inner] if tag in tags else []
        return _options(inner, tag)
    if origin is Union or origin is types.UnionType:
        return [found for member in get_args(annotation) for found in _options(member, tag)]
    return [annotation]
