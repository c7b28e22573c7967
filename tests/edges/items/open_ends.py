"""A drawing that is not closed is told where it is open."""

from __future__ import annotations

from tests.edges.shell import Shell

NUMBER = "ends"
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="30m" height="15m" viewBox="0 0 30 15">'


def try_gap_at_the_right_end(shell: Shell) -> None:
    walls = '<polyline points="28,7 28,2 2,2"/><polyline points="2,2 2,13"/>'
    last = '<polyline points="2,13 28,13 28,8"/>'
    shell.write(
        "plan.svg", f'{HEAD}<g id="boundary" fill="none" stroke="black">{walls}{last}</g></svg>'
    )
    done = shell.physim("import", "plan.svg", "-o", "plan.yaml", "--scale", 1)
    done.refused("plan.svg:1: ", "(28.00, 7.00)", "(28.00, 8.00)", "1 m")
