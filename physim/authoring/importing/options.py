"""What is asked of an import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, Tag

from physim.authoring.importing.drawing import DIGITS, refused
from physim.authoring.importing.source import FORMATS
from physim.world.base import Model
from physim.world.kinds import Flag, Number, Sequence, Text, Whole, either

Above = Annotated[Number, Field(gt=0.0)]
Least = Annotated[Number, Field(ge=0.0)]
Counted = Annotated[Whole, Field(ge=1, le=10_000)]
Pair = Annotated[tuple[Number, Number], Sequence]
Side = Annotated[Number, Field(ge=10.0**-DIGITS)]
Size = Annotated[
    Annotated[Literal["fit"], Tag("<word>")]
    | Annotated[tuple[Side, Side], Sequence, Tag("<value>")],
    either("<word>", "<value>"),
]


class Options(Model):
    """What the user asked for; None where the source or the import decides.

    Lengths [m]: ``tolerance`` of simplified and flattened lines, ``start`` and ``gap`` of a closed
    track, ``origin`` and ``goal`` (x, y) of the route, ``robot`` (length, width) or "fit", as large
    as the path has room for, ``close`` the longest gap between ends of lines that is closed.
    ``scale`` [m per unit of the source], ``specks`` [m²] the largest occupied patch that is left
    out. ``open``: the track is open, whatever its ends look like. ``boundary`` are ids or labels of
    shapes and groups of an SVG drawing that are walls; ``ignore`` are those of a drawing, or names
    and layers of features, that are left out, ``ignore_others`` leaves out all without a role.
    Raises WorldError for values that cannot be.
    """

    format: Literal["track", "ros-map", "svg", "wkt", "geojson"] | None = None
    scale: Above | None = None
    tolerance: Above | None = None
    specks: Least | None = None
    start: Least | None = None
    gap: Above | None = None
    open: Flag = False
    origin: Pair | None = None
    goal: Pair | None = None
    robots: Counted | None = None
    lanes: Counted | None = None
    robot: Size | None = None
    no_formation: Flag = False
    close: Above | None = None
    name: Text | None = None
    boundary: Annotated[tuple[Text, ...], Sequence] = ()
    ignore: Annotated[tuple[Text, ...], Sequence] = ()
    ignore_others: Flag = False

    def changed(self, **changes: Any) -> Options:
        """Return these with some values replaced; WorldError for values that cannot be."""
        return Options(**{**dict(self), **changes})

    @property
    def unit(self) -> float:
        """Metres per unit of a source whose units are metres unless the user says otherwise."""
        return 1.0 if self.scale is None else self.scale


def check_options(source: Path, kind: str, options: Options) -> None:
    """Refuse options that would be without effect for a kind of source."""
    for name, field in Options.model_fields.items():
        kinds = [key for key, one in FORMATS.items() if name in one.options]
        if kinds and kind not in kinds and getattr(options, name) != field.default:
            option = f"--{name.replace('_', '-')}"
            message = f"{option} is for {', '.join(kinds)}; this is read as {kind}"
            raise refused(source, message)
