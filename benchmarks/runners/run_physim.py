"""physim: polygons with contacts in the corridor; what is asked for is a function of `KINDS`.

The walls are 200 segments. The paper's controller decides every 0.1 s, as those of the peers do.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from math import atan2, hypot, pi
from pathlib import Path
from typing import Any

import numpy as np
from common import (
    FIRST_X,
    LENGTH_OF_ROBOT,
    PACKED,
    PERIOD,
    SPACING,
    SPEED,
    STEP,
    WIDTH,
    WIDTH_OF_ROBOT,
    lane,
    places,
    rate,
    report,
    road_length,
    task,
)  # fmt: skip

import physim
from physim import Decision, Mode, Simulation, World

SHORT = {"look_ahead": 1.0, "horizon": 10.0, "longest_interval": PERIOD}
NEAR = {"distance_low": 0.15, "distance_high": 0.25, "boundary_low": 0.05, "safe_distance": 0.3}
SOON = {"time_low": 0.5, "time_high": 1.0}
ALWAYS = {"distance_low": 0.5, "distance_high": 0.8, "boundary_low": 6.0, "avoidance": "time"}
"""Thresholds under which no robot is ever safe: no place of the corridor is 6 m from its walls. All
decide by (13), the dearer rule."""
SEGMENTS = 200
SEGMENTS_OF_DEAD_END = 50
FAR = 200.0
"""[m] from the corridor to walls that nobody sees"""
FAR_LENGTH = 64.0


def corridor(
    robots: int, settings: dict[str, Any] | None = None, jam: bool = False, noise: float = 0.05,
    duration: float = 2000.0, speed: float = SPEED, segments: int = SEGMENTS,
    spacing: float | None = None, far: int = 0,
) -> World:  # fmt: skip
    """World of the corridor; without settings nobody decides. ``far`` segments are out of sight."""
    rng = np.random.default_rng(0)
    spacing = spacing or (PACKED if jam else SPACING)
    length = road_length(robots, jam, spacing) + 0.5
    margin = 0.5 if jam else 3.0
    points = np.linspace(0.0, length - margin, max(2, segments // 2 - 1))
    robot = {
        "footprint": {"length": LENGTH_OF_ROBOT, "width": WIDTH_OF_ROBOT},
        "limits": {"v": max(1.0, speed), "omega": 1.6},
    }
    standing = [
        {**robot, "name": f"a{i}", "path": {"offset": lane(i)},
         "pose": [x + rng.normal(0.0, noise), y + rng.normal(0.0, noise),
                  rng.normal(0.0, 2.0 * noise)]}
        for i, (x, y) in enumerate(places(robots, spacing))
    ]  # fmt: skip
    paper = {"type": "mode_switching", **(settings or {})}
    formation = {
        "gain": 0.005, "speed": speed, "limits": [0.8 * speed, max(1.0, speed)],
        "spacing": "initial", "range": 10.0,
    }  # fmt: skip
    road = {
        "corridor": {"centreline": [[float(x), 0.0] for x in points], "width": WIDTH,
                     "end_margin": margin},
    }  # fmt: skip
    if far:
        road = _with_far_walls(points, far)
    return World(
        name="corridor",
        seed=0,
        time={"step": STEP, "duration": duration},
        robots=standing,
        formation=formation,
        controller={"type": "constant"} if settings is None else paper,
        **road,
    )


def _with_far_walls(points: np.ndarray, far: int) -> dict[str, Any]:
    """The corridor as walls that are drawn, and a line of ``far`` segments that nobody sees."""
    xs, half = [-1.0, *points.tolist(), float(points[-1]) + 3.0], WIDTH / 2
    round_it = [*([x, -half] for x in xs), *([x, half] for x in xs[::-1]), [xs[0], -half]]
    line = [[float(x), FAR] for x in np.linspace(0.0, FAR_LENGTH, far + 1)]
    return {
        "boundaries": [round_it, line],
        "reference_path": [[float(x), 0.0] for x in points],
    }


class Cautious:
    """The controller of one's own in README.md."""

    modes = (Mode("going", "#0072b2"), Mode("waiting", "#e69f00", "waits", danger=True))

    def decide(self, observation: Any, memory: Any) -> Decision:
        """Steer to a point 2 m ahead; wait while a robot further along is near."""
        o = observation
        if o.station >= o.stop_station - 0.05:
            return Decision(v=0.0, omega=0.0, hold=PERIOD, mode="going")
        x, y, heading = o.pose
        tx, ty = o.path.target(o.station, 2.0)
        error = (atan2(ty - y, tx - x) - heading + pi) % (2 * pi) - pi
        omega = max(-o.limits[1], min(o.limits[1], 2.0 * error))
        ahead = [s for s in o.others if s.station > o.reference_station]
        if any(hypot(s.pose[0] - x, s.pose[1] - y) < 1.1 for s in ahead):
            return Decision(v=0.0, omega=omega, hold=PERIOD, mode="waiting")
        return Decision(v=min(SPEED, o.limits[0]), omega=omega, hold=PERIOD, mode="going")


PAPER = {
    "free": {**SHORT, **NEAR, **SOON},
    "danger": {**SHORT, **NEAR, **SOON, **ALWAYS},
    "default": {"longest_interval": PERIOD},
    "short": {"longest_interval": PERIOD, "safe_distance": 0.3},
    "long": {**SHORT, **NEAR, **SOON, "safe_distance": 1.0},
}
"""Settings of the paper's controller by what is measured; ``short`` is the default but for L,
``long`` is ``free`` but for L."""
FORWARD = ("drive", "jam", "dead_end")
"""What is driven straight on, from outside."""


def simulation(kind: str, robots: int, **walls: int) -> Simulation:
    """Set up what is to be measured; ``walls`` are numbers of segments."""
    if kind in PAPER:
        return Simulation(corridor(robots, PAPER[kind], **walls))
    if kind == "plain":
        return Simulation(corridor(robots), controller=Cautious())
    if kind == "dead_end":  # which they have a way to
        return Simulation(
            corridor(robots, jam=True, spacing=SPACING, segments=SEGMENTS_OF_DEAD_END)
        )
    return Simulation(corridor(robots, jam=kind == "jam", noise=0.01 if kind == "jam" else 0.0))


def speed(asked: dict[str, Any]) -> dict[str, Any]:
    """Rate of the corridor, and the share of decisions in danger mode."""
    kind, robots = asked["kind"], asked["robots"]
    began = time.process_time()
    running = simulation(kind, robots, **asked.get("walls", {}))
    ready = time.process_time() - began
    forward = np.tile([SPEED, 0.0], (robots, 1)) if kind in FORWARD else None
    start = running.state
    found = rate(
        lambda: running.step(forward), robots, asked["seconds"], asked["most"],
        lambda: running.restore(start), asked.get("whole", False),
    )  # fmt: skip
    found["contacts"] = len(running.contacts)
    if forward is None:
        running.restore(start)
        found.update(_decisions(running, min(found["steps"], asked["most"])))
        if kind == "danger" and found["danger"] < 1.0:
            raise SystemExit(f"only {found['danger']:.3f} of the decisions are in danger mode")
    return {**found, "ready": ready}


def _decisions(running: Simulation, steps: int) -> dict[str, float]:
    """Share of decisions in danger mode, and decisions a robot and step: the way once more."""
    is_danger = np.array([*(mode.danger for mode in running.declared.modes), False])
    made = danger = 0
    for _ in range(steps):
        running.step()
        decisions = running.last.decisions if running.last else None
        if decisions is not None:
            made += len(decisions.mode)
            danger += int(is_danger[decisions.mode].sum())
    robots = running.scene.robots
    return {"danger": danger / max(made, 1), "decisions": made / (steps * robots)}


def record(asked: dict[str, Any]) -> dict[str, Any]:
    """The same run with a record on disk and without, in turn, and how large the record is."""
    from physim.simulation.run import record_run

    robots, seconds = asked["robots"], asked["steps"] * STEP
    running = Simulation(corridor(robots, PAPER["free"], duration=seconds))
    start, spent = running.state, {True: [], False: []}
    with tempfile.TemporaryDirectory() as folder:
        for repeat in range(3):
            for is_recorded in (True, False):
                running.restore(start)
                began = time.process_time()
                if is_recorded:
                    record_run(running, path=Path(folder) / f"{repeat}.h5")
                else:
                    for _ in range(asked["steps"]):
                        running.step()
                if repeat:  # the first time kernels are compiled
                    spent[is_recorded].append(time.process_time() - began)
        size = (Path(folder) / "1.h5").stat().st_size / 1e6
    rates = {yes: 2 * robots * asked["steps"] / sum(times) for yes, times in spent.items()}
    spans = [robots * asked["steps"] / one for one in spent[True]]
    return {"rate": rates[True], "without": rates[False], "spans": spans, "size": size}


def head_on(asked: dict[str, Any]) -> dict[str, Any]:
    """A robot driven head-on at the end of a corridor: refused at this step, or told when."""
    found: list[dict[str, Any]] = []
    refused = {}
    for v in asked["speeds"]:
        step = STEP
        for offset in asked["offsets"]:
            world = corridor(1, jam=True, noise=0.0, speed=v, duration=20.0)
            try:
                running = Simulation(_placed(world, offset, step))
            except physim.WorldError as error:
                refused[v] = str(error).splitlines()[0]
                step = 0.01 * 2.0 ** np.floor(np.log2(0.24 * WIDTH_OF_ROBOT / v / 0.01))
                step = round(step, 6)
                running = Simulation(_placed(world, offset, step))
            found.append({"speed": v, "step": step, **_watch(running, v)})
    return {"runs": found, "refused": refused}


def _placed(world: World, offset: float, step: float) -> World:
    robot = world.robots[0].model_dump(exclude_none=True)
    robot["pose"] = [FIRST_X - 2.0 - offset, 0.0, 0.0]
    robot["limits"]["omega"] = 0.01
    return world.changed(robots=[robot], time={"step": step, "duration": 20.0})


def _watch(running: Simulation, v: float) -> dict[str, Any]:
    wall = running.scene.walls.vertices[:, 0].max()
    due = (wall - running.pose[0, 0] - LENGTH_OF_ROBOT / 2) / v
    told, command = None, np.array([[v, 0.0]])
    while running.time < due + 2.0:
        running.step(command)
        if told is None and len(running.contacts):
            told = running.time
    return {
        "passed": bool(running.pose[0, 0] > wall),
        "late": None if told is None else float(told - due),
    }


def video(asked: dict[str, Any]) -> dict[str, Any]:
    """Frames a second of an MP4, without the simulation; and the whole with it."""
    from physim.drawing.video import render
    from physim.simulation.run import record_run

    world = corridor(asked["robots"], PAPER["free"], duration=asked["seconds"])
    with tempfile.TemporaryDirectory() as folder:
        cpu, wall = time.process_time(), time.perf_counter()
        made = record_run(Simulation(world), path=Path(folder) / "record.h5")
        simulated = time.process_time() - cpu
        cpu, wall = time.process_time(), time.perf_counter()
        frames = render(made, Path(folder) / "video.mp4", speed=1.0)
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return {
        "frames": frames, "rate": frames / cpu, "wall": frames / wall, "seconds": cpu + simulated,
    }  # fmt: skip


def world(asked: dict[str, Any]) -> dict[str, Any]:
    """Processor time to read, check and build a world file: as `physim check`, and as a run."""
    from physim.world.checks import check_world

    with tempfile.TemporaryDirectory() as folder:
        spent = {}
        for robots in (10, asked["robots"]):  # the first loads the kernels
            made = corridor(robots, PAPER["free"], segments=asked["segments"])
            file = Path(folder) / f"{robots}.yaml"
            file.write_text(made.to_yaml(), encoding="utf-8")
            began = time.process_time()
            running = Simulation(physim.load_world(file))
            spent["built"] = time.process_time() - began
            began = time.process_time()
            found = check_world(file)
            spent["checked"] = time.process_time() - began
            if found.errors:
                raise SystemExit(str(found.errors[0]))
    return {**spent, "walls": len(running.scene.walls.part_start) - 1}


def whole_run(asked: dict[str, Any]) -> dict[str, Any]:
    """Processor time of a shipped world from its file to its end, with a record on disk."""
    times = []
    with tempfile.TemporaryDirectory() as folder:
        for repeat in range(3):
            began = time.process_time()
            physim.simulate(physim.load_world(asked["world"]), path=Path(folder) / f"{repeat}.h5")
            times.append(time.process_time() - began)
    return {"cpu": min(times[1:]), "first": times[0]}


def parts(asked: dict[str, Any]) -> dict[str, Any]:
    """Processor time of a simulated second, by part, with a record on disk."""
    from physim.simulation.run import record_run

    robots, steps = asked["robots"], asked["steps"]
    began = time.process_time()
    world = corridor(robots, PAPER["free"], duration=steps * STEP)
    running = Simulation(world)
    spent = {"build": time.process_time() - began}
    start = running.state
    names = {"decide": (running._batch, "decide_due"), "physics": (running.physics, "step")}
    for name, (owner, method) in names.items():
        setattr(owner, method, _timed(getattr(owner, method), name, spent))
    with tempfile.TemporaryDirectory() as folder:
        record_run(running, path=Path(folder) / "0.h5")  # kernels
        running.restore(start)
        for name in names:
            spent[name] = 0.0
        plain = time.process_time()
        for _ in range(steps):
            running.step()
        plain = time.process_time() - plain
        found = {name: spent[name] for name in names}
        running.restore(start)
        whole = time.process_time()
        record_run(running, path=Path(folder) / "1.h5")
        whole = time.process_time() - whole
    found["record"] = max(whole - plain, 0.0)
    found["rest"] = plain - found["decide"] - found["physics"]
    return {
        "parts": {name: value / (steps * STEP) for name, value in found.items()},
        "build": spent["build"],
    }  # fmt: skip


def _timed(call: Callable[..., Any], name: str, spent: dict[str, float]) -> Callable[..., Any]:
    def timed(*given: Any, **named: Any) -> Any:
        began = time.process_time()
        try:
            return call(*given, **named)
        finally:
            spent[name] = spent.get(name, 0.0) + time.process_time() - began

    return timed


KINDS: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "speed": speed, "record": record, "head_on": head_on, "video": video, "parts": parts,
    "world": world, "run": whole_run,
}  # fmt: skip


def main() -> None:
    """Do what is asked."""
    asked = task()
    report(**KINDS[asked["what"]](asked), version=physim.__version__, python=sys.version.split()[0])


if __name__ == "__main__":
    main()
