"""What a report states, whatever its words and wherever its lines break."""

from __future__ import annotations

import re

from tests.helpers import facts


def states(text: str, first: str, *parts: str, within: int = 120) -> bool:
    """Whether ``first`` stands in a text with all other parts at most ``within`` characters away.

    Parts are as of `facts`: words of their own, in any order.
    """
    text = " ".join(text.split())
    for at in re.finditer(re.escape(first), text):
        start, end = max(at.start() - within, 0), at.end() + within
        if re.search(facts(first, *parts), text[start:end]):
            return True
    return False
