"""Registers, due lists, seasons and editions as text for a person."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import polars as pl

from dashboards.statements import due as of_due
from dashboards.statements import edition, season
from herijk.cli.options import Told
from herijk.cli.render import codes, page, section, speech, table
from pipeline.messages import ngettext, say, tell
from pipeline.tables.row import Row

if TYPE_CHECKING:
    from warehouse.editions.publish import Published
    from warehouse.editions.verify import Finding, Verification
    from warehouse.queries.registers import DueReport, RegisterReport
    from warehouse.queries.reports import LogErrorReport


def _frame(rows: Sequence[Row]) -> pl.DataFrame:
    return pl.DataFrame(rows, infer_schema_length=None)


# Registers


REGISTER: Final = (
    "fsn_no name crew empty_thwart status valid_until tow_id declared_speed_m_s a_kg_m b_m_s "
    "cw_kg_m cw_lo_kg_m cw_hi_kg_m waterline_length_m beam_m bow_height_m weight_kg"
)
DUE: Final = (
    "valid_until fsn_no name crew tow_date declared_speed_m_s power_w raced_speed_m_s "
    "lowest_speed_m_s highest_speed_m_s tow_speed_m_s beyond_curve speed_reason"
)
RETOW: Final = "position fsn_no name crew seasons valid_until tow_speed_m_s factor_sd_after_percent"


def said_of_register(report: "RegisterReport") -> Told:
    """How many lines have a curve."""
    return {report.edition: [edition.register(_frame(report.lines))]}


def register(report: "RegisterReport") -> str:
    """The lines of an edition, and the day on which their validity was judged."""
    parts = [
        *(
            f"{speech().edition(name)}: {one(speech())}"
            for name, (one,) in said_of_register(report).items()
        ),
        table(report.lines, REGISTER),
        tell(
            "Low, high: the 95 % interval of Cw where the method estimates the error of the log; "
            "else the spread\nof the runs alone, without that error. A and B hold from 85 to 115 % "
            "of v."
        ),
    ]
    return page(parts, report.simulated)


URGENCIES: Final = {
    "expired": say("Expired: does not count any more"),
    "this_year": say("Expires at the end of this year: tow before the next season"),
    "without_curve": say("Without a curve: never towed, or no tow gave one"),
    "later": say("Later"),
}


def said_of_due(report: "DueReport") -> Told:
    """Who has to tow, and whether towing more is worth it."""
    choice = report.retow_choice
    worth = [of_due.retow(_frame(choice))] if choice else []
    return {report.method: [of_due.due(_frame(report.lines)), *worth]}


def due(report: "DueReport") -> str:
    """Who is due, at what speed, and which boats to tow again."""
    by_urgency = (
        section(tell(title), table([row for row in report.lines if row["urgency"] == urgency], DUE))
        for urgency, title in URGENCIES.items()
    )
    parts = [
        of_due.due(_frame(report.lines))(speech()),
        *by_urgency,
        tell(
            "The speed takes 70-90 W per rower (men) or 40-55 W (women) on the known curve of "
            "method {}. A boat that was altered\nsince may be towed at another one. Beyond the "
            "curve: outside 85-115 % of the last declared speed, where it does not hold.",
            report.method,
        ),
        _retow(report.retow_choice),
    ]
    return page(parts, report.simulated)


def _retow(choice: list[Row]) -> str:
    title = tell("To narrow the season factors most, tow these again, in this order")
    if not choice:
        return tell(
            "{}: nobody, this method estimates no log error, so no tow would narrow it.", title
        )
    rows = [row | {"factor_sd_after_percent": 100 * row["factor_sd_after_ratio"]} for row in choice]
    return section(title + ":", of_due.retow(_frame(choice))(speech()), table(rows, RETOW))


# Seasons


def said_of_seasons(report: "LogErrorReport") -> Told:
    """Where the log was furthest off."""
    furthest = season.log_factors(_frame(report.factors)) if report.factors else None
    return {report.method: [furthest] if furthest else []}


def seasons(report: "LogErrorReport") -> str:
    """The log factors of all seasons, and what else may be wrong with instruments."""
    factor = "factor lo hi source n_tows n_links"
    lacking = _seasons_between([row["season"] for row in report.factors])
    parts = [
        *(one(speech()) for one in said_of_seasons(report)[report.method]),
        section(
            tell("True speed = log speed x factor, under {} (95 % intervals):", report.method),
            table(report.factors, f"season {factor} cause", {"cause": say("step is of")}),
        ),
        tell(
            "Step is of: whether the season differs by its log or by its load cell (force), as the "
            "bend of the\nsame boats' curves tells. Prescribed: nothing ties the season to one "
            "with dGPS, so the method's own\nfactor is used."
        ),
        tell("No sound tow in {}: nothing is known of the log there.", lacking) if lacking else "",
        section(
            tell("Each log, and each part of a season in which one was replaced:"),
            table(
                [row | {"part": row["part"] + 1} for row in report.parts], f"season part {factor}"
            ),
        ),
        section(
            tell("What may be wrong with the instruments of a season:"),
            _diagnosis(report.diagnosis),
        ),
    ]
    return page(parts, report.simulated)


def _seasons_between(seasons: list[int]) -> str:
    """Seasons that are missing between the first and the last."""
    every = range(min(seasons, default=0), max(seasons, default=0))
    return ", ".join(str(season) for season in every if season not in seasons)


DIAGNOSIS: Final = "season instrument verdict first_tow size size_lo size_hi p_fault confused_with"


def _diagnosis(faults: list[Row]) -> str:
    """Faults that were found, or of which nothing can be said."""
    if not faults:
        return tell("  nothing was found, and nothing is in doubt")
    sizes = ("size", "size_lo", "size_hi")
    rows = [
        fault
        | {name: _size(fault[name], fault["unit"]) for name in sizes}
        | {"confused_with": _or_else(fault["confused_with"])}
        for fault in faults
    ]
    note = tell(
        "Would not show: a fault of the usual size would be taken for what is given under "
        "'or else'. The interval\ncounts how seldom such a fault is, so where nothing points to "
        "one it can be 0 to 0."
    )
    return f"{table(rows, DIAGNOSIS)}\n\n{note}"


def _size(value: float, unit: str) -> str:
    return f"{speech().number(value, 1, '+')}\u00a0{unit}"


def _or_else(confused_with: str | None) -> str:
    """What else would explain it: kinds of faults, and their seasons."""
    kinds = (kind.partition(" ") for kind in (confused_with or "").split(", ") if kind)
    return ", ".join(f"{codes(kind)}{space}{season}" for kind, space, season in kinds) or "-"


# Editions


def published(report: "Published") -> str:
    """An edition that was just published."""
    about = report.manifest
    statuses = ", ".join(f"{n} {codes(status)}" for status, n in report.statuses.items())
    compared = (
        tell(
            "Compared with {}: herijk compare {} {}", about.previous, about.previous, about.edition
        )
        if about.previous
        else tell("There is no earlier edition to compare it with.")
    )
    parts = [
        tell(
            "Published {}: {} lines ({}), method {}, valid from {}.",
            about.edition,
            sum(report.statuses.values()),
            statuses,
            about.method or tell("as printed"),
            about.valid_from,
        ),
        tell("Decision: {}", about.decision),
        compared,
        *_to_look_at(report.to_look_at),
        tell("Seal, to be kept in the minutes: {}", about.seal),
        tell("Folder: {}", report.folder),
        tell("  register.xlsx, register.csv        the register"),
        tell("  bericht.md, notice.md              what changes and why, Dutch and English"),
        tell("It is never changed. To see that it stays so: herijk verify"),
    ]
    return page(["\n".join(parts)], about.simulated)


def _to_look_at(lines: list[Row]) -> list[str]:
    """Which lines are marked or left empty, one a line; nothing where none is."""
    if not lines:
        return []
    return [
        tell(
            "{} lines need a look; they are marked in the register. Look at each with "
            "herijk audit, and write what you decide in besluiten.toml:",
            len(lines),
        ),
        *(
            f"  {line['fsn_no']} {line['rowers']}{line['crew_class']}: "
            + (
                tell("tow {}: {}", line["tow_id"], codes(line["flags"]))
                if line["tow_id"]
                else tell(
                    "no numbers: the archive rules its tows out (see doubts in the table tows)"
                )
            )
            for line in lines
        ),
    ]


KINDS: Final = {
    "altered": say("altered"),
    "differs": say("differs"),
    "missing": say("missing"),
    "notice": say("notice"),
    "swapped": say("swapped"),
    "unchecked": say("unchecked"),
}
"""What a check of editions can find."""


def verify(report: "Verification") -> str:
    """What was checked and what is wrong."""
    if not report.editions and not report.findings:
        return tell("No edition has been published yet; nothing to verify.")
    findings = [
        vars(finding)
        | {
            "verdict": tell("WRONG" if finding.wrong else "notice"),
            "kind": tell(KINDS.get(finding.kind, finding.kind)),
        }
        for finding in report.findings
    ]
    head = tell(
        "Head: {}\nThe seal of the last edition. Keep it, for example in the minutes: with it "
        "anybody can tell later whether\nany edition was made anew.",
        report.head,
    )
    parts = [
        table(list(map(vars, report.editions)), "edition kind lines made_again equal"),
        tell(
            "Made again: measured lines from the samples files of the archive, carried lines from "
            "the printed edition,\nprinted lines from the register in the archive."
        ),
        table(findings, "edition verdict kind where message"),
        head if report.head else "",
        _verdict(report.findings),
    ]
    return page(parts, simulated=False)


def _verdict(findings: "list[Finding]") -> str:
    wrong = sum(f.wrong for f in findings)
    if wrong and all(f.kind == "differs" for f in findings if f.wrong):
        return tell(
            "{} of these come out otherwise: either the code changed since, or the edition did. "
            "The head decides: compare\nit with the minutes, or give it with --head.",
            wrong,
        )
    if wrong:
        return tell(ngettext("{n} thing is wrong.", "{n} things are wrong.", wrong))
    otherwise = sum(f.kind == "differs" for f in findings)
    if otherwise:
        return tell(
            "Nothing was altered. The code of today makes {} of these otherwise; "
            "what was published stands.",
            otherwise,
        )
    return tell("Everything is as it was published.")
