"""`archief.toml` with proposals written in."""

from collections.abc import Iterable
from typing import Any

import tomlkit
from tomlkit.items import InlineTable, Table

from warehouse.archive.check.proposals import OF_NAMES, Proposal


def merged(text: str, proposals: Iterable[Proposal]) -> str:
    """`archief.toml` with proposals written in; what is there stays."""
    document = tomlkit.parse(text)
    for proposal in proposals:
        if proposal.section == "ignore":
            _add(document, "ignore", proposal.value)
        elif proposal.season:
            _in_profile(document, proposal)
        else:
            _in_section(document, proposal)
    return str(tomlkit.dumps(document))


def _in_section(document: Any, proposal: Proposal) -> None:
    section = document.setdefault(proposal.section, tomlkit.table())
    if proposal.is_active:
        section.setdefault(proposal.key, proposal.value)
    else:
        section.add(tomlkit.comment(proposal.assignment))


def _add(table: Any, key: str, value: str) -> None:
    """Adds to a list; a new one goes before the tables, where TOML wants it."""
    if key in table:
        if value not in table[key]:
            table[key].append(value)
        return
    fresh = tomlkit.array()
    fresh.append(value)
    if isinstance(table, Table):
        table.add(key, fresh)
        return
    rest = tomlkit.dumps(table)
    made = tomlkit.parse(f"{key} = {fresh.as_string()}\n{rest}")
    table.clear()
    for name, item in made.items():
        table[name] = item


def _in_profile(document: Any, proposal: Proposal) -> None:
    profiles = document.setdefault("profile", tomlkit.aot())
    mine = next((p for p in profiles if _covers(str(p.get("seasons", "")), proposal.season)), None)
    if mine is None:
        mine = tomlkit.table()
        mine.add("seasons", str(proposal.season))
        profiles.append(mine)
        mine = profiles[-1]
    if not proposal.is_active:
        _loosen(mine)
        mine.add(tomlkit.comment(proposal.assignment))
    elif proposal.section in OF_NAMES:
        _add(mine, proposal.section, proposal.value)
    elif proposal.section == "sample_rate_hz":
        mine.setdefault("sample_rate_hz", int(proposal.value))
    elif proposal.key not in mine.get("columns", {}):
        _loosen(mine)
        mine.add(tomlkit.key(["columns", proposal.key]), proposal.value)


def _loosen(profile: Any) -> None:
    """Writes `columns = { force = "trek" }` as a line for each, so that more can be added."""
    columns = profile.get("columns")
    if isinstance(columns, InlineTable):
        profile.remove("columns")
        for name, value in columns.items():
            profile.add(tomlkit.key(["columns", name]), value.unwrap())


def _covers(seasons: str, season: int) -> bool:
    first, _, last = seasons.partition(":")
    return first.isdigit() and int(first) <= season <= int(last or first)
