"""``physim report`` and ``physim compare`` from a folder of real runs, and their mistakes."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from physim.campaigns import Folder, read, spec_of
from physim.world.file import parse_world
from tests.campaigns.real import WORLD, campaign
from tests.campaigns.test_report import Elements
from tests.cli.commands import physim, tree
from tests.helpers import check_error, inside

Until, write_until, take = inside("physim.campaigns", "Until", "write_until", "take")
read_goal = inside("physim.statistics", "read_goal")

CONTROLLERS = ("mode_switching", "path_following")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("campaign") / "c"
    rows = campaign(folder, range(1, 5), CONTROLLERS)
    assert not any(row.failed for row in rows)
    return folder


def test_a_report_has_pictures_of_the_worst(made: Path, capsys) -> None:
    done = physim("report", made, capture=capsys)
    assert done.code == 0
    for name in CONTROLLERS:
        assert f"small, {name}: 0 of 4 runs" in done.out
    assert f"physim replay {made}:" in done.out
    page = Elements((made / "report.html").read_text(encoding="utf-8"))
    assert page.tags.count("img") == 16
    assert "no picture" not in page.said
    stills = sorted((made / "stills").iterdir())
    assert len(stills) == 16
    times = [file.stat().st_mtime_ns for file in stills]
    assert physim("report", made, "--quiet", capture=capsys).code == 0
    assert [file.stat().st_mtime_ns for file in stills] == times


OVERWRITTEN = (
    *((option, part, "part of the campaign")
      for option in ("-o", "--json") for part in ("MADE/campaign.json", "MADE/rows/x.jsonl")),
    ("-o", "record.h5", "must end in .html"),
)  # fmt: skip


@pytest.mark.parametrize(("option", "name", "said"), OVERWRITTEN)
@pytest.mark.parametrize("command", [("report",), ("compare", "--by", "controller")])
def test_neither_a_campaign_nor_what_is_no_page_is_written_over(
    command: tuple[str, ...], option: str, name: str, said: str, made: Path, tmp_path: Path, capsys
) -> None:
    """By force, too: the campaign was lost, its own file was a page."""
    (tmp_path / "record.h5").write_bytes(b"kept")
    before = tree(made), tree(tmp_path)
    file = name.replace("MADE", str(made)) if "MADE" in name else tmp_path / name
    done = physim(command[0], made, *command[1:], option, file, "--force", capture=capsys)
    assert done.code == 2
    check_error(done.err, f"{file}:", said)
    both = ("-o", tmp_path / "b.html", "--json", tmp_path / "." / "b.html")
    done = physim(command[0], made, *command[1:], *both, capture=capsys)
    assert done.code == 2
    check_error(done.err, f"{tmp_path / 'b.html'}:", "--json takes another file")
    assert (tree(made), tree(tmp_path)) == before


def test_the_worst_lead_to_pages_at_their_moments(made: Path, capsys) -> None:
    assert physim("report", made, "--pages", "--quiet", capture=capsys).code == 0
    page = Elements((made / "report.html").read_text(encoding="utf-8"))
    links = [value for name, value in page.attributes if name == "href"]
    rows = read(made)
    assert sorted(links) == sorted(
        f"pages/{row.run}.html#robot={pair.split(', ')[0]}&t={time:.3f}"
        for row in rows
        for pair, time in (
            (row.least_distance_pair, row.least_distance_time),
            (row.not_arrived, row.seconds),
        )
    )
    assert all((made / link.partition("#")[0]).is_file() for link in links)


def test_a_kept_record_of_another_run_is_not_shown(tmp_path: Path, capsys) -> None:
    """Records that were exchanged after the runs: neither may stand beside the other's row."""
    place, cell = Folder(tmp_path / "kept"), spec_of(parse_world(WORLD), 1, name="small")
    place.open([cell])
    taken = [take(replace(cell, seed=seed), "all", place.records) for seed in range(3)]
    place.rows.write([one.row for one in taken if one is not None])
    first, second, _ = (place.records / f"{one.row.run}.h5" for one in taken if one is not None)
    kept = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(kept)
    assert physim("report", place.path, "--quiet", capture=capsys).code == 0
    page = Elements((place.path / "report.html").read_text(encoding="utf-8"))
    assert page.tags.count("img") == 2
    assert page.said.count("record of another run") == 4


def test_values_and_no_pictures(made: Path, tmp_path: Path, capsys) -> None:
    page = tmp_path / "r.html"
    done = physim(
        "report", made, "--json", "-", "--quiet", "--no-pictures", "-o", page, capture=capsys
    )
    assert done.code == 0
    assert json.loads(done.out)["runs"] == 8
    assert "img" not in Elements(page.read_text(encoding="utf-8")).tags


def test_code_of_ones_own_is_not_run_for_pictures_unless_named(
    tmp_path: Path, monkeypatch, capsys
) -> None:
    (tmp_path / "own_for_report.py").write_text(
        "from pathlib import Path\nfrom physim import Decision\n"
        "Path('imported').touch()\n"
        "class Own:\n    def decide(self, observation, memory):\n"
        "        return Decision(0.1, 0.0, hold=0.1)\n",
        encoding="utf-8",
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    name = "own_for_report:Own"
    campaign(tmp_path / "c", range(1, 3), (name,))
    (tmp_path / "imported").unlink()
    sys.modules.pop("own_for_report", None)
    assert physim("report", "c", capture=capsys).code == 0
    assert not (tmp_path / "imported").exists()
    page = Elements((tmp_path / "c" / "report.html").read_text(encoding="utf-8"))
    assert "img" not in page.tags
    assert f"--controller {name}" in page.said
    assert physim("report", "c", "--controller", name, capture=capsys).code == 0
    page = Elements((tmp_path / "c" / "report.html").read_text(encoding="utf-8"))
    assert page.tags.count("img") == 4


def test_a_campaign_with_a_goal_is_reported_and_compared_as_such(tmp_path: Path, capsys) -> None:
    campaign(tmp_path / "c", range(1, 3), CONTROLLERS)
    write_until(tmp_path / "c", Until(read_goal("rate > 0.9"), 1))
    assert (
        "confidence sequence"
        in physim("report", tmp_path / "c", "--no-pictures", capture=capsys).out
    )
    done = physim("compare", tmp_path / "c", "--by", "controller", capture=capsys)
    assert done.code == 0
    assert "stopped because of its results" in done.out


def test_compare_writes_a_page_and_values(made: Path, tmp_path: Path, capsys) -> None:
    page, values = tmp_path / "c.html", tmp_path / "c.json"
    done = physim(
        "compare", made, "--by", "controller", "-o", page, "--json", values, capture=capsys
    )
    assert done.code == 0
    assert "4 seeds in common" in done.out
    assert "not tested: 4 pairs" in done.out
    assert "path_following" in Elements(page.read_text(encoding="utf-8")).said
    assert json.loads(values.read_text())["comparisons"][0]["seeds"] == 4
    done = physim("compare", made, made, "--only", "rate,deviation_peak", capture=capsys)
    assert done.code == 0
    assert "least distance" not in done.out


def test_collision_times_of_controllers_that_report_none_are_compared(made: Path, capsys) -> None:
    compare = ("compare", made, "--by", "controller", "--json", "-", "--quiet", "--only")
    for name, found in (("shortest_collision_time", []), ("shortest_pair_collision_time", [4])):
        (one,) = json.loads(physim(*compare, name, capture=capsys).out)["comparisons"]
        assert [finding["pairs"] for finding in one["findings"]] == found


def test_a_page_of_ones_own_is_overwritten_by_force_alone(
    made: Path, tmp_path: Path, capsys
) -> None:
    place = tmp_path / "c"
    shutil.copytree(made, place)
    page = place / "report.html"
    page.write_text("<html>my thesis", encoding="utf-8")
    assert physim("report", place, "--no-pictures", capture=capsys).code == 2
    assert page.read_text(encoding="utf-8") == "<html>my thesis"
    assert physim("report", place, "--no-pictures", "--force", capture=capsys).code == 0
    assert "path_following" in Elements(page.read_text(encoding="utf-8")).said
    assert physim("report", place, "--no-pictures", capture=capsys).code == 0


def test_rows_without_a_verdict_are_validated_on_request(
    tmp_path: Path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(WORLD, encoding="utf-8")
    sweep = ("sweep", "small.yaml", "--seeds", "0:2", "--workers", "1", "-o", "c", "--json")
    for more, now in ((), 2), (("--validate",), 2), (("--validate",), 0), ((), 0):
        done = physim(*sweep, *more, capture=capsys)
        assert (done.code, json.loads(done.out)["run_now"]) == (0, now)
    assert [(row.verdict, row.unexplained) for row in read("c")] == [("contact-free", 0)] * 2
    row = take(spec_of(parse_world(WORLD), 0, name="small"), "none", None, True).row
    Folder("c").rows.write([replace(row, verdict="checks disagree: once")])
    done = physim(*sweep, "--validate", capture=capsys)
    assert (done.code, done.err.count("checks disagree: once")) == (3, 1)


def test_mistakes(made: Path, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.html").touch()
    (tmp_path / "odd").mkdir()
    (tmp_path / "odd" / "campaign.json").write_text("{", encoding="utf-8")
    for name, version in (("later", 2), ("foreign", 1)):
        (tmp_path / name / "rows").mkdir(parents=True)
        tree = {**json.loads((made / "campaign.json").read_text()), "version": version}
        (tmp_path / name / "campaign.json").write_text(json.dumps(tree), encoding="utf-8")
    (tmp_path / "foreign/report.html").write_text("<html>my thesis", encoding="utf-8")
    mistakes: dict[tuple[object, ...], tuple[str, ...]] = {
        ("report", "none"): ("none:", "campaign", "physim sweep"),
        ("report", "odd"): ("odd/campaign.json:",),
        ("report", made, "-o", "there.html"): ("there.html:", "exists", "--force"),
        ("report", made, "-o", "no/r.html"): ("no/r.html:", "folder"),
        ("report", made, "--json", "there.html"): ("there.html:", "exists"),
        ("compare", "none", "--by", "world"): ("none:", "campaign"),
        ("compare", made): ("--by:", "missing", "physim compare A B"),
        ("report", "later"): ("later/campaign.json:", "2", "1"),
        ("report", "foreign"): ("foreign/report.html:", "exists", "--force"),
        ("compare", made, made, "--by", "world"): ("--by:", "B"),
        ("compare", made, "--by", "world"): ("--by world:", "small"),
        ("compare", made, "--by", "word"): ("--by word:", "controller, settings, world", '"world"'),
        ("compare", made, made, "--only", "rats"): ("--only rats:", "contact_free", '"rate"'),
        ("compare", made, made, "--only", "rate:more"): ("--only rate:more:", '"rate"'),
    }
    for arguments, (place, *said) in mistakes.items():
        done = physim(*arguments, capture=capsys)
        assert (done.code, done.out) == (2, ""), arguments
        check_error(done.err, place, *said)


@pytest.mark.deep
def test_the_decision_is_the_same_with_any_number_of_workers(
    tmp_path: Path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("small.yaml").write_text(WORLD, encoding="utf-8")
    found = []
    for workers in (1, 2):
        done = physim(
            "sweep", "small.yaml", "--seeds", "1:200", "--until", "contact_free > 0.8",
            "--workers", workers, "-o", f"by{workers}", "--json", capture=capsys,
        )  # fmt: skip
        assert done.code == 0
        (cell,) = json.loads(done.out)["cells"]
        found.append(cell["decision"])
        runs = [row.seed for row in read(Path(f"by{workers}"))]
        assert cell["decision"]["runs"] <= len(runs) < 60
        assert runs[: cell["decision"]["runs"]] == list(range(1, cell["decision"]["runs"] + 1))
    assert found[0] == found[1]
    assert found[0]["holds"] is True
    done = physim("report", "by2", "--json", "-", "--quiet", "--no-pictures", capture=capsys)
    values = json.loads(done.out)
    assert values["interval"] == "beta-binomial sequence"
    assert values["cells"][0]["decision"] == found[0]
