"""Methods: by name or from a file, and applied to the samples of one tow."""

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.channels import BACK, OUT, RUNS_PER_FILE, SAMPLE_SCHEMA, TARGET_SPEED_RATIOS
from pipeline.errors import HerijkError
from pipeline.method.definition import Method
from pipeline.method.reading import list_shipped_methods, parse_method, read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.tables.archive import Tows
from warehouse.store.methods import read_method_file

REQUIRED: Final = ("declared_speed_m_s", "waterline_length_m", "beam_m", "bow_height_m")
DEFAULTS: Final = {
    "tow_id": "tow",
    "fsn_no": "boat",
    "rowers": 8,
    "crew_class": "H",
    "altered": False,
    "log1_part": 0,
    "log2_part": 0,
    "boat_type": None,
    "doubts": [],
}


@dataclass(frozen=True)
class Applied:
    """What a method makes of a tow.

    Attributes:
        curves: one row of the table `curves`.
        run_points: rows of the table `run_points`.
    """

    curves: pl.DataFrame
    run_points: pl.DataFrame


def methods() -> tuple[str, ...]:
    """Return the names of the methods that ship with Herijk.

    >>> "rebased" in methods()
    True
    """
    return list_shipped_methods()


def method(name_or_file: str | Path) -> Method:
    """Return a method that ships, by name, or one from a TOML file, by path.

    Raises:
        HerijkError: there is no such method, or the file has an error, with its line.

    >>> method("rebased-2015").get_steps(2010).window.rule
    'steady'
    """
    file = Path(name_or_file)
    if file.suffix != ".toml":
        return read_shipped_method(str(name_or_file))
    return parse_method(read_method_file(file), str(file))


def apply_method(
    applied: Method, samples: pl.DataFrame, tow: Mapping[str, Any], sample_rate_hz: int
) -> Applied:
    """Return the curve of one tow under a method, from its samples.

    A method that estimates something from the whole archive (`rebased`: log factors, the wind
    coefficient) knows this tow alone, and says less than a rebuild would.

    Args:
        applied: the method.
        samples: columns of `pipeline.channels.SAMPLE_SCHEMA` in the order measured; runs 1-3 go
            out and 4-6 back, at 90, 100 and 110 % of the declared speed.
        tow: columns of the table `tows`; at least the tow's date, declared speed, waterline length,
            beam and bow height.
        sample_rate_hz: samples per second.

    Raises:
        HerijkError: a column is missing, the rate is not at least 1, or the method says nothing
            about the season.
    """
    missing = [name for name in ("tow_date", *REQUIRED) if tow.get(name) is None]
    missing += [name for name in SAMPLE_SCHEMA if name not in samples.columns]
    if missing:
        raise HerijkError("missing: {}", ", ".join(missing))
    if sample_rate_hz < 1:
        raise HerijkError("sample_rate_hz is {}; it must be at least 1", sample_rate_hz)
    day: dt.date = tow["tow_date"]
    columns = {**Tows.create_empty().schema, "boat_type": pl.String()}
    known = {"season": day.year, "sample_rate_hz": sample_rate_hz, **DEFAULTS, **tow}
    tows = pl.DataFrame([{name: known.get(name) for name in columns}], schema=columns)
    runs = _runs(samples["run"].unique().sort()).select(
        pl.lit(known["tow_id"]).alias("tow_id"), pl.all()
    )
    cast = samples.select(pl.col(name).cast(dtype) for name, dtype in SAMPLE_SCHEMA.items())
    sums = block_sums(cast, sample_rate_hz).select(
        pl.lit(known["tow_id"]).alias("tow_id"), pl.all()
    )
    made = recompute(applied, tows, stack_blocks(sums, runs), with_bands=False)
    return Applied(made.curves, made.run_points)


def _runs(numbers: pl.Series) -> pl.DataFrame:
    """Return the runs as the federation tows them: the first half out and the second back."""
    half = RUNS_PER_FILE // 2
    place = (pl.col("run") - 1) % half
    return pl.DataFrame({"run": numbers.cast(pl.Int8)}).with_columns(
        pl.when(pl.col("run") <= half).then(OUT).otherwise(BACK).cast(pl.Int8).alias("direction"),
        place.replace_strict(list(range(half)), TARGET_SPEED_RATIOS).alias("target_speed_ratio"),
        pl.lit(value=True).alias("selected"),
    )
