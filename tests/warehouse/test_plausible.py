"""A wrong number that looks sound is not published: units, gains, zeros and wind of a real archive.

The archive is sound; a fault is put in by changing the unit in a header or the numbers themselves.
"""

import datetime as dt
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from herijk.simulate import Defects, WorldSettings, simulate_world, world_settings
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.assessment.plausibility import Shift, plausibility
from pipeline.assessment.tow_summary import summarize_tows
from pipeline.blocks.tows import Tows
from pipeline.method.reading import read_shipped_method
from tests.warehouse.edition_bench import EditionBench
from tests.worlds import measure
from warehouse.derive.plausible import add_doubts
from warehouse.editions.publish import list_lines_to_look_at
from warehouse.store.editions import read_edition

WORLD = WorldSettings(seasons=(2015, 2016, 2017), tows_per_season=10, rate_hz=20, seed=5)
METHOD = read_shipped_method("rebased")


class Archive(EditionBench):
    """An archive, and what is doubted in it."""

    def season(self, season: int) -> list[str]:
        listed = self.store.read("listed_tows").filter(season=season)
        tows: list[str] = listed["tow_id"].to_list()
        return tows

    def quarantined(self) -> dict[str, tuple[str, str]]:
        faults = self.store.read("quarantine").filter(lost="tow")
        return {t: (c, m) for t, c, m in faults.select("tow_id", "reason_code", "message").rows()}

    def doubts(self) -> dict[str, list[str]]:
        doubted = self.store.read("tows").filter(pl.col("doubts").list.len() > 0)
        return dict(doubted.select("tow_id", "doubts").rows())

    def curves(self) -> pl.DataFrame:
        self.rebuild((METHOD,))
        return self.store.read("curves", METHOD.name)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Archive:
    root = tmp_path_factory.mktemp("plausible")
    archive = Archive(root / "archive", root / "data")
    write_simulated_archive(archive.archive, simulate_world(WORLD))
    archive.rebuild(())
    return archive


@pytest.fixture
def archive(whole: Archive, tmp_path: Path) -> Archive:
    return whole.copy(tmp_path)


def header(word: str, unit: str) -> Callable[[str], str]:
    """Gives a column another unit; its numbers stay."""
    return lambda text: re.sub(rf"{re.escape(word)} \[[^]]*\]", f"{word} [{unit}]", text, count=1)


def test_a_sound_archive_is_not_doubted(whole):
    assert not whole.quarantined()
    assert not whole.doubts()


@pytest.mark.parametrize(
    ("change", "code", "word"),
    [
        (header("kracht", "kgf"), "force_not_plausible", "kgf"),
        (header("wind", "kn"), "wind_not_plausible", "knots"),
    ],
    ids=["kgf", "knots"],
)
def test_a_tow_in_another_unit_is_set_aside_with_the_likely_unit(archive, change, code, word):
    archive.change_samples("2016-004", change)
    archive.rebuild(())
    found = archive.quarantined()
    assert set(found) == {"2016-004"}
    assert found["2016-004"][0] == code
    assert word in found["2016-004"][1]
    assert "instead of" not in str(archive.store.read("quarantine")["message_nl"][0])
    assert not archive.doubts()


def test_a_log_replaced_within_a_season_is_seen_as_a_part_and_doubts_no_tow():
    """Logs may differ by 6 %: the joint model needs these tows to say by how much."""
    size = {"seasons": (2010, 2015), "tows_per_season": 12, "rate_hz": 10, "seed": 3}
    world = measure(world_settings("log-replaced", **size))
    judged = plausibility(Tows.from_frames(world.tows, world.blocks))
    speeds = [s for s in judged if s.quantity == "speed"]
    assert [s.kind for s in speeds if s.clear] == ["part"]
    assert add_doubts(world.tows, speeds)["doubts"].list.len().sum() == 0


def wind_changed(world, tows: list[str], **factors: float) -> list[Shift]:
    """What is said of the wind when it is multiplied in some tows; `back` means their runs back."""
    runs = world.blocks.runs
    mine = runs["tow_id"].is_in(tows).to_numpy()
    if factors.pop("back", False):
        mine &= runs["run"].to_numpy() > 3
    sums = {
        name: np.where(mine[:, None], factors.get(name, 1.0), 1.0) * values
        for name, values in world.blocks.sums.items()
    }
    blocks = replace(world.blocks, sums=sums)
    shifts = plausibility(Tows.from_frames(world.tows, blocks))
    return [s for s in shifts if s.quantity in ("wind", "vane") and s.clear]


@pytest.mark.parametrize("seed", range(1, 7))
def test_gusts_of_a_windy_season_are_no_fault_and_another_unit_is(seed):
    """Wind of 6 m/s, with gusts that do not cancel between out and back, as at sea."""
    settings = WorldSettings(
        seasons=(2015, 2016, 2017),
        tows_per_season=10,
        rate_hz=5,
        seed=seed,
        defects=lambda season: replace(Defects.clean(season), wind_m_s=6.0),
    )
    world = measure(settings)
    assert wind_changed(world, []) == []
    true_wind = summarize_tows(Tows.from_frames(world.tows, world.blocks)).true_wind
    middle = int(true_wind.argsort()[len(true_wind) // 2])
    tow = world.tows["tow_id"].sort()[middle]
    in_knots = dict.fromkeys(("wind_x", "wind_y", "wind_v"), 1.9438445)
    shifts = wind_changed(world, [tow], **in_knots)
    assert [(shift.quantity, shift.tows) for shift in shifts] == [("wind", (tow,))]


def test_a_turned_vane_is_gross_in_a_tow_and_in_a_season_and_a_dead_anemometer_in_no_other_unit():
    world = measure(WorldSettings((2015, 2016, 2017), 6, 10, 4))
    season = world.tows.filter(season=2016)["tow_id"].to_list()
    assert wind_changed(world, []) == []
    for kind, tows in (("tow", season[:1]), ("season", season)):
        first = wind_changed(world, tows, wind_x=-1.0, wind_y=-1.0)[0]
        assert (first.kind, first.tows, first.is_gross) == (kind, tuple(sorted(tows)), True)
        assert abs(first.size - 180.0) < 20.0
    dead = wind_changed(world, season[4:5], wind_x=0.0, wind_y=0.0, wind_v=0.0, back=True)
    assert [(s.causes, s.is_gross) for s in dead if s.quantity == "wind"] == [((), False)]


def test_a_season_in_another_unit_is_set_aside_as_a_season_in_one_sentence(archive):
    mine = archive.season(2016)
    for tow in mine:
        archive.change_samples(tow, header("kracht", "kgf"))
    archive.rebuild(())
    found = archive.quarantined()
    assert set(found) == set(mine)
    (sentence,) = {message for _, message in found.values()}
    assert f"All {len(mine)} tows of season 2016" in sentence
    assert "kgf" in sentence
    assert not archive.doubts()


def with_two_decimals(text: str) -> str:
    """As a spreadsheet saves what it shows."""

    def rounded(number: re.Match[str]) -> str:
        return f"{float(number[0].replace(',', '.')):.2f}".replace(".", number[1])

    return re.sub(r"\d+([.,])\d{3,}", rounded, text)


def test_samples_of_another_boat_are_found_also_when_written_otherwise(archive):
    taken, other = "2016-003", "2017-005"
    written: list[str] = []
    archive.change_samples(taken, lambda text: written.append(with_two_decimals(text)) or text)
    archive.change_samples(other, lambda _: written[0])
    archive.rebuild(())
    found = {tow: code for tow, (code, _) in archive.quarantined().items()}
    assert found == dict.fromkeys((taken, other), "samples_listed_twice")


@pytest.mark.more
def test_a_zero_that_is_off_is_doubted_shared_with_nobody_and_not_published(archive):
    sound = archive.curves()
    tow = "2017-002"
    archive.change_force(tow, lambda newtons: newtons + 100.0)
    archive.rebuild(())
    assert archive.doubts() == {tow: ["force_not_plausible"]}
    now = archive.curves()
    both = sound.join(now, on="tow_id", suffix="_now").filter(pl.col("tow_id") != tow)
    assert ((both["cw_kg_m_now"] / both["cw_kg_m"]).log().abs().max()) < 0.002
    assert "force_not_plausible" in now.filter(tow_id=tow)["flags"][0]
    archive.publish("2018-1", METHOD, dt.date(2018, 1, 1))
    edition = read_edition(archive.store, "2018-1")
    assert tow not in edition.register["tow_id"].drop_nulls().to_list()
    to_look_at = list_lines_to_look_at(edition)
    assert [line["status"] for line in to_look_at if not line["flags"]] == ["doubted"]
    assert len(to_look_at) < edition.register.height
