"""A folder to work in: worlds, controllers, media, and a README with the next commands."""

from __future__ import annotations

CONTROLLER = '''\
"""A controller to begin with: what it sees is a physim.Observation, what it says a Decision."""

from math import atan2, hypot, pi

from physim import Decision, Mode


class Cautious:
    """Steer to a point 2 m ahead; wait while a robot further along is within 2.2 m."""

    # name, colour, words; summary, plots and video show them
    modes = (
        Mode("go", "#0072b2", "on its way"),
        Mode("wait", "#e69f00", "waits for another", danger=True),
        Mode("there", "#009e73", "at its stop station"),
    )

    def decide(self, observation, memory):
        o = observation
        if o.station >= o.stop_station - 0.05:  # [m]
            return Decision(v=0.0, omega=0.0, hold=0.1, mode="there")
        x, y, heading = o.pose  # [m, m, rad]
        tx, ty = o.path.target(o.station, 2.0)  # [m]
        error = (atan2(ty - y, tx - x) - heading + pi) % (2 * pi) - pi
        omega = max(-o.limits[1], min(o.limits[1], 2.0 * error))  # [rad/s]
        ahead = [s for s in o.others if s.station > o.reference_station]
        near = any(hypot(s.pose[0] - x, s.pose[1] - y) < 2.2 for s in ahead)
        v, mode = (0.0, "wait") if near else (min(0.8, o.limits[0]), "go")
        return Decision(v=v, omega=omega, hold=0.1, mode=mode)  # [m/s], [rad/s], [s]
'''

README = """\
# {title}

`worlds/` holds the worlds, `controllers/` controllers of your own, `media/` what is worth keeping.
Runs go to `runs/`. In this folder:

```sh
physim preview worlds/{stem}.yaml -o media/{stem}.png
physim run worlds/{stem}.yaml -o runs/{stem}
physim run worlds/{stem}.yaml -o runs/cautious --controller controllers.cautious:Cautious
```

The first draws the world, the second runs it with its own controller and writes record, video and
summary, the third runs it with the one in `controllers/cautious.py`. An editor that knows YAML
schemas completes the keys of a world and shows what they mean.
"""

MEDIA = """\
# Media

| file | made by |
|---|---|
| `{stem}.png` | `physim preview worlds/{stem}.yaml -o media/{stem}.png` |
"""


def new_project(title: str, stem: str, world: str, schema: str) -> dict[str, str]:
    """Text of every file of a new project, by its path in the folder.

    ``stem`` is the file name of the first world, without its ending; ``world`` its text.
    """
    return {
        "README.md": README.format(title=title, stem=stem),
        ".gitignore": "runs/\n__pycache__/\n",
        f"worlds/{stem}.yaml": world,
        "worlds/world.schema.json": schema,
        "controllers/__init__.py": "",
        "controllers/cautious.py": CONTROLLER,
        "media/README.md": MEDIA.format(stem=stem),
    }
