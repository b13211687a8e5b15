"""The due list in the warehouse: races, decisions, and what makes it stale."""

import datetime as dt

import polars as pl
import pytest

from dashboards.words import CODES
from pipeline.register.due import NOT_RACED
from pipeline.register.register import name_draft
from warehouse.store.decisions import FILE_NAME

METHOD = "rebased-2015"


def test_every_line_of_the_register_is_on_the_list(built):
    due, register = built.table("due_list"), built.table("register")
    key = ["method", "fsn_no", "rowers", "crew_class"]
    assert due.select(key).equals(register.select(key).sort(key))
    assert set(due["speed_reason"]) <= CODES.keys()
    last_tow, last_race = built.table("tows")["tow_date"].max(), due["as_of"].max()
    assert due["as_of"].n_unique() == 1
    assert last_race >= last_tow


@pytest.mark.more
def test_a_race_and_a_decision_change_the_list_at_the_next_rebuild(bench):
    due = bench.table("due_list").filter(pl.col("method") == METHOD, status="valid")
    line = due.row(0, named=True)
    key = {name: line[name] for name in ("method", "fsn_no", "rowers", "crew_class")}
    list_file = bench.archive / "wedstrijden" / "proefrace_2014.csv"
    day = line["as_of"] + dt.timedelta(days=1)
    list_file.write_text(
        "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd;stroom [km];straf [W]\n"
        f"Proefrace;{day};36,000;{line['fsn_no']};{line['rowers']};{line['crew_class']};2:00:00;;\n",
        encoding="utf-8",
    )
    (bench.data / FILE_NAME).write_text(
        f'[[besluit]]\nsleep_id = "{due["tow_id"][1]}"\noordeel = "uitsluiten"\n'
        'reden = "scheef"\nwie = "SKC"\ndatum = 2014-05-01\n',
        encoding="utf-8",
    )
    curves = bench.store.table_path("curves")
    made = curves.stat().st_mtime_ns
    assert bench.rebuild().done.database
    assert curves.stat().st_mtime_ns == made  # of tows: neither concerns them
    after = bench.table("due_list").filter(pl.col("method") == METHOD)
    raced = after.filter(**key).row(0, named=True)
    assert raced["as_of"] == day
    assert raced["raced_speed_m_s"] == pytest.approx(5.0)
    assert raced["speed_reason"] != NOT_RACED
    draft = pl.col("edition") == name_draft(METHOD)
    for table in ("register", "register_history"):
        assert due["tow_id"][1] not in bench.table(table).filter(draft)["tow_id"].to_list()
    assert due["tow_id"][1] not in after["tow_id"].to_list()
    assert not bench.rebuild().done.database
