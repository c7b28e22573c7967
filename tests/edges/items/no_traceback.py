"""Odd input, closed outputs and interrupts at any moment end in one line, not in a traceback."""

from __future__ import annotations

import json
import time

import h5py

from tests.edges.records import damaged
from tests.edges.shell import HANGUP, INTERRUPT, TERMINATE, Shell

NUMBER = "6"


def try_closed_outputs(shell: Shell) -> None:
    shell.write("bad.yaml", "name: 1\n")
    done = shell.sh("physim check straight 2>&-")
    assert (done.code, done.err) == (0, ""), done
    assert done.out
    assert shell.sh("physim summary none.h5 2>&-")[:2] == (2, b""), "errors on standard output"
    done = shell.sh("physim check bad.yaml >&-")
    assert done.code == 2
    assert "Traceback" not in done.err
    assert shell.sh("physim check bad.yaml <&- >&- 2>&-").code == 2


def try_an_emoji_where_output_is_ascii(shell: Shell) -> None:
    def change(file: h5py.File) -> None:
        file.attrs["name"] = "robot 🤖"

    damaged(shell, change)
    for encoding in ("ascii", "latin-1", "cp1252"):
        done = shell.physim("summary", "record.h5", PYTHONIOENCODING=encoding, PYTHONUTF8="0")
        assert (done.code, done.err) == (0, ""), done
        done = shell.physim("summary", "record.h5", "--json", PYTHONIOENCODING=encoding)
        assert json.loads(done.raw_out.decode(encoding))["name"] == "robot 🤖"


def try_signals_at_the_start(shell: Shell) -> None:
    """From the first moment that physim itself runs; before it, Python answers as it does."""
    for number in (INTERRUPT, TERMINATE, HANGUP):
        for late in (0.15, 0.25, 0.4):
            process = shell.start("validate", "straight", "--seeds", "0:1000", "--quiet")
            time.sleep(late)
            process.send_signal(number)
            out, err = process.communicate(timeout=60)
            assert process.returncode in (130, -number), (process.returncode, err)
            if process.returncode == 130:
                assert (out, err) == (b"", b"interrupted\n")


def try_a_record_of_many_rows(shell: Shell) -> None:
    damaged(shell, lambda file: file["/contacts"].resize(200_000_000, axis=0))
    shell.physim("summary", "record.h5", memory=4000, seconds=60).refused("/contacts")
    damaged(shell, lambda file: file.attrs.create("steps_run", 200_000_000))
    shell.physim("summary", "record.h5", memory=4000, seconds=60).refused("samples", "200000000")


def try_a_record_that_leads_elsewhere(shell: Shell) -> None:
    def link(file: h5py.File) -> None:
        del file["/steps/pose"]
        file["/steps/pose"] = h5py.ExternalLink("/etc/hostname", "/x")

    def storage(file: h5py.File) -> None:
        rows = len(file["/steps/step"])
        del file["/steps/step"]
        file.create_dataset(
            "/steps/step", (rows,), "<i8", external=[("/etc/hostname", 0, 8 * rows)]
        )

    damaged(shell, link)
    shell.physim("summary", "record.h5").refused("/steps/pose", "link")
    damaged(shell, storage)
    shell.physim("summary", "record.h5").refused("/steps/step", "another file")


def try_a_record_of_odd_numbers(shell: Shell) -> None:
    for name in ("seed", "steps_run", "dt", "safe_distance", "rejected_contacts"):
        damaged(shell, lambda file, name=name: file.attrs.create(name, float("nan")))
        shell.physim("summary", "record.h5").refused(f"attribute {name} is")


def try_drawings_in_other_encodings(shell: Shell) -> None:
    drawing = '<svg xmlns="http://www.w3.org/2000/svg"><desc>é</desc></svg>'
    for name in ("Shift_JIS", "UTF-7", "UTF-16", "no-such-thing", "rot13"):
        shell.write("d.svg", f'<?xml version="1.0" encoding="{name}"?>{drawing}')
        shell.physim("import", "d.svg", "-o", "w.yaml").refused("d.svg:1:", name, "UTF-8")


def try_numbers_of_thousands_of_digits(shell: Shell) -> None:
    digits = "9" * 5000
    shell.write("w.yaml", f"name: a\nseed: {digits}\n")
    done = shell.physim("run", "w.yaml")
    assert done.code == 2
    assert "w.yaml:2:7: seed: an integer of 5000 digits" in done.err, done.err
    for given in (("run", "straight", "--seed", digits),
                  ("validate", "straight", "--seeds", f"0:{digits}"),
                  ("run", "straight", "--set", f"seed={digits}"),
                  ("run", "straight", "--set", "seed=0x_")):  # fmt: skip
        shell.physim(*given).refused("seed")
    shell.write("a.geojson", f'{{"type": "Point", "coordinates": [{digits}, 0]}}')
    shell.physim("import", "a.geojson", "-o", "o.yaml").refused("a.geojson: ", "5000 digits")

    def change(file: h5py.File) -> None:
        file.attrs["world"] = f"name: a\nseed: {digits}\n"

    damaged(shell, change)
    done = shell.physim("summary", "record.h5")
    assert "sys." not in done.err + done.out


def try_lengths_that_are_as_good_as_none(shell: Shell) -> None:
    for value in ("1.0e-320", "1.0e-300", "1.0e+300"):
        for key in ("corridor.width", "corridor.end_margin", "robots.0.pose"):
            pose = f"[{value}, {value}, {value}]"
            given = f"{key}={pose if key.endswith('pose') else value}"
            done = shell.physim("check", "straight", "--set", given)
            assert done.code in (0, 2)
            assert "Warning" not in done.err, done.err
