"""The heavy part of a rebuild in other tools: samples kept, and the sums of every second.

From text each tool writes the samples of a tow as Parquet (32 bits, lz4), as Herijk does; from
those it makes the sums of `pipeline.blocks.run_blocks`, from which every method can be computed.
Nothing is checked. Each works the way it is best at: pandas tow after tow with NumPy, DuckDB in
SQL, Polars in lazy expressions; the last two with `THREADS` threads.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import pandas as pd
import polars as pl

from benchmarks.harness import THREADS, both
from benchmarks.world import HEADERS, RATE_HZ
from pipeline.blocks.run_blocks import AIR_SUMS, SPEED_SOURCES, SUM_NAMES
from pipeline.channels import SAMPLE_SCHEMA


def means_of_runs(sums: pl.DataFrame) -> pl.DataFrame:
    """What `plain.curves` takes, from the sums of seconds."""
    total = sums.group_by("tow_id", "run").agg(pl.col("n", *SUM_NAMES).sum())
    n = pl.col("n")
    return total.select(
        "tow_id",
        "run",
        (pl.col("log1_v") / n).alias("speed_m_s"),
        (pl.col("log1_cw") / n).alias("gross_kg_m"),
        (pl.col("log1_front_ahead") / n).alias("ahead"),
        (pl.col("log1_front_behind") / n).alias("behind"),
        (pl.col("log1_side") / n).alias("side"),
    )


def sums(tool: str, files: Mapping[str, str], folder: Path) -> pl.DataFrame:
    """Sums of every second of every tow.

    Args:
        tool: pandas, duckdb or polars.
        files: of each tow, text or Parquet.
        folder: where Parquet made from text goes.
    """
    return {"pandas": _pandas, "duckdb": _duckdb, "polars": _polars}[tool](files, folder)


def _is_text(path: str) -> bool:
    return not path.endswith(".parquet")


# pandas and NumPy


def _pandas(files: Mapping[str, str], folder: Path) -> pl.DataFrame:
    return pl.from_pandas(
        pd.concat([_pandas_tow(path, folder).assign(tow_id=tow) for tow, path in files.items()])
    )


def _pandas_tow(path: str, folder: Path) -> pd.DataFrame:
    if _is_text(path):
        samples = pd.read_csv(path, sep=";", decimal=",", usecols=list(HEADERS.values()))
        samples = samples.rename(columns={text: name for name, text in HEADERS.items()})
        samples = samples.astype(dict.fromkeys(list(HEADERS)[1:], "float32") | {"run": "int8"})
        samples.to_parquet(folder / "pandas.parquet", compression="lz4", index=False)
    else:
        samples = pd.read_parquet(path, columns=list(HEADERS))
    run = samples.pop("run").to_numpy()
    first = np.flatnonzero(np.diff(run, prepend=-1))
    second = (np.arange(len(run)) - np.repeat(first, np.diff(first, append=len(run)))) // RATE_HZ
    starts = np.flatnonzero((np.diff(second, prepend=-1) != 0) | (np.diff(run, prepend=-1) != 0))
    channels = {name: samples[name].to_numpy(np.float64) for name in samples}
    present = np.isfinite(channels["gps_m_s"])
    channels["gps_m_s"] = np.where(present, channels["gps_m_s"], 0.0)
    angle = np.radians(channels["wind_angle_deg"])
    made = _quantities(channels, np.cos(angle), np.sin(angle)) | {"gps_n": present.astype(float)}
    found = {name: np.add.reduceat(made[name], starts) for name in SUM_NAMES}
    n = np.diff(starts, append=len(run))
    return pd.DataFrame({"run": run[starts], "second": second[starts], "n": n} | found)


def _quantities(channel: Mapping[str, Any], cos: Any, sin: Any) -> dict[str, Any]:
    """What is added up, but for the count of the ground speeds: arrays, or expressions of Polars.

    Args:
        channel: the samples, in 64 bits.
        cos: cosine of the wind's angle.
        sin: its sine.
    """
    force, wind = channel["force_n"], channel["wind_speed_m_s"]
    x, gps = wind * cos, channel["gps_m_s"]
    head = x * abs(x)
    air = {"head_ahead": head.clip(0, None), "head_behind": head.clip(None, 0)}
    for side in ("ahead", "behind"):
        air[f"front_{side}"] = air[f"head_{side}"] * abs(cos)
    made = {"force": force, "side": head * abs(sin)} | air
    made |= {"wind_v": wind, "wind_cos": cos, "wind_sin": sin}
    made |= {"wind_x": x, "wind_y": wind * sin, "gps": gps}
    log1, log2 = channel["log1_m_s"], channel["log2_m_s"]
    for source, v in zip(SPEED_SOURCES, (log1, log2, 0.5 * (log1 + log2)), strict=True):
        inverse = 1.0 / (v * v)
        cw = force * inverse
        made |= {f"{source}_v": v, f"{source}_inv_v2": inverse}
        made |= {f"{source}_cw": cw, f"{source}_cw2": cw * cw}
        made |= {f"{source}_{term}": made[term] * inverse for term in AIR_SUMS}
    return made


# Polars


def _polars(files: Mapping[str, str], folder: Path) -> pl.DataFrame:
    return pl.concat(both(lambda file: _polars_tow(*file, folder), files.items()))


def _polars_tow(tow: str, path: str, folder: Path) -> pl.DataFrame:
    if _is_text(path):
        text = pl.scan_csv(path, separator=";", decimal_comma=True)
        samples = text.select(
            pl.col(header).cast(SAMPLE_SCHEMA[name]).alias(name) for name, header in HEADERS.items()
        )
        path = str(folder / f"{tow}.parquet")
        samples.sink_parquet(path, compression="lz4", statistics=False)
    wide = pl.scan_parquet(path, hive_partitioning=False).with_columns(
        pl.col(list(HEADERS)[1:]).cast(pl.Float64),
        second=pl.int_range(pl.len()).over("run") // RATE_HZ,
    )
    angle = pl.col("wind_angle_deg").radians()
    made = _quantities({name: pl.col(name) for name in HEADERS}, angle.cos(), angle.sin())
    made["gps_n"] = pl.col("gps_m_s").is_not_null().cast(pl.Float64)
    return (
        wide.select("run", "second", *(quantity.alias(n) for n, quantity in made.items()))
        .group_by("run", "second")
        .agg(pl.lit(tow).first().alias("tow_id"), pl.len().alias("n"), pl.col(SUM_NAMES).sum())
        .collect()
    )


# DuckDB

_SAMPLES = """
select tow_id, run, log1_m_s::double as log1, log2_m_s::double as log2, gps_m_s::double as gps,
       (log1 + log2) / 2 as mean, force_n::double as force, wind_speed_m_s::double as wind,
       radians(wind_angle_deg::double) as angle,
       (file_row_number - min(file_row_number) over (partition by filename, run)) // {rate}
       as second
from read_parquet({files}, filename = true, file_row_number = true) join files using (filename)
"""
_WIND = """
select *, cos(angle) as cos, sin(angle) as sin, wind * cos as x, x * abs(x) as head,
       greatest(head, 0) as head_ahead, least(head, 0) as head_behind,
       head_ahead * abs(cos) as front_ahead, head_behind * abs(cos) as front_behind,
       head * abs(sin) as side,
       1 / (log1 * log1) as log1_inverse, 1 / (log2 * log2) as log2_inverse,
       1 / (mean * mean) as mean_inverse
from ({samples})
"""
_ADDED = {
    **{name: name for name in ("force", *AIR_SUMS)},
    "wind_v": "wind",
    "wind_cos": "cos",
    "wind_sin": "sin",
    "wind_x": "x",
    "wind_y": "wind * sin",
    "gps": "gps",
    **{f"{s}_v": s for s in SPEED_SOURCES},
    **{f"{s}_inv_v2": f"{s}_inverse" for s in SPEED_SOURCES},
    **{f"{s}_cw": f"force * {s}_inverse" for s in SPEED_SOURCES},
    **{f"{s}_cw2": f"(force * {s}_inverse) * (force * {s}_inverse)" for s in SPEED_SOURCES},
    **{f"{s}_{term}": f"{term} * {s}_inverse" for s in SPEED_SOURCES for term in AIR_SUMS},
}


def _duckdb(files: Mapping[str, str], folder: Path) -> pl.DataFrame:
    with duckdb.connect() as connection:
        connection.execute(f"set threads = {THREADS}")
        if _is_text(next(iter(files.values()))):
            both(lambda file: _duckdb_to_parquet(connection.cursor(), *file, folder), files.items())
            files = {tow: str(folder / f"{tow}.parquet") for tow in files}
        named = pl.DataFrame({"tow_id": list(files), "filename": list(files.values())})
        connection.register("files", named.to_arrow())
        added = ", ".join(f"sum({what}) as {name}" for name, what in _ADDED.items())
        samples = _WIND.format(samples=_SAMPLES.format(files=list(files.values()), rate=RATE_HZ))
        query = (
            f"select tow_id, run, second, count(*) as n, count(gps)::double as gps_n, {added} "
            f"from ({samples}) group by tow_id, run, second"
        )
        return pl.DataFrame(connection.sql(query).to_arrow_table())


def _duckdb_to_parquet(cursor: Any, tow: str, path: str, folder: Path) -> None:
    asked = ", ".join(
        f'"{header}"::{"tinyint" if name == "run" else "float"} as {name}'
        for name, header in HEADERS.items()
    )
    cursor.execute(
        f"copy (select {asked} from read_csv('{path}', delim = ';', header = true, "
        f"decimal_separator = ',')) to '{folder / f'{tow}.parquet'}' "
        "(format parquet, compression lz4)"
    )
