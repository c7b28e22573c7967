"""A mistake in a world is told once, with what is meant."""

from __future__ import annotations

from tests.edges.shell import Shell

NUMBER = "messages"
WORLD = """\
name: two
time: {step: 0.01, duration: 20.0}  # [s]
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}  # [m]
robots:
  - name: a
    footprint: {length: 1.8, width: 1.0}
    pose: [6.0, 1.0, 0.0]
    path: {offset: 1.0}
  - name: b
    footprint: {length: 1.8, width: 1.0}
    pose: [3.0, -1.0, 0.0]
    path: {offset: -1.0}
"""


def lines(shell: Shell, old: str, new: str) -> list[str]:
    """Errors of the world in which something stands in the place of something else."""
    assert WORLD.count(old) == 1
    shell.write("w.yaml", WORLD.replace(old, new))
    done = shell.physim("check", "w.yaml")
    assert done.code == 2, done.out
    return [line.strip() for line in done.out.split("\n\n")[0].splitlines()[1:]]


def told(shell: Shell, old: str, new: str, *parts: str) -> str:
    """The one error of a world; each of ``parts`` is said."""
    (line,) = lines(shell, old, new)
    for part in parts:
        assert part in line, f"{part} is not said: {line}"
    return line


def try_a_needed_value_left_empty(shell: Shell) -> None:
    line = told(shell, "width: 8.0}", "width: }", "3:50: corridor.width", "empty", "full width")
    assert "leave the key out" not in line


def try_centimetres(shell: Shell) -> None:
    box = "{length: 1.8, width: 1.0}\n    pose: [6.0"
    told(
        shell,
        box,
        box.replace("1.8", "180").replace("1.0}", "100}"),
        "6:16: robots[0].footprint",
        "centimetres",
    )


def try_a_number_with_its_unit(shell: Shell) -> None:
    told(shell, "width: 8.0}", "width: 8 m}", "corridor.width", '"8 m"', "8 is meant")


def try_a_missing_dash(shell: Shell) -> None:
    told(shell, "  - name: b", "    name: b", "9:5: robots[0].name", '"- "')


def try_a_pose_without_heading(shell: Shell) -> None:
    told(shell, "[6.0, 1.0, 0.0]", "[6.0, 1.0]", "7:5: robots[0].pose[2]", "heading")


def try_an_unknown_file(shell: Shell) -> None:
    for name in ("m.yaml", "empty.yaml", "corridor_one.yaml"):
        shell.write(name, WORLD)
    for given, meant in (("my_wrld.yaml", False), ("coridor_one.yaml", True)):
        done = shell.physim("run", given)
        done.refused(f"{given}: no such file")
        assert ("did you mean corridor_one.yaml?" in done.err) is meant
        assert "did you mean m.yaml" not in done.err
