"""Results of the commands about editions as text for a person."""

from collections import Counter
from typing import TYPE_CHECKING, Final

from dashboards.labels import code_in_words
from herijk.cli.text import SIMULATED, boat, decimals, page, table, window
from pipeline.messages import LANGUAGE, headings, in_per_cent, ngettext, say, tell
from pipeline.tables.row import Row
from warehouse.editions.words import CHANGES, CREWS, STATUSES, Language

if TYPE_CHECKING:
    from warehouse.editions.chain import Finding
    from warehouse.editions.compare import DiffReport, Group
    from warehouse.editions.lineage import Lineage, LineLineage
    from warehouse.editions.publish import Published
    from warehouse.editions.verify import Verification
    from warehouse.queries.register import RegisterReport


KINDS: Final = {
    "altered": say("altered"),
    "differs": say("differs"),
    "missing": say("missing"),
    "notice": say("notice"),
    "swapped": say("swapped"),
    "unchecked": say("unchecked"),
}
"""What a check of editions can find."""


def _words() -> Language:
    """Words for codes in the language of this command."""
    return Language(LANGUAGE.get())


def _to_look_at(lines: list[Row]) -> list[str]:
    """Which lines are marked or left empty, one a line; nothing where none is."""
    if not lines:
        return []
    rows = [
        f"  {line['fsn_no']} {line['rowers']}{line['crew_class']}: "
        + (
            tell("tow {}: {}", line["tow_id"], ", ".join(map(code_in_words, line["flags"])))
            if line["tow_id"]
            else tell("no numbers: the archive rules its tows out (see doubts in the table tows)")
        )
        for line in lines
    ]
    return [
        tell(
            "{} lines need a look; they are marked in the register. Look at each with "
            "herijk audit, and write what you decide in besluiten.toml:",
            len(lines),
        ),
        *rows,
    ]


def register(report: "RegisterReport") -> str:
    """The lines of an edition, and the day on which their validity was judged."""
    head = (
        *headings("boat", "name", "crew", "empty thwart", "status", "valid until", "tow", "v m/s"),
        *headings("A kg/m", "B m/s", "Cw kg/m", "from", "to", "length m", "beam m", "bow m", "kg"),
    )
    counts = Counter(line["status"] for line in report.lines)
    statuses = ", ".join(f"{n} {_words().word(STATUSES, s)}" for s, n in counts.items())
    parts = [
        tell("Register {}, validity judged on {}: {}.", report.edition, report.as_of, statuses),
        table(head, [_register_line(line) for line in report.lines]),
        tell(
            "From, to: the 95 % interval of Cw where the method estimates the error of the log; "
            "else the spread\nof the runs alone, without that error. A and B hold from 85 to 115 % "
            "of v."
        ),
    ]
    return page(parts, report.simulated)


def _register_line(line: Row) -> tuple[object, ...]:
    shown = (
        *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
        *("waterline_length_m", "beam_m", "bow_height_m"),
    )
    return (
        *boat(line),
        line["empty_thwart"] or "-",
        _words().word(STATUSES, line["status"]),
        line["valid_until"],
        line["tow_id"],
        *(decimals(line[name], 2) for name in shown),
        decimals(line["weight_kg"], 0),
    )


def published(report: "Published") -> str:
    """An edition that was just published."""
    about = report.manifest
    lines = sum(report.statuses.values())
    source = about.method or tell("as printed")
    statuses = ", ".join(f"{n} {_words().word(STATUSES, s)}" for s, n in report.statuses.items())
    compared = (
        tell(
            "Compared with {}: herijk diff {} {}",
            about.previous,
            about.previous,
            about.edition,
        )
        if about.previous
        else tell("There is no earlier edition to compare it with.")
    )
    return "\n".join(
        [
            *([tell(SIMULATED)] if about.simulated else []),
            tell(
                "Published {}: {} lines ({}), method {}, valid from {}.",
                about.edition,
                lines,
                statuses,
                source,
                about.valid_from,
            ),
            tell("Decision: {}", about.decision),
            compared,
            *_to_look_at(report.to_look_at),
            tell("Seal, to be kept in the minutes: {}", about.seal),
            tell("Folder: {}", report.folder),
            tell("  register.xlsx, register.csv        the register"),
            tell(
                "  bericht.md, notice.md              one page for the members, Dutch and English"
            ),
            tell("  toelichting.md, release_notes.md   release notes, Dutch and English"),
            tell("It is never changed. To see that it stays so: herijk verify"),
        ]
    )


def diff(report: "DiffReport") -> str:
    """Two editions side by side."""
    counts = ", ".join(f"{n} {_words().word(CHANGES, c)}" for c, n in report.changes.items())
    parts = [
        f"{report.from_edition} -> {report.to_edition}: {counts or tell('no lines')}.",
        tell(
            "Gain (more power for the same race): {}\nLose: {}\nLarger than the "
            "uncertainty: {}; uncertainty not known for {}.",
            _group(report.gain),
            _group(report.loss),
            _exceeding(report),
            report.interval_unknown,
        ),
    ]
    parts += [
        tell(
            "The interval of {} is the spread of the runs alone: the log's error is not in it.",
            edition,
        )
        for edition in report.runs_alone
    ]
    if report.causes:
        rows = [
            (
                _words().cause(c.cause, c.step),
                c.lines,
                *map(_per_cent, (c.median_factor, c.lowest_factor, c.highest_factor)),
            )
            for c in report.causes
        ]
        head = headings("cause", "lines", "median", "lowest", "highest")
        parts.append(tell("Causes, with their factor on Cw:\n") + table(head, rows))
    every_line = tell(
        "Every line: A and Cw in kg/m, B in m/s, W per rower at the old declared "
        "speed, seconds that the new register gives in\na two-hour race, rank at "
        "equal power among all boats of the class:\n"
    )
    return page([*parts, every_line + _lines(report.rows), _races(report)], report.simulated)


def _exceeding(report: "DiffReport") -> str:
    """How many lines moved by more than their uncertainty, where that is known of any."""
    known = report.changes.get("changed", 0) > report.interval_unknown
    return str(report.exceeds_interval) if known else tell("not known")


def _group(group: "Group") -> str:
    if not group.lines:
        return tell("no lines")
    return tell(
        "{} lines, median {}, {} in two hours",
        group.lines,
        _per_cent(group.median_power_ratio),
        _seconds(group.median_seconds),
    )


def _lines(rows: list[Row]) -> str:
    head = (
        *headings(
            "boat", "name", "crew", "change", "A old", "new", "B old", "new", "Cw old", "new"
        ),
        *headings("W old", "new", "W %", "in 2 h", "rank", "new", "causes"),
    )
    return table(head, [_line(row) for row in rows])


def _line(row: Row) -> tuple[object, ...]:
    pairs = [
        decimals(row[f"{side}_{name}"], 2)
        for name in ("a_kg_m", "b_m_s", "cw_kg_m", "power_w")
        for side in ("old", "new")
    ]
    causes = "; ".join(f"{_cause(c)} {_per_cent(c['factor'])}" for c in row["causes"])
    return (
        *boat(row),
        _words().word(CHANGES, row["change"])
        if row["change"] != "removed"
        else tell("removed: {}", _words().word(STATUSES, row["new_status"] or "gone")),
        *pairs,
        _per_cent(row["power_ratio"]),
        _seconds(row["gain_in_two_hours_s"]),
        row["old_rank"],
        row["new_rank"],
        causes,
    )


_FATIGUE: Final = {
    "none": say("Races, not corrected for fatigue: "),
    "known": say("Races, corrected for fatigue as published: "),
    "extend": (
        say("Races, corrected for fatigue (beyond 2 to 3 hours by the same power law, inferred): ")
    ),
}


def _races(report: "DiffReport") -> str:
    races, rules = report.races, report.race_rules
    if races is None or rules is None or report.winners is None:
        return tell("Races: the archive holds none.")
    ranked = [r for r in races if r["new_rank"] is not None]
    moved = [r for r in ranked if r["old_rank"] != r["new_rank"]]
    podium = sum(r["podium_changed"] for r in ranked)
    head = tell(_FATIGUE[rules.fatigue])
    text = tell(
        "{}{} results, {} of them ranked by both editions: {} change rank among those, "
        "{} on or off the podium.",
        head,
        len(races),
        len(ranked),
        len(moved),
        podium,
    )
    parts = [text, tell("Winners:\n{}", _winners(report.winners))]
    if moved:
        parts.append(tell("Ranks that change:\n{}", _moved(moved)))
    return "\n".join(parts)


def _winners(winners: list[Row]) -> str:
    rows = [
        (
            w["race"],
            str(w["race_date"]),
            _words().word(CREWS, w["crew_class"]),
            w["old_winner"],
            w["new_winner"],
            _same_winner(w),
            tell("not known")
            if w["change_probability"] is None
            else in_per_cent(w["change_probability"]),
        )
        for w in winners
    ]
    head = headings(
        "race", "day", "class", "old winner", "new winner", "", "chance that another wins"
    )
    note = tell(
        "  The chance: in how many of the equally likely new registers the old winner loses."
    )
    return f"{table(head, rows)}\n{note}"


def _same_winner(winner: Row) -> str:
    if winner["old_winner"] is None:
        return ""
    return tell("changes") if winner["winner_changed"] else tell("the same")


def _moved(moved: list[Row]) -> str:
    rows = [
        (
            r["race"],
            str(r["race_date"]),
            r["fsn_no"],
            f"{r['rowers']}{r['crew_class']}",
            decimals(r["old_power_w"], 2),
            decimals(r["new_power_w"], 2),
            r["old_rank"],
            r["new_rank"],
            "podium" if r["podium_changed"] else "",
        )
        for r in moved
    ]
    columns = headings("race", "day", "boat", "crew", "old W", "new W", "old rank", "new rank", "")
    return table(columns, rows)


def verify(report: "Verification") -> str:
    """What was checked and what is wrong."""
    if not report.editions and not report.findings:
        return tell("No edition has been published yet; nothing to verify.")
    rows = [
        (e.edition, code_in_words(e.kind), e.lines, e.made_again, e.equal) for e in report.editions
    ]
    head = headings("edition", "kind", "lines", "made again", "equal")
    parts = [
        tell(
            "{}\nMade again: measured lines from the samples files of the archive, carried "
            "lines from the printed edition,\nprinted lines from the register in the archive.",
            table(head, rows),
        )
    ]
    if report.findings:
        findings = [
            (
                *(
                    f.edition,
                    tell("WRONG" if f.wrong else "notice"),
                    tell(KINDS.get(f.kind, f.kind)),
                ),
                *(f.where, f.message),
            )
            for f in report.findings
        ]
        parts.append(table(headings("edition", "", "kind", "where", "what"), findings))
    if report.head is not None:
        parts.append(
            tell(
                "Head: {}\nThe seal of the last edition. Keep it, for example in the "
                "minutes: whoever has it can tell later whether\nany edition was made "
                "anew.",
                report.head,
            )
        )
    parts.append(_verdict(report.findings))
    return "\n\n".join(parts)


def _verdict(findings: list["Finding"]) -> str:
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


def lineage(report: "Lineage") -> str:
    """From a line to files, runs and seconds."""
    about = report.about
    head = tell(
        "Edition {}, valid from {}, method {} ({}), code {}. Decision: {}",
        about["edition"],
        about["valid_from"],
        about["method"] or tell("as printed"),
        (about["method_hash"] or "-")[:12],
        about["code_version"],
        about["decision"],
    )
    return page([head, *map(_line_history, report.lines)], about["simulated"])


def _line_history(line: "LineLineage") -> str:
    printed = "; ".join(f"{header} {cell}" for header, cell in line.printed.items() if cell)
    parts = [tell("Verification code {}\n  {}", line.code, printed)]
    if line.tow is None:
        parts.append(tell("  No tow of the archive is behind this line."))
        return "\n".join(parts)
    files = "\n".join(f"    {f['path']}  sha256 {f['sha256']}" for f in line.files)
    parts.append(tell("  Tow {} of {}, from\n{}", line.tow["tow_id"], line.tow["tow_date"], files))
    rows = [
        (
            run["run"],
            window(run),
            run["speed_m_s"],
            run["cw_kg_m"],
            tell("yes") if run["used"] else tell("no: {}", code_in_words(run["reason"])),
        )
        for run in line.runs
    ]
    parts.append(table(headings("run", "seconds", "v m/s", "Cw kg/m", "counts"), rows))
    return "\n".join(parts)


def _cause(cause: Row) -> str:
    return _words().cause(cause["cause"], cause.get("step"))


def _per_cent(ratio: float | None) -> str:
    return _words().per_cent(ratio)


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:+.0f} s"
