"""Where goldens lie, and how two values differ."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).with_name("kept")
WITHIN = 1e-9
"""Relative and absolute: what the text of a number may lose"""


def write(name: str, value: Any) -> None:
    """Keep a value as JSON, one element a line."""
    text = json.dumps(value, indent=0, ensure_ascii=False)
    (FOLDER / f"{name}.json").write_text(text + "\n", encoding="utf-8")


def read(name: str) -> Any:
    """What was kept."""
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))


def differences(kept: Any, now: Any, place: str = "") -> Iterator[str]:
    """A line for each place in which two JSON values differ."""
    numbers = isinstance(kept, (int, float)) and isinstance(now, (int, float))
    if isinstance(kept, dict) and isinstance(now, dict):
        for key in {**kept, **now}:
            yield from differences(kept.get(key), now.get(key), f"{place}/{key}")
    elif isinstance(kept, list) and isinstance(now, list) and len(kept) == len(now):
        for k, (one, other) in enumerate(zip(kept, now, strict=True)):
            yield from differences(one, other, f"{place}/{k}")
    elif numbers and math.isclose(kept, now, rel_tol=WITHIN, abs_tol=WITHIN):
        return
    elif kept != now:
        yield f"{place}: {kept!r} was kept, {now!r} is made"
