"""``python -m benchmarks.league``: the whole league, and docs/LEAGUE.md, which is its page.

Further arguments are those of ``physim league``; ``--no-run`` writes the page of the runs that are
there, in build/league. Empty that folder where code of physim was changed: rows do not know it.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from physim.cli import main

ROOT = Path(__file__).parents[1]
FOLDER, PAGE = ROOT / "build" / "league", ROOT / "docs" / "LEAGUE.md"
PROGRAMME = ROOT / "worlds" / "league" / "league.yaml"


if __name__ == "__main__":
    code = main(["league", "-o", str(FOLDER), "--programme", str(PROGRAMME), *sys.argv[1:]])
    if code == 0:
        shutil.copyfile(FOLDER / "LEAGUE.md", PAGE)
    sys.exit(code)
