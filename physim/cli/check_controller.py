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
    """Check that a controller keeps the rules below. It decides for the first seconds of each world
    and in unusual situations, then decides again under other conditions; each difference is
    reported. Worlds whose robots it refuses are reported and left out. All checks run in one
    process; physim validate RECORD finds what differs between two processes, such as the order of a
    set of texts.

    arguments:
      CONTROLLER  a registered controller (physim list) or your own as module:Class

    options:
      --world WORLD  check in this world: its file, its name, or a run (its folder or record.h5), to
          use its world (default: all shipped worlds of up to 100 robots; may be repeated)
      --seconds S  simulated time in each world [s] (2)
      --set KEY=VALUE  a setting of the controller, instead of those in the worlds, e.g.
          controller.look_ahead=3.0 (may be repeated)

    rules; each finding names the rule that is broken:
      raises       it raises no exception when it decides
      decision     it returns a decision with commands within the limits
      repeats      the same settings, observation and memory give the same decision
      state        it keeps nothing in its object, class or module, only in its memory
      order        a decision does not depend on which other robots decide, or in which order
      memory       it does not write into the memory that it gets
      copies       memory can be copied and pickled, and a copy gives the same decision
      observation  it does not write into the observation
      forms        decide and decide_all, if it has both, give the same decisions, bit for bit or
                   within the agreement that the class declares
      portions     decide_all gives a robot the same decision, whichever others are due with it
      sight        it does not use what a robot cannot know: robots and walls out of range

    situations besides the worlds: nobody in sight, no wall in sight, at the end of the path, facing
    backwards, overlapping

    exit codes:
      0    no findings
      1    one line for each finding: rule, world, robot, time, and what is wrong
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
