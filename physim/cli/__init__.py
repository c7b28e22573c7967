"""The command line: ``physim run``, ``video``, ``summary``, ``list``."""

from __future__ import annotations

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    0 fine, 1 ran but an expectation failed, 2 bad input, 130 interrupted.
    """
    from physim.cli.parser import build_parser
    from physim.errors import PhysimError

    parser = build_parser()
    options = parser.parse_args(arguments)
    try:
        code: int = options.action(options)
    except PhysimError as error:
        print(f"physim: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("physim: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone; say nothing more
        return 0
    return code
