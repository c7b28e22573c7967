"""A validation as JSON. Units: m, s, m/s, rad/s, N s; bodies by id, named in run.bodies."""

from __future__ import annotations

import json
import math
from dataclasses import fields, is_dataclass
from typing import Any

from physim.analysis.validation.told import sentences
from physim.analysis.validation.validation import Validation
from physim.parts.declarations import Mode, Rule
from physim.record.setup import Setup

UNITS = "m, s, rad, m/s, rad/s, N s; world frame"


def json_of_validation(validation: Validation) -> str:
    """JSON of one run. Infinite values are the text "inf"; what was not looked at is null."""
    values, names = plain(validation), validation.names
    for key in ("contacts", "grazes"):
        for one, said in zip(getattr(validation, key), values[key], strict=True):
            said["sentences"] = sentences(one, names)
    tree = {
        "format": "physim-validation",
        "version": 2,
        "units": UNITS,
        "verdict": validation.verdict,
        "exit_code": validation.code,
        "unexplained": validation.unexplained,
        "pairs_in_contact": validation.pairs,
        **values,
    }
    return json.dumps(tree, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """Value in types that JSON knows; modes and rules by their names."""
    if isinstance(value, Mode | Rule):
        return value.name
    if isinstance(value, Setup):
        return plain(value.to_dict())
    if is_dataclass(value) and not isinstance(value, type):
        return {
            field.metadata.get("json", field.name): plain(getattr(value, field.name))
            for field in fields(value)
        }
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
