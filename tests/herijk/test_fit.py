"""`herijk fit`: a curve from a table that anybody made."""

import json

import pytest

from tests.golden.sources import DATA


def test_a_bend_is_told_with_its_interval(herijk, tmp_path):
    table = tmp_path / "points.csv"
    table.write_text(
        "snelheid [km/h];kracht [kgf]\n9,72;21,92\n10,8;28,65\n11,88;37,12\n"
        "9,72;22,13\n10,8;28,45\n11,88;37,32\n",
        encoding="utf-8",
    )
    status, out, _ = herijk("fit", table, "--plot", tmp_path / "fit.svg")
    assert status == 0
    assert "B = " in out
    assert "<svg" in (tmp_path / "fit.svg").read_text(encoding="utf-8")
    report = json.loads(herijk("fit", table, "--json")[1])
    assert report["b_is_determined"]
    assert report["cw_kg_m"][1]["speed_m_s"] == pytest.approx(3.0)


def test_a_drag_without_a_bend_has_no_b(herijk):
    columns = ("--speed", "tow_speed_m_per_s", "--force", "tare_drag_N")
    status, out, _ = herijk("fit", DATA / "unh_rm2_tare_drag.csv", *columns)
    assert status == 0
    assert "there is no B" in out


@pytest.mark.parametrize(("unit", "a"), [("lbf", 31.28), ("N", 7.03), ("links", None), ("x", None)])
def test_a_unit_in_the_name_of_a_column_is_read_or_refused(herijk, tmp_path, unit, a):
    table = tmp_path / "points.csv"
    table.write_text(f"speed;pull_{unit}\n2;28.13\n3;63.29\n4;112.5\n", encoding="utf-8")
    status, out, err = herijk("fit", table, "--force", f"pull_{unit}", "--json")
    assert status == (a is None)
    assert "brackets" in err if a is None else round(json.loads(out)["a_kg_m"], 2) == a


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("speed;drag\n3;200\n3,3\n", "Line 3"),
        ("speed;drag\n3;200\n-3,3;210\n", "Line 3"),
        ("length;drag\n3;200\n", "--speed"),
        ("speed;drag\n3;200\n", "no curve"),
    ],
)
def test_a_table_that_cannot_be_used_is_refused_in_a_sentence(herijk, tmp_path, text, what):
    table = tmp_path / "points.csv"
    table.write_text(text, encoding="utf-8")
    status, _, err = herijk("fit", table)
    assert status == 1
    assert what in err
