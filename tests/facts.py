"""What a message must say, whatever its words: place, key, what was given and what is allowed."""

from __future__ import annotations

import re


def facts(*parts: str) -> str:
    """Regular expression of a text in which every part stands, as itself and in any order.

    A part that begins and ends with a letter or digit stands there as words of its own.
    """
    return "(?s)^" + "".join(f"(?=.*{_alone(part)})" for part in parts)


def _alone(part: str) -> str:
    before = r"(?<!\w)(?<!\d\.)" if part[:1].isalnum() else ""
    after = r"(?!\w)(?!\.\d)" if part[-1:].isalnum() else ""
    return before + re.escape(part) + after
