"""How the command line presents itself: its language, commands by what people do, and folders.

Where the folders are, in this order: the option, `HERIJK_ARCHIVE` and `HERIJK_DATA`, the nearest
`herijk.toml` in this folder or above, and for the data folder `data`. The language: `--lang`,
which every command has, and otherwise that of the system.
"""

import inspect
import os
import re
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

import typer
from typer._click import Context, HelpFormatter
from typer._click.exceptions import ClickException, NoArgsIsHelpError, UsageError
from typer.core import TyperGroup
from typer.main import get_command

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGE, LANGUAGES, say, tell
from pipeline.toml_text import decoded, parse_toml

if TYPE_CHECKING:
    from typer._click import Command
    from typer.core import TyperOption

FOLDERS_FILE: Final = "herijk.toml"
FOLDERS: Final = ("archive", "data")

SECTIONS: Final = {
    say("Begin"): ("init", "check", "rebuild", "simulate", "doctor"),
    say("Look"): ("audit", "register", "due", "pages", "log-error", "slides", "fit", "workbench"),
    say("Change the method"): ("methods", "rebase", "proposal"),
    say("Publish"): ("publish", "diff", "verify", "lineage", "certificate"),
    say("Run it as a service, use it in programs"): ("serve", "schema"),
}
OTHER: Final = say("More")


# Language


def language_of(arguments: Sequence[str], environment: Mapping[str, str]) -> str:
    """The language that `--lang` asks for, or else that of the system: `nl` or `en`."""
    after = pairwise(arguments)
    asked = [
        *(argument.partition("=")[2] for argument in arguments if argument.startswith("--lang=")),
        *(value for argument, value in after if argument == "--lang"),
    ]
    known = [language for language in asked if language in LANGUAGES]
    named = ("LC_ALL", "LC_MESSAGES", "LANG")
    system = next((environment[name] for name in named if environment.get(name)), "")
    return known[-1] if known else "nl" if system.casefold().startswith("nl") else "en"


def _lang(
    lang: Annotated[
        Literal["nl", "en"] | None,
        typer.Option("--lang", help="Language. Default: that of the system.", expose_value=False),
    ] = None,
) -> None:
    """Carries the option that every command has."""


def _lang_option() -> "TyperOption":
    carrier = typer.Typer(add_completion=False)
    carrier.command()(_lang)
    (option,) = get_command(carrier).params
    return option  # type: ignore[return-value]


class SpokenHelp(HelpFormatter):
    """Writes help in the language of this command."""

    def write_usage(self, prog: str, args: str = "", prefix: str | None = None) -> None:
        """Writes how the command is called."""
        super().write_usage(prog, args, prefix or tell("Usage: "))

    def write_heading(self, heading: str) -> None:
        """Writes the title of a section."""
        super().write_heading(tell(heading))

    def write_text(self, text: str) -> None:
        """Writes a paragraph."""
        super().write_text(_help_in_words(text))

    def write_dl(self, rows: Sequence[tuple[str, str]], *args: Any, **named: Any) -> None:
        """Writes commands or options, each with its text."""
        super().write_dl([(name, _help_in_words(text)) for name, text in rows], *args, **named)


class SpokenContext(Context):
    """The context of a command whose help is in its language."""

    formatter_class = SpokenHelp


def _help_in_words(text: str) -> str:
    """A text of the help, and the brackets behind it: a default, `required`."""
    said, bracket, note = " ".join(text.split(" ")).partition("  [")
    for word in (say("default"), say("required"), "env var") if bracket else ():
        note = note.replace(word, tell(word))
    return tell(" ".join(said.split())) + bracket + note


USAGE: Final = (
    say("Missing option {}."),
    say("Missing argument {}."),
    say("Missing command."),
    say("No such option: {} (Possible options: {})"),
    say("No such command {}. Did you mean {}?"),
    say("No such option: {}"),
    say("No such command {}."),
    say("Got unexpected extra argument(s) ({})"),
    say("Option {} requires an argument."),
    say("Invalid value for {}: {}"),
    say("Invalid value: {}"),
    say("{} is not one of {}."),
)
"""What the library that reads arguments says of them; braces stand for what is in its place."""


def _usage_in_words(error: ClickException) -> str:
    """What is wrong with the arguments."""
    own: dict[str, str] = {str(error.message): tell(str(error.message))}

    def in_words(said: str) -> str:
        for text in USAGE:
            match = re.fullmatch(re.escape(text).replace(r"\{\}", "(.*?)"), said, re.DOTALL)
            if match:
                return tell(text, *map(in_words, match.groups()))
        return own.get(said, said.replace("env var", tell("env var")))

    return in_words(error.format_message().replace("Value error, ", ""))


def _show_usage(error: ClickException) -> None:
    """Says what is wrong with the arguments, and where help is; or gives the help itself."""
    if isinstance(error, NoArgsIsHelpError):
        error.show()
        return
    if isinstance(error, UsageError) and error.ctx is not None:
        typer.echo(error.ctx.get_usage(), err=True)
        typer.echo(tell("Try '{} --help' for help.", error.ctx.command_path) + "\n", err=True)
    typer.echo(tell("Error: {}", _usage_in_words(error)), err=True)


def _first_sentence(text: str) -> str:
    return text.partition(". ")[0].removesuffix(".")


class Overview(TyperGroup):
    """Lists commands in sections, each with its whole first sentence; speaks Dutch and English."""

    context_class = SpokenContext

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        lang = _lang_option()
        others = (c for c in self.commands.values() if not isinstance(c, Overview))  # they did so
        for command in (self, *others):
            command.context_class = SpokenContext
            command.params.append(lang)

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Runs the command in the language that is asked for."""
        LANGUAGE.set(language_of(sys.argv[1:] if args is None else list(args), os.environ))
        run = partial(
            super().main, args, prog_name, complete_var, False, windows_expand_args, **extra
        )
        if not standalone_mode:
            return run()
        try:
            sys.exit(run() or 0)
        except ClickException as error:
            _show_usage(error)
            sys.exit(error.exit_code)

    def format_commands(self, ctx: "Context", formatter: "HelpFormatter") -> None:
        """Writes the sections of the overview."""
        listed = {name for names in SECTIONS.values() for name in names}
        rest = tuple(name for name in self.list_commands(ctx) if name not in listed)
        for title, names in {**SECTIONS, OTHER: rest}.items():
            commands = ((name, self.get_command(ctx, name)) for name in names)
            rows = [
                (name, _first_sentence(tell(inspect.cleandoc(command_of.help or ""))))
                for name, command_of in commands
                if command_of
            ]
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)


def defaults_of(command: "Command", folders: Mapping[str, str]) -> dict[str, Any]:
    """The folders as defaults of a command and of all that are below it."""
    below = command.commands.items() if isinstance(command, TyperGroup) else ()
    return {**folders, **{name: defaults_of(inner, folders) for name, inner in below}}


def folders_here(start: Path) -> dict[str, str]:
    """The folders that the nearest `herijk.toml` names, as paths; none where there is no such file.

    Args:
        start: the folder in which the search upwards begins.

    Raises:
        MissingKnowledgeError: the file cannot be understood.
    """
    for folder in (start, *start.parents):
        file = folder / FOLDERS_FILE
        if file.is_file():
            return {key: str(folder / value) for key, value in _read(file).items()}
    return {}


def _read(file: Path) -> dict[str, Any]:
    try:
        settings = parse_toml(decoded(file.read_bytes()))
    except (ValueError, OSError) as error:
        raise MissingKnowledgeError("{} cannot be read: {}", file, error) from error
    wrong = [k for k, value in settings.items() if k not in FOLDERS or not isinstance(value, str)]
    if wrong:
        raise MissingKnowledgeError(
            '{}: {!r}: it may hold archive = "folder" and data = "folder"', file, wrong[0]
        )
    return settings
