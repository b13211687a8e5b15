"""Registers, due lists, seasons and editions as text for a person."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import polars as pl

from dashboards import labels
from dashboards.statements import due as of_due
from dashboards.statements import edition, season
from herijk.cli.render import Part, Section, codes, marked, prose, speech
from pipeline.messages import ngettext, say, tell
from pipeline.tables.row import Row

if TYPE_CHECKING:
    from warehouse.editions.integrity import Finding
    from warehouse.editions.publish import Published
    from warehouse.editions.verify import Verification
    from warehouse.queries.registers import DueReport, RegisterReport
    from warehouse.queries.reports import LogErrorReport
    from warehouse.queries.years import YearsReport


def _frame(rows: Sequence[Row]) -> pl.DataFrame:
    return pl.DataFrame(rows, infer_schema_length=None)


# Registers


REGISTER: Final = (
    "fsn_no name crew empty_thwart status flags valid_until tow_id declared_speed_m_s a_kg_m b_m_s "
    "cw_kg_m cw_lo_kg_m cw_hi_kg_m waterline_length_m beam_m bow_height_m weight_kg"
)
DUE: Final = (
    "valid_until fsn_no name crew tow_date declared_speed_m_s power_w raced_speed_m_s "
    "lowest_speed_m_s highest_speed_m_s tow_speed_m_s beyond_curve speed_reason"
)


def register(report: "RegisterReport") -> Iterator[Part]:
    """The lines of an edition, and the day on which their validity was judged."""
    yield marked(report.simulated)
    yield Section(
        speech().edition(report.edition),
        [edition.register(_frame(report.lines))],
        report.edition,
        rows=report.lines,
        columns=REGISTER,
        note=tell(edition.REGISTER),
    )


def years(report: "YearsReport") -> Iterator[Part]:
    """What a method would have changed in the register of every year."""
    yield marked(report.simulated)
    yield Section(
        tell("At the end of each season: the register under {} / as published", report.method),
        rows=report.years,
        columns="year lines changed median_ratio lowest_ratio highest_ratio exceeds_interval "
        "rank_changed printed_lines printed_median_ratio printed_largest_ratio",
        note=tell(
            "Cw at the declared speed; the same rule of validity on both sides. Printed: that "
            "year's printed register / the one that the method of that time gives."
        ),
    )
    yield Section(
        tell("Winners, by the register of that time and by this one:"),
        rows=report.winners,
        columns="race race_date crew_class published_winner winner winner_changed "
        "change_probability",
        empty=tell("The archive holds no races."),
    )
    yield Section(
        tell("Causes, with their factor on Cw:"),
        rows=[row | {"cause": tell(labels.cause(row))} for row in report.causes],
        columns="year cause lines median_factor lowest_factor highest_factor",
    )


URGENCIES: Final = {
    "expired": say("Expired: does not count any more"),
    "this_year": say("Expires at the end of this year: tow before the next season"),
    "without_curve": say("Without a curve: never towed, or no tow gave one"),
    "later": say("Later"),
}


def due(report: "DueReport") -> Iterator[Part]:
    """Yield who is due, and at what speed."""
    yield marked(report.simulated)
    yield Section("", [of_due.due(_frame(report.lines))], report.method)
    for urgency, title in URGENCIES.items():
        rows = [row for row in report.lines if row["urgency"] == urgency]
        yield Section(tell(title), rows=rows, columns=DUE)
    yield prose(tell(of_due.SPEEDS))


# Seasons


def seasons(report: "LogErrorReport") -> Iterator[Part]:
    """The log factors of all seasons, and what else may be wrong with instruments."""
    factor = "factor lo hi source n_tows n_links"
    furthest = season.log_factors(_frame(report.factors)) if report.factors else None
    yield marked(report.simulated)
    yield Section(
        tell("True speed = log speed x factor, under {} (95 % intervals):", report.method),
        [furthest] if furthest else [],
        report.method,
        rows=report.factors,
        columns=f"season {factor}",
        note=tell(
            "Prescribed: nothing ties the season to one with "
            "dGPS, so the method's own factor is used."
        ),
    )
    known = [row["season"] for row in report.factors]
    between = range(min(known, default=0), max(known, default=0))
    if lacking := [str(year) for year in between if year not in known]:
        yield tell("No sound tow in {}: nothing is known of the log there.", ", ".join(lacking))
    yield Section(
        tell("Each log, and each part of a season in which one was replaced:"),
        rows=[row | {"part": row["part"] + 1} for row in report.parts],
        columns=f"season part {factor}",
    )
    yield Section(
        tell("What may be wrong with the instruments of a season:"),
        rows=[row | {"confused_with": _or_else(row["confused_with"])} for row in report.diagnosis],
        columns="season instrument verdict first_tow size size_lo size_hi unit p_fault "
        "shown_by confused_with",
        empty=tell("nothing was found, and nothing is in doubt"),
        note=tell(season.DIAGNOSIS),
    )
    yield Section(
        tell("Level of each season, against what its boats show in other seasons:"),
        rows=report.levels,
        columns="season verdict size size_lo size_hi unit",
        note=tell(season.LEVEL),
    )


def _or_else(confused_with: str | None) -> list[str]:
    """What else would explain it: kinds of faults, and their seasons."""
    kinds = (kind.partition(" ") for kind in (confused_with or "").split(", ") if kind)
    return [f"{codes(kind)}{space}{year}" for kind, space, year in kinds]


# Editions


def published(report: "Published") -> Iterator[Part]:
    """An edition that was just published."""
    about = report.manifest
    yield marked(about.simulated)
    statuses = ", ".join(f"{n} {codes(status)}" for status, n in report.statuses.items())
    yield Section(
        tell(
            "Published {}: {} lines ({}), method {}, valid from {}.",
            about.edition,
            sum(report.statuses.values()),
            statuses,
            about.method or tell("as printed"),
            about.valid_from,
        ),
        lines=[
            tell("Decision: {}", about.decision),
            tell("Seal, to be kept in the minutes: {}", about.seal),
            tell("Folder: {}", report.folder),
            tell("  register.xlsx, register.csv        the register"),
            tell("  bericht.md, notice.md              what changes and why, Dutch and English"),
        ],
        note=tell("It is never changed. To see that it stays so: herijk verify"),
    )
    if about.previous:
        yield tell("What it changes: herijk compare {} {}", about.previous, about.edition)
    look = report.to_look_at
    yield Section(
        tell(
            ngettext(
                "1 line needs a look; it is marked in the register. Look at it with herijk audit, "
                "and write what you decide in besluiten.toml:",
                "{n} lines need a look; they are marked in the register. Look at each with herijk "
                "audit, and write what you decide in besluiten.toml:",
                len(look),
            )
        ),
        rows=look,
        columns="fsn_no crew tow_id flags",
        note=tell("Without a tow: the archive rules its tows out (see doubts in the table tows).")
        if not all(line["tow_id"] for line in look)
        else "",
    )


KINDS: Final = {
    "altered": say("altered"),
    "differs": say("differs"),
    "missing": say("missing"),
    "notice": say("notice"),
    "swapped": say("swapped"),
    "unchecked": say("unchecked"),
}
"""What a check of editions can find."""


def verify(report: "Verification") -> Iterator[Part]:
    """What was checked and what is wrong."""
    if not report.editions and not report.findings:
        yield tell("No edition has been published yet; nothing to verify.")
        return
    yield Section(
        rows=list(map(vars, report.editions)),
        columns="edition kind lines equal",
        note=tell(
            "Made again: measured lines from the samples files of the archive, carried lines from "
            "the printed edition, printed lines from the register in the archive."
        ),
    )
    yield Section(
        rows=[
            vars(one)
            | {"verdict": tell("WRONG" if one.wrong else "notice"), "kind": tell(KINDS[one.kind])}
            for one in report.findings
        ],
        columns="edition verdict kind where message",
    )
    if report.head:
        yield Section(
            tell("Head: {}", report.head),
            lines=[
                tell(
                    "That is the seal of the last edition. Keep it, for example in the minutes: "
                    "with it anybody can\ntell later whether any edition was made anew."
                )
            ],
        )
    yield _verdict(report.findings)
    if report.is_without_head:
        yield tell(
            "Without the head from the minutes nobody can see whether the last edition was "
            "removed: herijk verify --head SEAL"
        )


def _verdict(findings: "list[Finding]") -> str:
    wrong = sum(f.wrong for f in findings)
    otherwise = sum(f.kind == "differs" for f in findings)
    if wrong and all(f.kind == "differs" for f in findings if f.wrong):
        return tell(
            "{} of these come out otherwise: either the code changed since, or the edition did. "
            "The head decides: compare it with the minutes, or give it with --head.",
            wrong,
        )
    if wrong:
        return tell(ngettext("{n} thing is wrong.", "{n} things are wrong.", wrong))
    if otherwise:
        return tell(
            "Nothing was altered. The code of today makes {} of these otherwise; "
            "what was published stands.",
            otherwise,
        )
    return tell("Everything is as it was published.")
