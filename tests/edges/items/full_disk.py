"""A disk that is full is one line that names the file; nothing half-written is left."""

from __future__ import annotations

from tests.edges.shell import Shell

NUMBER = "disk"
FULL = "ulimit -f 8; "  # 4 kB in a file, and none more
SHORT = "--set time.duration=2"


def try_pictures_and_films(shell: Shell) -> None:
    done = shell.sh(f"physim run three_robots {SHORT} --no-video --quiet -o out")
    assert done.code in (0, 1), done.err
    for name in ("a.mp4", "a.gif", "a.webp", "a.png --at 1"):
        file = name.partition(" ")[0]
        done = shell.sh(f"{FULL} physim video out/record.h5 --width 640 -o {name}")
        assert (done.code, done.err.count("\n")) == (2, 1), done.err
        assert file in done.err, done.err
        assert sorted(one.name for one in shell.folder.iterdir()) == ["out"]


def try_a_replayed_run(shell: Shell) -> None:
    given = f"sweep three_robots {SHORT} --seeds 1:2 --controller path_following -o many"
    assert shell.sh(f"physim {given}").code == 0
    done = shell.sh(f"{FULL} physim replay many:0 --no-video -o again")
    assert "Traceback" not in done.err, done.err
    assert done.code in (2, 3), done.err
    assert done.err.count("\n") == 1, "what follows from it is not told beside it: " + done.err
    assert "again/record.h5" in done.err, done.err
