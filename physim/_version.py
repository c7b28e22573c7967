"""The version of physim, as installed."""

import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

try:
    __version__ = version("physim")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"


def version_told() -> str:
    """The version, in a checkout with the commit: ``1.0.0 (commit 1a2b3c4d5e, modified)``."""
    checkout = Path(__file__).parents[1]
    if not (checkout / ".git").exists():
        return __version__
    git = ["git", "-C", str(checkout), "describe", "--always", "--dirty", "--abbrev=10"]
    try:  # no tag matches the last: the commit is wanted
        done = subprocess.run([*git, "--exclude=*"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return __version__
    commit, _, modified = done.stdout.strip().partition("-")
    return f"{__version__} (commit {commit}{', modified' if modified else ''})"
