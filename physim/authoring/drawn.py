"""A world whose road the seed draws, with that road written out: a plain world, to be edited."""

from __future__ import annotations

from physim._version import __version__
from physim.errors import Fault, WorldError
from physim.escaping import escaped
from physim.world import World
from physim.world.file.schema import FILE
from physim.world.layout.layout import lay_out
from physim.world.layout.road import plain_world


def drawn_text(world: World, name: str, command: str) -> str:
    """Text of a world called ``name`` with the road that the seed of ``world`` draws.

    Numbers are those of the drawn road to the last bit, so that a run of it moves as one of
    ``world`` does; what else is random still comes from the same seed. ``command`` is what it was
    made with. Raises WorldError where there is no such road, or it cannot be drawn.
    """
    if not world.is_road_random:
        message = "has no corridor.random, so nothing of its road is drawn; copy the file instead"
        raise WorldError([Fault((), message)])
    laid = lay_out(world)
    lines = [
        f"# yaml-language-server: $schema={FILE}",
        f"# The road of {escaped(world.name)} as seed {world.seed} draws it, made by physim "
        f"{__version__} with",
        f"#   {escaped(command)}",
    ]
    return "\n".join(lines) + "\n" + plain_world(laid.world, name).to_yaml()
