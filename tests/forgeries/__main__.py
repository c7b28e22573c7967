"""Try every forgery, and the records as they are: ``python -m tests.forgeries``.

A line each; exit code 0 where all forgeries are found and no true record is doubted, else 1.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.forgeries.trial import null_arm, try_all


def main() -> int:
    """Run both arms."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    with tempfile.TemporaryDirectory() as folder:
        forged, plain = Path(folder) / "forged", Path(folder) / "plain"
        forged.mkdir()
        plain.mkdir()
        missed = try_all(forged) + null_arm(plain)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
