"""The commands about an archive that come before a rebuild: `check` and `init`."""

import os
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import typer

from herijk.cli.arguments import AsJson, show, show_files

Language = Annotated[
    Literal["nl", "en"] | None,
    typer.Option("--lang", help="Language of the messages. Default: that of the system."),
]
Report = dict[str, Any]

TEXTS: Final = {
    "sound": ("Er is niets mis: {tows} sleepproeven kunnen gelezen worden.",
              "Nothing is wrong: {tows} tows can be read."),
    "causes": ("{causes} oorzaken, {faults} plaatsen. Met wat hieronder wordt voorgesteld kunnen "
               "{tows} sleepproeven gelezen worden.",
               "{causes} causes, {faults} places. With what is proposed below {tows} tows can be "
               "read."),
    "line": ("regel", "line"),
    "more": ("en nog {number}", "and {number} more"),
    "cells": ("Er staat ook: {cells}", "There is also: {cells}"),
    "put": ("Zet in archief.toml", "Put into archief.toml"),
    "ask": ("Kies en zet in archief.toml", "Choose, and put into archief.toml"),
    "write": ("Schrijf het voorstel met: herijk check {archive} --write-profile",
              "Write what is proposed with: herijk check {archive} --write-profile"),
    "written": ("Het voorstel staat in {path}; lees het na, ook de regels achter een #.",
                "What is proposed is in {path}; read it, also the lines behind a #."),
    "made": ("Een leeg archief staat in {path}; begin met LEESMIJ.md.",
             "An empty archive is in {path}; begin with LEESMIJ.md."),
}  # fmt: skip
"""Dutch and English."""


def language(chosen: str | None) -> str:
    """Return the language asked for, or that of the system: `nl` or `en`."""
    spoken = os.environ.get("LC_ALL") or os.environ.get("LC_MESSAGES") or os.environ.get("LANG", "")
    return chosen or ("nl" if spoken.casefold().startswith("nl") else "en")


def say(name: str, lang: str, **values: Any) -> str:
    """Return a text of this command line in a language."""
    return TEXTS[name][0 if lang == "nl" else 1].format(**values)


def check(
    archive: Annotated[Path, typer.Argument(metavar="ARCHIVE", help="The archive folder.")],
    write_profile: Annotated[
        bool, typer.Option("--write-profile", help="Write what is proposed to archief.toml.")
    ] = False,
    lang: Language = None,
    as_json: AsJson = False,
) -> None:
    """Every fault of lists, headers and a sample of the data, by cause, before any rebuild."""
    from herijk.warehouse.archive.check import as_report, check_archive
    from herijk.warehouse.archive.files import PROFILE_FILE

    spoken = language(lang)
    checked = check_archive(archive)
    report = as_report(checked, spoken) | {"archive": str(archive)}
    show(report, lambda found: check_text(found, spoken), as_json)
    if write_profile and checked.profile is not None:
        from herijk.warehouse.store.files import written_beside

        path = archive / PROFILE_FILE
        with written_beside(path) as beside:
            beside.write_text(checked.profile, encoding="utf-8")
        typer.echo(say("written", spoken, path=path), err=True)
    if checked.causes:
        raise typer.Exit(1)


def init(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to make.")],
    lang: Language = None,
    as_json: AsJson = False,
) -> None:
    """An empty archive with examples, spreadsheets to fill in, and a page that explains it."""
    from herijk.warehouse.archive.templates import write_templates

    write_templates(directory)
    files = sorted(file for file in directory.rglob("*") if file.is_file())
    show_files(files, as_json, say("made", language(lang), path=directory))


def check_text(report: Report, lang: str) -> str:
    """A check in words: a paragraph per cause."""
    causes = report["causes"]
    if not causes:
        return say("sound", lang, tows=report["tows"])
    faults = sum(cause["number"] for cause in causes)
    head = say("causes", lang, causes=len(causes), faults=faults, tows=report["tows"])
    parts = [head, *(_cause(cause, lang) for cause in causes)]
    if report["profile"] is not None:
        parts.append(say("write", lang, archive=report["archive"]))
    return "\n\n".join(parts)


def _cause(cause: Report, lang: str) -> str:
    lines = [f"{cause['number']} x {cause['reason_code']}: {cause['sentence']}"]
    if len(cause["cells"]) > 1:
        cells = ", ".join(f"'{cell}'" for cell in cause["cells"][1:9])
        lines.append(f"    {say('cells', lang, cells=cells)}")
    lines += [f"    {_place(place, lang)}" for place in cause["places"]]
    if cause["number"] > len(cause["places"]):
        lines.append(f"    {say('more', lang, number=cause['number'] - len(cause['places']))}")
    for proposal in cause["proposals"]:
        how = say("put" if proposal["is_active"] else "ask", lang)
        lines.append(f"  > {how}: {proposal['line']}")
    return "\n".join(lines)


def _place(place: Report, lang: str) -> str:
    line = "" if place["line"] is None else f", {say('line', lang)} {place['line']}"
    tow = "" if place["tow_id"] is None else f" ({place['tow_id']})"
    return f"{place['path']}{line}{tow}"
