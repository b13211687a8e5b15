"""A tow on the quay: in seconds, without a trace, and what the next rebuild says of it."""

import csv
import shutil

import numpy as np
import polars as pl
import pytest

from dashboards.document import Document
from dashboards.language import Language
from dashboards.queries.quay import describe_tow
from dashboards.reading import read_blocks
from pipeline.method.reading import read_shipped_method
from tests.conftest import METHODS, SMALL
from tests.warehouse.archive.conftest import TOWS, small_archive
from warehouse.queries.assess import assess
from warehouse.store.files import file_sha256

METHOD = METHODS[-1]


def say_of(tow):
    """What is said of a tow on the quay, in Dutch, by the kind of statement."""
    html = Document(Language("nl")).render("tow", **describe_tow(tow, log_known=True))
    said = [block for block in read_blocks(html) if block.said]
    return {block.said.partition(" ")[0]: block.text for block in said}


def hashes(folder):
    return {str(f): file_sha256(f) for f in sorted(folder.rglob("*")) if f.is_file()}


@pytest.fixture
def new_tow(bench):
    """A tow that the last rebuild did not have: its file came afterwards."""
    tow = bench.table("tows").filter(season=2014).row(-1, named=True)
    file, kept = bench.archive / tow["samples_path"], bench.archive.parent / "later"
    shutil.move(file, kept)
    bench.rebuild(METHODS)
    assert bench.table("tows").filter(tow_id=tow["tow_id"]).is_empty()
    shutil.move(kept, file)
    return tow


@pytest.mark.more
def test_a_new_tow_has_the_number_of_the_next_rebuild_and_leaves_no_trace(bench, new_tow):
    before = hashes(bench.data)
    found = assess(bench.store, bench.archive, new_tow["tow_id"], read_shipped_method(METHOD))
    assert hashes(bench.data) == before
    bench.rebuild(METHODS)
    then = bench.table("curves").filter(tow_id=new_tow["tow_id"], method=METHOD)
    assert found.curve["cw_lo_kg_m"] <= then["cw_kg_m"][0] <= found.curve["cw_hi_kg_m"]
    assert then["cw_kg_m"][0] == pytest.approx(found.curve["cw_kg_m"], rel=1e-9)
    assert [run["run"] for run in found.runs] == [1, 2, 3, 4, 5, 6]
    assert found.of_type["lowest"] <= found.of_type["median"] <= found.of_type["highest"]


def edit_samples(bench, tow_id, change):
    """Write the samples file of a tow of 2014 anew."""
    tow = bench.table("tows").row(by_predicate=pl.col("tow_id") == tow_id, named=True)
    path = bench.archive / tow["samples_path"]
    samples = change(pl.read_csv(path))
    samples.write_csv(path, compression="gzip", float_precision=4)


def scale(header, factor, where=None):
    """Multiply a column in some rows, or in all."""

    def change(samples):
        (name,) = [one for one in samples.columns if one.startswith(header)]
        rows = pl.lit(value=True) if where is None else where
        return samples.with_columns(pl.when(rows).then(pl.col(name) * factor).otherwise(name))

    return change


RUN = pl.col("run")
SECOND = pl.int_range(pl.len()).over("run") / SMALL.rate_hz


def with_log_2_as_log_1(samples):
    """Log 2 with its own noise and no other mean."""
    ratio = pl.col("log1 [m/s]").mean().over("run") / pl.col("log2 [m/s]").mean().over("run")
    return samples.with_columns(pl.col("log2 [m/s]") * ratio)


def with_the_wind_over_ground(samples):
    """The true wind, which is not what is felt on board."""
    speed, wind, angle = (
        samples[next(c for c in samples.columns if c.startswith(start))].to_numpy()
        for start in ("log1", "wind [m/s]", "wind [gra]")
    )
    ahead = wind * np.cos(np.radians(angle)) - speed
    abeam = wind * np.sin(np.radians(angle))
    angle = np.degrees(np.arctan2(abeam, ahead)) % 360
    return samples.with_columns(
        pl.Series("wind [m/s]", np.hypot(ahead, abeam)), pl.Series("wind [gra]", angle)
    )


def numbered_from_fast_to_slow(samples):
    other = {1: 3, 2: 2, 3: 1, 4: 6, 5: 5, 6: 4}
    return samples.with_columns(RUN.replace_strict(other, return_dtype=pl.Int64)).sort(
        "run", maintain_order=True
    )


def change_row(bench, tow_id, cells):
    """Write cells of a tow in the tow list of 2014, by their headings, which may be new."""
    (path,) = (bench.archive / "sleeplijsten").glob("sleeplijst_2014.*")
    lines = path.read_bytes().decode("utf-8-sig").splitlines()
    delimiter = max(";,\t|", key=lines[0].count)
    header, *rows = csv.reader(lines, delimiter=delimiter)
    new = [name for name in cells if name not in header]
    header += new
    for row in rows:
        row.extend([""] * len(new))
    (mine,) = [row for row in rows if row[header.index("sleep_id")] == tow_id]
    for name, cell in cells.items():
        mine[header.index(name)] = cell
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, delimiter=delimiter).writerows([header, *rows])


def test_a_tow_in_a_shallow_estuary(bench, sound_tow):
    """Salt is taken off, so that the number is that in fresh water; the depth is looked at."""
    method = read_shipped_method("rebased")
    in_fresh = assess(bench.store, bench.archive, sound_tow, method)
    change_row(bench, sound_tow, {"Zoutgehalte [‰]": "34", "waterdiepte [m]": "1.5"})
    in_salt = assess(bench.store, bench.archive, sound_tow, method)
    assert 0.985 < in_salt.curve["cw_kg_m"] / in_fresh.curve["cw_kg_m"] < 0.992
    assert [row["check"] for row in in_salt.checks] == ["shallow_water"]
    assert "Sleep opnieuw in dieper water" in " ".join(say_of(in_salt).values())


SPOILED = {
    "the load cell dead for 8 s": (scale("kracht", 0.0, (RUN == 3) & SECOND.is_between(20, 28)),
                                   "runs_set_aside", [3]),
    "another wind": (with_the_wind_over_ground, "wind_not_plausible", None),
    "a run that is off": (scale("kracht", 1.25, RUN == 5), "run_off_curve", [5]),
    "runs in another order": (numbered_from_fast_to_slow, "runs_in_other_order", []),
    "a speed that rises": (scale("log1", 0.9 + 0.2 * SECOND / 50, RUN == 6),
                           "no_steady_window", [6]),
}  # fmt: skip


@pytest.fixture
def sound_tow(bench):
    """A tow of which only log 2 was off, and is mended: nothing is wrong with it."""
    marked = bench.table("assessments").filter("flagged", method=METHOD)["tow_id", "check"]
    of_2014 = bench.table("tows").filter(season=2014)["tow_id"].to_list()
    by_tow = marked.group_by("tow_id").agg("check")
    only_log2 = by_tow.filter(pl.col("check") == ["log2_differs"])["tow_id"].to_list()
    tow_id = next(one for one in of_2014 if one in only_log2)
    edit_samples(bench, tow_id, with_log_2_as_log_1)
    return tow_id


def test_a_sound_tow_may_go(bench, sound_tow):
    found = assess(bench.store, bench.archive, sound_tow, read_shipped_method(METHOD))
    kinds = [*say_of(found)]
    assert (found.verdict, found.redo, found.checks) == ("good", [], [])
    assert "let_go" in kinds


@pytest.mark.more
@pytest.mark.parametrize("what", SPOILED)
def test_what_goes_wrong_in_a_tow_is_found_on_the_quay(bench, sound_tow, what):
    change, finding, redo = SPOILED[what]
    edit_samples(bench, sound_tow, change)
    found = assess(bench.store, bench.archive, sound_tow, read_shipped_method(METHOD))
    row = next(one for one in found.first_assessment if one["finding"] == finding)
    if redo is None:
        assert (row["verdict"], found.redo) == ("tow_again", None)
    else:
        assert row["verdict"] == ("tow_again" if redo else "look")
        assert set(redo) <= set(row["runs"] if redo else [])
    texts = say_of(found)
    assert "let_go" not in texts
    assert all(f"run {run}" in texts[finding] for run in redo or ())
    assert "{" not in "".join(texts.values())


def test_the_command_says_that_it_is_provisional(built, herijk):
    tow_id = built.table("tows")["tow_id"][-1]
    folders = ("--archive", built.archive, "--data", built.data)
    code, out, _ = herijk("assess", tow_id, *folders)
    assert (code, "Provisional: Cw is" in out, "Its runs" in out) == (0, True, True)


def test_a_run_towed_again_is_named_and_can_be_used_as_is_said(bench, sound_tow, herijk):
    def with_run_7(samples):
        again = samples.filter(RUN == 2).with_columns(run=pl.lit(7, pl.Int64))
        return pl.concat([scale("kracht", 1.3, RUN == 2)(samples), scale("kracht", 1.001)(again)])

    edit_samples(bench, sound_tow, with_run_7)
    folders = ("--archive", bench.archive, "--data", bench.data, "--method", METHOD)
    code, out, _ = herijk("--lang", "nl", "assess", sound_tow, *folders)
    assert (code, "In het bestand staat ook run 7" in out) == (0, True)
    lines = [line.strip() for line in out.partition("in plaats van run 2")[2].splitlines()]
    selection = next(line for line in lines if line.startswith("in kolom")).split(": ")[1]
    assert selection == "1,7,3,4,5,6"
    begin = lines.index("[[plan]]")
    plan = "\n".join(lines[begin : begin + 4])
    with (bench.archive / "archief.toml").open("a", encoding="utf-8") as profile:
        profile.write(f"\n{plan}\n")
    (tow_list,) = (bench.archive / "sleeplijsten").glob("*2014*")
    rows = tow_list.read_text(encoding="utf-8").splitlines()
    mine = next(place for place, row in enumerate(rows) if row.startswith(sound_tow))
    rows[mine] = rows[mine].replace("1,2,3,4,5,6", selection)
    tow_list.write_text("\n".join(rows), encoding="utf-8")
    found = assess(bench.store, bench.archive, sound_tow, read_shipped_method(METHOD))
    assert [run["run"] for run in found.runs if run["used"]] == [1, 3, 4, 5, 6, 7]
    assert (found.verdict, found.ways_to_use) == ("good", [])


def test_a_file_with_all_runs_twice_offers_the_second_six(bench, sound_tow):
    def twice(samples):
        again = samples.with_columns(run=RUN + 6)
        return pl.concat([samples, scale("kracht", 1.001)(again)])

    edit_samples(bench, sound_tow, twice)
    found = assess(bench.store, bench.archive, sound_tow, read_shipped_method(METHOD))
    assert [way["use_runs"] for way in found.ways_to_use] == ["7,8,9,10,11,12"]
    assert found.verdict == "look"


def test_why_a_tow_cannot_be_used_is_said_in_dutch(bench, sound_tow, herijk):
    edit_samples(bench, sound_tow, lambda samples: samples.filter(RUN < 3))
    folders = ("--archive", bench.archive, "--data", bench.data)
    code, _, err = herijk("--lang", "nl", "assess", sound_tow, *folders)
    assert (code, "Run 3 " in err, "is not in the file" in err) == (1, True, False)


def test_a_force_a_fifth_too_high_is_noticed_at_a_first_tow(bench):
    """Its type shows it, as there is no earlier tow."""
    compared = bench.table("assessments").filter(
        ~pl.col("flagged"), method=METHOD, check="unlike_its_type"
    )
    tow_id = compared["tow_id"][0]
    edit_samples(bench, tow_id, scale("kracht", 1.2))
    found = assess(bench.store, bench.archive, tow_id, read_shipped_method(METHOD))
    assert "unlike_its_type" in {row["finding"] for row in found.first_assessment}
    assert found.verdict != "good"


def test_where_no_tow_can_be_used_the_cause_is_said(tmp_path, herijk):
    archive = small_archive(tmp_path)
    tows = archive / TOWS
    tows.write_text(tows.read_text().replace(";20;", ";19.531;"))
    folders = ("--archive", archive, "--data", tmp_path / "data")
    code, _, err = herijk("assess", "2014-001", *folders)
    assert (code, "no tow can be used" in err, "ambiguous_number" in err) == (1, True, True)
