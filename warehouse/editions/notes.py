"""The release notes of an edition, in Dutch: what, who gains and who loses, from when, objections.

Made from the edition and its comparison with the one before; no number is computed here.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl

from warehouse.editions import sheets
from warehouse.editions.compare import Comparison, Report, report
from warehouse.editions.folder import Edition

CAUSE_WORDS: Final = {
    "tow": "andere sleep telt",
    "input": "gegevens van de sleep gewijzigd",
    "other_input": "gegevens van andere sleepproeven gewijzigd",
    "code": "programma gewijzigd",
    "input_and_code": "gegevens en programma gewijzigd, niet te scheiden",
    "code_or_other_input": "programma of gegevens van andere sleepproeven gewijzigd",
    "method": "methode",
    "printed": "gedrukt register: methode niet vastgelegd",
    "closed_form": "gedrukte A en B omgerekend met de logfactor",
    "unseparated": "methode met gegevens of programma, niet te scheiden",
    "unexplained": "onverklaard",
}
STEP_WORDS: Final = {
    "speed": "snelheidscorrectie",
    "window": "knippen",
    "runs": "runs die tellen",
    "calibration": "ijking",
    "run_point": "runpunt",
    "wind": "wind",
    "temperature": "watertemperatuur",
    "curve": "kromme",
}
CHANGE_WORDS: Final = {
    "added": "nieuw",
    "removed": "vervallen",
    "changed": "gewijzigd",
    "same": "gelijk",
}


def summary(edition: Edition) -> str:
    """One paragraph: what it is, from when, by whose decision."""
    about = edition.about
    simulated = "GESIMULEERD, geen metingen van de federatie. " if about.simulated else ""
    return (
        f"{simulated}Sloepenregister {about.edition}, geldt vanaf {about.valid_from}. Besluit: "
        f"{about.decision}. Rekenmethode: {_method(edition)}."
    )


def release_notes(edition: Edition, previous: Comparison | None) -> str:
    """The notes as Markdown."""
    about = edition.about
    parts = [
        f"# Sloepenregister {about.edition}",
        summary(edition),
        f"Vastgesteld op {about.published_on} met programmaversie {about.code_version}.",
        _what(edition),
        _changes(report(previous)) if previous is not None else _first(),
        "## Bezwaar\n\nWie meent dat een regel niet klopt, meldt dat bij de federatie met het "
        "fsn_nr en de controlecode van die regel. Van elke regel is na te gaan op welke bestanden, "
        f"runs en seconden hij berust: `herijk lineage {about.edition} FSN_NR`.",
        "## Wat er niet bij zit\n\nEr is bij deze uitgave geen ensemble van mogelijke registers: "
        "de onzekerheid staat per regel als interval van Cw.",
    ]
    return "\n\n".join(parts) + "\n"


def _method(edition: Edition) -> str:
    if edition.method is None:
        return "zoals destijds gedrukt; welke methode is niet vastgelegd"
    return f"{edition.method.title} ({edition.method.name}, {edition.method.content_hash[:12]})"


def _what(edition: Edition) -> str:
    counts = edition.register["status"].value_counts().sort("count", "status", descending=True)
    rows = [(sheets.STATUS_WORDS[status], str(count)) for status, count in counts.rows()]
    text = f"## Wat\n\n{_table(('status', 'regels'), rows)}"
    taken = edition.register.filter(pl.col("basis") == "printed_rebased").height
    if taken:
        text += (
            f"\n\nVan {_lines(taken)} zijn de meetgegevens er niet meer. De gedrukte A en B zijn "
            "omgerekend met de logfactor y van het seizoen: A/y² en B·y (basis "
            f"“{sheets.BASIS_WORDS['printed_rebased']}”)."
        )
    return f"{text}\n\nSloepen zonder geldige sleep staan als zodanig vermeld, zonder A, B en Cw."


def _first() -> str:
    return (
        "## Wat verandert er\n\nDit is de eerste uitgave: er is geen eerdere om mee te vergelijken."
    )


def _changes(found: Report) -> str:
    counts = ", ".join(f"{CHANGE_WORDS[c]} {n}" for c, n in found["changes"].items())
    parts = [
        f"## Wat verandert er ten opzichte van {found['from_edition']}",
        f"Regels: {counts or 'geen'}. Meer vermogen bij dezelfde roeitijd krijgen "
        f"{_group(found['gain'])}; minder krijgen {_group(found['loss'])}. Groter dan de "
        "onzekerheid van beide uitgaven samen is de wijziging van "
        f"{_lines(found['exceeds_interval'])}"
        + (
            f" (van {found['interval_unknown']} is de onzekerheid niet bekend)."
            if found["interval_unknown"]
            else "."
        ),
    ]
    if found["causes"]:
        rows = [
            (cause_words(c["cause"], c["step"]), str(c["lines"]), per_cent(c["median_factor"]))
            for c in found["causes"]
        ]
        parts.append("Oorzaken:\n\n" + _table(("oorzaak", "regels", "mediaan in Cw"), rows))
    if found["largest"]:
        parts.append("Grootste wijzigingen:\n\n" + _largest(found))
    return "\n\n".join(parts)


def _group(group: Report) -> str:
    if not group["lines"]:
        return _lines(0)
    return (
        f"{_lines(group['lines'])} (mediaan {per_cent(group['median_power_ratio'])}, "
        f"{seconds(group['median_seconds'])} in een race van twee uur)"
    )


def _lines(count: int) -> str:
    return "1 regel" if count == 1 else f"{count} regels"


def _largest(found: Report) -> str:
    rows = [
        (
            line["fsn_no"],
            line["name"] or "",
            f"{line['rowers']}{line['crew_class']}",
            _number(line["old_cw_kg_m"]),
            _number(line["new_cw_kg_m"]),
            per_cent(line["power_ratio"]),
            seconds(line["gain_in_two_hours_s"]),
            "; ".join(
                f"{cause_words(c['cause'], c.get('step'))} {per_cent(c['factor'])}"
                for c in line["causes"]
            ),
        )
        for line in found["largest"]
    ]
    head = ("sloep", "naam", "ploeg", "Cw oud", "Cw nieuw", "vermogen", "in twee uur", "oorzaken")
    return _table(head, rows)


def cause_words(cause: str, step: str | None) -> str:
    """A cause as people say it."""
    words = CAUSE_WORDS.get(cause, cause)
    return f"{words}: {STEP_WORDS.get(step, step)}" if step else words


def per_cent(ratio: float | None) -> str:
    """A ratio as a change in per cent, with a decimal comma."""
    return "-" if ratio is None else f"{100 * (ratio - 1):+.2f} %".replace(".", ",")


def seconds(value: float | None) -> str:
    """Seconds with their sign."""
    return "-" if value is None else f"{value:+.0f} s"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}".replace(".", ",")


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(_cell(c) for c in line) + " |" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", r"\|").replace("\n", " ")
