"""The certificate of a boat and crew: one page A4, and all of an edition in one file."""

import datetime as dt
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Final

import polars as pl
import segno

from dashboards import drawn, labels
from dashboards.addresses import boat_path
from dashboards.columns import written
from dashboards.documents import pdf
from dashboards.speech import Speech, Text
from dashboards.statements import EditionName, number, told
from dashboards.statements.boat import crew_name, interval
from pipeline.messages import Sentence, pgettext, say
from pipeline.method.definition import COMPLETE, RUNS_ALONE
from pipeline.tables.row import Row
from warehouse.queries.documents import certificate_lines, draw_line_curve
from warehouse.queries.views import Views
from warehouse.store.unforeseen import Border

READING: Final = (
    say("Cw is the tow force divided by the speed squared. The lower, the easier the boat runs."),
    say("Cw = A / (1 - (v/B)²) holds from 85 to 115 % of the declared speed."),
    say(
        "The power is what each rower gives on average at that speed, in still water and still air."
    ),
)


MEASURES: Final = {
    "a_kg_m": 3, "b_m_s": 3, "declared_speed_m_s": 2, "waterline_length_m": 2, "beam_m": 2,
    "bow_height_m": 2, "weight_kg": 0,
}  # fmt: skip
"""Measures of a line, with their decimals."""
HEADLINE: Final = say("Cw {cw_kg_m} kg/m at {declared_speed_m_s} m/s")
NOT_KNOWN: Final = "\u2013"
SIZE: Final = {"width": 340, "height": 190}
"""Of the curve [px]."""


@dataclass(frozen=True)
class Issued:
    """By whom and when certificates are made.

    Attributes:
        day: on which it is said whether they hold; None for the day on which the register judged
            its lines.
        issuer: the federation; "" where it gave no name.
        site: where its pages are, to which the QR code leads; "" where nowhere.
    """

    day: dt.date | None = None
    issuer: str = ""
    site: str = ""


def certificates(
    views: Views,
    edition: str,
    fsn_no: str | None,
    language: str,
    issued: Issued,
    border: Border = nullcontext,
) -> bytes | None:
    """The certificates of a boat in an edition, or of all boats, as PDF.

    Each is made within a border; nothing is given where none could be made.

    Raises:
        MissingKnowledgeError: there is no such edition, or no valid line in it.
    """
    speech = Speech(language)
    say = speech.say
    about = views.about()
    lines = certificate_lines(views, edition, fsn_no)
    made = []
    for line in lines:
        whose = f"{line['fsn_no']} {line['rowers']}{line['crew_class']}"
        with border(f"certificate {edition} {whose}"):
            made.append(_one(line, issued, speech))
    if not made:
        return None
    made_by = lines[0]["code_version"] or about.get("code_version", "")
    content = {
        "language": language,
        "title": f"{say('Certificate')} {fsn_no or ''} {edition}".replace("  ", " "),
        "kind": f"{say('Certificate')} · {speech.edition(edition)}",
        "simulated": say(labels.SIMULATED) if views.simulated(edition) else "",
        "curve_title": say("Resistance curve"),
        "power_title": say("Power at speed"),
        "power_head": [say("Speed [m/s]"), say("Cw [kg/m]"), say("W/rower")],
        "reading_title": say("How to read this certificate"),
        "reading": [say(text) for text in READING],
        "others_title": say("The other crews of this boat in this register"),
        "others_head": [say(text) for text in OTHERS],
        "checking_title": say("How to check it"),
        "footing": f"{say('Made by code')} {made_by}",
        "certificates": made,
    }
    return pdf("certificate.typ", content)


def _one(line: Row, issued: Issued, speech: Speech) -> dict[str, object]:
    say, words = speech.say, speech.words
    code = line["verification_code"] or ""
    crew, curve = crew_name(line, speech), draw_line_curve(line)
    return {
        "name": line["name"] or line["fsn_no"],
        "subtitle": " · ".join(filter(None, (line["fsn_no"], line["boat_type"], crew))),
        "code": code,
        "qr": _qr(line, code, issued.site),
        "headline": words(told("certified", HEADLINE, line)),
        "interval": _interval(line, speech),
        "validity": _validity(line, issued.day or line["as_of"], speech),
        "left": [
            (
                labels.unbroken(say(labels.column(column))),
                NOT_KNOWN if line[column] is None else words(number(line, column, digits)),
            )
            for column, digits in MEASURES.items()
        ],
        "right": _terms(line, issued.issuer, speech),
        "others": [_other(other, speech) for other in line["others"]],
        "curve": _picture(line, curve, speech.language),
        "curve_note": say(
            "Cw against speed, from A and B; the bar is the interval at the declared speed"
        ),
        "curve_alt": f"{say('Resistance curve')} {line['fsn_no']} {crew}",
        "powers": [
            [words(number(row, column)) for column in row] for row in curve.iter_rows(named=True)
        ],
        "checking": say(
            "Look {fsn_no} up in the register of edition {edition}: the same verification "
            "code {code} must be there, with the same numbers. If something is wrong, tell the "
            "committee."
            if code
            else "This line is not published and has no verification code.",
            code=code,
            fsn_no=line["fsn_no"],
            edition=line["edition"],
        ),
    }


def _picture(line: Row, curve: pl.DataFrame, language: str) -> str:
    """The curve, and the interval of Cw at the declared speed."""
    ends = ("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")
    declared = {"speed_m_s": line["declared_speed_m_s"]} | {name: line[name] for name in ends}
    kinds = {"line": curve, "declared": pl.DataFrame([declared])}
    rows = [rows.with_columns(kind=pl.lit(kind)) for kind, rows in kinds.items()]
    spec = drawn.specification("certificate_curve", language) | SIZE
    interval = COMPLETE if line["log_known"] else RUNS_ALONE
    drawn_rows = pl.concat(rows, how="diagonal_relaxed").with_columns(interval=pl.lit(interval))
    return drawn.svg(spec, drawn_rows, language)


def _qr(line: Row, code: str, site: str) -> str:
    """What a phone reads: the page of the boat, or the words that the search for a line takes."""
    if not code:
        return ""
    crew = f"{line['rowers']}{line['crew_class']}"
    text = f"{line['edition']} {line['fsn_no']} {crew} {code}"
    if site:
        text = f"{site.rstrip('/')}/{boat_path(line['fsn_no'])}?code={code}#{crew}"
    return str(segno.make(text, micro=False).svg_inline(scale=4, border=1))


def _validity(line: Row, day: dt.date, speech: Speech) -> str:
    """Whether it is a valid certificate on a day."""
    if not line["verification_code"]:
        return speech.say("Draft: not decided, and so no valid certificate.")
    until = line["valid_until"]
    if line["status"] == "expired" or (until is not None and until < day):
        return speech.say(say("Expired: no longer valid on {}.", speech.day(day)))
    return speech.say(say("Valid on {}.", speech.day(day)))


OTHERS: Final = (say("Crew"), say("Cw [kg/m]"), say("Speed [m/s]"), say("Valid until"))


def _other(line: Row, speech: Speech) -> list[str]:
    """Another crew of the boat: its number, or why it has none."""
    names, until = ("cw_kg_m", "declared_speed_m_s"), line["valid_until"]
    numbers = (NOT_KNOWN if line[name] is None else number(line, name) for name in names)
    known = line["cw_kg_m"] is not None and until is not None
    last = until if known else labels.code(line["status"])
    return [crew_name(line, speech), *map(speech.words, (*numbers, last))]


def _interval(line: Row, speech: Speech) -> str:
    if line["cw_lo_kg_m"] is None or line["cw_hi_kg_m"] is None:
        return speech.say("The uncertainty of this number is not known.")
    return interval(line, line["log_known"])(speech)


def _terms(line: Row, issuer: str, speech: Speech) -> list[tuple[str, str]]:
    """From which tow and by which method, on whose decision, and how long it holds."""
    method: Text | None = line["method"] and labels.method(line["method"])
    if line["basis"] == "printed_rebased":
        method = say("{} ({})", method, labels.code("printed_rebased"))
    before: Text | None = None
    if line["old_cw_kg_m"] is not None:
        wording, edition = (
            say("{old_cw_kg_m}\u00a0kg/m ({edition})"),
            EditionName(line["from_edition"]),
        )
        before = told("before", wording, line, edition=edition)
    rows: list[tuple[Sentence, Text | None]] = [
        (say("Tow of"), line["tow_date"]),
        (labels.column("tow_id"), line["tow_id"]),
        (say("Cw before"), before),
        (labels.column("valid_from"), line["valid_from"]),
        (pgettext("certificate", "Valid until"), line["valid_until"]),
        (labels.column("edition"), EditionName(line["edition"])),
        (labels.column("method"), method),
        (say("Issued by"), issuer),
        (labels.column("decision"), line["decision"]),
        (labels.column("empty_thwart"), line["empty_thwart"] or labels.code("none")),
    ]
    terms = [(speech.say(name), speech.words(value or NOT_KNOWN)) for name, value in rows]
    if line["flags"]:
        terms.append((speech.say(labels.column("flags")), written("flags", line["flags"], speech)))
    return terms
