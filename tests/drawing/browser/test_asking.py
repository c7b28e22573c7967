"""Why? A click on a robot or contact tells what the record knows of it; links lead to moments."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

import physim
from physim.drawing.page import write_page
from physim.record import Record
from physim.units import true_minus
from tests.analysis.validation.runs import REAR_END, lane
from tests.drawing.browser.driver import Seen
from tests.helpers import inside

DecisionTable, Predictor = inside("physim.analysis.validation", "DecisionTable", "Predictor")
analytic_contacts = inside("physim.analysis.validation", "analytic_contacts")
contacts_of, sentences = inside("physim.analysis.validation", "contacts_of", "sentences")

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
        x, y = (true_minus(f"{float(row[key]):z.2f}") for key in ("target_x", "target_y"))
        assert f"({x}, {y})" in told
        considered = record.considered
        mine = (considered["robot"] == robot) & (considered["step"] == row["step"])
        buttons = seen.page.locator("#why .facts tr", has_text="considered").locator("button")
        assert buttons.all_inner_texts() == [record.names[k] for k in considered["other"][mine]]


def test_a_contact_tells_what_validate_says(opened: Opened, record: Record) -> None:
    table = DecisionTable(record)
    found = contacts_of(record, analytic_contacts(record), table, Predictor(record, table))
    names = [body.name for body in record.bodies]
    seen = opened()
    seen.drawn_at(1.85)
    row = record.contacts[0]
    click(seen, float(row["x"]), float(row["y"]))
    told = seen.text("#why")
    assert all(line in told for line in sentences(found[0], names))
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
    assert found.verdict in seen.text(".stage .verdict")
    worst = max(found.contacts, key=lambda one: one.severity.closing)
    assert abs(seen.ask("physim.player.time") - worst.time) < 1e-3, "opens at the severest"
    assert seen.ask("physim.view.drawn.lens.scale") > 1.5 * seen.ask(
        "physim.view.camera.wholeScale"
    )
    assert seen.ask("getComputedStyle(document.querySelector('.panel')).overflowY") == "visible"
    for k, contact in enumerate(found.contacts):
        line = seen.page.locator("#validation tbody tr", has_text=f"{contact.time:.2f} s").filter(
            has_text=" and ".join(found.names[body] for body in (contact.a, contact.b))
        )
        line.locator("a[href*=contact]").first.click()
        seen.until(f"physim.contact === {k}")
        assert abs(seen.ask("physim.player.time") - contact.time) < 1e-3


def test_who_stays_in_danger_is_told_until_when(
    opened: Opened, ten: Record, page_of_ten: Path
) -> None:
    """All thresholds must be clear: none alone is the reason for the mode."""
    rows = ten.updates
    danger = [number for number, mode in enumerate(ten.declared.modes) if mode.danger]
    bad = np.isin(rows["mode"], danger)
    robot, after = next(
        (robot, np.flatnonzero(mine)[k + 1])
        for robot in range(ten.robots)
        for mine in (rows["robot"] == robot,)
        for k in np.flatnonzero(bad[mine][:-1] & bad[mine][1:])
    )
    time = float(rows["step"][after] * ten.dt)
    seen = opened(page_of_ten, hash=f"#t={time}&robot={ten.names[robot]}")
    told = seen.text("#why .because")
    assert "leaves danger mode only when" in told
    assert all(words in told for words in ("nearest robot", "nearest wall", "collision time"))


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
