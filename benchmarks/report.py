"""RESULTS.md from the results on disk."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from benchmarks import first, headon, scaling, speed, targets, trial
from benchmarks.environments import PEERS, Environment
from benchmarks.measuring import FAILED, ROOT, Store, table

OWN = ("numpy", "pymunk", "h5py", "shapely", "imageio_ffmpeg")
"""Packages that physim's speed depends on."""


def write(store: Store, peers: Mapping[str, Environment], file: Path, quick: bool) -> None:
    """Write the tables of what was measured, and the picture."""
    parts = [HEADER, _conditions(quick)]
    if store.results(speed.SUBJECT, "physim", "drive-10"):
        parts.append(speed.text(store, peers))
    if (store.folder / headon.SUBJECT).exists():
        parts.append(headon.text(store, peers))
    if (store.folder / first.SUBJECT).exists():
        parts.append(first.text(store, peers))
    if (store.folder / scaling.SUBJECT).exists():
        scaling.draw(store, file.parent)
        parts.append(scaling.text(store))
    if (store.folder / trial.SUBJECT).exists():
        parts.append(trial.text(store))
    if (store.folder / targets.SUBJECT).exists():
        parts.append(targets.text(store))
    parts.append(_peers(store, peers))
    file.write_text("".join(parts).rstrip() + "\n", encoding="utf-8")


HEADER = """\
# Results

Written by `python -m benchmarks`; [README.md](README.md) says how it measures. Ratios hold on
other machines, figures do not. A † stands behind a rate for every process of which
two spans differ more than twice, even measured again: something else was in one of them.

"""


def _conditions(quick: bool) -> str:
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True
    ).stdout.strip()
    packages = ", ".join(f"{name} {version(name)}" for name in OWN)
    quickly = "A quick run: one round, short, few sizes. " if quick else ""
    return (
        f"{quickly}{datetime.now(UTC):%Y-%m-%d}; {_processor()}, {os.cpu_count()} cores, "
        f"{platform.system()}; Python {platform.python_version()}; physim {version('physim')} "
        f"({commit or 'no commit'}), {packages}.\n\n"
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _peers(store: Store, peers: Mapping[str, Environment]) -> str:
    rows = []
    for peer in PEERS:
        one = peers.get(peer.name)
        state = "not asked for" if one is None else one.failed or _version(store, peer.name)
        rows.append([peer.name, state, peer.lacks, peer.does])
    head = ["peer", "version", "what it does not do", "what it does and physim does not"]
    return f"## Peers\n\n{table(head, rows)}"


def _version(store: Store, name: str) -> str:
    for file in sorted(store.folder.glob(f"*/{name}*.json")):
        subject, (who, what, _) = file.parent.name, file.stem.split(".")[:3]
        for one in store.results(subject, who, what):
            if FAILED not in one and "version" in one:
                return str(one["version"])
    return "installed, not run"
