"""Mistakes on the command line, told as all errors are: where, what was given, what is allowed."""

from __future__ import annotations

import argparse
import re
import sys
from typing import NoReturn

MOST_SHOWN = 60
"""Characters of what was given that are shown."""


def refuse(message: str, prog: str) -> NoReturn:
    """Tell a mistake in one line, with the way to the help, and exit with 2."""
    print(f"{message} (see {prog} --help)", file=sys.stderr)
    sys.exit(2)


def told(message: str, parser: argparse.ArgumentParser) -> str:
    """An error of `argparse` in the words of this program, see `physim.cli.arguments.types`."""
    for pattern, words in (
        (r"argument (\S+): expected .*argument.*", _without_value),
        (r"argument (.+?): invalid choice: (.+) \(choose from .*", _no_choice),
        (r"argument (\S+): not allowed with argument (\S+)", _not_together),
        (r"argument (\S+): ignored explicit argument (.+)", _needless_value),
        (r"argument (\S+): (.*)", _bad_value),
        (r"ambiguous option: (\S+) could match (.+)", _ambiguous),
        (r"the following arguments are required: (.+)", _missing),
    ):
        if found := re.fullmatch(pattern, message, re.DOTALL):
            return words(parser, *found.groups())
    return f"{parser.prog}: {message}"


def unknown(extra: list[str], parser: argparse.ArgumentParser) -> str:
    """What to say of arguments that a command does not take."""
    from physim.errors import nearest

    option = next((word for word in extra if word.startswith("-")), None)
    if option is not None:
        option = option.partition("=")[0]
        words = {one.strip("-"): one for one in sorted(options_of(parser))}
        close = nearest(option.strip("-")[:MOST_SHOWN], list(words))
        for word, one in words.items():
            close = close.replace(f'"{word}"', f'"{one}"')
        return f"{shown(option)}: {parser.prog} has no such option{close}"
    takes = [str(a.metavar or a.dest) for a in parser._actions if not a.option_strings]
    named = f"takes {' and '.join(takes)} alone" if takes else "takes options alone"
    return f"{shown(extra[0])}: is one too many; {parser.prog} {named}"


def options_of(parser: argparse.ArgumentParser) -> set[str]:
    """Every option of a parser itself."""
    return {option for action in parser._actions for option in action.option_strings}


def shown(text: str) -> str:
    """What was given, in quotes where it would not be seen as one word."""
    text = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
    text = text if len(text) <= MOST_SHOWN else text[: MOST_SHOWN - 1] + "…"
    return text if text and re.fullmatch(r"[^\s\"']+", text) else f'"{text}"'


def _action(parser: argparse.ArgumentParser, name: str) -> argparse.Action | None:
    """The argument that argparse calls so in its messages."""
    for action in parser._actions:
        if name in ("/".join(action.option_strings), action.metavar, action.dest):
            return action
    return None


def _without_value(parser: argparse.ArgumentParser, name: str) -> str:
    action = _action(parser, name)
    if action is None or action.metavar is None:
        listed = ", ".join(map(str, (action.choices if action is not None else None) or ()))
        return f"{name}: its value is missing; must be one of {listed}"
    return f"{name}: its {action.metavar} is missing; {name} {action.metavar}: {action.help}"


def _no_choice(parser: argparse.ArgumentParser, name: str, given: str) -> str:
    from physim.errors import nearest

    action, given = _action(parser, name), given.strip("'\"")
    choices = [str(choice) for choice in (action.choices if action is not None else None) or ()]
    close = nearest(given[:MOST_SHOWN], choices)
    if isinstance(action, argparse._SubParsersAction):
        return (
            f"{parser.prog} {shown(given)}: no such command; there are {', '.join(choices)}{close}"
        )
    return f"{name} {shown(given)}: must be one of {', '.join(choices)}{close}"


def _not_together(parser: argparse.ArgumentParser, name: str, other: str) -> str:
    return f"{name}: does not go together with {other}"


def _needless_value(parser: argparse.ArgumentParser, name: str, given: str) -> str:
    return f"{name}: takes no value; given {shown(given.strip(chr(39)))}"


def _bad_value(parser: argparse.ArgumentParser, name: str, message: str) -> str:
    """The types of `physim.cli.arguments.types` say ``GIVEN: must be ALLOWED``."""
    return f"{name} {message}"


def _ambiguous(parser: argparse.ArgumentParser, name: str, options: str) -> str:
    return f"{name}: may be any of {options}; write it out"


def _missing(parser: argparse.ArgumentParser, names: str) -> str:
    listed = names.split(", ")
    return f"{parser.prog}: {' and '.join(listed)} {'is' if len(listed) == 1 else 'are'} missing"
