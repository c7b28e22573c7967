"""An import too large to work on is refused in one line, before the work."""

from __future__ import annotations

from math import cos, pi, sin

from tests.edges.shell import Shell

NUMBER = "5"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">'


def check_refused(shell: Shell, name: str, content: str, *parts: str) -> None:
    shell.write(name, content)
    done = shell.physim("import", name, "-o", "w.yaml", "--scale", 1, memory=4000, seconds=15)
    done.refused(name, *parts)


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
