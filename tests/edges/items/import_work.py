"""No import takes more than 10 s and 1 GB: what is too large to work on is refused in one line."""

from __future__ import annotations

from math import cos, pi, sin

from tests.edges.shell import Shell

NUMBER = "5"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">'


BOUNDS: dict[str, int] = {"memory": 1000, "seconds": 10}
"""[MB] that the process may ask for, [s] of processor time: those of the requirement"""


def check_refused(shell: Shell, name: str, content: str, *parts: str) -> None:
    shell.write(name, content)
    done = shell.physim("import", name, "-o", "w.yaml", "--scale", 1, **BOUNDS)
    done.refused(name, *parts)


def check_read(shell: Shell, name: str, content: str) -> str:
    """Import what is large, but can be read; returns what is said."""
    shell.write(name, content)
    done = shell.physim("import", name, "-o", "w.yaml", "--scale", 1, "--force", **BOUNDS)
    assert done.code == 0, (done.code, done.err)
    return done.out


def try_a_circle_as_large_as_a_country(shell: Shell) -> None:
    for radius in ("1e9", "1e5"):
        text = f'{HEAD}<circle id="boundary" r="{radius}"/></svg>'
        check_refused(shell, "plan.svg", text, "--scale")


def try_polygons_of_many_points(shell: Shell) -> None:
    count = 200_000
    points = [(100 * cos(2 * pi * k / count), 100 * sin(2 * pi * k / count)) for k in range(count)]
    points.append(points[0])
    ring = ", ".join(f"{x:.9f} {y:.9f}" for x, y in points)
    check_refused(shell, "ring.wkt", f"POLYGON (({ring}))", "200001 points")
    line = "[" + ",".join(f"[{x:.9f},{y:.9f}]" for x, y in points) + "]"
    text = f'{{"type": "Polygon", "coordinates": [{line}]}}'
    check_refused(shell, "ring.geojson", text, "200001 points")


def try_lines_over_each_other(shell: Shell) -> None:
    many = ", ".join(f"{k % 2 * 50}.{k % 997} {k % 3 * 20}" for k in range(600_000))
    check_refused(shell, "lines.wkt", f"LINESTRING ({many})", "600000 points")
    few = ", ".join(f"{k % 2 * 50}.{k % 997} {k % 3 * 20}" for k in range(20_000))
    check_refused(shell, "lines.wkt", f"LINESTRING ({few})", "over each other")
    data = " ".join(f"{k % 2 * 20},{k % 13}" for k in range(20_000))
    text = f'{HEAD}<polyline id="boundary" points="{data}"/></svg>'
    check_refused(shell, "lines.svg", text, "over each other")


def try_curves_that_take_many_chords(shell: Shell) -> None:
    arcs = " ".join(f"A 1e6 1e6 0 1 1 {k % 30} {k % 13}" for k in range(5000))
    text = f'{HEAD}<path id="boundary" d="M0 0 {arcs}"/></svg>'
    check_refused(shell, "arcs.svg", text, "arcs.svg:1", "boundary", "50000 points")
    many = " ".join(f"M{k % 30} {k % 15}L{k * 7 % 30} {k * 3 % 15}" for k in range(300_000))
    text = f'{HEAD}<path id="boundary" d="{many}"/></svg>'
    check_refused(shell, "many.svg", text, "numbers")


def try_very_many_shapes(shell: Shell) -> None:
    shapes = "".join(f'<circle cx="{k % 30}" cy="{k % 15}" r="1"/>' for k in range(20_000))
    check_refused(shell, "shapes.svg", f"{HEAD}{shapes}</svg>", "boundary")
    points = ",".join(['{"type": "Point", "coordinates": [1, 2]}'] * 150_000)
    text = f'{{"type": "GeometryCollection", "geometries": [{points}]}}'
    check_refused(shell, "shapes.geojson", text, "10000 geometries")
    holes = (f"({x} {y}, {x + 1} {y}, {x} {y + 1}, {x} {y})"
             for x in range(2, 190, 2) for y in range(2, 190, 2))  # fmt: skip
    text = f"POLYGON ((0 0, 200 0, 200 200, 0 200, 0 0), {', '.join(holes)})"
    check_refused(shell, "holes.wkt", text, "obstacles")


PLAN = '<rect id="boundary" width="30" height="15"/><path id="path" d="M3 7 L27 7"/>'


def try_what_an_import_need_not_read(shell: Shell) -> None:
    sheet = f"<style>{'.a{fill:red}' * 300_000}</style>"
    check_refused(shell, "sheet.svg", f"{HEAD}{sheet}{PLAN}</svg>", "sheet.svg:1", "style")
    sheet = f"<style>{'.a{fill:red}' * 90_000}{'/*' * 300_000}</style>"
    check_read(shell, "sheet.svg", f"{HEAD}{sheet}{PLAN}</svg>")
    names = " ".join(f'a{k}="1"' for k in range(20_000))
    shapes = "".join(f'<rect x="{k % 30}" y="1" width="1" height="1"/>' for k in range(5000))
    check_read(shell, "names.svg", f"{HEAD}<g {names}>{shapes}</g>{PLAN}</svg>")
    style = ";".join(f"a{k}:1" for k in range(20_000))
    check_read(shell, "style.svg", f'{HEAD}<g style="{style}">{shapes}</g>{PLAN}</svg>')
    sheet = f"<style>*{{{style}}}</style>"
    check_read(shell, "all.svg", f"{HEAD}{sheet}{shapes}{PLAN}</svg>")


def try_lines_of_a_text_and_lists_within_lists(shell: Shell) -> None:
    rows = "\n".join([", 1 1"] * 300_000)
    check_refused(shell, "rows.wkt", f"POLYGON ((0 0\n{rows}\n", "bracket")
    for depth in (30, 500, 985):
        lists = "[" * depth + "]" * depth
        text = f'{{"type": "Polygon", "coordinates": {lists}}}'
        check_refused(shell, "lists.geojson", text, "[[[[" if depth < 900 else "nested")


def try_very_many_robots(shell: Shell) -> None:
    def robots(count: int) -> str:
        return "".join(
            f'<rect id="robot {k}" x="{1 + k % 100 * 0.25}" y="{1 + k // 100 * 0.25}" width="0.2" '
            'height="0.1"/>' for k in range(count)
        )  # fmt: skip

    check_refused(shell, "many.svg", f"{HEAD}{PLAN}{robots(5000)}</svg>", "5000 robots", "500")
    assert "400 robots as drawn" in check_read(shell, "few.svg", f"{HEAD}{PLAN}{robots(400)}</svg>")


def try_transforms_of_very_many_shapes(shell: Shell) -> None:
    turn = "rotate(1)" * 3000
    shapes = "".join(f'<rect x="{k % 30}" y="1" width="1" height="1"/>' for k in range(1000))
    group = f'<g transform="{turn}">{shapes}</g>'
    check_refused(shell, "group.svg", f"{HEAD}{group}{PLAN}</svg>", "transforms")
    copies = "".join(f'<use href="#a" x="{k}"/>' for k in range(1000))
    group = f'<g id="a" transform="{turn}"><rect width="1" height="1"/></g>'
    check_refused(shell, "copies.svg", f"{HEAD}{group}{copies}{PLAN}</svg>", "transforms")


def try_walls_that_fill_the_place(shell: Shell) -> None:
    teeth = " ".join(f"{k * 0.0015:.4f},{k // 2 % 2 * 14 + 0.5}" for k in range(20_000))
    text = f'{HEAD}<polygon id="boundary" points="0,0 {teeth} 30,0"/></svg>'
    check_refused(shell, "comb.svg", text, "to and fro")


def try_finely_sampled_walls_are_thinned(shell: Shell) -> None:
    ring = [(100 * cos(2 * pi * k / 49_000), 100 * sin(2 * pi * k / 49_000)) for k in range(49_000)]
    ring.append(ring[0])
    text = f"POLYGON (({', '.join(f'{x:.9f} {y:.9f}' for x, y in ring)}))"
    assert "of 49001 points" in check_read(shell, "ring.wkt", text)
    rows = "\n".join(f"{0.3 * k:.2f},{sin(0.001 * k):.6f},3,3" for k in range(14_900))
    check_read(shell, "track.csv", f"# x_m,y_m,w_tr_right_m,w_tr_left_m\n{rows}\n")


def try_maps_of_many_cells(shell: Shell) -> None:
    shell.write("map.pgm", b"P5\n10000 10000\n255\n" + b"\xfe" * 10**8)
    text = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
    text += "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    shell.write("map.yaml", text)
    given = ("import", "map.yaml", "-o", "w.yaml")
    shell.physim(*given, **BOUNDS).refused("map.pgm", "pixels")
