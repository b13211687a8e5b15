"""The commands about an archive that come before a rebuild: `check` and `init`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from herijk.cli.arguments import AsJson, show, show_files
from herijk.cli.text import place
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from warehouse.archive.check import CauseReport, CheckReport


def check(
    archive: Annotated[
        Path,
        typer.Argument(metavar="ARCHIVE", envvar="HERIJK_ARCHIVE", help="The archive folder."),
    ],
    as_json: AsJson = False,
) -> None:
    """Every fault of lists, headers and a sample of the data, by cause, before any rebuild."""
    from warehouse.archive.check import check_archive, check_report

    checked = check_archive(archive)
    show(check_report(archive, checked, LANGUAGE.get()), check_text, as_json)
    if checked.causes:
        raise typer.Exit(1)


def init(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to make.")],
    as_json: AsJson = False,
) -> None:
    """An empty archive with examples, spreadsheets to fill in, and a page that explains it."""
    from warehouse.archive.files.empty_archive import write_templates

    try:
        write_templates(directory)
    except OSError as error:
        raise MissingKnowledgeError(
            "no archive can be made in {}: {}. Name another folder", directory, error.strerror
        ) from error
    files = sorted(file for file in directory.rglob("*") if file.is_file())
    said = tell("An empty archive is in {}; begin with LEESMIJ.md.", directory)
    show_files(files, as_json, said)


def check_text(report: "CheckReport") -> str:
    """A check in words: a paragraph per cause."""
    causes = report.causes
    if not causes:
        return tell("Nothing is wrong in the lists and headers of {} tows.", report.tows)
    head = tell(
        "Causes: {}; places: {}. As it is, {} tows are left for a rebuild to judge.",
        len(causes),
        sum(cause.number for cause in causes),
        report.tows,
    )
    return "\n\n".join([head, *(_cause(cause) for cause in causes)])


def _cause(cause: "CauseReport") -> str:
    lines = [f"{cause.number} x {cause.reason_code}: {cause.sentence}"]
    if len(cause.cells) > 1:
        cells = ", ".join(f"'{cell}'" for cell in cause.cells[1:9])
        lines.append(f"    {tell('There is also: {}', cells)}")
    lines += [f"    {place(vars(one))}" for one in cause.places]
    if cause.number > len(cause.places):
        lines.append(f"    {tell('and {} more', cause.number - len(cause.places))}")
    lines += [f"  > archief.toml: {line}" for line in cause.settings]
    return "\n".join(lines)
