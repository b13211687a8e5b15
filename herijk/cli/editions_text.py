"""Results of the commands about editions as text for a person."""

from collections import Counter
from typing import Any

from herijk.cli.text import SIMULATED, table
from herijk.warehouse.editions.words import ENGLISH

Report = dict[str, Any]
KINDS = {"recomputed": "recomputed", "as_printed": "as printed"}


def _to_look_at(lines: list[Report]) -> list[str]:
    """Which lines are marked or left empty, one a line; nothing where none is."""
    if not lines:
        return []
    rows = [
        f"  {line['fsn_no']} {line['rowers']}{line['crew_class']}: "
        + (
            f"tow {line['tow_id']}: {', '.join(line['flags'])}"
            if line["tow_id"]
            else "no numbers: the archive rules its tows out (see doubts in the table tows)"
        )
        for line in lines
    ]
    return [
        f"{len(lines)} lines need a look; they are marked in the register. Look at each with "
        "herijk audit, and write what you decide in besluiten.toml:",
        *rows,
    ]


def register(report: Report) -> str:
    """The lines of an edition, and the day on which their validity was judged."""
    head = (
        *("boat", "name", "crew", "empty thwart", "status", "valid until", "tow", "v m/s"),
        *("A kg/m", "B m/s", "Cw kg/m", "length m", "beam m", "bow m", "kg"),
    )
    parts = [SIMULATED] if report["simulated"] else []
    counts = Counter(line["status"] for line in report["lines"])
    statuses = ", ".join(f"{n} {ENGLISH.statuses.get(s, s)}" for s, n in counts.items())
    parts += [
        f"Register {report['edition']}, validity judged on {report['as_of']}: {statuses}.",
        table(head, [_register_line(line) for line in report["lines"]]),
    ]
    return "\n\n".join(parts)


def _register_line(line: Report) -> tuple[Any, ...]:
    return (
        line["fsn_no"],
        line["name"] or "-",
        f"{line['rowers']}{line['crew_class']}",
        line["empty_thwart"] or "-",
        ENGLISH.statuses.get(line["status"], line["status"]),
        line["valid_until"],
        line["tow_id"],
        *(line[name] for name in ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m")),
        *(line[name] for name in ("waterline_length_m", "beam_m", "bow_height_m", "weight_kg")),
    )


def published(report: Report) -> str:
    """An edition that was just published."""
    lines = report["tables"]["register"]["rows"]
    source = report["method"] or "as printed"
    statuses = ", ".join(f"{n} {ENGLISH.statuses[s]}" for s, n in report["statuses"].items())
    compared = (
        f"Compared with {report['previous']}: herijk diff {report['previous']} {report['edition']}"
        if report["previous"]
        else "There is no earlier edition to compare it with."
    )
    return "\n".join(
        [
            *([SIMULATED] if report["simulated"] else []),
            f"Published {report['edition']}: {lines} lines ({statuses}), method {source}, valid "
            f"from {report['valid_from']}.",
            f"Decision: {report['decision']}",
            compared,
            *_to_look_at(report["to_look_at"]),
            f"Seal, to be kept in the minutes: {report['seal']}",
            f"Folder: {report['folder']}",
            "  register.xlsx, register.csv        the register",
            "  bericht.md, notice.md              one page for the members, Dutch and English",
            "  toelichting.md, release_notes.md   release notes, Dutch and English",
            "It is never changed. To see that it stays so: herijk verify",
        ]
    )


def diff(report: Report) -> str:
    """Two editions side by side."""
    parts = [SIMULATED] if report["simulated"] else []
    counts = ", ".join(f"{count} {change}" for change, count in report["changes"].items())
    parts.append(f"{report['from_edition']} -> {report['to_edition']}: {counts or 'no lines'}.")
    parts.append(
        f"Gain (more power for the same race): {_group(report['gain'])}\n"
        f"Lose: {_group(report['loss'])}\n"
        f"Larger than the intervals of both: {report['exceeds_interval']}; interval not known "
        f"for {report['interval_unknown']}."
    )
    parts += [
        f"The interval of {edition} is the spread of the runs alone: the log's error is not in it."
        for edition in report["runs_alone"]
    ]
    if report["causes"]:
        rows = [
            (
                _cause(c),
                c["lines"],
                *(_per_cent(c[f"{n}_factor"]) for n in ("median", "lowest", "highest")),
            )
            for c in report["causes"]
        ]
        head = ("cause", "lines", "median", "lowest", "highest")
        parts.append("Causes, with their factor on Cw:\n" + table(head, rows))
    parts.append(
        "Every line: A and Cw in kg/m, B in m/s, W per rower at the old declared speed, seconds "
        "that the new register gives in\na two-hour race, rank at equal power among all boats of "
        "the class:\n" + _lines(report["rows"])
    )
    parts.append(_races(report))
    return "\n\n".join(parts)


def _group(group: Report) -> str:
    if not group["lines"]:
        return "no lines"
    return (
        f"{group['lines']} lines, median {_per_cent(group['median_power_ratio'])}, "
        f"{_seconds(group['median_seconds'])} in two hours"
    )


def _lines(rows: list[Report]) -> str:
    head = (
        *("boat", "name", "crew", "change", "A old", "new", "B old", "new", "Cw old", "new"),
        *("W old", "new", "Cw %", "in 2 h", "rank", "new", "causes"),
    )
    return table(head, [_line(row) for row in rows])


def _line(row: Report) -> tuple[Any, ...]:
    pairs = [
        _number(row[f"{side}_{name}"])
        for name in ("a_kg_m", "b_m_s", "cw_kg_m", "power_w")
        for side in ("old", "new")
    ]
    causes = "; ".join(f"{_cause(c)} {_per_cent(c['factor'])}" for c in row["causes"])
    return (
        row["fsn_no"],
        row["name"] or "-",
        f"{row['rowers']}{row['crew_class']}",
        row["change"] if row["change"] != "removed" else f"removed: {row['new_status'] or 'gone'}",
        *pairs,
        _per_cent(row["cw_ratio"]),
        _seconds(row["gain_in_two_hours_s"]),
        row["old_rank"],
        row["new_rank"],
        causes,
    )


def _races(report: Report) -> str:
    races, rules = report["races"], report["race_rules"]
    if races is None:
        return "Races: the archive holds none."
    moved = [r for r in races if r["old_rank"] != r["new_rank"]]
    podium = sum(r["podium_changed"] for r in races)
    head = f"Races (fatigue {rules['fatigue']}): "
    text = f"{head}{len(races)} results, {len(moved)} change rank, {podium} on or off the podium."
    parts = [text, f"Winners:\n{_winners(report['winners'])}"]
    if moved:
        parts.append(f"Ranks that change:\n{_moved(moved)}")
    return "\n".join(parts)


def _winners(winners: list[Report]) -> str:
    rows = [
        (
            w["race"],
            str(w["race_date"]),
            ENGLISH.crews[w["crew_class"]],
            w["old_winner"],
            w["new_winner"],
            "changes" if w["winner_changed"] else "the same",
            "not known"
            if w["change_probability"] is None
            else f"{100 * w['change_probability']:.0f} %",
        )
        for w in winners
    ]
    head = ("race", "day", "class", "old winner", "new winner", "", "chance that another wins")
    note = "  The chance: in how many of the equally likely new registers the old winner loses."
    return f"{table(head, rows)}\n{note}"


def _moved(moved: list[Report]) -> str:
    rows = [
        (
            r["race"],
            str(r["race_date"]),
            r["fsn_no"],
            f"{r['rowers']}{r['crew_class']}",
            _number(r["old_power_w"]),
            _number(r["new_power_w"]),
            r["old_rank"],
            r["new_rank"],
            "podium" if r["podium_changed"] else "",
        )
        for r in moved
    ]
    columns = ("race", "day", "boat", "crew", "old W", "new W", "old rank", "new rank", "")
    return table(columns, rows)


def verify(report: Report) -> str:
    """What was checked and what is wrong."""
    if not report["editions"] and not report["findings"]:
        return "No edition was published yet; nothing to verify."
    rows = [
        (e["edition"], KINDS[e["kind"]], e["lines"], e["made_again"], e["equal"])
        for e in report["editions"]
    ]
    head = ("edition", "kind", "lines", "made again", "equal")
    parts = [
        f"{table(head, rows)}\nMade again: measured lines from the blocks of the archive, carried "
        "lines from the printed edition, printed lines\nfrom the register in the archive. Lines of "
        "boats that were never towed hold nothing to make. From blocks means\nthat samples files "
        "are compared by their hash, not read again."
    ]
    if report["findings"]:
        rows = [
            (f["edition"], "WRONG" if f["wrong"] else "notice", f["kind"], f["where"], f["message"])
            for f in report["findings"]
        ]
        parts.append(table(("edition", "", "kind", "where", "what"), rows))
    if report["head"] is not None:
        parts.append(
            f"Head: {report['head']}\nThe seal of the last edition. Keep it, for example in the "
            "minutes: whoever has it can tell later whether\nany edition was made anew."
        )
    parts.append(_verdict(report["findings"]))
    return "\n\n".join(parts)


def _verdict(findings: list[Report]) -> str:
    wrong = sum(f["wrong"] for f in findings)
    if wrong:
        return f"{wrong} {'thing is' if wrong == 1 else 'things are'} wrong."
    otherwise = sum(f["kind"] == "differs" for f in findings)
    if otherwise:
        return (
            f"Nothing was altered. The code of today makes {otherwise} of these otherwise; what "
            "was published stands."
        )
    return "Everything is as it was published."


def lineage(report: Report) -> str:
    """From a line to files, runs and seconds."""
    about = report["about"]
    parts = [SIMULATED] if about["simulated"] else []
    parts.append(
        f"Edition {about['edition']}, valid from {about['valid_from']}, method "
        f"{about['method'] or 'as printed'} ({(about['method_hash'] or '-')[:12]}), code "
        f"{about['code_version']}. Decision: {about['decision']}"
    )
    parts += [_line_history(line) for line in report["lines"]]
    return "\n\n".join(parts)


def _line_history(line: Report) -> str:
    printed = "; ".join(f"{header} {cell}" for header, cell in line["printed"].items() if cell)
    parts = [f"Verification code {line['code']}\n  {printed}"]
    if line["tow"] is None:
        parts.append("  No tow of the archive is behind this line.")
        return "\n".join(parts)
    files = "\n".join(f"    {f['path']}  sha256 {f['sha256']}" for f in line["files"])
    parts.append(f"  Tow {line['tow']['tow_id']} of {line['tow']['tow_date']}, from\n{files}")
    rows = [
        (
            run["run"],
            _seconds_of(run),
            run["speed_m_s"],
            run["cw_kg_m"],
            "yes" if run["used"] else f"no: {run['reason']}",
        )
        for run in line["runs"]
    ]
    parts.append(table(("run", "seconds", "v m/s", "Cw kg/m", "counts"), rows))
    return "\n".join(parts)


def _seconds_of(run: Report) -> str:
    if run["window_start_s"] is None:
        return "-"
    return f"{run['window_start_s']:.0f}-{run['window_end_s']:.0f}"


def _cause(cause: Report) -> str:
    return ENGLISH.cause(cause["cause"], cause.get("step"))


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _per_cent(ratio: float | None) -> str:
    return ENGLISH.per_cent(ratio)


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:+.0f} s"
