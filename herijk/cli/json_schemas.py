"""What `--json` of each command prints, as JSON Schema: `herijk schema COMMAND`.

A field that is a column of a table has its type, unit and meaning from the declaration of that
table. Fields may be added to a result; none is renamed or dropped without a line in the changelog.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any, Final

import polars as pl

from herijk.pipeline.register.register import LINE as NAMES_LINE
from herijk.tables.declare import dy
from herijk.tables.schemas import TABLES

Schema = dict[str, Any]
DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"


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


def record(meaning: str, fields: Mapping[str, Schema], maybe: bool = False) -> Schema:
    """An object with these fields."""
    return _field("object", meaning, maybe) | {"properties": dict(fields)}


def rows(meaning: str, fields: Mapping[str, Schema]) -> Schema:
    """A list of objects with these fields."""
    items = {"type": "object", "properties": dict(fields)}
    return {"type": "array", "items": items, "description": meaning}


def by_name(meaning: str, value: Schema) -> Schema:
    """An object whose keys are names: of methods, steps or statuses."""
    return {"type": "object", "additionalProperties": value, "description": meaning}


def columns(table: str, *names: str) -> dict[str, Schema]:
    """Columns of a table, all of them where none is named; joined in, each may be empty."""
    found = TABLES[table].columns()
    return {name: _of_column(found[name]) for name in names or found}


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


SIMULATED: Final = {"simulated": flag("the archive was made by a simulator")}
NAME: Final = columns("boats", "name")
LINE: Final = columns("register", *NAMES_LINE)
FACTOR: Final = number("what it does to Cw: new / old", maybe=True)
PART: Final = {
    "cause": text("why the line changed"),
    "step": text("step of the method, where a method is the cause", maybe=True),
    "factor": FACTOR,
}


def _written(what: str) -> Schema:
    return record(what, {"files": texts("files written")})


def _rebuild() -> Schema:
    change = {
        "median_ratio": number("median of Cw / Cw of the method compared with", maybe=True),
        "lowest_ratio": number("the lowest", maybe=True),
        "highest_ratio": number("the highest", maybe=True),
    }
    fault = columns(
        *("quarantine", "path", "tow_id", "line", "message", "message_nl", "reason_code")
    )
    return record(
        "What a rebuild did and what the tables hold.",
        {
            **SIMULATED,
            "database": text("the file with all tables"),
            "site": text("first page of the site"),
            "report": text("page about what changed"),
            "seasons": rows("seasons with tows", {"season": whole("year"), "tows": whole("tows")}),
            "set_aside": rows(
                "what was set aside, by reason",
                columns("quarantine", "lost", "reason_code") | {"number": whole("how often")},
            ),
            "first_faults": rows("the first of each cause", fault | {"number": whole("how often")}),
            "curves": rows(
                "curves by method and status",
                columns("curves", "method", "status") | {"number": whole("curves")},
            ),
            "by_season": rows(
                "change of Cw at the declared speed",
                columns("season_changes", "method", "season", "tows")
                | change
                | {"compared_with": text("draft of the method compared with")},
            ),
            "biggest_changes": rows(
                "lines that change most",
                columns("register_changes", "from_edition", "to_edition", "change")
                | LINE
                | NAME
                | {"cw_ratio": FACTOR, "time_ratio": number("new / old time of a race", True)},
            ),
            "done": record(
                "the work",
                {
                    "seasons": {"type": "array", "items": {"type": "integer"}},
                    "methods": texts("methods applied again"),
                    "database": flag("the database was made again"),
                },
            ),
            "since": record("the report, as report/latest.json has it", {}),
        },
    )


def _log_error() -> Schema:
    links = columns(
        "season_links",
        *("n_tows", "n_links", "component", "influence", "influence_boat"),
        *("factor_no_boats", "agreement"),
    )
    factor = columns("log_factors", "season", "factor", "lo", "hi", "source")
    return record(
        "The speed log of every season: true speed = log speed x factor.",
        {
            **SIMULATED,
            "method": text("method"),
            "factors": rows("a season each", factor | links | {"cause": text("step is of", True)}),
            "parts": rows(
                "each log, and each part of a season in which one was replaced",
                factor | columns("season_links", "part", "log", "n_tows", "n_links"),
            ),
            "diagnosis": rows("what may be wrong", columns("season_diagnosis")),
        },
    )


def _rebase() -> Schema:
    factors: Schema = {"additionalProperties": FACTOR}
    by_season = rows(
        "per season: median factor on Cw of each step, by the step's name, and of all",
        {"season": whole("year"), "tows": whole("tows"), "total": FACTOR},
    )
    by_season["items"] |= factors
    boats = rows(
        "lines most affected, with the factor of each step, by its name",
        columns("register_changes") | NAME | {"tow_id": text("its tow", maybe=True)},
    )
    boats["items"] |= factors
    return record(
        "All of history under a method, against another.",
        {
            **SIMULATED,
            "method": text("method"),
            "method_hash": text("its content hash"),
            "against": text("method it is compared with"),
            "by_season": by_season,
            "changes": rows("lines by kind", {"change": text("kind"), "count": whole("lines")}),
            "boats": boats,
        },
    )


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


def _about_edition() -> dict[str, Schema]:
    own = columns(
        "editions",
        *("edition", "kind", "method", "method_hash", "valid_from", "published_on", "decision"),
        *("previous", "code_version", "seal"),
    )
    return {
        **own,
        **SIMULATED,
        "inputs_digest": text("hash of all tows that went in"),
        "carried_from": text("printed edition of which lines were taken over", maybe=True),
        "number": whole("place in the chain of editions", maybe=True),
        "after_seal": text("seal of the edition before", maybe=True),
    }


def _publish() -> Schema:
    to_look_at = LINE | columns("register", "status", "tow_id") | {"flags": texts("its flags")}
    return record(
        "The edition that was published.",
        {
            **_about_edition(),
            "tables": by_name("digest of each table", {"type": "object"}),
            "files": by_name("SHA-256 of each file", {"type": "string"}),
            "folder": text("where it lies"),
            "statuses": by_name("lines by status", {"type": "integer"}),
            "to_look_at": rows("lines with flags, or without numbers", to_look_at),
        },
    )


def _diff() -> Schema:
    line = columns("register_changes") | {"causes": rows("what moved it", PART)}
    line["causes"]["items"]["additionalProperties"] = True
    lines = rows("lines", line)
    lines["items"]["additionalProperties"] = True
    group = record(
        "lines that gain or lose power for the same race",
        {
            "lines": whole("lines"),
            "of_class": by_name("by class", {"type": "integer"}),
            "median_power_ratio": number("median of new / old power", maybe=True),
            "median_seconds": number("median gain in two hours [s]", maybe=True),
            "most": lines,
        },
    )
    cause = {
        "cause": PART["cause"],
        "step": PART["step"],
        "lines": whole("lines it moved"),
        "median_factor": FACTOR,
        "lowest_factor": FACTOR,
        "highest_factor": FACTOR,
    }
    return record(
        "Two editions side by side.",
        {
            **SIMULATED,
            "from_edition": text("the old edition"),
            "to_edition": text("the new edition"),
            "lines": whole("lines in either"),
            "changes": by_name("lines by kind of change", {"type": "integer"}),
            "gain": group,
            "loss": group,
            "exceeds_interval": whole("lines that moved by more than their intervals"),
            "interval_unknown": whole("lines whose interval is not known"),
            "runs_alone": texts("editions whose intervals are the spread of the runs alone"),
            "causes": rows("per cause and step", cause),
            "largest": lines,
            "rows": lines,
            "race_rules": record(
                "how races are worked out",
                {
                    "fatigue": text("correction for fatigue"),
                    "speed_decimals": whole("decimals of the speed; null for all", maybe=True),
                },
            ),
            "races": _or_none(rows("races under both; null without results", _race())),
            "winners": _or_none(rows("who wins under both", _winner())),
        },
    )


def _or_none(schema: Schema) -> Schema:
    return schema | {"type": [schema["type"], "null"]}


def _race() -> dict[str, Schema]:
    return columns(
        "race_changes",
        *("race", "race_date", "fsn_no", "rowers", "crew_class", "empty_thwart", "rowing_time_s"),
        *("old_power_w", "new_power_w", "old_remark", "new_remark"),
        *("old_rank", "new_rank", "podium_changed"),
    )


def _winner() -> dict[str, Schema]:
    return {
        **columns("race_changes", "race", "race_date", "crew_class"),
        "old_winner": text("boat that wins under the old edition", maybe=True),
        "new_winner": text("boat that wins under the new edition", maybe=True),
        "winner_changed": flag("they differ"),
        "change_probability": number(
            "probability that another boat wins than under the old edition", True
        ),
    }


def _verify() -> Schema:
    finding = {
        "edition": text("edition"),
        "kind": text("altered, missing, swapped, differs, unchecked or notice"),
        "where": text("file, tow or line"),
        "message": text("what is seen, what it was, what to do"),
        "wrong": flag("a promise is broken"),
    }
    edition = {
        "edition": text("edition"),
        "kind": text("recomputed, or as_printed"),
        "lines": whole("its lines", maybe=True),
        "made_again": whole("of which made again", maybe=True),
        "equal": whole("of which came out equal", maybe=True),
    }
    return record(
        "Whether editions and archive are what they were.",
        {
            "editions": rows("editions checked", edition),
            "head": text("seal of the last edition published", maybe=True),
            "findings": rows("what was found", finding),
            "wrong": flag("any finding breaks a promise"),
        },
    )


def _lineage() -> Schema:
    inputs = {"inputs_sha256": text("hash of all that its numbers were made from", maybe=True)}
    tow = record("the tow", columns("tows") | columns("boats", "boat_type") | inputs, maybe=True)
    curve = record("its curve", columns("curves"), maybe=True)
    boat = columns("boats", "ht_no", "name", "boat_type")
    origin = {
        "basis": text("where the numbers come from"),
        "verification_code": text("verification code", maybe=True),
    }
    line = {
        "line": record("the line", columns("register") | boat | inputs | origin),
        "printed": by_name("the line as printed, by header", {"type": "string"}),
        "code": text("verification code", maybe=True),
        "tow": tow,
        "files": rows("its files", {"path": text("file"), "sha256": text("content hash")}),
        "runs": rows("its runs", columns("run_points")),
        "curve": curve,
    }
    return record(
        "What the lines of a boat were made from.",
        {
            "about": record("the edition", _about_edition()),
            "folder": text("where it lies"),
            "lines": rows("lines of the boat", line),
        },
    )


def _register() -> Schema:
    own = NAME | columns("boats", "boat_type")
    return record(
        "The lines of an edition, and whether they are valid on a day.",
        {
            **SIMULATED,
            "edition": text("name of the edition or draft"),
            "as_of": text("day on which validity is judged"),
            "lines": rows("a boat and crew each", columns("register") | own),
        },
    )


def _due() -> Schema:
    own = NAME | columns("boats", "boat_type")
    choice = columns("due_list", "valid_until", "tow_speed_m_s")
    return record(
        "Who has to tow when, and at what speed.",
        {
            **SIMULATED,
            "method": text("method"),
            "as_of": text("day of the list"),
            "asked": flag("whether that day was asked for"),
            "lines": rows(
                "a boat and crew each",
                columns("due_list")
                | own
                | {"urgency": text("expired, this_year, later or without_curve")},
            ),
            "retow_choice": rows(
                "boats whose next tow narrows the season factors most",
                columns("retow_choice") | NAME | choice,
            ),
        },
    )


def _methods() -> Schema:
    method = {
        "method": text("name"),
        "title": text("title"),
        "content_hash": text("SHA-256 of what it says"),
        "ships": flag("it ships with Herijk"),
    }
    return record("The methods.", {"methods": rows("a method each", method)})


def _one_method() -> Schema:
    return record(
        "A method.",
        {
            "method": text("name"),
            "title": text("title"),
            "content_hash": text("SHA-256 of what it says"),
            "extends": text("method it extends", maybe=True),
            "words": text("what it says, in words"),
        },
    )


def _methods_diff() -> Schema:
    option = {
        "step": text("step"),
        "option": text("option"),
        "first": whole("first season"),
        "last": whole("last season"),
        "before": {"type": "array", "description": "values it replaces"},
        "after": {"description": "value"},
    }
    return record(
        "What differs between two methods.",
        {
            "from": text("one method"),
            "to": text("the other"),
            "options": rows("options that differ", option),
            "effect": _rebase(),
        },
    )


def _check() -> Schema:
    proposal = {
        "section": text("section of archief.toml"),
        "key": text("key in it"),
        "value": text("value"),
        "season": whole("season of a profile, else 0"),
        "is_active": flag("it is no guess"),
        "line": text("the line to put into the file"),
    }
    place = {"path": text("file"), "line": whole("line", True), "tow_id": text("tow", True)}
    cause = {
        "reason_code": text("code of the cause"),
        "number": whole("places"),
        "sentence": text("what is wrong"),
        "cells": texts("cells that have it"),
        "places": rows("the first places", place),
        "proposals": rows("what would settle it", proposal),
    }
    return record(
        "The faults of an archive by cause.",
        {
            "archive": text("the archive"),
            "tows": whole("tows that can be read"),
            "causes": rows("causes", cause),
            "profile": text("archief.toml with the proposals", maybe=True),
        },
    )


def _doctor() -> Schema:
    finding = {"what": text("what"), "sound": flag("in order"), "found": text("what was found")}
    return record("Whether all is in order.", {"findings": rows("findings", finding)})


def _audit() -> Schema:
    curve = columns("curves") | columns("methods", "interval")
    curve["run_points"] = rows("its runs", columns("run_points"))
    curve["budget"] = rows(
        "what makes it uncertain",
        columns("uncertainty_budget", "component", "shared", "u_ratio", "dof"),
    )
    tow = columns("tows")
    tow["curves"] = rows("a method each", curve)
    tow["steps"] = rows("what each step did", columns("correction_steps"))
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
    of_boat = {
        "boat": record("the boat", columns("boats")),
        "tows": rows("its tows", tow),
        "type_size": record("how many boats and tows its type has", {}),
        **{key: rows(f"its rows of {name}", columns(name)) for key, name in tables.items()},
    }
    of_types = {
        "types": rows("the types, with their statistics under each method", {}),
        "differences": by_name("what differs between two types, by method", texts("quantities")),
        "fleet": by_name("what holds for all types, by method", {"type": "object"}),
    }
    return record(
        "Where a boat's numbers come from; or, of types, whether their boats are equal.",
        {
            **SIMULATED,
            "about": text("boat, or types"),
            "methods": texts("methods shown"),
            "statistics_over": text("the tows that statistics of types are over"),
            **of_boat,
            **of_types,
            "plots": texts("pictures written"),
        },
    )


@cache
def schemas() -> dict[str, Schema]:
    """The schema of each command's result, by command."""
    simulated = {"archive": text("the archive"), "truth": text("file with its truth")}
    return {
        "audit": _audit(),
        "certificate": _written("The certificates."),
        "check": _check(),
        "diff": _diff(),
        "doctor": _doctor(),
        "due": _due(),
        "fit": _fit(),
        "init": _written("The new archive."),
        "lineage": _lineage(),
        "log-error": _log_error(),
        "methods": _methods(),
        "methods check": _one_method(),
        "methods diff": _methods_diff(),
        "methods new": _written("The new method file."),
        "methods show": _one_method(),
        "proposal": _written("The proposal."),
        "publish": _publish(),
        "rebase": _rebase(),
        "rebuild": _rebuild(),
        "register": _register(),
        "simulate": record("The simulated archive.", simulated),
        "slides": _written("The slides."),
        "verify": _verify(),
    }


def schema_of(command: str) -> Schema:
    """The schema of one command's result.

    Raises:
        KeyError: the command has none.
    """
    return {"$schema": DIALECT, "title": f"herijk {command} --json", **schemas()[command]}
