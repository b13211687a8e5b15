"""What `--json` of each command prints, as JSON Schema: `herijk schema COMMAND`.

The form of a result is that of its dataclass: types from its fields, meanings from its docstring.
Rows have no class, so their columns are named here; the type, unit and meaning of a column come
from the declaration of its table. Fields may be added to a result; none is renamed or dropped
without a line in the changelog.
"""

import collections.abc
import datetime as dt
import inspect
import re
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from operator import attrgetter
from types import NoneType
from typing import Any, Final, Literal, get_args, get_origin, get_type_hints

import polars as pl
from pydantic import BaseModel

from assets.report import Done, Report
from herijk.cli.doctor import Findings
from herijk.cli.methods import MethodReport
from pipeline.method.variant import Difference
from pipeline.register.register import LINE as NAMES_LINE
from pipeline.tables.declare import dy
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES
from warehouse.archive.check import CheckReport
from warehouse.editions.compare import DiffReport
from warehouse.editions.lineage import Lineage
from warehouse.editions.publish import Published
from warehouse.editions.verify import Verification
from warehouse.queries.audit import BoatAudit
from warehouse.queries.audit_types import TypesAudit
from warehouse.queries.due import DueReport
from warehouse.queries.rebase import RebaseReport
from warehouse.queries.register import RegisterReport
from warehouse.queries.reports import LogErrorReport, RebuildReport
from warehouse.store.editions import Manifest

Schema = dict[str, Any]
Fields = Mapping[str, Any]
"""Schemas by name; of a field that has a class of its own, the columns of the rows in it."""

DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"
KINDS: Final = {str: "string", dt.date: "string", bool: "boolean", int: "integer", float: "number"}
LISTS: Final = (list, tuple, collections.abc.Sequence)
OBJECTS: Final = (dict, collections.abc.Mapping)


def of(report: type[Any], **rows: Fields) -> Schema:
    """The schema of a dataclass or a pydantic model.

    Args:
        report: the class.
        rows: the columns of its fields that are rows, by the name of the field.
    """
    documented = [inspect.cleandoc(one.__doc__ or "") for one in reversed(report.__mro__)]
    meanings = {name: text for doc in documented for name, text in _attributes(doc)}
    hints = get_type_hints(report)
    names = (
        report.model_fields
        if issubclass(report, BaseModel)
        else map(attrgetter("name"), fields(report))
    )
    return record(
        documented[-1].partition("\n")[0],
        {
            name: _of_hint(hints[name], rows.get(name, {}))
            | ({"description": meanings[name]} if name in meanings else {})
            for name in names
        },
    )


def _attributes(documented: str) -> list[tuple[str, str]]:
    """Name and meaning of each field in the section `Attributes` of a docstring."""
    section = documented.partition("Attributes:\n")[2].partition("\n\n")[0]
    entries = re.findall(r"^    (\w[\w, ]*): (.*(?:\n {8}.*)*)", section, re.MULTILINE)
    return [(name, " ".join(text.split())) for names, text in entries for name in names.split(", ")]


def _of_hint(hint: Any, columns: Fields) -> Schema:
    """The schema of an annotation; rows in it have these columns."""
    origin, inner = get_origin(hint), get_args(hint)
    if NoneType in inner:
        (known,) = set(inner) - {NoneType}
        schema = _of_hint(known, columns)
        return schema | {"type": [schema["type"], "null"]}
    if hint == Row:
        return {"type": "object", "properties": columns}
    if origin in LISTS:
        return {"type": "array", "items": _of_hint(inner[0], columns)}
    if origin in OBJECTS:
        return {"type": "object", "additionalProperties": _of_hint(inner[1], columns)}
    if origin is Literal or hint in KINDS:
        return {"type": KINDS.get(hint, "string")}
    return {} if hint is object else of(hint, **columns)


def _field(kind: str, meaning: str, maybe: bool = False) -> Schema:
    return {"type": [kind, "null"] if maybe else kind, "description": meaning}


def text(meaning: str, maybe: bool = False) -> Schema:
    """Text, or a day as 2026-05-08."""
    return _field("string", meaning, maybe)


def number(meaning: str, maybe: bool = False) -> Schema:
    """A number."""
    return _field("number", meaning, maybe)


def whole(meaning: str, maybe: bool = False) -> Schema:
    """A whole number."""
    return _field("integer", meaning, maybe)


def flag(meaning: str, maybe: bool = False) -> Schema:
    """True or false."""
    return _field("boolean", meaning, maybe)


def texts(meaning: str) -> Schema:
    """A list of texts."""
    return {"type": "array", "items": {"type": "string"}, "description": meaning}


def record(meaning: str, fields: Fields) -> Schema:
    """An object with these fields."""
    return _field("object", meaning) | {"properties": dict(fields)}


def rows(meaning: str, fields: Fields) -> Schema:
    """A list of objects with these fields."""
    items = {"type": "object", "properties": dict(fields)}
    return {"type": "array", "items": items, "description": meaning}


def columns(table: str, *names: str) -> dict[str, Schema]:
    """Columns of a table, all of them where none is named; joined in, each may be empty."""
    declared = TABLES[table].columns()
    return {name: _of_column(declared[name]) for name in names or declared}


def _of_column(column: dy.Column) -> Schema:
    unit = (column.metadata or {}).get("unit")
    meaning = f"{column.description} [{unit}]" if unit else str(column.description)
    if isinstance(column.dtype, pl.List):
        return texts(meaning)
    if column.dtype == pl.Boolean:
        return flag(meaning, maybe=True)
    if column.dtype.is_integer():
        return whole(meaning, maybe=True)
    return number(meaning, maybe=True) if column.dtype.is_float() else text(meaning, maybe=True)


NAME: Final = columns("boats", "name")
TYPED: Final = columns("boats", "name", "boat_type")
LINE: Final = columns("register", *NAMES_LINE)
FACTOR: Final = number("what it does to Cw: new / old", maybe=True)
COUNTED: Final = {"number": whole("how often")}


def _rebuild() -> Schema:
    report = of(
        RebuildReport,
        seasons={"season": whole("year"), "tows": whole("tows")},
        set_aside=columns("quarantine", "lost", "reason_code") | COUNTED,
        first_faults=columns(
            *("quarantine", "path", "tow_id", "line", "message", "message_nl", "reason_code")
        )
        | COUNTED,
        curves=columns("curves", "method", "status") | COUNTED,
        by_season=columns(
            *("season_changes", "method", "season", "tows"),
            *("median_ratio", "lowest_ratio", "highest_ratio"),
        )
        | {"compared_with": text("draft of the method compared with")},
        biggest_changes=LINE
        | NAME
        | columns(
            *("register_changes", "from_edition", "to_edition", "change", "cw_ratio"),
            "time_ratio",
        ),
    )
    report["properties"] |= {"done": of(Done), "since": of(Report)}
    return report


def _log_error() -> Schema:
    links = columns(
        "season_links",
        *("n_tows", "n_links", "component", "influence", "influence_boat"),
    )
    factor = columns("log_factors", "season", "factor", "lo", "hi", "source")
    return of(
        LogErrorReport,
        factors=factor | links | {"cause": text("step is of", maybe=True)},
        parts=factor | columns("season_links", "part", "n_tows", "n_links"),
        diagnosis=columns("season_diagnosis"),
    )


def _rebase() -> Schema:
    report = of(
        RebaseReport,
        by_season={"season": whole("year"), "tows": whole("tows"), "total": FACTOR},
        changes={"change": text("kind"), "count": whole("lines")},
        boats=columns("register_changes") | NAME | {"tow_id": text("its tow", maybe=True)},
    )
    for name in ("by_season", "boats"):  # and of each step, by its name
        report["properties"][name]["items"]["additionalProperties"] = FACTOR
    return report


def _fit() -> Schema:
    estimate = {
        "value": number("value", maybe=True),
        "lo": number("lower end of its 95 % interval; null for none", maybe=True),
        "hi": number("upper end; null for none", maybe=True),
    }
    return record(
        "A curve through points.",
        {
            "file": text("the file"),
            "points": whole("points in it"),
            "a_kg_m": number("A [kg/m]"),
            "b_m_s": record("B [m/s]; no value where the points show no bend", estimate),
            "b_is_determined": flag("the points set B a lower and an upper bound"),
            "cw_kg_m": rows(
                "Cw [kg/m] at the speeds measured", {"speed_m_s": number("speed [m/s]"), **estimate}
            ),
        },
    )


ABOUT: Final = columns(
    "editions",
    *("edition", "kind", "method", "method_hash", "valid_from", "published_on", "decision"),
    *("previous", "code_version", "seal"),
)
"""What the table of editions says of the fields of an edition."""


def _publish() -> Schema:
    to_look_at = LINE | columns("register", "status", "tow_id") | {"flags": texts("its flags")}
    report = of(Published, to_look_at=to_look_at)
    about = report["properties"].pop("manifest")["properties"]
    report["properties"] |= about | ABOUT
    return report


def _changed_line() -> Fields:
    """A line of two editions: how it changed and why, and what it is in either."""
    in_either = {
        **columns("register", "a_kg_m", "b_m_s", "cw_kg_m", "declared_speed_m_s"),
        **columns("register", "tow_id", "status"),
        **columns("curves", "power_w"),
        "rank": whole("rank by speed at equal power, in its class", maybe=True),
    }
    cause = {
        "cause": text("why the line changed"),
        "step": text("step of the method, where a method is the cause", maybe=True),
        "factor": FACTOR,
    }
    return {
        **columns("register_changes"),
        **NAME,
        **{f"{side}_{name}": own for side in ("old", "new") for name, own in in_either.items()},
        "gain_in_two_hours_s": number("what it gains in a race of two hours [s]", maybe=True),
        "exceeds_interval": flag("it moved by more than its interval", maybe=True),
        "causes": rows("what moved it", cause),
    }


def _diff() -> Schema:
    line = _changed_line()
    return of(
        DiffReport,
        gain={"most": line},
        loss={"most": line},
        largest=line,
        rows=line,
        races=columns(
            *("race_changes", "race", "race_date", "fsn_no", "rowers", "crew_class"),
            *("empty_thwart", "rowing_time_s", "old_power_w", "new_power_w", "old_remark"),
            *("new_remark", "old_rank", "new_rank", "podium_changed"),
        ),
        winners={
            **columns("race_changes", "race", "race_date", "crew_class"),
            "old_winner": text("boat that wins under the old edition", maybe=True),
            "new_winner": text("boat that wins under the new edition", maybe=True),
            "winner_changed": flag("they differ"),
            "change_probability": number(
                "probability that another boat wins than under the old edition", maybe=True
            ),
        },
    )


def _lineage() -> Schema:
    inputs = {"inputs_sha256": text("hash of all that its numbers were made from", maybe=True)}
    origin = {
        "basis": text("where the numbers come from"),
        "verification_code": text("verification code", maybe=True),
    }
    return of(
        Lineage,
        about=of(Manifest)["properties"] | ABOUT,
        lines={
            "line": columns("register") | TYPED | columns("boats", "ht_no") | inputs | origin,
            "tow": columns("tows") | columns("boats", "boat_type") | inputs,
            "files": {"path": text("file"), "sha256": text("content hash")},
            "runs": columns("run_points"),
            "curve": columns("curves"),
        },
    )


def _due() -> Schema:
    return of(
        DueReport,
        lines=columns("due_list")
        | TYPED
        | {"urgency": text("expired, this_year, later or without_curve")},
        retow_choice=columns("retow_choice")
        | NAME
        | columns("due_list", "valid_until", "tow_speed_m_s"),
    )


def _methods() -> Schema:
    method = of(MethodReport)["properties"]
    shown = {name: method[name] for name in ("method", "title", "content_hash")}
    listed = rows("a method each", shown | {"ships": flag("it ships with Herijk")})
    return record("The methods.", {"methods": listed})


def _methods_diff() -> Schema:
    return record(
        "What differs between two methods.",
        {
            "from": text("one method"),
            "to": text("the other"),
            "options": rows("options that differ", of(Difference)["properties"]),
            "effect": _rebase(),
        },
    )


def _check() -> Schema:
    return of(CheckReport)


def _audit() -> Schema:
    budget = columns("uncertainty_budget", "component", "shared", "u_ratio", "dof")
    curve = {
        **columns("curves"),
        **columns("methods", "interval"),
        "run_points": rows("its runs", columns("run_points")),
        "budget": rows("what makes it uncertain", budget),
    }
    tow = {
        **columns("tows"),
        "curves": rows("a method each", curve),
        "steps": rows("what each step did", columns("correction_steps")),
    }
    tables = {
        "in_type": "type_outliers",
        "pooled": "pooled_curves",
        "slow_tows": "slow_tows",
        "repeat_pairs": "repeat_pairs",
        "predicted": "predicted_cw",
        "register": "register",
        "set_aside": "quarantine",
        "options": "option_effects",
    }
    of_tables = {name: columns(table) for name, table in tables.items()}
    of_boat = of(BoatAudit, boat=columns("boats"), tows=tow, **of_tables)["properties"]
    return record(
        "Where a boat's numbers come from; or, of types, whether their boats are equal.",
        of_boat | of(TypesAudit)["properties"] | {"plots": texts("pictures written")},
    )


def _written(what: str) -> Schema:
    return record(what, {"files": texts("files written")})


@cache
def schemas() -> dict[str, Schema]:
    """The schema of each command's result, by command."""
    simulated = {"archive": text("the archive"), "truth": text("file with its truth")}
    return {
        "audit": _audit(),
        "certificate": _written("The certificates."),
        "check": _check(),
        "diff": _diff(),
        "doctor": of(Findings),
        "due": _due(),
        "fit": _fit(),
        "init": _written("The new archive."),
        "lineage": _lineage(),
        "log-error": _log_error(),
        "methods": _methods(),
        "methods check": of(MethodReport),
        "methods diff": _methods_diff(),
        "methods new": _written("The new method file."),
        "methods show": of(MethodReport),
        "proposal": _written("The proposal."),
        "publish": _publish(),
        "rebase": _rebase(),
        "rebuild": _rebuild(),
        "register": of(RegisterReport, lines=columns("register") | TYPED),
        "simulate": record("The simulated archive.", simulated),
        "slides": _written("The slides."),
        "verify": of(Verification),
    }


def schema_of(command: str) -> Schema:
    """The schema of one command's result.

    Raises:
        KeyError: the command has none.
    """
    return {"$schema": DIALECT, "title": f"herijk {command} --json", **schemas()[command]}
