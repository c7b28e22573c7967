"""Whether a message says enough: place, key, what was given and what is allowed; not its words."""

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


def check_error(told: str, place: str, *parts: str) -> None:
    """An error of one line that begins with its place and says each of the parts, whole.

    A part is a key, what was given, or what is allowed; not how the sentence puts it.
    """
    assert told.endswith("\n")
    assert told.count("\n") == 1, told
    assert "Traceback" not in told
    after = "" if place.endswith(":") else r"(?![\w.])"
    assert re.match(re.escape(place) + after, told), told
    for part in parts:
        whole = rf"(?<![\w.-]){re.escape(part)}(?![\w-]|\.\d)"
        assert re.search(whole, told), f"{part} is not said: {told}"
