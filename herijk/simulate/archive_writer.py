"""Writes a simulated world as a tow archive, spelled as real ones are, with the truth beside it.

Each season has another of the allowed spellings, so that reading one archive exercises them all.
What is measured is decided elsewhere in `herijk.simulate`; archives are read by
`warehouse.archive`.
"""

import csv
import datetime as dt
import io
import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TypeAlias

import numpy as np
import polars as pl

from herijk.simulate import RunTruth, Tow, World, simulate_tow, true_cw_kg_m
from herijk.simulate.defects import FIRST_SEASON
from herijk.simulate.hull import REFERENCE_TEMPERATURE_C
from herijk.simulate.papers import RACE_KM, Curves, print_register, race
from herijk.simulate.practice import Practice, practices, print_curve
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.errors import HerijkError

SPEED_UNITS: Final = {"m/s": 1.0, "km/h": 3.6, "kn": 3600.0 / 1852.0}
FORCE_UNITS: Final = {"N": 1.0, "kgf": 1.0 / 9.80665}
COMPRESSIONS: Final[Mapping[str, Literal["uncompressed", "gzip", "zstd"]]] = {
    ".csv": "uncompressed",
    ".csv.gz": "gzip",
    ".csv.zst": "zstd",
}
SAMPLE_DECIMALS: Final = 3
CURVE_SPEED_RATIOS: Final = np.linspace(0.8, 1.2, 17)
"""Speeds of the true curve in the truth file, relative to the declared speed."""
REMARKS: Final = ("", "", "één roer los", "", "gesimuleerde sleep")


@dataclass(frozen=True)
class Spelling:
    """How a season's files are spelled; every choice is one that archives may make.

    `own_names` gives two columns names of their own and leaves out a unit, so that the archive
    needs a profile in `archief.toml`.
    """

    extension: Literal[".csv", ".csv.gz", ".csv.zst", ".parquet"]
    separator: str = ";"
    decimal_comma: bool = True
    encoding: Literal["utf-8", "utf-8-sig", "cp1252"] = "utf-8"
    line_end: str = "\n"
    speed_unit: str = "m/s"
    force_unit: str = "N"
    signed_vane: bool = False
    iso_dates: bool = True
    time_column: bool = False
    own_names: bool = False

    def number(self, value: float, decimals: int) -> str:
        """Return a number as text."""
        text = f"{value:.{decimals}f}"
        return text.replace(".", ",") if self.decimal_comma else text

    def date(self, day: dt.date) -> str:
        """Return a date as text."""
        return day.isoformat() if self.iso_dates else day.strftime("%d-%m-%Y")


PLAIN: Final = Spelling(".csv", encoding="cp1252")
"""How files are written that belong to no season."""
SPELLINGS: Final = (
    PLAIN,
    Spelling(".csv.gz", force_unit="kgf", iso_dates=False, own_names=True),
    Spelling(".csv", "\t", decimal_comma=False, encoding="utf-8-sig", line_end="\r\n"),
    Spelling(".csv.zst", speed_unit="km/h", encoding="cp1252", iso_dates=False),
    Spelling(".parquet", ",", decimal_comma=False, signed_vane=True),
    Spelling(".csv.gz", ",", decimal_comma=False, force_unit="kgf", time_column=True),
    Spelling(".csv.zst", "\t", speed_unit="kn", encoding="utf-8-sig"),
    Spelling(".csv", signed_vane=True, line_end="\r\n", iso_dates=False),
)
"""In turn by season, from the first season that can be simulated."""

FREEBOARD_COLUMNS: Final = ("vrijboord laagst [m]", "vrijboord boeg [m]", "vrijboord achter [m]")
ALL_RUNS: Final = "1,2,3,4,5,6"
OUT_AND_BACK_OF_THE_SECOND: Final = "1,2,3,b4,b5,b6"
RACE_NAME: Final = "Spiegelrace"

Row: TypeAlias = dict[str, str]
"""Cells of a list by the header of their column; the first row of a list gives all headers."""


def find_spelling(season: int) -> Spelling:
    """Return the spelling of a season's files."""
    return SPELLINGS[(season - FIRST_SEASON) % len(SPELLINGS)]


def truth_path(directory: Path) -> Path:
    """Return where the truth of an archive lies: beside it, never in it."""
    return directory.with_name(f"{directory.name}-truth.json")


def write_simulated_archive(
    directory: Path,
    world: World,
    on_tow: Callable[[int, int], None] | None = None,
    workers: int = 2,
) -> Path:
    """Simulate all tows of a world and write them as an archive, with the truth beside it.

    Everything is written under a temporary name and renamed when complete.

    Args:
        directory: the archive to be; must not exist or be empty.
        world: what to write.
        on_tow: called after each tow with the number done and the total.
        workers: threads that simulate and write.

    Returns:
        The path of the truth file, `<directory>-truth.json`.

    Raises:
        HerijkError: the directory is not empty, or its truth file exists.
    """
    directory = directory.absolute()
    _refuse_to_overwrite(directory)
    directory.parent.mkdir(parents=True, exist_ok=True)
    partial = directory.with_name(f".{directory.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    try:
        _write_papers(partial, world)
        truth, curves = _write_all_samples(partial, world, on_tow, workers)
        _write_registers(partial, world, curves)
        partial_truth = partial / "truth.json"
        partial_truth.write_text(json.dumps(truth, indent=1), encoding="utf-8")
        partial_truth.replace(truth_path(directory))
        # Renaming onto an empty directory is allowed, onto a filled one is not.
        partial.replace(directory)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return truth_path(directory)


def _refuse_to_overwrite(directory: Path) -> None:
    if directory.exists() and (not directory.is_dir() or any(directory.iterdir())):
        raise HerijkError(
            "{} exists and is not an empty folder; nothing was written. Choose "
            "another folder, or remove it first",
            directory,
        )
    if truth_path(directory).exists():
        raise HerijkError(
            "{} exists; nothing was written. Remove it, or choose another folder",
            truth_path(directory),
        )


def _write_all_samples(
    directory: Path,
    world: World,
    on_tow: Callable[[int, int], None] | None,
    workers: int,
) -> tuple[dict[str, object], Curves]:
    """Write the samples of all tows; return the truth of each, and what was printed of it."""
    for season in world.settings.seasons:
        _samples_folder(directory, season).mkdir(parents=True)
    truth: dict[str, object] = {tow.tow_id: None for tow in world.tows}
    curves = {}
    with ThreadPoolExecutor(max_workers=workers) as pool:
        futures = {pool.submit(_write_tow, directory, world, tow): tow for tow in world.tows}
        try:
            for done, future in enumerate(as_completed(futures), start=1):
                tow = futures[future]
                runs, curves[tow.tow_id] = future.result()
                truth[tow.tow_id] = _truth_record(world, tow, runs)
                if on_tow is not None:
                    on_tow(done, len(futures))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return truth, curves


def _write_tow(
    directory: Path, world: World, tow: Tow
) -> tuple[tuple[RunTruth, ...], dict[Practice, tuple[float, float]]]:
    samples, runs = simulate_tow(world, tow)
    spelling = find_spelling(tow.season)
    second = pl.col("run") > SECOND_FILE_OFFSET
    first_run = pl.col("run") - pl.lit(SECOND_FILE_OFFSET, pl.Int8)
    files = {tow.samples_name: samples.filter(~second)}
    if tow.second_name:
        files[tow.second_name] = samples.filter(second).with_columns(first_run)
    for name, part in files.items():
        path = _samples_folder(directory, tow.season) / f"{name}{spelling.extension}"
        _write_samples(path, part, spelling, world.settings.rate_hz)
    return runs, {
        practice: print_curve(samples, runs, tow, practice) for practice in practices(tow.season)
    }


def _samples_folder(directory: Path, season: int) -> Path:
    return directory / f"meetdata_{season}"


def _write_samples(path: Path, samples: pl.DataFrame, spelling: Spelling, rate_hz: int) -> None:
    table = samples.select(_spelled_columns(samples, spelling, rate_hz))
    if spelling.extension == ".parquet":
        table.write_parquet(path)
        return
    compression = COMPRESSIONS[spelling.extension]
    table.write_csv(
        path,
        include_bom=spelling.encoding == "utf-8-sig",
        compression=compression,
        compression_level=1 if compression != "uncompressed" else None,
        separator=spelling.separator,
        line_terminator=spelling.line_end,
        float_precision=SAMPLE_DECIMALS,
        decimal_comma=spelling.decimal_comma,
    )


def _spelled_columns(samples: pl.DataFrame, spelling: Spelling, rate_hz: int) -> list[pl.Expr]:
    """Return the samples under the federation's headers, in the units of the spelling."""
    per_m_s = SPEED_UNITS[spelling.speed_unit]
    force = pl.col("force_n") * FORCE_UNITS[spelling.force_unit]
    angle = pl.col("wind_angle_deg")
    if spelling.signed_vane:
        angle = pl.when(angle > 180.0).then(angle - 360.0).otherwise(angle)
    log1, kracht = "log1", f"kracht [{spelling.force_unit}]"
    if spelling.own_names:
        log1, kracht = OWN_NAMES["log1"], OWN_NAMES["force"]

    def speed(column: str, header: str) -> pl.Expr:
        return (pl.col(column) * per_m_s).alias(f"{header} [{spelling.speed_unit}]")

    columns = [pl.col("run"), speed("log1_m_s", log1), speed("log2_m_s", "log2")]
    if samples["gps_m_s"].null_count() < samples.height:
        columns.append(speed("gps_m_s", "gps"))
    columns += [force.alias(kracht), speed("wind_speed_m_s", "wind"), angle.alias("wind [gra]")]
    if spelling.time_column:
        within_run = pl.int_range(pl.len()).over("run")
        columns.insert(1, (within_run / rate_hz).alias("tijd [s]"))
    return columns


OWN_NAMES: Final = {"log1": "snelheid A", "force": "trek"}
"""Headers of a season that needs a profile; the example of the archive's description."""


def _write_papers(directory: Path, world: World) -> None:
    """Write what does not depend on samples: the profile, boats, lists and a race."""
    seasons = world.settings.seasons
    for folder in ("sloepregister", "sleeplijsten", "wedstrijden"):
        (directory / folder).mkdir(parents=True)
    (directory / "archief.toml").write_text(_profile(seasons), encoding="utf-8")
    register = directory / "sloepregister"
    _write_table(register / "sloependata.csv", _boat_rows(world), PLAIN)
    for season in seasons:
        path = directory / "sleeplijsten" / f"sleeplijst_{season}.csv"
        _write_table(path, _list_rows(world, season), find_spelling(season))
    path = directory / "wedstrijden" / f"{RACE_NAME.lower()}_{seasons[-1]}.csv"
    _write_table(path, _race_rows(world, seasons[-1]), find_spelling(seasons[-1]))


def _write_registers(directory: Path, world: World, curves: Curves) -> None:
    """Write the registers of the middle season and of the last."""
    seasons = world.settings.seasons
    for year in sorted({seasons[len(seasons) // 2], seasons[-1]}):
        path = directory / "sloepregister" / f"sloepregister_{year}.csv"
        _write_table(path, _register_rows(world, year, curves), find_spelling(year))


def _write_table(path: Path, rows: Sequence[Row], spelling: Spelling) -> None:
    text = io.StringIO()
    writer = csv.DictWriter(
        text, list(rows[0]), delimiter=spelling.separator, lineterminator=spelling.line_end
    )
    writer.writeheader()
    writer.writerows(rows)
    path.write_bytes(text.getvalue().encode(spelling.encoding))


def _profile(seasons: Sequence[int]) -> str:
    lines = [
        "# Made by a simulator: these are not the federation's measurements.",
        "simulated = true",
        "",
        "[publication]",
        'licence = "CC0-1.0"',
    ]
    for season in seasons:
        spelling = find_spelling(season)
        if spelling.own_names:
            columns = ", ".join(f'{channel} = "{name}"' for channel, name in OWN_NAMES.items())
            lines += [
                "",
                "[[profile]]",
                f'seasons = "{season}:{season}"',
                f"columns = {{ {columns} }}",
                f'units = {{ force = "{spelling.force_unit}" }}',
            ]
    return "\n".join(lines) + "\n"


def _boat_rows(world: World) -> list[Row]:
    newest = {tow.boat.index: tow for tow in world.tows}
    return [
        {
            "fsn_nr": boat.fsn_no,
            "ht_nr": boat.ht_no,
            "sloep": boat.name,
            "type": boat.boat_type.name,
            "lengte [m]": PLAIN.number(boat.waterline_length_m, 2),
            "breedte [m]": PLAIN.number(boat.beam_m, 2),
            "hoogte [m]": PLAIN.number(boat.bow_height_m, 2),
            "gewicht [kg]": PLAIN.number(newest[boat.index].weight_kg, 0),
            "roeiers": str(boat.boat_type.rowers),
            "klasse": boat.crew_classes[0],
        }
        for boat in world.boats
    ]


def _list_rows(world: World, season: int) -> list[Row]:
    """Return the rows of a season's list; a column that is empty for every tow is left out."""
    tows = [tow for tow in world.tows if tow.season == season]
    rows = [_list_row(world, tow) for tow in tows]
    if any(tow.free_thwart or tow.freeboards_m or tow.salinity_g_kg for tow in tows):
        return [row | _optional_cells(tow) for row, tow in zip(rows, tows, strict=True)]
    return rows


def _list_row(world: World, tow: Tow) -> Row:
    spelling, listed_c = find_spelling(tow.season), tow.listed_temperature_c
    return {
        "sleep_id": tow.tow_id,
        "datum": spelling.date(tow.day),
        "fsn_nr": tow.boat.fsn_no,
        "meetfile": tow.samples_name,
        "meetfile2": tow.second_name,
        "roeiers": str(tow.rowers),
        "klasse": tow.crew_class,
        "roeisnelheid [m/s]": spelling.number(tow.declared_speed_m_s, 2),
        "lengte [m]": spelling.number(tow.boat.waterline_length_m, 2),
        "breedte [m]": spelling.number(tow.boat.beam_m, 2),
        "hoogte [m]": spelling.number(tow.boat.bow_height_m, 2),
        "gewicht [kg]": spelling.number(tow.weight_kg, 0),
        "gewicht na [kg]": spelling.number(tow.weight_after_kg, 0),
        "bemanning [kg]": spelling.number(tow.crew_kg, 0),
        "watertemperatuur [C]": "" if listed_c is None else spelling.number(listed_c, 1),
        "correctie [%]": "",
        "gebruik runs": OUT_AND_BACK_OF_THE_SECOND if tow.second_name else ALL_RUNS,
        "verbouwd": "ja" if tow.altered_reported else "nee",
        "meetfrequentie [Hz]": str(world.settings.rate_hz),
        "opmerking": REMARKS[tow.number % len(REMARKS)],
    }


def _optional_cells(tow: Tow) -> Row:
    spelling = find_spelling(tow.season)
    freeboards = zip(FREEBOARD_COLUMNS, tow.freeboards_m or (), strict=False)
    cells = {"lege doft": tow.free_thwart} | dict.fromkeys(FREEBOARD_COLUMNS, "")
    for column, height_m in freeboards:
        cells[column] = spelling.number(height_m, 3)
    if tow.salinity_g_kg:
        cells["zoutgehalte [g/kg]"] = spelling.number(tow.salinity_g_kg, 1)
    return cells


def _register_rows(world: World, year: int, curves: Curves) -> list[Row]:
    spelling = find_spelling(year)
    return [
        {
            "fsn_nr": line.boat.fsn_no,
            "roeiers": str(line.rowers),
            "klasse": line.crew_class,
            "A": spelling.number(line.a_kg_m, 2),
            "B": spelling.number(line.b_m_s, 2),
            "Cw": spelling.number(line.cw_kg_m, 2),
            "roeisnelheid [m/s]": spelling.number(line.declared_speed_m_s, 2),
            "sleepdatum": spelling.date(line.tow_day) if line.tow_day else "",
        }
        for line in print_register(world, year, curves)
    ]


def _race_rows(world: World, season: int) -> list[Row]:
    spelling = find_spelling(season)
    day, lines = race(world, season)
    return [
        {
            "wedstrijd": RACE_NAME,
            "datum": spelling.date(day),
            "afstand [km]": spelling.number(RACE_KM, 3),
            "fsn_nr": line.tow.boat.fsn_no,
            "roeiers": str(line.tow.rowers),
            "klasse": line.tow.crew_class,
            "roeitijd": str(dt.timedelta(seconds=line.seconds)),
            "stroom [km]": "" if line.stream_km is None else spelling.number(line.stream_km, 3),
            "straf [W]": "",
        }
        for line in lines
    ]


def _truth_record(world: World, tow: Tow, runs: tuple[RunTruth, ...]) -> dict[str, object]:
    """Return the truth about a tow, which the archive does not tell, ready for JSON."""
    truth = tow.truth
    defects = world.settings.defects(tow.season)
    speeds = tow.declared_speed_m_s * CURVE_SPEED_RATIOS

    def curve(temperature_c: float) -> list[float]:
        cw = true_cw_kg_m(tow.hull, speeds, temperature_c, world.settings.air)
        return [round(float(value), 4) for value in cw]

    return {
        "simulated": True,
        "cw_declared_kg_m_at_15C": round(truth.cw_at_15c_kg_m, 4),
        "cw_declared_kg_m_at_tow_temperature": round(truth.cw_at_tow_temperature_kg_m, 4),
        "season_log_factor": round(truth.season_log_factor, 6),
        "log_factor_of_day": round(truth.log_factor_of_day, 6),
        "log_factor": round(truth.log_factor, 6),
        "second_log_factor": truth.second_log_factor,
        "log2_ratio": round(truth.log2_ratio, 6),
        "askew_ratio": round(truth.askew_ratio, 4),
        "force_scale": defects.force_scale,
        "force_zero_n": truth.force_zero_n,
        "anemometer_scale": defects.anemometer_scale,
        "gps_scale": defects.gps_scale,
        "altered": truth.altered,
        "altered_reported": tow.altered_reported,
        "runs": [
            {
                "run": run.run,
                "target_speed_m_s": round(run.target_speed_m_s, 4),
                "undisturbed_s": [
                    round(run.undisturbed_start_s, 2),
                    round(run.undisturbed_end_s, 2),
                ],
                "disturbances": [
                    {"kind": d.kind, "start_s": round(d.start_s, 2), "end_s": round(d.end_s, 2)}
                    for d in run.disturbances
                ],
            }
            for run in runs
        ],
        "curve": {
            "speed_m_s": [round(float(speed), 4) for speed in speeds],
            "cw_kg_m_at_tow_temperature": curve(tow.water_temperature_c),
            "cw_kg_m_at_15C": curve(REFERENCE_TEMPERATURE_C),
        },
    }
