"""The commands: how one is found, run, and what is said of mistakes in what follows its name.

A command is a function in a module of its own. Its arguments are typed
(`physim.cli.options`); its docstring is its help: one paragraph, what each option means, then exit
codes and examples as they are printed. Such a module imports what is heavy within its functions, so
that help comes at once.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from inspect import cleandoc, signature
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_type_hints

from physim.errors import PhysimError, nearest, plain_key

if TYPE_CHECKING:
    from cyclopts import App, Argument, ArgumentCollection, CycloptsError

GROUPS = {
    "run": {
        "list": ("listing:listing", "list worlds, controllers and other parts"),
        "run": ("run:run", "run a world; write record, video and summary"),
        "branch": ("branch:branch", "go on from a moment of a run with something changed"),
        "summary": ("listing:summary", "print contacts, distances and times of a record"),
        "plot": ("pictures:plot", "draw the figures of a record"),
        "video": ("pictures:video", "make a film or a still of one record, or of two"),
        "page": ("page:page", "show a run in a browser, and why robots decided"),
    },
    "judge": {
        "validate": ("validate:validate", "check a run: contacts, distances, responsibility"),
        "judge": ("judge:judge", "judge a log of real robots or of another simulator"),
        "check-controller": (
            "check_controller:check_controller",
            "check that a controller keeps the rules of every run",
        ),
        "crashtest": (
            "crashtest:crashtest", "compare engine and exact geometry on random shapes",
        ),
    },
    "author": {
        "new": ("new:new", "write a first world, with a comment on every key"),
        "import": ("importing:import_world", "make a world from a track, map, drawing or polygons"),
        "check": ("check:check", "find the faults of a world before you run it"),
        "preview": ("check:preview", "draw a world before you run it"),
        "schema": ("new:schema", "print the JSON Schema of world files, for editors"),
    },
    "study": {
        "sweep": ("sweep:sweep", "run many: worlds, seeds, settings, controllers"),
        "replay": ("replay:replay", "repeat one run of a sweep, with record and video"),
        "report": ("report:report", "report how often contacts happen, and the worst runs"),
        "compare": ("compare:compare", "compare A with B on the same seeds: which is better?"),
        "bear": ("bear:bear", "find how much noise, delay or loss a world can bear"),
        "falsify": ("falsify:falsify", "search for the worst case and reduce it"),
        "league": ("league:league", "let controllers compete in the same worlds; rank them"),
        "reproduce": ("reproduce:reproduce", "repeat the paper's experiments; compare the results"),
    },
}  # fmt: skip
"""By job, the commands in the order of the help: where each is defined, and what it is for."""
COMMANDS = {name: where for group in GROUPS.values() for name, (where, _) in group.items()}
HELP, VERSION = ("-h", "--help"), "--version"
INSTEAD = {
    ("import", "--untried"): "--no-run",
    ("new", "--from"): "--like WORLD --seed N",
    ("validate", "--seeds"): "physim sweep WORLD --seeds A:B --validate",
    ("compare", "--seeds"): "physim sweep, then physim compare DIR --by WHAT",
    ("branch", "--page"): "none: it always writes both.html",
}
"""Options that there were or that are looked for, and what does the same"""


def run_command(arguments: Sequence[str]) -> int:
    """Run the command that the arguments name; returns its exit code.

    Raises PhysimError, one line, for arguments that it does not take.
    """
    from physim.cli.help import overview, page

    name, *rest = arguments or HELP
    if name in HELP:
        print(overview(), end="")
        return 0
    if name == VERSION:
        from physim._version import version_told

        print(f"physim {version_told()}")
        return 0
    if name not in COMMANDS:
        raise PhysimError(f"{_unknown(name)} (see physim --help)")
    app = app_of(name)
    if not set(HELP).isdisjoint(rest):
        print(page(name, app), end="")
        return 0
    return _run(name, app, rest)


def app_of(name: str) -> App:
    """The command of this name, imported."""
    from cyclopts import App, Group, Parameter

    from physim.cli.options import Changes

    module, _, function = COMMANDS[name].partition(":")
    command = getattr(import_module(f"physim.cli.{module}"), function)
    for one in (command, Changes):
        tell_arguments(one)
    together = Group("Options", validator=check_keys)
    app = App(
        name=name, help_flags=(), version_flags=(), group_arguments=together,
        group_parameters=together, default_parameter=Parameter(negative=()),
    )  # fmt: skip
    app.default(command)
    return app


@cache
def tell_arguments(command: Any) -> None:
    """Put what the docstring of a command says of its arguments into their types, once."""
    from cyclopts import Parameter

    hints = get_type_hints(command, include_extras=True)
    places = [
        one.name for one in signature(command).parameters.values()
        if one.kind in (one.POSITIONAL_ONLY, one.VAR_POSITIONAL)
        and not any(getattr(more, "help", None) for more in get_args(hints[one.name]))
    ]  # fmt: skip
    for title, entries in tables(cleandoc(command.__doc__)):
        for left, text in entries:
            if title == "arguments":
                name, metavar = places.pop(0), left
            else:
                option, _, metavar = left.rpartition(", ")[2].partition(" ")
                name = option.lstrip("-").replace("-", "_")
                name = name if name in hints else f"{name}_"
            told: dict[str, Any] = {"help": text, "metavar": metavar or None}
            if title not in ("arguments", "options"):
                told["group"] = title.capitalize()
            command.__annotations__[name] = Annotated[hints[name], Parameter(**told)]


def tables(docstring: str) -> list[tuple[str, list[tuple[str, str]]]]:
    """Arguments and options as a docstring tells them: by title, what is typed and its help."""
    found = []
    for block in docstring.split("\n\n"):
        title, _, body = block.partition(":\n")
        if title == "arguments" or body.startswith("  -"):
            entries = re.split(r"^  (?=\S)", body, flags=re.MULTILINE)[1:]
            pairs = (entry.split("  ", 1) for entry in entries)
            found.append((title, [(left, " ".join(text.split())) for left, text in pairs]))
    return found


def _run(name: str, app: App, words: list[str]) -> int:
    from cyclopts import CycloptsError

    from physim.cli.output import json_alone

    try:
        function, bound, more = app.parse_args(words, exit_on_error=False, print_error=False)
    except CycloptsError as error:
        raise PhysimError(f"{_explained(name, error)} (see physim {name} --help)") from None
    given = bound.arguments
    try:
        with json_alone(given.get("json")) as out:
            kept = {"out": out} if "out" in more else {}
            return int(function(*bound.args, **bound.kwargs, **kept))
    except PhysimError as error:
        told = given.get("traceback", getattr(given.get("changes"), "traceback", False))
        if told and error.__cause__ is not None:
            traceback.print_exception(error.__cause__)
        raise


def check_keys(given: ArgumentCollection) -> None:
    """Raise ValueError for a key that has two values."""
    values = {one.names[-1]: [token.value for token in one.tokens] for one in given}
    keys = [plain_key(text) for text in values.get("--set", ())]
    for seed in ("--seed", "--seeds"):
        if values.get(seed) and "seed" in keys:
            raise ValueError(f"--set seed: is given twice, once by {seed}")
    if twice := next((key for key in keys if keys.count(key) > 1), None):
        raise ValueError(f"--set {twice}: is given twice")


def label(argument: Argument) -> str:
    """An option or argument as errors name it: ``-o/--output``, ``WORLD``."""
    if argument.index is None:
        return "/".join(argument.names)
    return (argument.parameter.metavar or argument.name).strip("[].")


def _unknown(name: str) -> str:
    """What is said of a word in the place of a command that is none."""
    from physim.cli.options import quoted

    word = quoted(name)
    if name.startswith("-"):
        close = nearest(name, [*HELP, VERSION])
        return f"{word}: is no option of physim itself; write physim COMMAND ... {word}{close}"
    close = nearest(name[:60], list(COMMANDS))
    return f"physim {word}: no such command; there are {', '.join(COMMANDS)}{close}"


def _explained(command: str, error: CycloptsError) -> str:
    """A mistake in the words of all errors: the option, what was given, what is allowed."""
    import cyclopts

    from physim.cli.options import one_of, quoted

    argument = error.argument
    if isinstance(error, cyclopts.UnknownOptionError):
        given = (error.token.keyword or error.token.value).partition("=")[0]
        known = [name for one in error.argument_collection if one.parse for name in one.names]
        close = nearest(given.strip("-"), [one[2:] for one in known if one.startswith("--")])
        close = close.replace('"', '"--', 1)
        if other := INSTEAD.get((command, given)):
            close = f"; take {other}"
        return f"{quoted(given)}: physim {command} has no such option{close}"
    if isinstance(error, cyclopts.RepeatArgumentError):
        return f"{error.token.keyword}: is given twice; it takes one value"
    if isinstance(error, cyclopts.UnusedCliTokensError):
        word = quoted((error.unused_tokens or [""])[0])
        return f"{word}: is one argument too many for physim {command}"
    if argument is None:  # of all of them together
        return getattr(error, "exception_message", "") or str(error)
    name, metavar = label(argument), argument.parameter.metavar
    choices = argument.get_choices(force=True)
    if isinstance(error, cyclopts.MissingArgumentError):
        if error.keyword is None:
            return f"physim {command}: {name} is missing"
        value = metavar or "|".join(choices or ())
        return f"{name}: its {value} is missing; {name} {value}: {argument.parameter.help}"
    token = getattr(error, "token", None) or next(iter(argument.tokens))
    if argument.is_flag():
        return f"{name}: takes no value; given {quoted(token.value)}"
    allowed = one_of(token.value, choices) if choices else getattr(error, "msg", None) or error
    return f"{name} {quoted(token.value)}: must be {allowed}"
