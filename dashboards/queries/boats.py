"""A boat: the answer about each of its crews, and how every tow came to its number."""

import json
from collections.abc import Sequence
from itertools import accumulate
from math import prod
from operator import mul
from typing import Any, Final

import polars as pl

from dashboards.queries.results import Data, Results
from pipeline.method.options import find_basis
from pipeline.method.variant import Difference, list_differences
from pipeline.register.register import name_draft
from pipeline.tables.display import STEP_CHANGE
from pipeline.tables.row import Row, get_key
from warehouse.queries.answers import (
    add_peers,
    list_season_faults,
    read_line_answers,
    select_own_races,
)
from warehouse.queries.views import DRAFT, prepare_curve_figure
from warehouse.store.methods import KnownMethods

NEGLIGIBLE_CHANGE: Final = 5e-4
"""A cause that changes Cw by a smaller share is shown as 0.0 %; such causes are summed as one."""

BAR_MARGIN: Final = 0.25
"""Room on either side of the bars of a change, as a share of their range."""

CREW: Final = ("fsn_no", "rowers", "crew_class")

_SET_ASIDE: Final = r"""
SELECT * FROM quarantine
WHERE regexp_matches(message, '\b' || regexp_escape(?) || '\b')
   OR starts_with(lower(parse_filename(path)), lower(?) || ' ')
ORDER BY path, line
"""


def read_boat(
    results: Results,
    fsn_no: str,
    *,
    edition: str | None = None,
    methods: Sequence[str] | None = None,
    tow_id: str | None = None,
) -> Data:
    """Return the data of the page of a boat and of `herijk audit BOAT`.

    Args:
        results: the tables.
        fsn_no: the number of the boat.
        edition: the edition or draft that the answers are about; the one that counts when left out.
        methods: methods whose results are shown; those of `Results.compared_methods` when left out.
        tow_id: the tow that is shown first; the newest when left out.

    Raises:
        MissingKnowledgeError: there is no such edition.
    """
    shown = list(methods or results.compared_methods)
    chosen_edition = results.choose_edition(edition)

    def own(source: str) -> pl.DataFrame:
        rows = results.select_boat(source, fsn_no)
        is_per_method = "method" in rows.columns
        return rows.filter(pl.col("method").is_in(shown)) if is_per_method else rows

    boat = results.select_boat("boats", fsn_no).row(0, named=True)
    is_draft = pl.col("edition").str.starts_with(DRAFT)
    of_editions = ~is_draft | pl.col("edition").is_in(list(map(name_draft, shown)))
    curves = own("curves").with_columns(
        tow=pl.format("{} · {}{}", "tow_date", "rowers", "crew_class")
    )
    runs = own("run_points").sort("tow_id", "run", maintain_order=True)
    figure = prepare_curve_figure(own("curve_points"), runs, curves)
    tows = dict(curves.select("tow_id", "tow").rows())
    crews = read_answers(results, chosen_edition).get(fsn_no, []) if tows else []
    acceptances = own("acceptances")
    accepted = acceptances.filter("newest").select("tow_id", "accepted_on", "accepted_by").unique()
    lineage = results.select_boat("lineage", fsn_no).filter(of_editions)
    budget = own("uncertainty_budget").filter(pl.col("u_ratio") >= NEGLIGIBLE_CHANGE)
    return {
        "methods": [name for name in shown if name in curves["method"].unique()],
        "boat": boat,
        "answers": crews,
        "has_sheet": fsn_no in results.valid_boats,
        "edition": chosen_edition,
        "register": _leave_out_repeated_drafts(
            results.select_boat("register", fsn_no).filter(of_editions)
        ),
        "tows": results.select_boat("tows", fsn_no).sort("tow_date", "tow_id"),
        "curves": curves,
        "steps": _tabulate_steps(select_own_steps(results, fsn_no, shown)),
        "runs": runs.with_columns(run_cw_kg_m="cw_kg_m"),
        "currents": own("tow_currents"),
        "budget": budget.sort("u_ratio", descending=True, maintain_order=True),
        "in_type": own("compared_tows"),
        "repeat_pairs": own("repeat_pairs").with_columns(cw_ratio=pl.col("ln_ratio").exp()),
        "predicted": own("predicted_cw"),
        "checks": own("flagged"),
        "hand_windows": results.select_boat("hand_windows", fsn_no),
        "acceptances": acceptances,
        "lineage": lineage.join(accepted, on="tow_id", how="left", maintain_order="left"),
        "set_aside": results.views.frame(_SET_ASIDE, fsn_no, boat["name"] or fsn_no).to_dicts(),
        "drawn": {
            "curve": pl.concat(figure.values(), how="diagonal_relaxed"),
            "seconds": results.select_boat("trace_seconds", fsn_no),
        },
        "tow_names": tows,
        "chosen": {
            "tow_id": tow_id or next(reversed(tows), ""),
            "method": results.method if results.method in shown else shown[-1],
        },
    }


def select_own_steps(results: Results, fsn_no: str, methods: Sequence[str]) -> pl.DataFrame:
    """Return the rows of `correction_steps` of a boat between these methods."""
    is_shown = pl.col("from_method").is_in(methods) & pl.col("to_method").is_in(methods)
    return results.select_boat("correction_steps", fsn_no).filter(is_shown)


def _tabulate_steps(steps: pl.DataFrame) -> pl.DataFrame:
    """Return a row per tow and pair of methods, with the factor of each step on Cw.

    Returns:
        `tow_id`, `from_method`, `to_method`, `total`, and per step the step with `STEP_CHANGE`.
    """
    key = ["tow_id", "from_method", "to_method"]
    total = steps.group_by(key, maintain_order=True).agg(total=pl.col("factor").product())
    factors = steps.filter(pl.col("position") > 0).with_columns(column=pl.col("step") + STEP_CHANGE)
    if factors.is_empty():
        return total.clear()
    wide = factors.pivot("column", index=key, values="factor", aggregate_function="first")
    return total.join(wide, on=key, how="left", maintain_order="left")


def _leave_out_repeated_drafts(register: pl.DataFrame) -> pl.DataFrame:
    """Return lines of a boat without drafts that say what an edition of their method says."""
    same = ["method", "fsn_no", "rowers", "crew_class", "tow_id", "cw_kg_m"]
    is_draft = pl.col("edition").str.starts_with(DRAFT)
    repeated = register.filter(is_draft).join(
        register.filter(~is_draft), on=same, how="semi", nulls_equal=True
    )
    return register.join(repeated, on=["edition", *same], how="anti", nulls_equal=True)


# -- Answers ----------------------------------------------------------------------------------


def read_answers(results: Results, edition: str) -> dict[str, list[Row]]:
    """Return the answer about each crew in an edition, by boat.

    Returns:
        Rows of `warehouse.queries.answers.read_line_answers` with `races`, `faults`, `causes`,
        `bars` (see `measure_bars`), `cw_verdict` (same, lower or higher), `has_moved` since the tow
        before, `peers` (Cw of the other boats of its type and class), the interval of the old
        number, `decided_steps`: those of which nothing is put to the vote, and `Results.objection`.
    """
    if edition in results.answers:
        return results.answers[edition]
    lines = read_line_answers(results.views, edition)
    previous = next(iter(lines["from_edition"].drop_nulls()), None)
    races = select_own_races(results.views, previous, edition)
    races_by_crew = races.partition_by(CREW, as_dict=True, maintain_order=True)
    # An edition holds no faults of instruments.
    faults = list_season_faults(results.views) if edition.startswith(DRAFT) else {}
    ends = ["cw_lo_kg_m", "cw_hi_kg_m"]
    old_ends = results.register.filter(edition=previous or "").select(
        *CREW, "empty_thwart", *(pl.col(name).alias(f"old_{name}") for name in ends)
    )
    lines = add_peers(lines).join(
        old_ends, on=[*CREW, "empty_thwart"], how="left", maintain_order="left", nulls_equal=True
    )
    decided_steps = find_decided_steps(find_changed_options(results, previous, edition))
    by_boat: dict[str, list[Row]] = {}
    for line in lines.to_dicts():
        own = races_by_crew.get(get_key(line, CREW), races.head(0)).to_dicts()
        of_season = faults.get((line["method"], line["season"]), [])
        answer = describe_answer(line, own, of_season)
        answer["decided_steps"] = decided_steps
        answer["objection"] = results.objection
        by_boat.setdefault(line["fsn_no"], []).append(answer)
    results.answers[edition] = by_boat
    return by_boat


def find_changed_options(results: Results, old: str | None, new: str) -> list[Difference]:
    """Return the options that a draft has otherwise than what it is compared with.

    Nothing of an edition is put to the vote: none is returned.

    Args:
        results: the tables.
        old: an edition or draft; one whose method is not known counts as the first method.
        new: an edition or draft.
    """
    if old is None or not new.startswith(DRAFT):
        return []
    known = KnownMethods.from_store(results.views.store)
    of_editions = dict(results.views.table("editions").select("edition", "method").rows())
    old_method = old.removeprefix(DRAFT) if old.startswith(DRAFT) else of_editions.get(old)
    before = known.get(old_method or results.methods[0])
    return list_differences(known.get(new.removeprefix(DRAFT)), before)


def find_decided_steps(changed: Sequence[Difference]) -> list[str]:
    """Return the steps in which all that differs was decided before."""
    is_decided: dict[str, bool] = {}
    for one in changed:
        status = find_basis(one.step, one.option, one.after).status
        is_decided[one.step] = is_decided.get(one.step, True) and status == "decided"
    return [step for step, decided in is_decided.items() if decided]


def describe_answer(line: Row, races: Sequence[Row], faults: Sequence[Row]) -> Row:
    """Return a line with all that its answer needs; see `read_answers`.

    Args:
        line: a row of `warehouse.queries.answers.read_line_answers`.
        races: rows of `select_own_races` of its boat and crew.
        faults: rows of `season_diagnosis` of its season that a person should look at.
    """
    described_faults = []
    for fault in faults:
        largest = fault["size"]
        if fault["shown_by"] is not None:  # one boat alone shows it: any size up to the larger end
            largest = max(fault["size_lo"], fault["size_hi"], key=abs)
        described_faults.append(fault | {"largest": largest})

    cw_verdict = ""
    if line["cw_kg_m"] is not None and line["cw_ratio"] is not None:
        ratio = line["cw_kg_m"] / line["old_cw_kg_m"]  # of the two shown, each at its own speed
        cw_verdict = "lower" if ratio < 1 else "higher"
        if abs(ratio - 1) <= NEGLIGIBLE_CHANGE:
            cw_verdict = "same"

    is_compared = line["best_moved_ratio"] is not None  # with the tow before of the unaltered boat
    return line | {
        "races": list(races),
        "faults": described_faults,
        "causes": list_causes(line),
        "bars": measure_bars(line),
        "cw_verdict": cw_verdict,
        "has_moved": is_compared and abs(line["moved_ratio"] - 1) >= NEGLIGIBLE_CHANGE,
    }


def list_causes(line: Row) -> list[Row]:
    """Return the causes of a line's change, the largest first; small ones as one, `rest`.

    Args:
        line: with `causes`, a list of rows or its JSON; None where it is not compared.
    """
    stored = line["causes"] or []
    causes = json.loads(stored) if isinstance(stored, str) else stored
    large = [one for one in causes if abs(one["factor"] - 1) >= NEGLIGIBLE_CHANGE]
    rest = prod(one["factor"] for one in causes if one not in large)
    large.sort(key=lambda one: -abs(one["factor"] - 1))
    if abs(rest - 1) >= NEGLIGIBLE_CHANGE:
        large.append({"cause": "rest", "factor": rest})
    return large


def measure_bars(line: Row) -> list[Row]:
    """Return the way from the old number to the new as marks and bars; nothing without a change.

    The axis need not begin at zero: both numbers are marks on it, and only changes have a length.

    Returns:
        The first and the last with `cw_kg_m`, between them the causes with their `factor`; all with
        `start`, causes also with `width`, in per cent of the axis.
    """
    if line["cw_ratio"] is None or line["change"] == "same":
        return []
    old_cw, new_cw = line["old_cw_kg_m"], line["old_cw_kg_m"] * line["cw_ratio"]
    causes = list_causes(line)
    ends = list(accumulate((one["factor"] for one in causes), mul, initial=old_cw))
    lowest, highest = min(ends), max(ends)
    margin = BAR_MARGIN * (highest - lowest) or 0.01 * old_cw
    whole = highest - lowest + 2 * margin

    def place(cw: float) -> float:
        return float(100 * (cw - lowest + margin) / whole)

    bars: list[dict[str, Any]] = [{"cw_kg_m": old_cw, "start": place(old_cw)}]
    for cause, before, after in zip(causes, ends, ends[1:], strict=False):
        start, end = sorted((place(before), place(after)))
        bars.append(cause | {"start": start, "width": end - start})
    bars.append({"cw_kg_m": new_cw, "start": place(new_cw)})
    return bars
