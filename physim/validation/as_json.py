"""A validation as JSON text. Units: m, s, m/s, rad/s, N s; bodies by id, named in run.bodies."""

from __future__ import annotations

import json
import math
from dataclasses import fields, is_dataclass
from typing import Any

from physim.declared import Mode, Rule
from physim.validation.seeds import SeedStudy
from physim.validation.validation import Validation

INTERRUPTED = 130
UNITS = "m, s, rad, m/s, rad/s, N s; world frame"


def json_of_validation(validation: Validation) -> str:
    """JSON of one run. Infinite values are the text "inf"; what was not looked at is null."""
    return _text(
        {
            "format": "physim-validation",
            "version": 2,
            "units": UNITS,
            "verdict": validation.verdict,
            "exit_code": validation.code,
            "unexplained": validation.unexplained,
            "pairs_in_contact": validation.pairs,
            **plain(validation),
        }
    )


def json_of_seeds(study: SeedStudy) -> str:
    """JSON of a study over seeds."""
    free, finished = study.rates
    return _text(
        {
            "format": "physim-validation-seeds",
            "version": 2,
            "world": study.world,
            "seeds_asked": study.asked,
            "interrupted": study.interrupted,
            "runs": len(study.results),
            "contact_free": study.free,
            "rate": free.share,
            "interval_95": list(free.interval),
            "finished": study.finished,
            "finished_rate": finished.share,
            "finished_interval_95": list(finished.interval),
            "exit_code": INTERRUPTED if study.interrupted else study.code,
            "seeds": plain(study.results),
        }
    )


def plain(value: Any) -> Any:
    """Value in types that JSON knows; modes and rules by their names."""
    if isinstance(value, Mode | Rule):
        return value.name
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float):
        if math.isnan(value):
            return None
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return float(value)
    return value


def _text(value: dict[str, Any]) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
