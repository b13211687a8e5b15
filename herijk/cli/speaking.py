"""Click in Dutch and English: help, headings and errors in the language of this command.

Click looks its own texts up by gettext, in the same catalogue as ours. The language is that of
`--lang`, which every command has, or else that of the system.
"""

import gettext
import os
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Any, Final

import click

from pipeline.messages import CATALOGUES, DOMAIN, LANGUAGE, LANGUAGES, tell

HELP: Final = "Show this message and exit."

Sections = Mapping[str, Sequence[str]]
"""Names of commands under the heading below which the overview lists them."""


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


def speak(language: str) -> None:
    """From here on this process speaks a language, click too."""
    LANGUAGE.set(language)
    gettext.bindtextdomain(DOMAIN, CATALOGUES)
    gettext.textdomain(DOMAIN)
    os.environ["LANGUAGE"] = language  # where gettext looks first


def in_words(text: str | None) -> str:
    """A help text in the language of this command."""
    return tell(" ".join((text or "").split()))


def _in_words(parameter: click.Parameter, record: tuple[str, str] | None) -> tuple[str, str] | None:
    """A line of the help, which is a text of ours with what click adds in brackets."""
    if record is None or not parameter.help:
        return record
    return record[0], record[1].replace(parameter.help, in_words(parameter.help), 1)


class Option(click.Option):
    """An option whose help is in the language of this command."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Its names, and what it is."""
        return _in_words(self, super().get_help_record(ctx))


class Argument(click.Argument):
    """An argument whose help is in the language of this command."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str]:
        """Its name, and what it is."""
        return _in_words(self, super().get_help_record(ctx)) or ("", "")


option = partial(click.option, cls=Option, show_default=True)
flag = partial(click.option, cls=Option, is_flag=True)
argument = partial(click.argument, cls=Argument)


class Command(click.Command):
    """A command that takes `--lang`, and whose help is in the language asked for."""

    def __init__(self, *given: Any, **settings: Any) -> None:
        super().__init__(*given, **settings)
        self.params.append(
            Option(
                ["--lang"],
                type=click.Choice(LANGUAGES),
                expose_value=False,  # it was read before the command was
                help="Language. Default: that of the system.",
            )
        )

    def get_help_option(self, ctx: click.Context) -> click.Option | None:
        """The option `--help`."""
        shown = super().get_help_option(ctx)
        if shown is not None:
            shown.help = tell(HELP)
        return shown

    def format_help_text(
        self,
        ctx: click.Context,  # noqa: ARG002 - as click calls it
        formatter: click.HelpFormatter,
    ) -> None:
        """Writes what the command does."""
        formatter.write_paragraph()
        with formatter.indentation():
            formatter.write_text(in_words(self.help))


class Group(Command, click.Group):
    """A command with commands below it, listed in sections, each with its first sentence."""

    command_class = Command

    def __init__(self, *given: Any, sections: Sections | None = None, **settings: Any) -> None:
        super().__init__(*given, **settings)
        self.sections = sections

    def make_context(
        self,
        info_name: str | None,
        args: list[str],
        parent: click.Context | None = None,
        **extra: Any,
    ) -> click.Context:
        """Reads the arguments, from here on in the language that they ask for."""
        if parent is None:
            speak(language_of(args, os.environ))
        return super().make_context(info_name, args, parent, **extra)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the sections of the overview."""
        sections = self.sections or {gettext.gettext("Commands"): self.list_commands(ctx)}
        for heading, names in sections.items():
            with formatter.section(tell(heading)):
                formatter.write_dl(
                    [(name, _first_sentence(in_words(self.commands[name].help))) for name in names]
                )


def _first_sentence(text: str) -> str:
    return text.partition(". ")[0].removesuffix(".")
