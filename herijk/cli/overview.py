"""How the command line presents itself: commands by what people do, and folders from settings.

Where the folders are, in this order: the option, `HERIJK_ARCHIVE` and `HERIJK_DATA`, the nearest
`herijk.toml` in this folder or above, and for the data folder `data`.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from typer.core import TyperGroup

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.toml_text import parse_toml

if TYPE_CHECKING:
    from typer._click import Command, Context, HelpFormatter

FOLDERS_FILE: Final = "herijk.toml"
FOLDERS: Final = ("archive", "data")

SECTIONS: Final = {
    "Begin": ("init", "check", "rebuild", "simulate", "doctor"),
    "Look": ("audit", "register", "due", "pages", "log-error", "slides", "fit", "workbench"),
    "Change the method": ("methods", "rebase", "proposal"),
    "Publish": ("publish", "diff", "verify", "lineage", "certificate"),
    "Run it as a service, use it in programs": ("serve", "schema"),
}
OTHER: Final = "More"


class Overview(TyperGroup):
    """Lists commands in sections, each with its whole first sentence."""

    def format_commands(self, ctx: "Context", formatter: "HelpFormatter") -> None:
        """Writes the sections of the overview."""
        listed = {name for names in SECTIONS.values() for name in names}
        rest = tuple(name for name in self.list_commands(ctx) if name not in listed)
        for title, names in {**SECTIONS, OTHER: rest}.items():
            commands = ((name, self.get_command(ctx, name)) for name in names)
            rows = [
                (name, command_of.get_short_help_str(500))
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
        settings = parse_toml(file.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise MissingKnowledgeError(f"{file} cannot be read: {error}") from error
    wrong = [k for k, value in settings.items() if k not in FOLDERS or not isinstance(value, str)]
    if wrong:
        raise MissingKnowledgeError(
            f'{file}: {wrong[0]!r}: it may hold archive = "folder" and data = "folder"'
        )
    return settings
