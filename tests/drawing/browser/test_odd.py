"""Pages of records that lack something, or have more than most: all of them play and answer."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import physim
from physim import Column, Decision
from physim.drawing.page import write_page
from tests.drawing.browser.__main__ import look
from tests.drawing.browser.driver import Seen
from tests.drawing.page.test_data import moved
from tests.helpers.records import make_record

Opened = Callable[..., Seen]
PLAYED = 0.5
"""[s] that playing takes"""


@pytest.mark.parametrize(("robots", "seconds"), [(1, 2.0), (2, 0.01), (2, 0.0), (80, 2.0)])
def test_few_samples_one_robot_and_a_crowd(
    opened: Opened, tmp_path: Path, robots: int, seconds: float
) -> None:
    with make_record(tmp_path / "r.h5", robots, seconds, contacts=False) as record:
        seen = opened(write_page([record], tmp_path / "r.html"))
    assert list(look(seen, PLAYED)) == []


def test_a_run_far_from_the_origin_looks_the_same(opened: Opened, tmp_path: Path) -> None:
    """Canvases compute with 24 bits: at 5,800 km a step of that is half a metre."""
    drawn = []
    make_record(tmp_path / "r.h5", 3, 4.0).close()
    for shift in ((0.0, 0.0), (454_000.0, 5_800_000.0)):
        with physim.Record.load(moved(tmp_path / "r.h5", shift)) as record:
            seen = opened(write_page([record], tmp_path / "r.html"))
        seen.drawn_at(1.6)
        data = seen.ask("document.querySelector('.view canvas').toDataURL()").partition(",")[2]
        image = Image.open(io.BytesIO(base64.b64decode(data))).convert("L")
        drawn.append(np.asarray(image, dtype=int))
    assert (np.abs(drawn[0] - drawn[1]) > 60).mean() < 2e-3


def run(**how: Any) -> physim.Record:
    """Two robots for 2 s."""
    world = physim.load_world("straight")
    time = world.time.model_copy(update={"duration": 2.0})
    return physim.simulate(world.changed(time=time), **how)


def test_without_tables_it_says_what_was_not_recorded(opened: Opened, tmp_path: Path) -> None:
    bare = run(save=physim.SaveAt(every=10, tables=()))
    seen = opened(write_page([bare], tmp_path / "r.html"))
    assert list(look(seen, PLAYED)) == []
    assert "not recorded" in seen.text(".figures")
    assert "not decided" in seen.text("#why")


class Slower:
    """A filter that halves every command."""

    def start(self, scene: Any) -> tuple[()]:
        return ()

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return 0.5 * nominal, state


def test_a_filter_is_seen_at_work(opened: Opened, tmp_path: Path) -> None:
    record = run(filters=[Slower()])
    seen = opened(write_page([record], tmp_path / "r.html"), hash="#t=1&robot=" + record.names[0])
    row = record.commands[(record.commands["step"] == 100) & (record.commands["robot"] == 0)][0]
    for stage in ("nominal", "filtered", "applied"):
        line = seen.page.locator("#why .facts tr", has_text=stage).inner_text()
        assert f"{row[f'{stage}_v']:.2f} m/s" in line
    assert row["filtered_v"] == 0.5 * row["nominal_v"] > 0.0


class Far:
    """Drives on, and reports a large number where no collision lies ahead."""

    columns = (Column("collision_time", "s"),)

    def decide(self, observation: object, memory: object) -> Decision:
        return Decision(v=0.2, omega=0.0, hold=0.1, report={"collision_time": 1e9})


def test_no_number_beside_a_plot_is_cut(opened: Opened, tmp_path: Path) -> None:
    script = """
        const write = CanvasRenderingContext2D.prototype.fillText;
        window.begins = {};
        CanvasRenderingContext2D.prototype.fillText = function (words, x, y, ...more) {
          if (this.textAlign === "right") window.begins[words] = x - this.measureText(words).width;
          write.call(this, words, x, y, ...more);
        };"""
    seen = opened(write_page([run(controller=Far())], tmp_path / "r.html"), script=script)
    seen.settle()
    begins = seen.ask("window.begins")
    assert {"0", "1e9"} <= begins.keys()
    assert min(begins.values()) >= 0.0
