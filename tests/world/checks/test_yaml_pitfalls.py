"""Each pitfall of YAML is reported at its place, with the way to write what is meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.world.checks import check_world
from tests.world.worlds import CORRIDOR, changed, check_finding, lines


def only(folder: Path, data: bytes) -> str:
    """The one error of a file, as ``line:column key message``."""
    file = folder / "w.yaml"
    file.write_bytes(data)
    (found,) = check_world(file).errors
    return f"{found.line}:{found.column} {found.key} {found.message}".replace("  ", " ")


@pytest.mark.parametrize(
    ("change", "place", "parts"),
    [
        (("name: corridor", "name:corridor"), "1:5", ["space", "colon", '"name: …"']),
        (("    pose: [6.0", "    pose:[6.0"), "7:9", ["space", "colon", '"pose: …"']),
        (("[30, 0]]", "[30, 0]"), "3:24", ['"["', '"}" at 3:52', 'with "]"']),
        (("    pose: [6.0, 1.0, 0.0]", "    pose: [6.0, 1.0, 0.0"),
         "7:11", ['"["', "not closed", "line 8", 'add "]"']),
        (("duration: 60.0}", "duration: 60.0"),
         "2:7", ['"{"', "not closed", "line 3", 'add "}"']),
        (("[0.0, -3.0]}", "[0.0, -3.0"),
         "13:22", ['"["', "not closed", "end", 'add "]"']),
        (("path: {offset: -1.0}", "path: {offset: -1.0"),
         "12:11", ['"{"', "not closed", "line 13", 'add "}"']),
        (("[0, 0], [30", "[0, 0] [30"), "3:32", ["comma", '"["', "3:24"]),
        (("0.01, duration", "0.01 duration"), "2:19", ["comma", '"{"', "2:7"]),
        (("name: corridor", 'name: "corridor'), "1:7", ["quote", "not closed"]),
        (("name: corridor", "name: a: b"), "1:8", ['": "', "quotes"]),
        (("name: corridor", "name: @home"), "1:7", ["character", "quotes"]),
    ],
)  # fmt: skip
def test_yaml_mistakes_are_reported_where_they_lie(tmp_path, change, place, parts):
    error = only(tmp_path, changed(CORRIDOR, change).encode())
    check_finding(error, place, "not valid YAML", *parts)


def test_an_entry_of_a_list_without_its_dash(tmp_path):
    file = tmp_path / "w.yaml"
    file.write_text(changed(CORRIDOR, ("  - name: b", "    name: b")), encoding="utf-8")
    errors, _ = lines(check_world(file))
    twice = [error for error in errors if " robots[0]." in error]
    assert len(twice) == 1  # the keys after it come twice for the same reason
    check_finding(twice[0], "9:5 robots[0].name", "twice", "line 5", "dash", '"- "')
