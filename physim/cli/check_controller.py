"""``physim check-controller``."""

from __future__ import annotations

from collections.abc import Sequence
from json import dumps
from typing import TYPE_CHECKING, Annotated

from physim.cli.options import JsonFlag, Out, kind, quoted, real
from physim.cli.progress import Bar, announce_compiling
from physim.errors import PhysimError, WorldError, plain_key, plural

if TYPE_CHECKING:
    from physim.testing.check import Candidate, WorldResult

FOUND = 1


def check_controller(
    controller: str, /, *,
    world: tuple[str, ...] = (),
    seconds: Annotated[float | None, kind(real(0.001, 1e6))] = None,
    set: tuple[str, ...] = (),
    json: JsonFlag = False,
    out: Out,
) -> int:  # fmt: skip
    """Let a controller decide for the first seconds of worlds and in awkward situations, ask it for
    the same decisions again under other conditions, and report what comes out differently.
    Worlds whose robots it refuses are reported and left out. All this is asked in one process: what
    differs from one to the next, as the order of a set of text or hash() of text does, is found by
    physim validate RECORD.

    arguments:
      CONTROLLER  a registered controller (physim list) or your own as module:Class

    options:
      --world WORLD  a world file; the name of a shipped world, or of one in worlds/; or the
          record.h5 of a run, whose world is taken; instead of all shipped ones of up to 100 robots
          (may be repeated)
      --seconds S  simulated time of each world [s] (2)
      --set KEY=VALUE  a setting of the controller, instead of those in the worlds, e.g.
          controller.look_ahead=3.0 (may be repeated)

    rules, each finding names the one that is broken:
      raises       decide raises nothing
      decision     it returns a Decision with commands within the limits
      repeats      the same settings, observation and memory give the same decision
      state        nothing is kept on the object, its class or module: that is memory
      order        whoever else is asked, and in whatever order, changes nothing
      memory       the memory handed over is not written into
      copies       memory can be copied and pickled, and a copy does as well
      observation  nothing is written into what is seen
      batch        the batch form, where there is one, decides as the plain form
      batch_order  and does so robot by robot, too

    situations beside the worlds: nobody in sight, no wall in sight, at the end of the path, facing
    backwards, overlapping

    exit codes:
      0    nothing was found
      1    a line a finding: rule, world, robot, time, and what is wrong
      2    bad input: one line says what and where
      130  interrupted (Ctrl-C)

    examples:
      physim check-controller my_module:MyController
      physim check-controller my_module:MyController --world my_world.yaml --seconds 20
      physim check-controller mode_switching --set controller.look_ahead=3.0 --json
    """
    from physim.simulation.run import is_warm, warm_up
    from physim.testing.check import SECONDS, SITUATIONS, check_worlds, worlds_to_try
    from physim.world.file import load_world
    from physim.world.layout.scene_builder import build_scene

    chosen = _chosen(controller, set)
    worlds = worlds_to_try(world or None)
    if not is_warm():
        announce_compiling("all that a run needs", quiet=False)
        warm_up(build_scene(load_world("straight")))
    parts: list[WorldResult] = []
    with Bar("check", len(worlds) + len(SITUATIONS), "worlds", quiet=False) as bar:

        def begins(name: str) -> None:
            bar.update(len(parts), name)

        for part in check_worlds(chosen, worlds, seconds or SECONDS, begins):
            parts.append(part)  # one by one: `begins` counts them
    if json:
        print(dumps(json_of(chosen.name, parts), indent=1), file=out)
    else:
        print(text_of(chosen.name, parts), end="")
    return FOUND if any(part.findings for part in parts) else 0


def _chosen(controller: str, overrides: Sequence[str]) -> Candidate:
    """Find the controller and check its settings; each fault with its place."""
    from physim.testing.check import candidate
    from physim.world.file import apply_overrides, read_document

    for key in map(plain_key, overrides):
        if key == "controller.type":
            raise PhysimError("--set controller.type: is what CONTROLLER says")
        if not key.startswith("controller."):
            raise PhysimError(
                f"--set {quoted(key)}: is no setting of the controller; write controller.KEY=VALUE"
            )
    document = apply_overrides(read_document("controller: {}", "--set"), overrides)
    settings = document.values["controller"]
    chosen = candidate(controller, settings or None)
    try:
        if settings:
            chosen.maker()
    except WorldError as error:
        raise document.error(error.faults) from None
    return chosen


def text_of(name: str, parts: list[WorldResult]) -> str:
    """A line a finding or world left out, and a last line that sums up."""
    found = sum(len(part.findings) for part in parts)
    tried = [part for part in parts if not part.skipped]
    worlds, odd = (sum(part.situation is is_odd for part in tried) for is_odd in (False, True))
    decisions = sum(part.decisions for part in tried)
    lines = [line for part in parts for line in part.lines()]
    lines.append(
        f"{name}: {plural(found, 'finding') if found else 'no findings'} in "
        f"{plural(decisions, 'decision')} of {plural(worlds, 'world')} and "
        f"{plural(odd, 'situation')}"
    )
    return "\n".join(lines) + "\n"


def json_of(name: str, parts: list[WorldResult]) -> dict[str, object]:
    """Everything that was found, as JSON holds it."""
    return {
        "format": "physim-check-controller",
        "version": 1,
        "controller": name,
        "findings": [finding.as_json() for part in parts for finding in part.findings],
        "worlds": [
            {
                "world": part.world,
                "situation": part.situation,
                "decisions": part.decisions,
                "skipped": part.skipped or None,
            }
            for part in parts
        ],
    }
