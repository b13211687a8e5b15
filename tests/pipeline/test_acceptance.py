"""Acceptances held against the checks of today: what is a doubt, and what was known."""

import datetime as dt

import polars as pl

from pipeline.assessment.acceptance import judge_acceptances
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import ListedAcceptances
from pipeline.tables.schemas import conform

FIRST, LATER = dt.date(2018, 5, 8), dt.date(2018, 6, 1)
TOWS = pl.DataFrame({"tow_id": ["2018-001", "2018-002"], "fsn_no": ["FSN1", "FSN2"]})


def judge(*accepted: tuple[str, dt.date, str | None], flags: dict[str, list[str]]) -> pl.DataFrame:
    """Return acceptances under two methods, of which the second marks nothing."""
    listed = [
        {
            "tow_id": tow_id,
            "accepted_on": day,
            "accepted_by": "SKC",
            "redone_runs": None,
            "explanation": None,
            "known_checks": known,
            "path": "sleeplijsten/beoordelingen.csv",
            "line": line,
        }
        for line, (tow_id, day, known) in enumerate(accepted, start=2)
    ]
    rows = [("one", tow_id, marks) for tow_id, marks in flags.items()]
    rows += [("other", tow_id, []) for tow_id in flags]
    schema = {"method": pl.String, "tow_id": pl.String, "flags": pl.List(pl.String)}
    curves = pl.DataFrame(rows, schema, orient="row")
    judged = judge_acceptances(make_frame(ListedAcceptances, listed), TOWS, curves)
    return conform("acceptances", judged)


def doubts(judged: pl.DataFrame, method: str = "one") -> list[tuple[object, ...]]:
    return judged.filter(method=method).select("tow_id", "newest", "doubted_by").rows()


def test_only_what_was_not_known_is_a_doubt_and_only_where_a_method_marks_it() -> None:
    flags = {"2018-001": ["crew_weight", "heavier_after"]}
    judged = judge(("2018-001", FIRST, "heavier_after, no_such_check"), flags=flags)
    assert doubts(judged) == [("2018-001", True, ["crew_weight"])]
    assert doubts(judged, "other") == [("2018-001", True, [])]
    assert judged["fsn_no"].to_list() == ["FSN1", "FSN1"]


def test_the_latest_acceptance_counts_and_settles_what_it_knows() -> None:
    flags = {"2018-001": ["crew_weight"]}
    judged = judge(("2018-001", LATER, "crew_weight"), ("2018-001", FIRST, None), flags=flags)
    assert doubts(judged) == [("2018-001", False, []), ("2018-001", True, [])]
    assert judged["accepted_on"].to_list()[:2] == [FIRST, LATER]


def test_an_accepted_tow_that_is_set_aside_is_doubted() -> None:
    judged = judge(("2018-002", FIRST, None), flags={"2018-001": []})
    assert doubts(judged) == [("2018-002", True, ["set_aside"])]


def test_a_tow_that_no_list_can_use_any_more_is_doubted_without_its_boat() -> None:
    judged = judge(("2018-003", FIRST, None), flags={"2018-001": []})
    assert doubts(judged) == [("2018-003", True, ["set_aside"])]
    assert judged["fsn_no"].to_list() == [None, None]


def test_without_an_acceptance_there_is_no_row() -> None:
    assert judge(flags={"2018-001": ["crew_weight"]}).is_empty()
