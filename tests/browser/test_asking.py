"""Why? A click on a robot or contact tells what the record knows of it; links lead to moments."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

import physim
from physim import Column, Decision
from physim.drawing.page import curves, write_page
from physim.record import Record
from tests.analysis.validation.runs import LANE, REAR_END, Drivers, lane
from tests.browser.driver import Seen
from tests.helpers import inside

analytic_contacts = inside("physim.analysis.validation", "analytic_contacts")
contact_reports, paragraph = inside("physim.analysis.validation", "contact_reports", "paragraph")
DecisionTable, NearMiss = inside("physim.analysis.validation", "DecisionTable", "NearMiss")
Predictor = inside("physim.analysis.validation", "Predictor")
decimal, metres, outline = inside("physim.drawing", "decimal", "metres", "outline")
placed = inside("physim.drawing", "placed")

Opened = Callable[..., Seen]


def click(seen: Seen, x: float, y: float) -> None:
    """Click at a place of the world [m]."""
    lens = seen.ask("physim.view.drawn.lens")
    place = {"x": x * lens["scale"] + lens["x"], "y": lens["y"] - y * lens["scale"]}
    seen.page.locator(".view canvas").click(position=place)
    seen.settle()


def test_a_click_on_a_robot_shows_its_decision_of_that_moment(
    opened: Opened, record: Record
) -> None:
    seen, rows = opened(), record.updates
    for time, robot in ((1.95, 1), (3.75, 1), (0.05, 2), (4.44, 0)):
        seen.drawn_at(time)
        click(seen, *record.pose[round(time / record.dt), robot, :2])
        at = np.flatnonzero((rows["robot"] == robot) & (rows["step"] * record.dt <= time + 1e-9))
        row = rows[at[-1]]
        told = seen.text("#why")
        assert told.count(record.names[robot]) >= 1
        assert f"{row['step'] * record.dt:.2f} s" in seen.text("#why .because")
        assert str(record.modes[row["mode"]]) in seen.text("#why h2")
        assert str(record.declared.rules[row["rule"]]) in seen.text("#why .rule")
        assert f"{row['next_step'] * record.dt:.2f} s" in told
        x, y = (decimal(float(row[key]), 2) for key in ("target_x", "target_y"))
        assert f"({x}, {y})" in told
        considered = record.considered
        mine = (considered["robot"] == robot) & (considered["step"] == row["step"])
        buttons = seen.page.locator("#why .facts tr", has_text="considered").locator("button")
        assert buttons.all_inner_texts() == [record.names[k] for k in considered["other"][mine]]


def test_what_is_told_goes_with_the_time(opened: Opened) -> None:
    seen = opened(hash="#t=1.0&robot=r2")
    assert "safe" in seen.text("#why h2")
    seen.drawn_at(1.9)
    assert "danger, by distance" in seen.text("#why h2")


def test_who_was_near_is_named(opened: Opened, ten: Record, page_of_ten: Path) -> None:
    """In danger by distance: the nearest robot it considered, and the threshold that it passed."""
    record = ten
    rows = record.updates[record.updates["mode"] == 1]
    row = rows[0]
    robot, at = int(row["robot"]), row["step"] * record.dt
    others = record.considered
    others = others[(others["robot"] == robot) & (others["step"] == row["step"])]["other"]
    shapes = [
        shapely.Polygon(placed(outline(record.footprints[k]), record.pose[row["step"], k]))
        for k in (robot, *others)
    ]
    nearest = others[int(np.argmin(shapely.distance(shapes[0], shapes[1:])))]
    seen = opened(page_of_ten, hash=f"#t={at + 1e-6}")
    seen.ask(f"physim.go({{robot: {robot}}})")
    seen.settle()
    told = seen.text("#why .because")
    assert f"considered, {record.names[nearest]}, was {metres(float(row['distance']))} away" in told
    assert "below 0.50 m" in told or "not yet above 0.80 m" in told
    seen.ask(
        "(({ view }, robot) => view.run.column('own:distance')"
        f"[view.run.decision(robot, {at + 1e-6})] = 0)(physim, {robot})"
    )
    seen.ask("physim.go({robot: -1})")
    seen.ask(f"physim.go({{robot: {robot}}})")
    seen.settle()
    told = seen.text("#why .because")
    assert re.search(rf"it touched a robot it considered, {record.names[nearest]}(\.$| and )", told)
    seen.ask(
        "(({ view }, robot) => view.run.column('own:distance')"
        f"[view.run.decision(robot, {at + 1e-6})] = 0)(physim, {robot})"
    )
    seen.ask("physim.go({robot: -1})")
    seen.ask(f"physim.go({{robot: {robot}}})")
    seen.settle()
    told = seen.text("#why .because")
    assert re.search(rf"it touched a robot it considered, {record.names[nearest]}(\.$| and )", told)


def test_a_contact_tells_what_validate_says(opened: Opened, record: Record) -> None:
    table = DecisionTable(record)
    found = contact_reports(record, analytic_contacts(record), table, Predictor(record, table))
    names = [body.name for body in record.bodies]
    seen = opened()
    seen.drawn_at(1.85)
    row = record.contacts[0]
    click(seen, float(row["x"]), float(row["y"]))
    told = seen.text("#why")
    for label, text in paragraph(found[0], names, found):
        assert label in told
        assert text in told
    seen.page.click("#why button:has-text('r1')")
    assert seen.ask("[physim.robot, physim.contact]") == [0, -1]


def test_an_address_leads_to_a_moment_and_follows_the_reader(opened: Opened) -> None:
    seen = opened(hash="#t=2.5&robot=r3")
    assert seen.ask("[physim.player.time, physim.robot]") == [2.5, 2]
    assert "r3" in seen.text("#why h2")
    seen.ask("location.hash = '#t=4&robot=r1'")
    seen.until("physim.player.time === 4")
    assert seen.ask("physim.robot") == 0
    seen.page.keyboard.press("ArrowRight")
    assert seen.ask("location.hash") == "#t=4.1&robot=r1"


class Sentinel(Drivers):
    """Writes 1e9 m for none, as many do; decides once for all from 2 s on."""

    columns = (Column("gap", "m"),)

    def __init__(self) -> None:
        super().__init__((0.5, 0.0), (1.4, 0.2))

    def decide(self, observation, memory):
        v, omega = self.commands[observation.index]
        early = observation.time < 1.0
        hold = 0.1 if observation.time < 2.0 else 1e12
        return Decision(v=v, omega=omega, hold=hold, report={"gap": 1e9 if early else 1.25})


def test_figures_are_those_of_the_moment(
    opened: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However long the run is, and whatever a column held at other times."""
    monkeypatch.setattr(curves, "BINS", 3)
    record = physim.simulate(physim.parse_world(LANE), controller=Sentinel())
    seen = opened(write_page([record], tmp_path / "r.html"))
    for time in (0.0, 0.43, 1.0, 2.6):
        seen.drawn_at(time)
        k = round(time / record.dt)
        for label, values in (
            ("closest now", record.clearance),
            ("wall, closest now", record.boundary_clearance),
        ):
            row = seen.page.locator(".figures tr", has=seen.page.get_by_text(label, exact=True))
            assert metres(float(values[k].min())) in row.inner_text(), (time, label)
    seen.ask("location.hash = '#t=1.5&robot=slow'")
    seen.until("physim.robot === 0")
    assert "1.25 m" in seen.text("#why")
    assert "formation error" not in seen.text("#why")  # the world has no formation
    seen.ask("location.hash = '#t=0.5&robot=slow'")
    seen.until("physim.player.time === 0.5")
    assert "1.25 m" not in seen.text("#why")


def test_moments_are_found_by_clicks_alone(opened: Opened, record: Record) -> None:
    """The shortest distance: one click leads there, and says who is asked why."""
    seen = opened()
    seen.page.click("#moments button:has-text('shortest distance')")
    seen.settle()
    least = record.extremes[int(np.argmin(record.extremes["clearance"]))]
    assert seen.ask("physim.player.time") == least["clearance_step"] * record.dt
    assert seen.text("#why .because").endswith(".")
    box = seen.page.locator("#views").bounding_box()
    assert box is not None
    assert box["y"] + box["height"] > 0
    summary = seen.page.locator(".tables")
    assert "shortest distance" in summary.inner_text()


def test_a_line_of_the_table_of_contacts_leads_there(opened: Opened, record: Record) -> None:
    seen = opened()
    link = seen.page.locator(".tables a").nth(1)
    link.click()
    seen.until("physim.contact === 1")
    began = record.contacts[record.contacts["phase"] == 0]["step"][1] * record.dt
    assert abs(seen.ask("physim.player.time") - began) < 1e-6
    assert "left" in seen.text("#why h2")


def test_a_finding_of_a_validation_leads_to_its_moment(opened: Opened, tmp_path: Path) -> None:
    record = lane(REAR_END)
    found = physim.validate(record)
    assert found.contacts
    seen = opened(write_page([record], tmp_path / "r.html", found))
    assert found.verdict in seen.text("#validation .verdict")
    for k, contact in enumerate(found.contacts):
        line = seen.page.locator("#validation tbody tr", has_text=f"{contact.time:.2f} s").filter(
            has_text=" and ".join(found.names[body] for body in (contact.a, contact.b))
        )
        line.locator("a[href*=contact]").first.click()
        seen.until(f"physim.contact === {k}")
        assert abs(seen.ask("physim.player.time") - contact.time) < 1e-3
    near = NearMiss(0, 1, 100, 1.0, 0.25, behind=1)
    apart = replace(found, near_misses=replace(found.near_misses, distances=(near,)))
    seen = opened(write_page([record], tmp_path / "near.html", apart))
    seen.page.click("#validation a[href^='#t=1.000&robot=']")
    seen.until("physim.robot === 1")
    assert seen.ask("physim.player.time") == 1.0


def test_what_happened_to_a_robot_is_found_without_the_view(opened: Opened, record: Record) -> None:
    """Chosen by name: contacts, dangers, arrival in a sentence, each with its moment."""
    seen = opened()
    seen.page.select_option("#why select", label="r2")
    seen.settle()
    assert seen.ask("physim.robot") == 1
    dangers = np.flatnonzero(np.diff(record.updates["mode"][record.updates["robot"] == 1]) > 0)
    told = seen.text("#why .story summary")
    assert told.startswith("r2 ")
    assert f"{len(dangers)} time" in told
    assert "2 contacts" in told
    assert "does not arrive" in told
    near = record.extremes[1]
    other = record.names[near["clearance_other"]]
    seen.page.click(f"#why .story button:has-text('closest to a robot, {other}')")
    seen.settle()
    assert seen.ask("physim.player.time") == near["clearance_step"] * record.dt
    seen.page.click("#why .story button:has-text('contact with r1')")
    seen.until("physim.contact === 0")


def test_a_time_in_danger_may_go_through_several_modes(opened: Opened) -> None:
    seen = opened()
    mode = "physim.runs[0].modes.findIndex(({{ words }}) => words === 'danger, by {}')".format
    seen.ask("physim.go({ robot: 1 })")
    seen.settle()
    before = seen.text("#why .story").splitlines()
    seen.ask(f"""(() => {{
        const [run] = physim.runs;
        const [one, other] = [{mode("distance")}, {mode("collision time")}];
        for (let row = run.first[1]; row < run.first[2]; row++) {{
          if (run.mode[row] === one && row % 2) run.mode[row] = other;
        }}
        physim.go({{ robot: -1 }});
        physim.go({{ robot: 1 }});
    }})()""")
    seen.settle()
    after = seen.text("#why .story").splitlines()
    assert "in danger, " in before[0]
    assert after[0] == before[0]
    assert len(after) == len(before)
    both = {"danger, by distance", "danger, by collision time"}
    assert any(set(line.partition(": ")[2].split("; ")) == both for line in after[1:])


def test_the_label_of_the_closest_pair_covers_no_robot(
    opened: Opened, ten: Record, page_of_ten: Path
) -> None:
    script = """
        const write = CanvasRenderingContext2D.prototype.fillText;
        window.written = [];
        CanvasRenderingContext2D.prototype.fillText = function (words, x, y, ...more) {
          if (words.endsWith(" m")) window.written.push([words, x, y]);
          write.call(this, words, x, y, ...more);
        };"""
    seen = opened(page_of_ten, script=script)
    drawn = seen.drawn_at(1.8)
    lens, poses = drawn["lens"], np.reshape(drawn["pose"], (-1, 3))
    words, x, y = [one for one in seen.ask("window.written") if "." in one[0]][-1]
    assert words == metres(float(ten.clearance[180].min()))
    at = ((x - lens["x"]) / lens["scale"], (lens["y"] - y) / lens["scale"])
    bodies = [
        shapely.Polygon(placed(outline(shape), pose))
        for shape, pose in zip(ten.footprints, poses, strict=True)
    ]
    assert shapely.distance(bodies, shapely.Point(at)).min() * lens["scale"] > 7.0


def test_plots_can_be_dragged(opened: Opened) -> None:
    seen = opened()
    box = seen.page.locator("#plots").bounding_box()
    assert box is not None
    seen.page.mouse.click(box["x"] + 52 + (box["width"] - 64) / 2, box["y"] + 30)
    assert abs(seen.ask("physim.player.time") - 3.0) < 0.02
