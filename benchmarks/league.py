"""``python -m benchmarks.league``: the whole league, and docs/LEAGUE.md, which is its page.

Further arguments are those of ``physim league``; ``--no-run`` writes the page of the runs that are
there.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from physim.cli import main

FOLDER = Path("build/league")
PAGE = Path(__file__).parents[1] / "docs" / "LEAGUE.md"


if __name__ == "__main__":
    code = main(["league", "-o", str(FOLDER), *sys.argv[1:]])
    if code == 0:
        shutil.copyfile(FOLDER / "LEAGUE.md", PAGE)
    sys.exit(code)
