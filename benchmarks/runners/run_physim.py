"""physim: polygons with contacts in the corridor; what is asked for is a function of `KINDS`."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from common import FIRST_X, LENGTH_OF_ROBOT, SPEED, STEP, WIDTH_OF_ROBOT, rate, report, task
from physim_corridor import FORWARD, PAPER, corridor, simulation

import physim
from physim import Simulation, World


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
                if repeat:  # the first is no measurement
                    spent[is_recorded].append(time.process_time() - began)
        running.restore(start)
        began = time.process_time()
        record_run(running, path=Path(folder) / "once.h5", stop=lambda: True)
        once = time.process_time() - began
        size = (Path(folder) / "1.h5").stat().st_size / 1e6
    rates = {yes: 2 * robots * asked["steps"] / sum(times) for yes, times in spent.items()}
    spans = [robots * asked["steps"] / one for one in spent[True]]
    lasting = 2 * robots * asked["steps"] / max(sum(spent[True]) - 2 * once, 1e-9)
    return {
        "rate": rates[True], "without": rates[False], "lasting": lasting, "once": once,
        "spans": spans, "size": size,
    }  # fmt: skip


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
    """Processor time of a simulated second, by part, with a record on disk.

    All parts are timed within the same runs: what is left over is none of them.
    """
    from physim.simulation.recorder import Recorder
    from physim.simulation.run import record_run

    robots, steps = asked["robots"], asked["steps"]
    began = time.process_time()
    world = corridor(robots, PAPER["free"], duration=steps * STEP)
    running = Simulation(world)
    spent = {"build": time.process_time() - began}
    start = running.state
    timed: dict[str, tuple[Any, str]] = {
        "decide": (running._asked.form, "decide_all"), "physics": (running.physics, "step"),
        "taken": (Recorder, "after_step"), "step": (running, "step"),
    }  # fmt: skip
    for name, (owner, method) in timed.items():
        setattr(owner, method, _timed(getattr(owner, method), name, spent))
    runs: list[dict[str, float]] = []
    with tempfile.TemporaryDirectory() as folder:
        for repeat in range(4):
            began = time.process_time()
            record_run(running, path=Path(folder) / "once.h5", overwrite=True, stop=lambda: True)
            once = time.process_time() - began
            running.restore(start)
            spent.update(dict.fromkeys(timed, 0.0))
            began = time.process_time()
            record_run(running, path=Path(folder) / "run.h5", overwrite=True)
            whole = time.process_time() - began
            running.restore(start)
            decide, physics, taken, step = (spent[name] for name in timed)
            if repeat:  # the first is no measurement
                runs.append({
                    "decide": decide, "physics": physics,
                    "record": whole - once - (step - taken),
                    "rest": step - taken - decide - physics, "once": once,
                })  # fmt: skip
    middle = {name: float(np.median([one[name] for one in runs])) for name in runs[0]}
    return {
        "parts": {
            name: middle[name] / (steps * STEP) for name in ("decide", "physics", "record", "rest")
        },
        "build": spent["build"], "once": middle["once"],
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
