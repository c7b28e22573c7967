"""Nothing in a file acts on the terminal that shows it."""

from __future__ import annotations

import h5py

from tests.edges.records import damaged
from tests.edges.shell import Done, Shell

NUMBER = "4"
NAME = "r1\x1b[31m\x1b]0;title\x07\x9b2J\u202eevil\nFORGED line"


def check_inert(done: Done) -> None:
    """Assert that a command told something in which no sign acts."""
    told = (done.raw_out + done.raw_err).decode()
    assert told
    assert told.replace("\n", "").isprintable(), repr(told)
    assert "\nFORGED" not in told


def try_names_in_a_record(shell: Shell) -> None:
    def change(file: h5py.File) -> None:
        file["/bodies/name"][0] = NAME

    damaged(shell, change)
    for command in ("summary", "validate"):
        done = shell.physim(command, "record.h5")
        assert done.code == 2, done
        check_inert(done)


def try_attributes_of_a_record(shell: Shell) -> None:
    for name in ("version", "name", "units", "ended", "format"):
        damaged(shell, lambda file, name=name: file.attrs.create(name, NAME))
        done = shell.physim("summary", "record.h5")
        assert done.code == 2, done
        check_inert(done)


def try_names_in_worlds_and_drawings(shell: Shell) -> None:
    shell.write("w.yaml", 'name: "\\e[31m\\x9b\\u202e"\n"\\e[2J": 1\n')
    check_inert(shell.physim("check", "w.yaml"))
    shell.write("d.svg", '<svg xmlns="http://www.w3.org/2000/svg"><g id="\u202e\x9b\u200b"/></svg>')
    check_inert(shell.physim("import", "d.svg", "-o", "x.yaml", "--scale", 1))
    shell.write("t.csv", "x_m,y_m,\x1b[2J\n1,2,3\n")
    check_inert(shell.physim("import", "t.csv", "-o", "x.yaml"))


def try_names_of_files(shell: Shell) -> None:
    name = b"\xff\x1b[31m\xe2\x80\xae.yaml"
    (shell.folder / name.decode("utf-8", "surrogateescape")).write_bytes(b"name: 1\n")
    check_inert(shell.sh("physim check ./*.yaml"))
