"""What a trial has: a folder, and the command line in fresh processes, as in a shell."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

LONGEST = 300
"""[s] after which a process is taken to hang"""


class Done(NamedTuple):
    """How a command ended: its exit code, and the bytes it wrote."""

    code: int
    raw_out: bytes
    raw_err: bytes

    @property
    def out(self) -> str:
        """Standard output."""
        return self.raw_out.decode("utf-8", "backslashreplace")

    @property
    def err(self) -> str:
        """Standard error."""
        return self.raw_err.decode("utf-8", "backslashreplace")

    def refused(self, *parts: str) -> None:
        """Assert that it ended with 2 and one line on standard error that says each of ``parts``.

        On standard output there is nothing.
        """
        assert (self.code, self.out) == (2, ""), f"{self.code}: {self.out}{self.err}"
        assert self.err.count("\n") == 1, self.err
        for part in parts:
            assert part in self.err, f"{part} is not said: {self.err}"


class Shell:
    """A folder, and commands in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, name: str, content: str | bytes) -> Path:
        """Write a file of the folder."""
        path = self.folder / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    def physim(self, *arguments: object, memory: int = 0, seconds: int = 0, **more: str) -> Done:
        """Run ``physim``. ``memory`` [MB] and ``seconds`` of processor time are bounds on it.

        Names in ``more`` are environment variables.
        """
        process = self.start(*arguments, memory=memory, seconds=seconds, **more)
        out, err = process.communicate(timeout=LONGEST)
        return Done(process.returncode, out, err)

    def start(
        self, *arguments: object, memory: int = 0, seconds: int = 0, **more: str
    ) -> subprocess.Popen[bytes]:
        """Start ``physim`` and go on."""

        def bounded() -> None:
            signal.signal(HANGUP, signal.SIG_DFL)  # which may be ignored where tests are run
            if memory:
                resource.setrlimit(resource.RLIMIT_AS, (memory * 1_000_000,) * 2)
            if seconds:
                resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))

        return subprocess.Popen(
            [sys.executable, "-m", "physim", *map(str, arguments)],
            cwd=self.folder, env=_environment(more), preexec_fn=bounded,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip

    def sh(self, script: str, **more: str) -> Done:
        """Run a line of a shell in which ``physim`` is the command, for redirections."""
        whole = f'physim() {{ "{sys.executable}" -m physim "$@"; }}\n{script}'
        done = subprocess.run(
            ["sh", "-c", whole], cwd=self.folder, env=_environment(more), timeout=LONGEST,
            stdin=subprocess.DEVNULL, capture_output=True, start_new_session=True,
        )  # fmt: skip
        return Done(done.returncode, done.stdout, done.stderr)


def _environment(more: dict[str, str]) -> dict[str, str]:
    """The environment of an ordinary shell: output to a pipe is buffered."""
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}
    root = str(Path(__file__).parents[2])
    return {**kept, "PYTHONPATH": root, **more}


HANGUP, INTERRUPT, TERMINATE = signal.SIGHUP, signal.SIGINT, signal.SIGTERM
