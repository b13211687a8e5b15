"""Documents on paper: certificates, a proposal to the members, and the notice of an edition."""

import datetime as dt
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Final

import polars as pl
import segno
from markupsafe import Markup

from dashboards.addresses import boat_path
from dashboards.queries.methods import read_method
from dashboards.queries.pages import measure_fatigue_range, pick_cause, sum_up_changes
from dashboards.queries.results import Data, Results
from pipeline.method.definition import COMPLETE, RUNS_ALONE
from pipeline.register.causes import summarise_causes
from pipeline.register.register import name_draft
from pipeline.tables.keys import UNKNOWN_TYPE
from pipeline.tables.row import Row, pick_columns
from warehouse.queries.answers import compare_editions, compare_races
from warehouse.queries.documents import (
    SMOOTH_SPEEDS,
    SPEEDS,
    compute_line_curve,
    read_certificate_lines,
)
from warehouse.queries.views import Views

MAX_CREWS_NAMED: Final = 10
"""Largest number of crews that a proposal names as gaining most, and as losing most."""

MEASURES: Final = {
    "a_kg_m": 3, "b_m_s": 3, "declared_speed_m_s": 2, "waterline_length_m": 2, "beam_m": 2,
    "bow_height_m": 2, "weight_kg": 0,
}  # fmt: skip
"""Measures of a line on its certificate, with their decimals."""


def read_certificates(
    views: Views,
    edition: str,
    fsn_no: str | None,
    *,
    day: dt.date | None = None,
    issuer: str = "",
    site: str = "",
    border: Callable[[str], AbstractContextManager[object]] = nullcontext,
) -> list[Data]:
    """Return the certificates of a boat in an edition, or of all boats, one per crew.

    Args:
        views: the open database.
        edition: an edition or draft.
        fsn_no: the number of the boat; None for all.
        day: on which it is said whether they hold; None for the day on which the register judged.
        issuer: the federation; "" where it gave no name.
        site: where its pages are, to which the QR code leads; "" where nowhere.
        border: goes round the making of each.

    Raises:
        MissingKnowledgeError: there is no such edition, or no valid line in it.
    """
    about, objection = views.about(), Results(views).objection
    made = []
    for line in read_certificate_lines(views, edition, fsn_no):
        whose = f"{line['fsn_no']} {line['rowers']}{line['crew_class']}"
        with border(f"certificate {edition} {whose}"):
            made.append(
                _describe_certificate(line, day or line["as_of"], site)
                | {
                    "issuer": issuer,
                    "objection": objection,
                    "made_by": line["code_version"] or about.get("code_version", ""),
                }
            )
    return made


def _describe_certificate(line: Row, day: dt.date, site: str) -> Data:
    """Return a line with its curve, the power that it asks, and the code that a phone reads."""
    smooth = compute_line_curve(line, SMOOTH_SPEEDS)
    ends = pick_columns(line, ("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"))
    declared = pl.DataFrame([{"speed_m_s": line["declared_speed_m_s"], **ends, "kind": "declared"}])
    interval = COMPLETE if line["new_log_known"] else RUNS_ALONE
    curve = pl.concat([smooth.with_columns(kind=pl.lit("line")), declared], how="diagonal_relaxed")
    until = line["valid_until"]
    is_expired = line["status"] == "expired" or (until is not None and until < day)
    return {
        "line": line,
        "day": day,
        "status": "draft"
        if not line["verification_code"]
        else "expired"
        if is_expired
        else "valid",
        "measures": MEASURES,
        "powers": compute_line_curve(line, SPEEDS),
        "curve": curve.with_columns(
            interval=pl.lit(interval), method=pl.lit(line["method"] or line["edition"])
        ),
        "qr": _draw_qr(line, site),
    }


def _draw_qr(line: Row, site: str) -> Markup:
    """Return the code that leads to the boat's page; nothing where the site has no address."""
    code = line["verification_code"]
    if not code or not site:
        return Markup()
    crew = f"{line['rowers']}{line['crew_class']}"
    address = f"{site.rstrip('/')}/{boat_path(line['fsn_no'])}?code={code}#{crew}"
    drawn = segno.make(address, micro=False).svg_inline(scale=4, border=1)
    return Markup(drawn)  # noqa: S704 - has no text in it


def read_proposal(
    views: Views,
    methods: Sequence[str],
    against: str,
    titles: Mapping[str, str],
    letter: Data,
) -> Data:
    """Return the effect of methods against an edition, by crew and type, with its uncertainty.

    Args:
        views: the open database.
        methods: one for a proposal, several for a ballot.
        against: the edition or draft that counts now.
        titles: of the methods.
        letter: `sender`, `date` and `valid_from`; what is not known is "" or None.

    Raises:
        MissingKnowledgeError: the last rebuild did not apply such a method, or there is no such
            edition.
    """
    results = Results(views)
    proposals = []
    for method in methods:
        lines = compare_editions(views, against, name_draft(method), letter["valid_from"])
        proposals.append(
            _describe_proposal(views, against, method, lines)
            | {"title": titles[method], "explained": read_method(results, method)}
        )
    return {
        "letter": letter,
        "objection": results.objection,
        "against": against,
        "proposals": proposals,
        "ballot": pl.DataFrame([one["effect"] for one in proposals], infer_schema_length=None),
        "guide": proposals[0]["explained"]["guide"],
        "code_version": views.about().get("code_version", ""),
    }


def _describe_proposal(views: Views, against: str, method: str, lines: pl.DataFrame) -> Data:
    """Return the effect of one method."""
    gain = pl.col("gain_in_two_hours_s")
    moved = lines.filter(change="changed").drop_nulls("gain_in_two_hours_s").sort(gain, "fsn_no")
    flagged = views.ask("flagged_boats").filter(method=method)["tow_id"]
    voted = lines.drop_nulls("new_cw_kg_m")["new_tow_id"]
    causes = sorted(summarise_causes(lines), key=lambda one: -abs(one["median_factor"] - 1))
    changed = sum_up_changes(lines)
    effects = measure_effects(lines)
    effect = {"method": method, "changed": changed["changed"]}
    return {
        "method_name": method,
        "changed": changed,
        "effect": effect | (effects.row(0, named=True) if effects.height else {}),
        "causes": [one | {"main_cause": pick_cause(one)} for one in causes],
        "types": measure_effects(lines, "boat_type", "crew_class"),
        "moved": moved,
        "gaining": moved.filter(gain > 0).reverse().head(MAX_CREWS_NAMED),
        "losing": moved.filter(gain < 0).head(MAX_CREWS_NAMED),
        "unknown": int(lines["exceeds_interval"].null_count()),
        "flagged": {"flagged": int(voted.is_in(flagged.implode()).sum()), "lines": voted.len()},
        **_replay_races(views, against, name_draft(method)),
    }


def measure_effects(lines: pl.DataFrame, *by: str) -> pl.DataFrame:
    """Return the change of lines that have a number on both sides, by these columns.

    Men come before women.

    Returns:
        The columns of `by`, number of `lines`, `median_ratio`, `lowest_ratio` and `highest_ratio`
        of Cw, `median_seconds` gained over two hours, and `beyond`: how many change by more than
        their uncertainty, None where that is not known.
    """
    ratio, beyond = pl.col("cw_ratio"), pl.col("exceeds_interval")
    known = lines.filter(ratio.is_not_null()).with_columns(
        pl.col("boat_type").replace("", None).fill_null(UNKNOWN_TYPE)
    )
    measures = (
        pl.len().alias("lines"),
        ratio.median().alias("median_ratio"),
        ratio.min().alias("lowest_ratio"),
        ratio.max().alias("highest_ratio"),
        pl.col("gain_in_two_hours_s").median().alias("median_seconds"),
        pl.when(beyond.count() > 0).then(beyond.sum()).alias("beyond"),
    )
    if not by:
        return known.select(measures).filter(pl.col("lines") > 0)
    grouped = known.group_by(by, maintain_order=True).agg(measures)
    return grouped.sort(by, descending=[name == "crew_class" for name in by])


def _replay_races(views: Views, old: str, new: str) -> Data:
    """Return who wins the races of the last season, and how many results change place."""
    winners, (n_moved, n_results) = compare_races(views, old, new)
    last = winners.filter(pl.col("race_date").dt.year() == winners["race_date"].dt.year().max())
    names = dict(views.table("boats").select("fsn_no", "name").drop_nulls().rows())
    races = last.filter("winner_changed").select("race", "race_date")
    results = views.store.read("listed_races")
    times_s = results.join(races, on=["race", "race_date"], how="semi")["rowing_time_s"]
    return {
        "year": last["race_date"][0].year if last.height else None,
        "winners": last.with_columns(pl.col("old_winner", "new_winner").replace(names)),
        "places": {"moved": n_moved, "results": n_results},
        "fatigue": measure_fatigue_range(times_s),
    }
