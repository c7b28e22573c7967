"""physim and its peers, measured in turn: ``python -m benchmarks [SUBJECT …]`` writes RESULTS.md.

Exit codes: 0 measured and written, 1 something could not be measured (RESULTS.md says what and
why), 2 bad input, 130 interrupted (``--resume`` goes on).
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from pathlib import Path

from benchmarks import first, headon, report, scaling, speed, targets, trial
from benchmarks.environments import PEERS, Environment, environment
from benchmarks.measuring import FAILED, HERE, ROOT, Job, Progress, Store, in_turn

SUBJECTS = ("speed", "headon", "first", "scaling", "trial", "targets")


def main() -> int:
    """Run the program; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="few sizes, one round: 4 minutes")
    parser.add_argument("--resume", action="store_true", help="keep what is measured already")
    parser.add_argument("--tables", action="store_true", help="measure nothing, write the tables")
    parser.add_argument("subjects", nargs="*", metavar="SUBJECT",
                        help=f"some of: {', '.join(SUBJECTS)} (all)")  # fmt: skip
    parser.add_argument("--rounds", type=int, help="fresh processes of each (3; quick: 1)")
    parser.add_argument("--trial", type=Path, metavar="FOLDER", help="a folder with measure.py")
    parser.add_argument("--vmas", action="store_true", help="install VMAS too (about 3 GB)")
    parser.add_argument("--work", type=Path, default=HERE / ".work", metavar="DIR",
                        help="environments and measurements (benchmarks/.work)")  # fmt: skip
    parser.add_argument("-o", "--output", type=Path, default=HERE / "RESULTS.md", metavar="FILE")
    options = parser.parse_args()
    for unknown in set(options.subjects) - set(SUBJECTS):
        print(f"{unknown}: no subject; allowed: {', '.join(SUBJECTS)}", file=sys.stderr)
        return 2
    if options.trial is not None and not (options.trial / "measure.py").is_file():
        print(f"--trial {options.trial}: no measure.py there", file=sys.stderr)
        return 2
    try:
        return measure(options)
    except KeyboardInterrupt:
        return 130


def measure(options: argparse.Namespace) -> int:
    """Measure what is asked for and write it."""
    work: Path = options.work.resolve()
    os.chdir(ROOT)
    measured = work / ("measured-quick" if options.quick else "measured")
    store = Store(measured)
    wanted = set(options.subjects or SUBJECTS)
    if not (options.resume or options.tables):
        for subject in wanted:
            shutil.rmtree(measured / subject, ignore_errors=True)
    peers = _peers(options, work)
    if not options.tables:
        _measure(options, work, store, peers, wanted)
    report.write(store, peers, options.output, options.quick)
    print(options.output)
    failures = [f"{name}: {one.failed}" for name, one in peers.items() if one.failed]
    for file in sorted(measured.glob("*/*.json")):
        subject, (who, what, number) = file.parent.name, file.stem.split(".")
        found = store.get(Job(subject, who, what, ()), int(number))
        if found is not None and FAILED in found:
            failures.append(f"{subject}: {who} {what}: {found[FAILED]}")
    for line in failures:
        print(line, file=sys.stderr)
    return 1 if failures else 0


def _peers(options: argparse.Namespace, work: Path) -> dict[str, Environment]:
    """Environments of the peers, made where they are not there yet."""
    progress, found = Progress(len(PEERS)), {}
    for peer in PEERS:
        if peer.optional and not options.vmas:
            continue
        progress.tell(f"environment of {peer.name}")
        found[peer.name] = environment(peer, work / "environments")
        progress.step()
    progress.end()
    return found


def _measure(
    options: argparse.Namespace, work: Path, store: Store, peers: dict[str, Environment],
    wanted: set[str],
) -> None:  # fmt: skip
    quick, groups = options.quick, []
    rounds = options.rounds or (1 if quick else 3)
    if "speed" in wanted:
        groups += [(group, rounds) for group in speed.groups(peers, quick)]
    if "headon" in wanted:
        groups += [(group, 1) for group in headon.groups(peers, quick)]
    if "first" in wanted:
        imports, videos, commands = first.groups(peers, work, quick)
        groups += [(imports, 1 if quick else 5), *(([job], 1) for job in videos)]
        groups += [([job], 3) for job in commands]
    if "scaling" in wanted:
        groups += [(group, 1) for group in scaling.groups(quick)]
    if "targets" in wanted:
        groups += [(group, rounds) for group in targets.groups(quick)]
        groups += [([job], 1) for job in targets.long_ones(quick)]
    if "trial" in wanted and options.trial is not None:
        theirs = trial.groups(options.trial.resolve(), work, quick)
        if failed := trial.warm_up(work):
            print(f"trial: {failed}", file=sys.stderr)
        groups += [(group, rounds) for group in theirs]
    progress = Progress(sum(len(group) * times for group, times in groups))
    try:
        if "first" in wanted and not quick:
            for who in first.FROM_NOTHING:
                progress.tell(f"first: installation of {who}")
                if not (options.resume and store.results("first", who, "install")):
                    first.from_nothing(who, work, store)
        for group, times in groups:
            in_turn([group], times, store, options.resume, progress)
    finally:
        progress.end()


if __name__ == "__main__":
    sys.exit(main())
