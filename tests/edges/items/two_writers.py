"""Two runs do not write one record: one has it, the other is refused and leaves it alone."""

from __future__ import annotations

from tests.edges.shell import Shell

NUMBER = "3"


def try_two_runs_into_one_folder(shell: Shell) -> None:
    given = ("run", "straight", "-o", "out", "--no-video", "--quiet", "--force")
    for _ in range(3):
        both = [shell.start(*given) for _ in range(2)]
        ends = [(process, process.communicate(timeout=300)) for process in both]
        codes = sorted(process.returncode for process, _ in ends)
        assert codes in ([0, 0], [0, 2]), ends
        for process, (out, err) in ends:
            if process.returncode == 2:
                assert b"another run is writing" in err, err
                assert b"written to" not in out
        assert shell.physim("validate", "out/record.h5", "--quiet").code == 0
        assert not list((shell.folder / "out").glob("*.part*"))
