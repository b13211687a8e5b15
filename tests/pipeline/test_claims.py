"""What the texts print, held against frames small enough to do by hand."""

import polars as pl
import pytest

from pipeline.studies import claims

LINE = {"fsn_no": "FSN1", "rowers": 8, "crew_class": "H", "a_kg_m": 30.0, "b_m_s": 5.0}


def printed(season, cw, speed=2.5):
    numbers = {"declared_speed_m_s": speed, "cw_kg_m": cw}
    return {**LINE, "season": season, "tow_date": 1, "has_valid_curve": True, **numbers}


def test_print_is_compared_at_the_printed_speed_by_the_first_register_that_printed_it():
    of_2015, of_2014 = printed(2015, 99.0), printed(2014, 41.0, speed=2.75)
    curve = {"tow_id": "a", "method": "m", "cw_kg_m": 40.0, "declared_speed_m_s": 2.5}
    curves = pl.DataFrame([LINE | curve | {"season": 2014}])
    tows = pl.DataFrame([LINE | {"tow_id": "a", "tow_date": 1}])
    found = claims.print_reproduction(pl.DataFrame([of_2015, of_2014]), curves, tows)
    row = found.row(0, named=True)
    assert (row["printed_in"], row["printed_cw_kg_m"]) == (2014, 41.0)
    # A 30 and Cw 40 at 2.5 m/s are B 5: at 2.75 m/s 30 / (1 - 0.55^2).
    assert row["cw_kg_m"] == pytest.approx(30.0 / (1 - 0.55**2))
    assert row["cw_ratio"] == pytest.approx(41.0 / row["cw_kg_m"])
