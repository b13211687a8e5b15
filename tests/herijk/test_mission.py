"""The mission, once and whole: from raw samples to verdicts and an edition, and a quiet night."""

import json
import re
import shutil

import duckdb
import pytest

import assets.rebuild
from herijk.cli.main import main
from tests.architecture.repository import read
from tests.conftest import DEMO, DEMO_METHODS, quickly
from warehouse.store.store import Store

WORN_LOG_SEASONS = (2009, 2010, 2011)
TRUE_CW = "cw_declared_kg_m_at_15C"
MISREADING = 1.06
"""True speed / log speed of worn logs, as the presentation of 2015 prescribes."""


def find_query(start):
    """Return the query of docs/results.md that begins so, as it is printed there."""
    blocks = re.findall(r"^```sql\n(.*?)^```", read("docs/results.md"), re.MULTILINE | re.DOTALL)
    (found,) = [
        query.strip()
        for block in blocks
        for query in re.sub(r"^--.*\n", "", block, flags=re.MULTILINE).split(";")
        if query.strip().startswith(start)
    ]
    return found


def call(monkeypatch, *words):
    """Run a command as a person does; return its exit status."""
    monkeypatch.setattr("sys.argv", ["herijk", *map(str, words)])
    with pytest.raises(SystemExit) as stopped:
        main()
    return stopped.value.code or 0


def test_the_history_is_rebased_judged_published_and_stays(demo, tmp_path, monkeypatch):
    archive, data = demo / "archief", tmp_path / "data"
    shutil.copytree(demo / "data", data)
    store = Store(data)

    # Raw samples of every season are in Parquet; only the tow whose file is missing is not.
    samples = sorted(data.glob("lake/samples/season=*/*.parquet"))
    n_listed = len(DEMO.seasons) * DEMO.tows_per_season
    assert len(samples) == n_listed - 1
    assert {file.parent.name for file in samples} == {f"season={year}" for year in DEMO.seasons}

    with duckdb.connect(str(store.database), read_only=True) as db:
        # The 6 % of the worn logs, and what was measured from 2014 on.
        factors = dict(
            db.sql(
                "SELECT season, factor FROM log_factors WHERE method = 'rebased-2015'"
            ).fetchall()
        )
        assert [factors[year] for year in WORN_LOG_SEASONS] == [MISREADING] * 3
        logs = db.sql(find_query("SELECT season, factor, lo, hi, source FROM log_factors")).pl()
        assert logs.filter(logs["season"] >= 2014)["source"].unique().to_list() == ["gps"]
        # Recordings are cut from 2014 on, and by the methods of today in every season.
        cut = db.sql(
            "SELECT method, season < 2014 AS early, count(*) FILTER (window_start_s > 0) AS cut "
            "FROM run_points JOIN tows USING (tow_id) GROUP BY ALL"
        ).fetchall()
        n_cut = {(method, early): number for method, early, number in cut}
        assert n_cut["as-published", True] == 0
        assert n_cut["as-published", False] > 0
        assert n_cut["rebased", True] > 0
        # Every boat is fitted again under every method.
        fitted = db.sql(
            "SELECT method, count(cw_kg_m) FROM curves GROUP BY method ORDER BY method"
        ).fetchall()
        assert dict(fitted) == dict.fromkeys(DEMO_METHODS, n_listed - 1)
        # Are whalers and Kuiken boats treated alike? By speed, and against weight.
        types = db.sql(find_query("SELECT method, boat_type, crew_class, boats")).pl()
        assert set(types["boat_type"]) == {"Kromhoutwhaler", "Kuikensloep"}
        verdicts = db.sql(
            "SELECT boat_type, verdict, weight_verdict FROM type_consistency WHERE method = "
            "'rebased' AND quantity = 'cw_standard_kg_m' AND boat_type IN "
            "('Kromhoutwhaler', 'Kuikensloep') ORDER BY boat_type"
        ).fetchall()
        judged = {boat_type: verdict for boat_type, verdict, _ in verdicts}
        assert judged.keys() == {"Kromhoutwhaler", "Kuikensloep"}
        assert judged["Kuikensloep"] != "differ"  # they are built within 1 %
        # The numbers are those of the boats, within what they say of their uncertainty.
        truth = json.loads((demo / "archief-truth.json").read_text("utf-8"))
        curves = db.sql(
            "SELECT tow_id, cw_lo_kg_m, cw_hi_kg_m FROM curves WHERE method = 'rebased'"
        ).fetchall()
        covered = [low <= truth[tow][TRUE_CW] <= high for tow, low, high in curves]
        assert sum(covered) >= 0.9 * len(covered)
        # The register of every year shows who was measured with the worn logs.
        years = db.sql(find_query("SELECT year, count(*) AS lines")).pl()
        ratio = dict(years.select("year", "ratio").rows())
        assert ratio[2011] < 0.9 < ratio[2018]

    # The night after, nothing has changed and nothing is made.
    before = store.database.stat().st_mtime_ns
    with quickly(store, left_out=("site",)):
        report = assets.rebuild.rebuild(archive, data, DEMO_METHODS)
    assert report.nothing_changed
    assert store.database.stat().st_mtime_ns == before

    # Members decide, and an edition is published that anyone can verify.
    folders = ("--data", data)
    assert call(
        monkeypatch, "publish", "2018-1", "--method", "rebased-2015", "--valid-from", "2018-12-31",
        "--decision", "meeting", *folders,
    ) == 0  # fmt: skip
    assert call(monkeypatch, "verify", *folders) == 0
