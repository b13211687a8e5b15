"""The rule of freshness, on assets of a line each: no archive and no method is needed."""

import dagster as dg
import polars as pl
import pytest

from assets.lake import Folders, Lake, incremental, make_outs

RAN: list[str] = []
WORLD = {"numbers": [1.0, 2.0]}


@dg.asset
@incremental()
def numbers() -> pl.DataFrame:
    """Looks outside, so it always runs."""
    RAN.append("numbers")
    return pl.DataFrame({"x": WORLD["numbers"]})


@dg.asset
@incremental()
def signs(numbers: pl.DataFrame) -> pl.DataFrame:
    """Equal for other positive numbers."""
    RAN.append("signs")
    return numbers.select(pl.col("x").sign())


@dg.multi_asset(outs=make_outs("low", "high"), can_subset=True)
@incremental()
def ends(signs: pl.DataFrame) -> dict[str, pl.DataFrame]:
    """Two tables of one computation."""
    RAN.append("ends")
    return {"low": signs.min(), "high": signs.max()}


@pytest.fixture
def make(tmp_path):
    WORLD["numbers"] = [1.0, 2.0]
    folders = Folders(archive=str(tmp_path), data=str(tmp_path / "data"))
    resources = {"folders": folders, "io_manager": Lake(folders=folders)}
    instance = dg.DagsterInstance.ephemeral()

    def made(*selection, fails=False):
        """Which bodies ran."""
        RAN.clear()
        result = dg.materialize(
            [numbers, signs, ends],
            resources=resources,
            instance=instance,
            selection=selection or None,
            raise_on_error=not fails,
        )
        assert result.success is not fails
        return list(RAN)

    made.store = folders.store
    made.instance = instance
    return made


def test_a_second_run_looks_outside_and_does_nothing_else(make):
    assert make() == ["numbers", "signs", "ends"]
    before = make.store.table_path("signs").stat().st_mtime_ns
    assert make() == ["numbers"]
    assert make.store.table_path("signs").stat().st_mtime_ns == before


def test_what_comes_out_equal_stops_there(make):
    make()
    WORLD["numbers"] = [3.0, 4.0]
    assert make() == ["numbers", "signs"]


def test_one_table_of_a_computation_can_be_asked_for(make):
    make()
    make.store.table_path("high").unlink()
    assert make("high") == ["ends"]
    assert make("low") == []


def test_a_lost_table_is_made_again(make):
    make()
    make.store.table_path("signs").unlink()
    assert make() == ["numbers", "signs"]


def test_a_damaged_table_is_removed_by_who_reads_it_and_made_by_the_next_run(make):
    make()
    path = make.store.table_path("signs")
    content = bytearray(path.read_bytes())
    content[10] ^= 255
    path.write_bytes(bytes(content))
    make.store.table_path("high").unlink()
    make(fails=True)
    assert not path.exists()
    assert make() == ["numbers", "signs", "ends"]


def test_dagster_knows_the_contents_as_version(make):
    make()
    key = dg.AssetKey("signs")
    event = make.instance.get_latest_materialization_event(key)
    said = event.asset_materialization.tags["dagster/data_version"]
    assert said == make.store.contents("signs")
