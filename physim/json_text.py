"""JSON that anybody may have written: whatever is wrong with it is a ValueError in plain words."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

MOST_BYTES = 20_000_000
"""Bytes of a file that is read"""


class TwiceError(ValueError):
    """An object has a key twice."""


def parse_json(text: str | bytes, once: bool = False) -> Any:
    """Value of a JSON text. Raises ValueError, with ``once`` also for a key that is given twice."""
    try:
        return json.loads(text, object_pairs_hook=_each_once if once else None)
    except TwiceError:
        raise
    except json.JSONDecodeError as error:
        raise ValueError(f"no JSON: {error.msg}, line {error.lineno}") from None
    except UnicodeDecodeError:
        raise ValueError("no UTF-8") from None
    except RecursionError:
        raise ValueError("no JSON that can be read: nested too deeply") from None
    except ValueError:  # of Python, for a whole number of thousands of digits
        raise ValueError("no JSON that can be read: a number has too many digits") from None


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    tree = dict(pairs)
    if len(tree) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise TwiceError(f"{json.dumps(twice[:40])} is given twice")
    return tree


def file_json(path: Path) -> Any:
    """Value of a file. Raises ValueError, also for one that is too large, and OSError."""
    with open(path, "rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise ValueError(f"more than {MOST_BYTES / 1e6:.0f} MB")
    return parse_json(data)


__all__ = ["file_json", "parse_json"]
