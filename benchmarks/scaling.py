"""Cost over the number of robots, by part: a plot, and where the time goes as stacked bars."""

from __future__ import annotations

import sys
from pathlib import Path

from benchmarks.measuring import FAILED, Job, Result, Store, runner, table

SUBJECT = "scaling"
STEPS = {10: 2000, 30: 1000, 100: 400, 300: 150, 1000: 60, 3000: 40, 10000: 20, 20000: 10}
"""Steps of 0.05 s by number of robots."""
QUICK = (10, 100, 1000)
PARTS = {
    "decide": ("controller", "#0072b2"),
    "physics": ("physics and contacts", "#d55e00"),
    "record": ("record on disk", "#009e73"),
    "rest": ("sensing, stations, arrival, checks", "#999999"),
}
"""Words and colour of each."""
PICTURE = "scaling.svg"


def groups(quick: bool) -> list[list[Job]]:
    """A process for each number of robots."""
    return [
        [runner(SUBJECT, "physim", f"parts-{robots}", sys.executable, "run_physim.py", 240.0,
                what="parts", robots=robots, steps=steps // (4 if quick else 1))]
        for robots, steps in STEPS.items() if not quick or robots in QUICK
    ]  # fmt: skip


def found(store: Store) -> dict[int, Result]:
    """Results by number of robots."""
    results = {n: store.results(SUBJECT, "physim", f"parts-{n}") for n in STEPS}
    return {n: one[0] for n, one in results.items() if one and FAILED not in one[0]}


def text(store: Store) -> str:
    """The table beside the picture."""
    rows = []
    for robots in STEPS:
        failed = store.why_not(SUBJECT, "physim", f"parts-{robots}")
        one = found(store).get(robots)
        if one is None and not failed:
            continue
        if one is None:
            rows.append([f"{robots:,}", failed, *[""] * (len(PARTS) + 3)])
            continue
        whole = sum(one["parts"].values())
        each = [
            f"{value / robots * 1e6:.1f}" if (value := one["parts"][name]) >= 0.0 else "-"
            for name in PARTS
        ]
        rows.append([f"{robots:,}", *each, f"**{whole / robots * 1e6:.1f}**",
                     f"{one['build']:.1f} s", f"{one['once']:.2f} s",
                     f"{one['memory']:.0f} MB"])  # fmt: skip
    head = [
        "N",
        *(words for words, _ in PARTS.values()),
        "whole",
        "built in",
        "record begun and ended",
        "memory",
    ]
    return (
        "## Cost over the number of robots\n\nThe paper's controller in free flow at fixed density,"
        " with a record on disk; microseconds of processor time a robot and simulated second. To"
        ' begin and end a record is paid once a run, however long it is; "-": below noise.\n\n'
        f"{table(head, rows)}\n![Cost over the number of robots]({PICTURE})\n\n"
    )


def draw(store: Store, folder: Path) -> None:
    """Write the picture."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot

    results = found(store)
    if not results:
        return
    robots = list(results)
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.0, 4.4), layout="constrained")
    for name, (words, colour) in PARTS.items():
        seconds = [
            one if (one := results[n]["parts"][name]) > 0.0 else float("nan") for n in robots
        ]
        left.loglog(robots, seconds, "o-", color=colour, label=words, markersize=4)
    whole = [sum(results[n]["parts"].values()) for n in robots]
    left.loglog(robots, whole, "k-", linewidth=2, label="whole")
    first = whole[-1] / robots[-1]
    left.loglog(robots, [first * n for n in robots], "k:", linewidth=1, label="linear")
    left.axhline(1.0, color="0.8", linewidth=1)
    left.text(robots[0], 1.05, "real time", color="0.45", va="bottom")
    left.set(xlabel="robots", ylabel="processor time of a simulated second [s]")
    left.set_xticks([10, 100, 1000, 10000], labels=["10", "100", "1,000", "10,000"])
    seconds = [0.001, 0.01, 0.1, 1, 10]
    left.set_yticks(seconds, labels=[f"{one:g}" for one in seconds])
    bottom = [0.0] * len(robots)
    labels = [f"{n:,}" for n in robots]
    for name, (words, colour) in PARTS.items():
        height = [max(results[n]["parts"][name], 0.0) / n * 1e6 for n in robots]
        right.bar(labels, height, bottom=bottom, color=colour, label=words)
        bottom = [a + b for a, b in zip(bottom, height, strict=True)]
    right.set(xlabel="robots", ylabel="µs a robot and simulated second")
    figure.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=6,
                  fontsize=9, frameon=False)  # fmt: skip
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(folder / PICTURE, metadata={"Date": None})
    pyplot.close(figure)
