"""Click in Dutch and English: help, headings and errors in the language of this command.

Click looks its own texts up by gettext, in the same catalogue as ours. The language is that of
`--lang`, which every command has, or else that of the system.
"""

import gettext
import os
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final

import click

from pipeline.messages import CATALOGUES, DOMAIN, LANGUAGE, LANGUAGES, Sentence, say, tell

HELP: Final = "Show this message and exit."
EXAMPLES: Final = say("Examples")


def find_language(arguments: Sequence[str], environment: Mapping[str, str]) -> str:
    """Return the language that `--lang` asks for, or else that of the system: `nl` or `en`."""
    get = environment.get
    system = get("LC_ALL") or get("LC_MESSAGES") or get("LANG") or ""
    language = "nl" if system.casefold().startswith("nl") else "en"
    for place, argument in enumerate(arguments):
        name, _, value = argument.partition("=")
        if argument == "--lang" and place + 1 < len(arguments):
            value = arguments[place + 1]
        if name == "--lang" and value in LANGUAGES:
            language = value
    return language


def speak(language: str) -> None:
    """From here on this process speaks a language, click too."""
    LANGUAGE.set(language)
    gettext.bindtextdomain(DOMAIN, CATALOGUES)
    gettext.textdomain(DOMAIN)
    os.environ["LANGUAGE"] = language  # where gettext looks first


def translate_help(command: click.Command) -> None:
    """Put what a command, its parameters and the commands below it say of themselves in words."""
    described: Any
    for described in (command, *command.params):
        described.english = getattr(described, "english", " ".join((described.help or "").split()))
        described.help = tell(described.english)
    if shown := command.get_help_option(click.Context(command)):
        shown.help = tell(HELP)
    for inner in getattr(command, "commands", {}).values():
        translate_help(inner)


option = partial(click.option, show_default=True)
flag = partial(click.option, is_flag=True)
argument = click.argument


class Command(click.Command):
    """A command that takes `--lang`, and whose help ends with examples."""

    def __init__(self, *given: Any, examples: Sequence[str] = (), **settings: Any) -> None:
        super().__init__(*given, **settings)
        self.examples = examples
        self.params.append(
            click.Option(
                ["--lang"],
                type=click.Choice(LANGUAGES),
                expose_value=False,  # it was read before the command was
                help="Language. Default: that of the system.",
            )
        )

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples."""
        super().format_epilog(ctx, formatter)
        if self.examples:
            with formatter.section(tell(EXAMPLES)), formatter.indentation():
                formatter.write("".join(f"  {example}\n" for example in self.examples))


class Group(Command, click.Group):
    """A command with commands below it, listed in sections, each with its first sentence."""

    command_class = Command

    def __init__(self, *given: Any, **settings: Any) -> None:
        super().__init__(*given, **settings)
        self.sections: dict[str, list[str]] = {}

    def add_section(self, heading: Sentence, *commands: click.Command) -> None:
        """Add commands below a heading of the overview."""
        for command in commands:
            self.add_command(command)
        self.sections[heading] = [command.name or "" for command in commands]

    def make_context(
        self,
        info_name: str | None,
        args: list[str],
        parent: click.Context | None = None,
        **extra: Any,
    ) -> click.Context:
        """Read the arguments, from here on in the language that they ask for."""
        if parent is None:
            speak(find_language(args, os.environ))
            translate_help(self)
        return super().make_context(info_name, args, parent, **extra)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the sections of the overview."""
        sections = self.sections or {gettext.gettext("Commands"): self.list_commands(ctx)}
        for heading, names in sections.items():
            with formatter.section(tell(heading)):
                rows = []
                for name in names:
                    text = self.commands[name].help or ""
                    rows.append((name, text.partition(". ")[0].removesuffix(".")))
                formatter.write_dl(rows)
