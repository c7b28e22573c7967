"""Copies of a checkout in a temporary folder, of which physim is imported in place of the one
that is installed.

A package of that name stands in each copy, with links to ``controllers`` and ``worlds`` inside, as
the wheel has them; the copy goes first on PYTHONPATH, which all processes below inherit.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

LINKS = {"physim/controllers": "../controllers", "physim/worlds": "../worlds"}


def tracked_files(root: Path) -> list[Path]:
    """Files of a checkout that git knows, and new ones that it does not ignore; from its root."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root, capture_output=True, check=True, text=True,
    )  # fmt: skip
    names = sorted({Path(name) for name in listed.stdout.split("\0") if name})
    return [name for name in names if (root / name).is_file()]


def copy_checkout(root: Path, target: Path) -> None:
    """Copy the files of a checkout, and set the links."""
    for name in tracked_files(root):
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(root / name, target / name)
    for kernels in (root / "physim").glob("_kernels*.so"):  # built already, from these sources
        shutil.copy2(kernels, target / "physim")
    for link, to in LINKS.items():
        (target / link).symlink_to(to, target_is_directory=True)


def environment(copy: Path, temporary: Path) -> dict[str, str]:
    """Environment of processes that are to use a copy, and a folder for what they leave."""
    temporary.mkdir(exist_ok=True)
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
    return {**kept, "PYTHONPATH": str(copy), "TMPDIR": str(temporary)}


def python(*arguments: str) -> list[str]:
    """Command line of this Python."""
    return [sys.executable, *arguments]
