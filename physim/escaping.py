"""What came from a file or the command line, as it may be shown: no sign in it acts.

Control signs (C0, C1), signs that turn the direction of writing, signs without a width and all
separators but the space are written as ``\\uXXXX``, which JSON reads as the same sign; beyond
U+FFFF as a pair of these.
"""

from __future__ import annotations


def escaped(text: str) -> str:
    """One line: every sign that is not printed as itself, line ends included, is escaped."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else escape(sign) for sign in text)


def escaped_lines(text: str, encoding: str | None = None) -> str:
    """Lines: as `escaped`, but line ends stay.

    With ``encoding`` signs that it does not have are escaped, too.
    """
    lines, encoding = "\n".join(map(escaped, text.split("\n"))), encoding or "utf-8"
    try:
        lines.encode(encoding)
    except UnicodeEncodeError:
        pass
    except LookupError:  # nobody knows that encoding
        encoding = "ascii"
    else:
        return lines
    return "".join(sign if sign.encode(encoding, "ignore") else escape(sign) for sign in lines)


def escape(sign: str) -> str:
    """``\\uXXXX`` of a sign, twice for one beyond U+FFFF."""
    units = sign.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[k]:02x}{units[k + 1]:02x}" for k in range(0, len(units), 2))
