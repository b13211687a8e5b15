"""The pages of `herijk audit`."""

import json
import re
from pathlib import Path

import duckdb
import polars as pl
from typer.testing import CliRunner

from dashboards.labels import code
from herijk.cli.arguments import as_json_text
from herijk.cli.audit_text import audit as page_of
from herijk.cli.main import app
from warehouse.queries.audit import audit

WIDTH = 100


def page(built, *names, method=None):
    return page_of(audit(built.store, names, method))


def types_of(built):
    return [*sorted(built.table("boats")["boat_type"].drop_nulls().unique()), "unknown"]


def run(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)))


def test_a_type_page_is_a_page_of_words_and_figures(built):
    for boat_type in types_of(built):
        lines = page(built, boat_type).splitlines()
        assert len(lines) <= 96
        assert max(map(len, lines)) <= WIDTH
        assert lines[0].startswith("SIMULATED")
        text = "\n".join(lines)
        assert not re.search(r"\bNone\b|\bnan\b|\binf\b|_m_s|_kg|few_boats|no_type", text)
        assert [line[0] for line in lines if re.match(r"\d\. ", line)] == list("12345678")


def test_every_figure_of_a_line_is_printed_with_its_n(built):
    rows = built.table("type_consistency").filter(
        pl.col("reason") == "",
        pl.col("quantity").is_in(["b_m_s", "a_kg_m", "cw_standard_kg_m", "q"]),
        explaining="weight_kg",
        method="rebased-2015",
    )
    assert rows.height > 0
    pages = {t: page(built, t, method="rebased-2015") for t in rows["boat_type"].unique()}
    for row in rows.iter_rows(named=True):
        text = pages[row["boat_type"]]
        step_kg = 1000 if row["quantity"] == "q" else 100
        ends = (f"{step_kg * row[end]:+.2f}" for end in ("slope", "slope_lo", "slope_hi"))
        slope = "{} ({} to {})".format(*ends)
        line = next(line for line in text.splitlines() if slope in line)
        assert f" {100 * row['r2']:.0f} % " in line
        assert re.search(rf" {row['n']}  (follows|no trend seen)$", line)


def test_where_nothing_is_claimed_the_page_says_why(bench):
    with duckdb.connect(bench.store.database) as db:
        for lines in ("type_consistency", "type_lines"):
            db.execute(
                f"""UPDATE {lines} SET slope = NULL, slope_lo = NULL, slope_hi = NULL,
                       reason = 'few_boats', n_boats = 2"""  # noqa: S608
            )
        db.execute("UPDATE type_homogeneity SET reason = 'few_boats', n_boats = 2")
        db.execute("UPDATE speed_trend SET reason = 'few_boats', n_boats = 2")
        db.execute("DELETE FROM type_outliers")
        db.execute("DELETE FROM pooled_curves WHERE pooling != 'own'")
        db.execute("DELETE FROM repeat_pairs")
        db.execute("DELETE FROM era_shifts")
        db.execute("UPDATE predicted_cw SET predicted_cw_kg_m = NULL, ln_ratio = NULL")
    text = page(bench, "Kuikensloep", method="rebased-2015")
    assert text.count("nothing claimed: too few boats (2 boats)") == 6
    assert text.count("fewer than six pairs") == 5
    assert "no repeat pairs of this type (n 0)" in text
    claims = ("follows", "equal bends are possible", "closer together", "disagree.", " outside (")
    assert not [claim for claim in claims if claim in text]


def test_two_types_stand_side_by_side_with_what_differs(bench):
    with duckdb.connect(bench.store.database) as db:
        db.execute("UPDATE type_homogeneity SET p_value = 0.4, power_at_10pct = 0.9, reason = ''")
        db.execute("UPDATE type_homogeneity SET p_value = 0.001 WHERE boat_type = 'Stersloep'")
    text = page(bench, "Kuikensloep", "Stersloep")
    assert max(map(len, text.splitlines())) <= WIDTH
    head = next(line for line in text.splitlines() if "method" in line)
    assert head.split() == ["method", "Kuikensloep", "Stersloep"]
    different = text.split("What differs:")[1]
    for method in ("as-published", "rebased-2015"):
        found = re.search(
            rf"equal bends possible, {method}: (.*?)(?:\n  \S|\Z)", different, re.DOTALL
        )
        assert re.match(
            r"Kuikensloep yes, p 0.400.*Stersloep\s+no,\s+p\s+0.001", found[1], re.DOTALL
        )


def test_a_boats_page_has_its_place_history_and_second_opinion(built):
    pairs = built.table("repeat_pairs").filter(method="rebased-2015")
    predicted = built.table("predicted_cw").filter(method="rebased-2015")
    fsn_no = next(f for f in pairs["fsn_no"] if f in predicted["fsn_no"])
    text = page(built, fsn_no, method="rebased-2015")
    for pair in pairs.filter(fsn_no=fsn_no).iter_rows(named=True):
        assert f"{pair['tow_id_before']} to {pair['tow_id']}" in text
        assert f"E_n {pair['e_n']:+.2f}" in text
    for line in built.table("register").filter(fsn_no=fsn_no, method="rebased-2015").rows():
        assert f"{line[0]}, {line[3]}{line[4]}: " in text
    assert "Its place among" in text
    assert "as-published" not in text
    assert re.search(r"Set aside, .*:\n  nothing", text)


def test_a_boats_page_has_its_uncertainty_budget(built):
    tow = built.table("tows").row(0, named=True)
    text = " ".join(page(built, tow["fsn_no"], method="rebased-2015").split())
    felt = built.table("uncertainty_budget").filter(
        pl.col("u_ratio") > 1e-4, tow_id=tow["tow_id"], method="rebased-2015"
    )
    assert felt.height >= 3
    for component, u_ratio in felt.select("component", "u_ratio").iter_rows():
        assert f"{code(component)} {100 * u_ratio:.2f} %" in text


def test_the_steps_of_a_boats_tow_multiply_to_the_total_printed(built):
    tow = built.table("correction_steps")["tow_id"][0]
    steps = built.table("correction_steps").filter(tow_id=tow, to_method="rebased-2015")
    fsn_no = built.table("tows").filter(tow_id=tow)["fsn_no"].item()
    total = steps["factor"].product()
    assert f"Cw {100 * (total - 1):+.1f} % = " in page(built, fsn_no)


def test_json_holds_what_the_page_is_made_of(built):
    names = ("Kuiken sloep", "barkas")
    printed = run("audit", *names, "--data", built.data, "--json")
    assert printed.exit_code == 0
    report = json.loads(printed.stdout)
    assert [one["boat_type"] for one in report["types"]] == ["Kuikensloep", "Barkas"]
    plots = report.pop("plots")
    assert report == json.loads(as_json_text(audit(built.store, names)))
    assert {Path(plot).parent for plot in plots} == {built.data / "audit" / "Kuiken-sloep-barkas"}
    assert all(Path(plot).is_file() for plot in plots)


def test_plots_lie_where_they_are_asked_for(built, tmp_path):
    fsn_no = built.table("tows")["fsn_no"][0]
    asked = tmp_path / "plots"
    printed = run("audit", fsn_no, "--data", built.data, "--plots", asked)
    plots = list(asked.glob("*.svg"))
    assert printed.stdout.rstrip().endswith(f"{len(plots)} plots in {asked}")
    assert (asked / "history.svg").is_file()


def test_where_plots_cannot_be_written_the_page_stands_and_it_is_said(built, tmp_path):
    asked = tmp_path / "plots"
    asked.write_text("a file", encoding="utf-8")
    fsn_no = built.table("boats")["fsn_no"][0]
    printed = run("audit", fsn_no, "--data", built.data, "--plots", asked)
    assert printed.exit_code == 0
    assert fsn_no in printed.stdout
    assert "plots in" not in printed.stdout
    assert printed.stderr.count("\n") == 1
    assert str(asked) in printed.stderr
    assert "--plots" in printed.stderr


def test_three_names_are_too_many(built):
    printed = run("audit", "Kuikensloep", "Barkas", "Vlet", "--data", built.data)
    assert printed.exit_code == 2
    assert "one or two types" in printed.stderr
