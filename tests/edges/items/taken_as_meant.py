"""Commands and drawings are taken as they are meant."""

from __future__ import annotations

from tests.edges.shell import Shell

NUMBER = "7"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">'
ROOM = '<rect id="boundary" x="1" y="1" width="28" height="13" fill="none"/>'


def try_a_negative_place_after_its_option(shell: Shell) -> None:
    shell.write("room.wkt", "POLYGON ((-10 -5, 20 -5, 20 5, -10 5, -10 -5))")
    made = []
    for form in (("--from", "-6,1"), ("--from=-6,1",)):
        done = shell.physim("import", "room.wkt", "-o", "w.yaml", "--force", *form, "--to", "15,0")
        assert (done.code, done.err) == (0, ""), done
        made.append((shell.folder / "w.yaml").read_text())
    assert made[0] == made[1]


def try_groups_within_groups(shell: Shell) -> None:
    for depth in (101, 500):
        shell.write("deep.svg", f"{HEAD}{'<g>' * depth}{ROOM}{'</g>' * depth}</svg>")
        done = shell.physim("import", "deep.svg", "-o", "w.yaml", "--force", "--scale", 1)
        assert (done.code, done.err) == (0, ""), done
    shell.write("deep.svg", f"{HEAD}{'<g>' * 3000}{ROOM}{'</g>' * 3000}</svg>")
    done = shell.physim("import", "deep.svg", "-o", "w.yaml", "--force", "--scale", 1)
    done.refused("deep.svg")


def try_labels_that_begin_with_robot(shell: Shell) -> None:
    route = '<polyline id="robot_route_0" points="3,7 25,7" fill="none"/>'
    shell.write("plan.svg", f"{HEAD}{ROOM}{route}</svg>")
    done = shell.physim("import", "plan.svg", "-o", "w.yaml", "--scale", 1)
    assert (done.code, done.err) == (0, ""), done
    assert "robot_route_0" in done.out


PLAN = """\
<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">
  <path id="rim" fill="none" d="M 2,2 L 28,2 L 28,13 L 2,13 Z"/>
</svg>
"""


def try_a_drawing_without_a_layer_of_walls(shell: Shell) -> None:
    shell.write("plan.svg", PLAN)
    given = ("import", "plan.svg", "-o", "plan.yaml", "--scale", 1)
    shell.physim(*given).refused("plan.svg: ", "--boundary", '"rim" (line 2, 26 x 11 m)')
    done = shell.physim(*given, "--boundary", "rim")
    assert done.code == 0, done.err
    assert shell.physim("check", "plan.yaml").code == 0


def try_an_error_of_a_drawing_names_element_and_line(shell: Shell) -> None:
    for mark, name in (("", "<line>"), ('id="w 1" ', '"w 1"')):
        shapes = f'<g id="boundary">\n<line {mark}x1="1e400" y1="0" x2="3" y2="3"/>\n</g>'
        shell.write("plan.svg", f"{HEAD}\n{ROOM}\n{shapes}</svg>")
        done = shell.physim("import", "plan.svg", "-o", "w.yaml", "--scale", 1)
        done.refused("plan.svg:4: ", name)
