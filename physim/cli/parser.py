"""The commands: how they are declared, their help, and mistakes in what follows their names.

A command stands in a module of its own, arguments and code together. Its docstring is its help: one
paragraph, then exit codes and examples as they are printed. Such a module imports what is heavy
within its functions, so that help comes at once.
"""

from __future__ import annotations

import inspect
import re
import traceback
from collections.abc import Callable, Sequence
from importlib import import_module
from types import SimpleNamespace
from typing import Any, TypeVar

import click

from physim.cli.output import output_of
from physim.cli.values import LONGEST_QUOTE, WHOLE, quoted
from physim.errors import PhysimError, nearest, plain_key

GROUPS = {
    "run": {
        "list": "physim.cli.listing:listing",
        "run": "physim.cli.run:run",
        "summary": "physim.cli.listing:summary",
        "plot": "physim.cli.pictures:plot",
        "video": "physim.cli.pictures:video",
        "page": "physim.cli.page:page",
    },
    "judge": {
        "validate": "physim.cli.validate:validate_command",
        "check-controller": "physim.cli.check_controller:check_controller_command",
        "crashtest": "physim.cli.crashtest:crashtest",
    },
    "author": {
        "new": "physim.cli.new:new",
        "import": "physim.cli.importing:import_command",
        "check": "physim.cli.check:check_command",
        "preview": "physim.cli.check:preview",
        "schema": "physim.cli.new:schema",
    },
    "study": {
        "sweep": "physim.cli.sweep:sweep",
        "replay": "physim.cli.replay:replay",
        "report": "physim.cli.report:report",
        "compare": "physim.cli.compare:compare",
        "falsify": "physim.cli.falsify:falsify",
        "reproduce": "physim.cli.reproduce:reproduce",
    },
}
"""By job, the commands in the order of the help: where each is defined."""
COMMANDS = {name: where for group in GROUPS.values() for name, where in group.items()}

HEAD = "Usage: physim [-h] [--version] COMMAND ...  Run polygon robots; judge the runs.\n"
TAIL = """\
exit: 0 success, 1 contact, 2 bad input, 3 disagreement, 70 bug, 130 interrupted
To begin: physim run three_robots. A command explained: physim COMMAND --help
"""

Options = SimpleNamespace
"""The options and arguments of a command, by name."""
Action = TypeVar("Action", bound=Callable[..., Any])


class Option(click.Option):
    """Option that may stand in a section of the help; it takes no other option for its value."""

    def __init__(self, *names: Any, section: str = "Options", **attributes: Any) -> None:
        super().__init__(*names, **attributes)
        self.section = section

    def type_cast_value(self, ctx: click.Context, value: Any) -> Any:
        """Read the value; raises UsageError where another option stands in its place."""
        known = _options(ctx)
        for given in value if self.multiple else (value,):
            if isinstance(given, str) and given.partition("=")[0] in known:
                raise click.BadOptionUsage(self.opts[0], "", ctx)
        return super().type_cast_value(ctx, value)


class Command(click.Command):
    """A command that returns its exit code; its mistakes are one line each."""

    allow_extra_args = True  # to name the first of them

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments. Raises UsageError in the words of all errors."""
        args = _joined(args, _options(ctx))
        try:
            self._check_repeated(ctx, args)
            rest = super().parse_args(ctx, list(args))
        except click.NoSuchOption as error:
            name = error.option_name
            meant = [option for option in _options(ctx) if option.startswith(name)]
            if len(meant) != 1:
                raise _explained(error, ctx, args) from None
            words = (word.partition("=") for word in args)
            whole = [(meant[0] if word == name else word) + eq + value for word, eq, value in words]
            return self.parse_args(ctx, whole)
        except click.UsageError as error:
            raise _explained(error, ctx, args) from None
        if rest:
            takes = " and ".join(_name(p) for p in self.params if isinstance(p, click.Argument))
            raise click.UsageError(
                f"{quoted(rest[0])}: is one argument too many; {ctx.command_path} takes "
                f"{takes or 'options'} only", ctx,
            )  # fmt: skip
        return rest

    def _check_repeated(self, ctx: click.Context, args: list[str]) -> None:
        """Raise UsageError for an option or key with two values, of which one would be dropped."""
        values, _, order = self.make_parser(ctx).parse_args(list(args))
        for k, one in enumerate(order):
            may_repeat = not isinstance(one, click.Option) or one.multiple or one.is_flag
            if not may_repeat and one in order[:k]:
                raise click.UsageError(f"{one.opts[-1]}: is given twice; it takes one value", ctx)
        by = [name for name in ("seed", "seeds") if name in values][:1]
        keys = ["seed" for _ in by] + [plain_key(text) for text in values.get("overrides") or ()]
        if twice := next((key for key in keys if keys.count(key) > 1), None):
            also = f", once by --{by[0]}" if twice == "seed" and by else ""
            raise click.UsageError(f"--set {quoted(twice)}: is given twice{also}", ctx)

    def invoke(self, ctx: click.Context) -> Any:
        """Do what the command is for; returns the exit code."""
        try:
            with output_of(ctx.params.get("json")) as out:
                return self.callback(Options(**ctx.params, stdout=out)) if self.callback else 0
        except PhysimError as error:
            if ctx.params.get("traceback") and error.__cause__ is not None:
                traceback.print_exception(error.__cause__)
            raise

    def format_help_text(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the first paragraph of the docstring."""
        formatter.write_paragraph()
        formatter.write_text(inspect.cleandoc(self.help or "").partition("\n\n")[0])

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options by sections."""
        sections: dict[str, list[tuple[str, str]]] = {}
        for param in self.get_params(ctx):
            if isinstance(param, click.Option) and (record := param.get_help_record(ctx)):
                sections.setdefault(getattr(param, "section", "Options"), []).append(record)
        for title, records in sections.items():
            with formatter.section(title):
                formatter.write_dl(records)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the rest of the docstring as it stands."""
        formatter.write(f"\n{inspect.cleandoc(self.help or '').partition(chr(10) * 2)[2]}\n")


class Commands(click.Group):
    """All commands, each imported when it is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All names, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command."""
        if cmd_name not in COMMANDS:
            return None
        module, _, name = COMMANDS[cmd_name].partition(":")
        found: click.Command = getattr(import_module(module), name)
        return found

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that is named. Raises UsageError with all that there are."""
        if args[0] not in COMMANDS:
            raise click.UsageError(
                f"physim {quoted(args[0])}: no such command; there are {', '.join(COMMANDS)}"
                f"{nearest(args[0][:LONGEST_QUOTE], list(COMMANDS))}", ctx,
            )  # fmt: skip
        return super().resolve_command(ctx, args)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read what stands before the command. Raises UsageError for all but its own."""
        try:
            return super().parse_args(ctx, list(args))
        except click.NoSuchOption as error:
            made = filter(None, (self.get_command(ctx, name) for name in COMMANDS))
            if not any(error.option_name in one.opts for each in made for one in each.params):
                raise _explained(error, ctx, args) from None
            option = quoted(error.option_name)
            why = f"stands before the command; write physim COMMAND ... {option}"
            raise click.UsageError(f"{option}: {why}", ctx) from None
        except click.UsageError as error:
            raise _explained(error, ctx, args) from None

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands by groups, on one screen."""
        formatter.write(HEAD)
        for title, group in GROUPS.items():
            for name in group:
                found = self.get_command(ctx, name)
                formatter.write(f"{title:<8}{name:<18}{found.short_help if found else ''}\n")
                title = ""
        formatter.write(TAIL)


@click.group(
    "physim",
    cls=Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.option("--version", is_flag=True, help="print the version")
@click.pass_context
def commands(ctx: click.Context, version: bool) -> None:
    """All commands of physim."""
    if version:
        from physim._version import __version__

        click.echo(f"physim {__version__}")
        ctx.exit()
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


def run_command(arguments: Sequence[str]) -> int:
    """Run the command that the arguments name; returns its exit code.

    Raises PhysimError, one line, for arguments that it does not take.
    """
    try:
        with commands.make_context("physim", list(arguments)) as ctx:
            return int(commands.invoke(ctx) or 0)
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.UsageError as error:
        path = error.ctx.command_path if error.ctx is not None else "physim"
        raise PhysimError(f"{error.message} (see {path} --help)") from None


def command(name: str, summary: str) -> Callable[[Callable[[Options], int]], Command]:
    """Make a command of a function, whose docstring is the help; ``summary`` is its line in it."""
    return click.command(name, cls=Command, short_help=summary)


def option(*names: str, **attributes: Any) -> Callable[[Action], Action]:
    """Add an option, as `click.option`; ``section`` names its section of the help."""
    return click.option(*names, cls=Option, **attributes)


def flag(name: str, text: str, **attributes: Any) -> Callable[[Action], Action]:
    """Add an option without a value; ``section`` as for `option`."""
    return option(name, is_flag=True, help=text, **attributes)


def changes(each: str = "the world") -> Callable[[Action], Action]:
    """Add the options that change a world before it is run: seed, controller and values."""

    def add(action: Action) -> Action:
        action = option(
            "--set", "overrides", multiple=True, metavar="KEY=VALUE",
            help=f"change one value of {each}, e.g. robots.0.limits.v=1.2, or leave one out, e.g. "
            "formation=null (may be repeated)",
        )(action)  # fmt: skip
        text = "show where code of your own failed, with all calls that led there"
        action = flag("--traceback", text)(action)
        text = "a registered controller (physim list) or your own as module:Class"
        action = option("--controller", metavar="NAME", help=text)(action)
        text = "seed, instead of the world's own"
        return option("--seed", type=WHOLE, metavar="N", help=text)(action)

    return add


def _explained(error: click.UsageError, ctx: click.Context, args: list[str]) -> click.UsageError:
    """The same mistake in one line: the option, what was given, what is allowed."""
    text = error.message
    if isinstance(error, click.NoSuchOption):
        text = _unknown(error.option_name, ctx)
    elif isinstance(error, click.BadOptionUsage):
        text = _misused(error.option_name, ctx, args)
    elif isinstance(error, click.MissingParameter):
        text = f"{ctx.command_path}: {_missing(ctx, args)}"
    elif isinstance(error, click.BadParameter) and error.param is not None:
        text = f"{_name(error.param)} {error.message}"
    return click.UsageError(text, ctx)


def _unknown(name: str, ctx: click.Context) -> str:
    """An option that a command does not have, or the beginning of several."""
    known = _options(ctx)
    if meant := [option for option in known if option.startswith(name)]:
        return f"{name}: may be {' or '.join(meant)}; write it out in full"
    words = {option.strip("-"): option for option in sorted(known)}
    close = nearest(name.strip("-")[:LONGEST_QUOTE], list(words))
    for word, written in words.items():
        close = close.replace(f'"{word}"', f'"{written}"')
    return f"{quoted(name)}: {ctx.command_path} has no such option{close}"


def _misused(name: str, ctx: click.Context, args: list[str]) -> str:
    """A flag with a value, or an option without one."""
    option = _options(ctx)[name]
    if option.is_flag:
        given = next(word for word in args if word.startswith(f"{name}="))
        return f"{name}: takes no value; given {quoted(given.partition('=')[2])}"
    name = _name(option)
    if isinstance(option.type, click.Choice):
        return f"{name}: its value is missing; must be one of {', '.join(option.type.choices)}"
    return f"{name}: its {option.metavar} is missing; {name} {option.metavar}: {option.help}"


def _missing(ctx: click.Context, args: list[str]) -> str:
    """All that is required and was not given."""
    ctx.resilient_parsing = True  # goes on to the end
    click.Command.parse_args(ctx.command, ctx, list(args))
    names = [
        _name(param) for param in ctx.command.params
        if param.required and ctx.params.get(param.name or "") in (None, ())
    ]  # fmt: skip
    return f"{' and '.join(names)} {'is' if len(names) == 1 else 'are'} missing"


def _joined(args: list[str], options: dict[str, click.Option]) -> list[str]:
    """Arguments in which ``--from -2,1`` is ``--from=-2,1``: a negative number is no option."""
    joined: list[str] = []
    for k, word in enumerate(args):
        if word == "--":
            return joined + args[k:]
        option = options.get(joined[-1]) if joined else None
        takes = option is not None and not option.is_flag and joined[-1].startswith("--")
        if takes and re.match(r"-\.?\d", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _options(ctx: click.Context) -> dict[str, click.Option]:
    """Every option of a command by its names."""
    params = ctx.command.get_params(ctx)
    return {name: p for p in params if isinstance(p, click.Option) for name in p.opts}


def _name(param: click.Parameter) -> str:
    """A parameter as errors name it: ``-o/--output``, ``WORLD``."""
    if isinstance(param, click.Option):
        return "/".join(param.opts)
    return param.human_readable_name.strip("[].")
