"""``physim check-controller``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from physim.cli.options import JsonFlag, Out, kind, quoted, real
from physim.cli.progress import Bar
from physim.errors import PhysimError, WorldError, plain_key, plural
from physim.json_text import json_text

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
      --world WORLD  a world file; the name of a shipped world, or of one in worlds/; or a run, its
          folder or its record.h5, whose world is taken; instead of all shipped ones of up to 100
          robots (may be repeated)
      --seconds S  simulated time of each world [s] (2)
      --set KEY=VALUE  a setting of the controller, instead of those in the worlds, e.g.
          controller.look_ahead=3.0 (may be repeated)

    rules, each finding names the one that is broken:
      raises       it raises nothing when it decides
      decision     it returns a decision with commands within the limits
      repeats      the same settings, observation and memory give the same decision
      state        nothing is kept on the object, its class or module: that is memory
      order        whoever else is asked, and in whatever order, changes nothing
      memory       the memory handed over is not written into
      copies       memory can be copied and pickled, and a copy does as well
      observation  nothing is written into what is seen
      forms        decide and decide_all, where there are both, decide alike, bit for bit or
                   within the agreement that the class declares
      portions     decide_all decides alike for some robots, or one, as for all that are due
      sight        it goes by nothing that a robot may not know: robots and walls out of range

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
    from physim.parts.declarations import agreement_of
    from physim.testing.check import SECONDS, SITUATIONS, check_worlds, worlds_to_try

    chosen = _chosen(controller, set)
    worlds = worlds_to_try(world or None)
    parts: list[WorldResult] = []
    with Bar("check", len(worlds) + len(SITUATIONS), "worlds", quiet=False) as bar:

        def begins(name: str) -> None:
            bar.update(len(parts), name)

        for part in check_worlds(chosen, worlds, seconds or SECONDS, begins):
            parts.append(part)  # one by one: `begins` counts them
    findings = [finding for part in parts for finding in part.findings]
    agreement = agreement_of(chosen.kind)
    within = f"; forms may differ by {agreement:g}, as it declares" if agreement else ""
    if json:
        values = {
            "format": "physim-check-controller",
            "version": 1,
            "controller": chosen.name,
            "agreement": agreement,
            "findings": [finding.as_json() for finding in findings],
            "worlds": [part.as_json() for part in parts],
        }
        print(json_text(values), end="", file=out)
        return FOUND if findings else 0
    for line in (line for part in parts for line in part.lines()):
        print(line)
    tried = [part for part in parts if not part.skipped]
    odd = sum(part.situation for part in tried)
    print(
        f"{chosen.name}: {plural(len(findings), 'finding') if findings else 'no findings'} in "
        f"{plural(sum(part.decisions for part in tried), 'decision')} of "
        f"{plural(len(tried) - odd, 'world')} and {plural(odd, 'situation')}{within}"
    )
    return FOUND if findings else 0


def _chosen(controller: str, overrides: Sequence[str]) -> Candidate:
    """Find the controller and check its settings; each fault with its place."""
    from physim.testing.check import candidate
    from physim.world.file import apply_overrides, read_document

    for key in map(plain_key, overrides):
        if not key.startswith("controller.") or key == "controller.type":
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
