"""Forgeries: what is changed in a record, and the words that name it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tests.analysis.forgeries.tools import (
    Change,
    attribute,
    cells,
    column,
    cut,
    decided,
    dropped,
    replace_rows,
    rows_of,
    together,
    world,
)
from tests.helpers.records import told

UP = "/updates"


class Forgery(NamedTuple):
    """An edit of the record of a run."""

    name: str
    run: str
    """of `tests.analysis.forgeries.runs.RUNS`"""
    change: Change
    words: tuple[str, ...]
    """that `physim validate` says, each of them"""
    arguments: tuple[str, ...] = ()
    """of the command, beyond the record"""
    code: int = 3
    """exit code: 3 the checks disagree, 2 refused when it is read"""


def nothing_near(file) -> None:
    """All robots far from everything, in safe mode, considering nobody."""
    rows = file[UP][()]
    rows["collision_time"], rows["mode"], rows["considered"] = 9.0, 0, 0
    file[UP][...] = rows
    replace_rows(file, "/considered", rows_of(file, "/considered")[:0])


def extra_decision(file) -> None:
    """One more decision than was announced."""
    rows = file[UP][()]
    k = int(np.flatnonzero(rows["robot"] == 1)[20])
    more = rows[k : k + 1].copy()
    more["step"] += 2
    rows = np.insert(rows, k + 1, more)
    replace_rows(file, UP, rows[np.argsort(rows["step"], kind="stable")])
    others = rows_of(file, "/considered")
    mine = others[(others["step"] == rows["step"][k]) & (others["robot"] == 1)].copy()
    mine["step"] += 2
    others = np.concatenate((others, mine))
    replace_rows(file, "/considered", others[np.argsort(others["step"], kind="stable")])


def teleport(file) -> None:
    """A robot 0.3 m further to the left, from 3 s on."""
    file["/steps/pose"][300:, 0, 1] += 0.3


def beside_the_wall(file) -> None:
    """A robot in contact, and all that it touches from then on, 0.2 m further along."""
    rows = file["/contacts"][()]
    step, a = (int(rows[name][rows["phase"] == 1][0]) for name in ("step", "a"))
    file["/steps/pose"][step:, a, 0] += 0.2


def commanded_from_outside(file) -> None:
    """No decision, and all commands as those of nobody."""
    rows = file["/updates"][()]
    taken = np.zeros(len(rows), dtype=file["/commands"].dtype)
    for name in ("step", "robot"):
        taken[name] = rows[name]
    for stage in ("nominal", "filtered", "applied"):
        for part in ("v", "omega"):
            taken[f"{stage}_{part}"] = rows[f"nominal_{part}"]
    replace_rows(file, "/commands", taken)
    together(dropped(UP, None), dropped("/considered", None))(file)


def onto_another(file) -> None:
    """Two robots 11.7 mm into each other at two samples, without a contact."""
    pose = file["/steps/pose"][()]
    for step in (200, 400):
        gap = pose[step, 0, :2] - pose[step, 1, :2]
        near = file["/steps/clearance"][step, 1]
        pose[step, 1, :2] += gap / np.hypot(*gap) * (near + 0.0117)
    file["/steps/pose"][...] = pose


def swapped(file) -> None:
    """Two robots in each other's place."""
    pose = file["/steps/pose"][()]
    file["/steps/pose"][...] = pose[:, [1, 0, 2]]


def no_contacts(file) -> None:
    """A run without a trace of its contacts."""
    file["/contacts"].resize(0, axis=0)


def later(file) -> None:
    """Contacts one step later."""
    rows = file["/contacts"][()]
    rows["step"] += 1
    replace_rows(file, "/contacts", rows[rows["step"] < len(file["/steps/step"])])


def danger(rows):
    return (rows["mode"] == 1) | (rows["mode"] == 2)


def middle(rows):
    return np.arange(len(rows)) == len(rows) // 2


def touches(rows):
    return rows["phase"] < 2


DECISIONS = [
    Forgery("nobody ever near", "free", nothing_near,
            ("/updates, row", "collision_time is 9 in the record")),
    Forgery("one collision time 1 ms later", "free",
            column(UP, "collision_time", lambda c: c + 1e-3,
                   lambda r: np.isfinite(r["collision_time"]) & (r["robot"] == 1)),
            ("r2: /updates", "collision_time is")),
    Forgery("a collision time of none", "free",
            column(UP, "collision_time", np.inf,
                   lambda r: (r["collision_time"] < 2.0) & (r["robot"] == 2)),
            ("r3: /updates", "collision_time is inf in the record")),
    Forgery("a collision time left out", "free",
            column(UP, "collision_time", np.nan, decided(1, 3)),
            ("collision_time is nan in the record", "simulated again")),
    Forgery("a distance 1 mm larger", "free",
            column(UP, "distance", lambda d: d + 1e-3, decided(2, 9)),
            ("r3: /updates", "distance is")),
    Forgery("boundary distances 1 mm larger", "free",
            column(UP, "boundary_distance", lambda d: d + 1e-3), ("boundary_distance is",)),
    Forgery("danger told as safe", "free", column(UP, "mode", 0, danger),
            ("mode is safe in the record, danger_",)),
    Forgery("one mode", "free", column(UP, "mode", 1, decided(0, 40)),
            ("r1: /updates", "mode is danger_distance in the record, safe")),
    Forgery("one rule", "free", column(UP, "rule", 2, decided(0, 40)),
            ("rule is distance in the record, path_following",)),
    Forgery("a mode of none", "free", column(UP, "mode", -1, decided(0, 40)), ("mode is none",)),
    Forgery("a target 1 cm off", "free", column(UP, "target_x", lambda x: x + 0.01, decided(1, 30)),
            ("r2: /updates", "target_x is")),
    Forgery("no formation error", "free", column(UP, "formation_error", 0.0),
            ("formation_error is 0 in the record",)),
    Forgery("fewer evaluations", "free", column(UP, "evaluations", lambda n: n // 2),
            ("evaluations is",)),
    Forgery("a station", "free", column(UP, "station", lambda s: s + 1e-6, decided(1, 30)),
            ("r2: /updates", "station is", "simulated again")),
    Forgery("deviations mirrored", "free", column(UP, "deviation", np.negative), ("deviation is",)),
    Forgery("reference stations", "free", column(UP, "reference_station", lambda s: s[::-1]),
            ("reference_station is",)),
    Forgery("fewer considered", "free", column(UP, "considered", 0, lambda r: r["considered"] > 0),
            ("considered is 0 in the record", "simulated again")),
    Forgery("a considered robot left out", "free",
            together(
                column(UP, "considered", lambda n: n - 1, decided(2, 5)),
                dropped("/considered", lambda r: (decided(2, 5)(r)) & (r["other"] == 0)),
            ),
            ("r3: /considered, row 8, count is 1 in the record, 2 simulated",)),
    Forgery("another considered", "free",
            column("/considered", "other", 2, lambda r: (r["robot"] == 1) & (r["step"] == 0)),
            ("r2: /considered_others, row",)),
    Forgery("somebody considered when nobody decides", "free",
            column("/considered", "step", lambda s: s + 1, lambda r: decided(2, 5)(r)),
            ("/considered, row", "simulated again")),
    Forgery("a decision taken out", "free",
            together(dropped(UP, decided(1, 20)), dropped("/considered", decided(1, 20))),
            ("/updates, row", "simulated again")),
    Forgery("the last decisions of a robot taken out", "free",
            together(
                dropped(UP, lambda r: (r["robot"] == 1) & (r["step"] > 1000)),
                dropped("/considered", lambda r: (r["robot"] == 1) & (r["step"] > 1000)),
            ),
            ("/updates, row", "simulated again")),
    Forgery("the first decisions taken out", "free",
            together(dropped(UP, lambda r: r["step"] == 0),
                     dropped("/considered", lambda r: r["step"] == 0)),
            ("r1: /updates, row 0, step is 20 in the record",)),
    Forgery("a decision that nobody announced", "free", extra_decision,
            ("/updates, row", "simulated again")),
    Forgery("a decision due later", "free",
            column(UP, "next_step", lambda s: s + 5, decided(0, 10)), ("next_step is",)),
    Forgery("other modes at the end", "touching", column(UP, "mode", 1, lambda r: r["step"] > 900),
            ("mode is arrived in the record, safe simulated again",)),
    Forgery("targets of another controller", "touching",
            column(UP, "target_y", lambda y: y - 0.2, lambda r: r["robot"] == 2),
            ("r3: /updates", "target_y is", "simulated again")),
    Forgery("a whole run of decisions gone", "free",
            together(dropped(UP, None), dropped("/considered", None)),
            ("poses do not follow the commands", "/updates, row 0 is not there")),
    Forgery("commands of nobody", "free", commanded_from_outside,
            ("another run, ", "/updates, row 0 is not there")),
]  # fmt: skip

COMMANDS = [
    Forgery("one command", "free",
            together(column(UP, "nominal_v", lambda v: v + 1e-3, decided(0, 30)),
                     column(UP, "applied_v", lambda v: v + 1e-3, decided(0, 30))),
            ("r1: unexplained (it touches nothing, yet its pose", "nominal_v is")),
    Forgery("applied commands of decisions", "free", column(UP, "applied_v", 0.0, decided(0, 30)),
            ("applied_v is 0 in the record",)),
    Forgery("beyond the limits", "free",
            together(column(UP, "nominal_omega", 9.0, decided(0, 30)),
                     column(UP, "applied_omega", 9.0, decided(0, 30))),
            ("nominal_omega is 9 in the record", "by the limits of that robot")),
    Forgery("filtered commands beyond the limits", "staged",
            column("/commands", "filtered_v", 99.0, middle), ("filtered_v is 99", "by the limits")),
    Forgery("limits lowered in the world", "free", world("v: 1.5", "v: 0.9"),
            ("nominal_v is", "0.9 at most either way, by the limits")),
    Forgery("rows of commands taken out", "staged",
            dropped("/commands", lambda r: r["step"] > 300), ("poses do not follow the commands",)),
    Forgery("filters not named", "staged",
            attribute("given", '[["disturbance", "tests.analysis.forgeries.parts:Slip"]]'),
            ("filtered_v is", "there is no filter")),
    Forgery("disturbances not named", "staged",
            attribute("given", '[["filter", "tests.analysis.forgeries.parts:Ramp"]]'),
            ("applied_v is", "there is no disturbance")),
    Forgery("a row of commands that says nothing", "staged",
            together(*(column("/commands", f"{stage}_{part}", lambda v: v * 0.0, middle)
                       for stage in ("nominal", "filtered", "applied") for part in ("v",))),
            ("/commands, row", "nominal_v is 0 in the record")),
    Forgery("what was applied", "staged",
            column("/commands", "applied_v", lambda v: v + 1e-3, middle),
            ("poses do not follow the commands",)),
    Forgery("nominal commands in one table", "staged",
            column("/commands", "nominal_omega", lambda w: w + 0.1, middle),
            ("nominal_omega is", "by the last decision of that robot")),
]  # fmt: skip

MOTION = [
    Forgery("a pose 1 mm aside", "free", cells("/steps/pose", (800, 1, 0), lambda x: x + 1e-3),
            ("poses do not follow the commands", "r2: unexplained")),
    Forgery("a heading", "free", cells("/steps/pose", (800, 1, 2), lambda a: a + 1e-3),
            ("r2: unexplained (it touches nothing",)),
    Forgery("robots swapped", "free", swapped, ("r1: /steps/pose, row 0",)),
    Forgery("a robot in contact further along", "touching", beside_the_wall,
            ("in contact it moved", "what pushes it allow")),
    Forgery("a teleport behind a filter", "staged", teleport,
            ("poses do not follow the commands", "its pose is 0.3 m")),
    Forgery("deep contacts behind a filter", "staged", onto_another,
            ("r1 and r2, signed distance -0.0", "no contact in the record, shapes overlap")),
    Forgery("a clearance", "free", cells("/steps/clearance", (700, 0), 0.5),
            ("distance to the nearest robot 0.5 m in the record",)),
    Forgery("a distance to walls", "free", cells("/steps/boundary_clearance", (700, 0), 0.5),
            ("distance to the nearest boundary 0.5 m in the record",)),
    Forgery("the shortest distance of all", "free", column("/extremes", "clearance", 0.9, 1),
            ("smallest distance", "0.9 m")),
    Forgery("the farthest pair", "free", cells("/extremes_farthest", "farthest", 3.0),
            ("largest distance of robots 3 m",)),
]  # fmt: skip

CONTACTS = [
    Forgery("no contacts", "touching", no_contacts, ("no contact in the record, shapes overlap",)),
    Forgery("one row of a contact", "touching", dropped("/contacts", 1), ("unexplained",)),
    Forgery("contacts a step later", "touching", later, ("in the record, shapes",)),
    Forgery("depths", "touching", column("/contacts", "depth", lambda d: 0.1 * d, touches),
            ("depth", "m in the record")),
    Forgery("contact points", "touching", column("/contacts", "x", lambda x: x + 0.1),
            ("contact point (",)),
    Forgery("normals", "touching", column("/contacts", "nx", np.negative), ("normal (",)),
    Forgery("contacts told as grazes", "touching", column("/contacts", "kind", 1, touches),
            ("shapes overlap",)),
    Forgery("a push without a hit", "touching", column("/contacts", "phase", 1, touches),
            ("a row that begins a contact or goes on with one, wrongly",)),
    Forgery("rejected contacts", "touching", attribute("rejected_contacts", np.int64(7)),
            ("attribute rejected_contacts is 7 in the record, 0 by the table",)),
    Forgery("contacts said not to be recorded", "touching",
            attribute("tables", '["updates", "considered", "false_contacts"]'),
            ("attribute tables is without contacts in the record",)),
    Forgery("gentler hits", "touching", column("/contacts", "impulse", lambda j: 0.5 * j, touches),
            ("another run", "/contacts, row 0, impulse is")),
    Forgery("another friction in the world", "touching",
            world("friction: 0.0", "friction: 0.8"), ("another run, ", "simulated again"),
            ("--rerun",)),
]  # fmt: skip

ENDING = [
    Forgery("cut short and called finished", "free", cut(600, "finished"),
            ("r1: /updates, row 91 is not there in the record",)),
    Forgery("cut short and called whole", "free", cut(600, "duration"),
            ("r1: /updates, row 91 is not there in the record",)),
    Forgery("finished called interrupted", "free", attribute("ended", "interrupted"),
            ("attribute ended is interrupted in the record, finished",)),
    Forgery("not finished called finished", "touching", attribute("ended", "finished"),
            ("attribute ended is finished in the record, duration",)),
    Forgery("arrived earlier", "free", cells("/robots/arrived", 0, 500),
            ("r1: /robots/arrived, row 0 is 500 in the record",)),
    Forgery("arrived after all", "touching", cells("/robots/arrived", 2, 700),
            ("r3: /robots/arrived, row 2 is 700 in the record, -1 simulated",)),
    Forgery("a narrow tolerance of arrival", "free", world("tolerance: 0.1", "tolerance: 0.0"),
            ("attribute ended is finished in the record, duration",)),
]  # fmt: skip

WORLD = [
    Forgery("another seed", "free", attribute("seed", np.int64(99)),
            ("seed is 99 in the record, 4 by the world inside it",)),
    Forgery("another seed, in the world too", "free",
            together(attribute("seed", np.int64(99)), world("seed: 4", "seed: 99")),
            ("r1: /steps/pose, row 0",)),
    Forgery("another name", "free", attribute("name", "other"), ("name is other in the record",)),
    Forgery("another step", "free", attribute("dt", 0.02), ("dt is 0.02 in the record",)),
    Forgery("a longer run planned", "free", attribute("steps_planned", np.int64(9000)),
            ("steps_planned is 9000 in the record",)),
    Forgery("another grain", "free", attribute("record_every", np.int64(2)),
            ("attribute record_every is 2 in the record, 1 by the recorded steps",)),
    Forgery("another L", "free", attribute("safe_distance", 0.2),
            ("safe_distance is 0.2 in the record", "the safe area is another")),
    Forgery("corners of the safe area in another order", "free",
            cells("/areas/safe/points", [1, 2], lambda corners: corners[::-1]),
            ("the safe area is another",)),
    Forgery("a lead", "free", cells("/robots/lead", 1, -1.0), ("/robots/lead, row 1 is -1",)),
    Forgery("a stop station", "free", cells("/robots/stop_station", 1, 5.0),
            ("/robots/stop_station, row 1 is 5 in the record",)),
    Forgery("a smaller robot", "free", cells("/footprints/vertices", (0, 0), lambda x: 0.9 * x),
            ("/footprints/vertices, row 0 is",)),
    Forgery("a wall", "free", cells("/walls/vertices", (0, 1), lambda y: y + 0.1),
            ("/walls/vertices, row 0 is",)),
    Forgery("a path", "free", cells("/paths/points", (0, 1), lambda y: y + 0.1),
            ("/paths/points, row 0 is",)),
    Forgery("another name of a robot", "free", told("bodies", None, 1, name="r9"),
            ("/bodies/name, row 1 is r9 in the record",)),
    Forgery("danger painted safe", "free", told("declared", "modes", 1, colour="#0072b2"),
            ("/modes/colour, row 1 is #0072b2 in the record",)),
    Forgery("danger that is none", "free", told("declared", "modes", 2, danger=False),
            ("/modes/danger, row 2 is 0 in the record",)),
    Forgery("another unit", "free", told("declared", "columns", 4, words="largest collision time"),
            ("/columns/words, row 4 is largest collision time",)),
    Forgery("another gain in the world", "free", world("gain: 0.05", "gain: 0.02"),
            ("nominal_v is", "simulated again")),
    Forgery("other thresholds in the world", "free", world("time_low: 1.5", "time_low: 0.3"),
            ("mode is danger_time in the record, safe simulated again",)),
    Forgery("another controller in the world", "free",
            world("type: mode_switching", "type: path_following"), ("world inside",), (), 2),
    Forgery("another range of sensing in the world", "free", world("range: 10.0", "range: 3.0"),
            ("nominal_v is", "simulated again")),
    Forgery("a duration in the world", "free", world("duration: 30.0", "duration: 90.0"),
            ("steps_planned is 3000 in the record, 9000 by the world inside it",)),
    Forgery("less expected in the world", "free", world("finished: true", "finished: false"),
            ("not made from", "expect.finished is False in the record, True"),
            ("--world", "LANE"), 2),
]  # fmt: skip

REFUSED = [
    Forgery("another major version", "free", attribute("version", "99"),
            ("record version is '99': Input should be '5'",), (), 2),
    Forgery("a robot that is not there", "free", column(UP, "robot", 9, 5),
            ("robot is 9; allowed: 0 to 2",), (), 2),
    Forgery("a decision twice", "free", column(UP, "robot", 0, 1),
            ("/updates, row 1, robot is 0 in the record, 1 simulated again",)),
    Forgery("negative impulses", "touching", column("/contacts", "impulse", lambda j: -1.0 - j),
            ("impulse is", "allowed: 0 to"), (), 2),
    Forgery("a missing sample", "free",
            lambda file: [replace_rows(file, f"/steps/{name}",
                                       np.delete(file[f"/steps/{name}"][()], 50, axis=0))
                          for name in ("step", "pose", "clearance", "boundary_clearance")],
            ("step 50 has no sample",), (), 2),
    Forgery("the world taken out", "free", attribute("world", ""),
            ("the world inside cannot be read: ", "the file is empty"), (), 2),
    Forgery("poses that are none", "free", cells("/steps/pose", (5, 0, 0), np.nan),
            ("/steps/pose, row 5: value [0, 0] is nan; allowed: ",), (), 2),
    Forgery("steps that are more than there are", "free", attribute("steps_run", np.int64(2000)),
            ("truncated: ", "samples", "for 2000 steps"), (), 2),
]  # fmt: skip

FORGERIES = [*DECISIONS, *COMMANDS, *MOTION, *CONTACTS, *ENDING, *WORLD, *REFUSED]
