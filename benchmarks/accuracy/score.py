"""How near the truth the tables of a method are: sums per archive, and the table made of them.

A record holds sums over one simulated archive, so that records can be added up; the Monte Carlo
error of a figure is that of its mean over archives.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import polars as pl

from herijk.simulate import WORLDS
from pipeline.assessment.checks import CHECKS

PERIODS = {
    "2009-11": range(2009, 2012),
    "2012-13": range(2012, 2014),
    "2014 on": range(2014, 10_000),
}
ALL = "all"
FAULTY = "faulty"
"""Group of the seasons in which a world has its fault, where these are not all seasons."""
ESTIMATES = {
    "as measured": ("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
    "best estimate": ("cw_best_kg_m", "cw_best_lo_kg_m", "cw_best_hi_kg_m"),
}
SUMS = ("n", "intervals", "error", "squared", "covered", "half_width", "flagged", "silent")
EQUAL_BOATS = "type_consistency"
"""Table of the test whether boats of a type are equal; given where they are."""
LEVEL = 0.05
NEAR = 0.02
"""Error of Cw as measured below which nothing is wrong with a tow."""
OF_SEASON = "season_in_doubt"
"""The question that a season is asked, and not a tow."""
ASKED = [check.code for check in CHECKS if check.severity != "note" and check.code != OF_SEASON]
Record = dict[str, Any]


def faulty_seasons(world: str, seasons: Iterable[int]) -> set[int]:
    """Seasons in which a world differs from its base."""
    named = WORLDS[world]
    unlinked = set(named.options.get("linking_boats", ()))
    return {s for s in seasons if s in unlinked or named.defects(s) != named.base(s)}


def score(world: str, tables: Mapping[str, pl.DataFrame], truth: pl.DataFrame) -> list[Record]:
    """Sums over tows, per estimate and group of seasons.

    Args:
        world: its name.
        tables: `curves`, `log_factors`, and `season_diagnosis`, of `rebased`.
        truth: `tow_id, season` and the fields of `TowTruth`.
    """
    doubted = seasons_said(tables, DOUBTED)
    tows = tables["curves"].drop("season", strict=False).join(truth, on="tow_id")
    tows = tows.with_columns(pl.col("season").is_in(doubted).alias("doubted"))
    groups = dict(PERIODS)
    faulty = faulty_seasons(world, truth["season"].unique())
    if faulty and len(faulty) < truth["season"].n_unique():
        groups[FAULTY] = faulty
    records = [
        {"what": what, "group": group} | _sums(tows.filter(pl.col("season").is_in(seasons)), *names)
        for what, names in ESTIMATES.items()
        if names[0] in tows.columns
        for group, seasons in groups.items()
    ]
    return [
        *records,
        *_factors(tables["log_factors"], truth, doubted, _not_told_apart(tables)),
        _alarms(truth, faulty, seasons_said(tables, NAMED)),
        *_equal_boats(tables),
        *_count_asked_tows(tows),
    ]


def _count_asked_tows(tows: pl.DataFrame) -> Iterator[Record]:
    """Count the sound tows about which, or only about whose season, a person is asked, per era.

    Sound is a tow that nothing was done to: not altered, not pulled askew. Of these, `near_*` are
    truly within `NEAR` of the truth as measured.
    """
    error = (pl.col("cw_kg_m") / pl.col("cw_at_15c_kg_m") - 1.0).abs()
    flags = pl.col("flags").list
    sound = tows.filter(~pl.col("altered") & (pl.col("askew_ratio") == 1.0)).with_columns(
        is_near=(error < NEAR).fill_null(False),
        is_asked=flags.set_intersection(pl.lit(ASKED)).list.len() > 0,
        of_season=flags.contains(OF_SEASON),
    )
    for group, seasons in (PERIODS | {ALL: set(sound["season"])}).items():
        of_group = sound.filter(pl.col("season").is_in(seasons))
        near = of_group.filter("is_near")
        yield {
            "what": "sound tows",
            "group": group,
            "sound_tows": of_group.height,
            "of_season": int(of_group["of_season"].sum()),
            "asked": int(of_group["is_asked"].sum()),
            "near_tows": near.height,
            "near_asked": int(near["is_asked"].sum()),
        }


def _sums(tows: pl.DataFrame, cw: str, lo: str, hi: str) -> Record:
    held = tows.drop_nulls(cw)
    error = held[cw] / held["cw_at_15c_kg_m"] - 1.0
    covered = held["cw_at_15c_kg_m"].is_between(held[lo], held[hi]).fill_null(False)
    flagged = (held["status"] != "accepted") | held["doubted"]
    half = ((held[hi] - held[lo]) / (2.0 * held[cw])).drop_nulls()
    numbers = (
        held.height,
        half.len(),
        error.sum(),
        (error**2).sum(),
        covered.sum(),
        half.sum(),
        flagged.sum(),
        (~covered & ~flagged).sum(),
    )
    return dict(zip(SUMS, map(float, numbers), strict=True))


def _factors(
    factors: pl.DataFrame, truth: pl.DataFrame, doubted: set[int], not_told_apart: set[int]
) -> Iterator[Record]:
    """Season log factors in the seasons without dGPS, against the mean of what the tows had."""
    means = truth.group_by("season").agg(pl.col("log_factor").log().mean().exp().alias("true"))
    held = factors.filter(pl.col("season") < PERIODS["2014 on"].start).join(means, on="season")
    held = held.drop_nulls("factor")
    error = held["factor"] / held["true"] - 1.0
    covered = held["true"].is_between(held["lo"], held["hi"]).fill_null(False)
    half = ((held["hi"] - held["lo"]) / (2.0 * held["factor"])).drop_nulls()
    flagged = held["season"].is_in(doubted | not_told_apart)
    sums = (error.sum(), (error**2).sum(), covered.sum(), half.sum(), flagged.sum())
    silent = (~covered & ~flagged).sum()
    numbers = map(float, (held.height, half.len(), *sums, silent))
    yield {"what": "log factor", "group": "2009-13"} | dict(zip(SUMS, numbers, strict=True))


NAMED = ("fault", "alarm")
DOUBTED = (*NAMED, "cannot be told", "not determined")


def seasons_said(tables: Mapping[str, pl.DataFrame], verdicts: tuple[str, ...]) -> set[int]:
    """Seasons of which the tables say such a thing of any instrument."""
    said = pl.col("verdict").is_in(verdicts)
    return set(tables["season_diagnosis"].filter(said)["season"])


def _not_told_apart(tables: Mapping[str, pl.DataFrame]) -> set[int]:
    """Seasons of which the tables say that a fault of the load cell would pass for the log."""
    said = (pl.col("instrument") == "force_scale") & (pl.col("verdict") == "would not show")
    return set(tables["season_diagnosis"].filter(said)["season"])


def _alarms(truth: pl.DataFrame, faulty: set[int], alarmed: set[int]) -> Record:
    sound = set(truth["season"]) - faulty
    return {
        "what": "alarms",
        "group": "seasons",
        "faulty": len(faulty),
        "found": len(faulty & alarmed),
        "sound": len(sound),
        "false": len(sound & alarmed),
    }


def _equal_boats(tables: Mapping[str, pl.DataFrame]) -> Iterator[Record]:
    """How often identical boats are told apart."""
    if EQUAL_BOATS in tables:
        judged = tables[EQUAL_BOATS].filter(quantity="b_m_s").drop_nulls("spread_ratio")["verdict"]
        counts = {"tested": judged.len(), "rejected": int((judged == "differ").sum())}
        yield {"what": "equal boats", "group": "types"} | counts


def mean_and_error(numerators: np.ndarray, counts: np.ndarray) -> tuple[float, float]:
    """Ratio of sums over archives, and its Monte Carlo error (delta method); NaN without any."""
    total = counts.sum()
    if total == 0:
        return np.nan, np.nan
    ratio = numerators.sum() / total
    if len(counts) < 2:
        return float(ratio), np.nan
    rest = numerators - ratio * counts
    return float(ratio), float(np.sqrt(len(counts) * (rest**2).sum() / (len(counts) - 1)) / total)


def table(records: pl.DataFrame) -> Iterator[str]:
    """Lines of the table, in Markdown; every figure with its Monte Carlo error behind it."""
    yield (
        "| world | seasons | estimate | archives | bias % | RMSE % | covered % | half-width % "
        "| flagged % | silent misses % |"
    )
    yield "| --- " * 10 + "|"
    for world in records["world"].unique(maintain_order=True):
        mine = records.filter(world=world)
        measures = mine.filter(pl.col("n").is_not_null())
        for (what, group), rows in measures.group_by("what", "group", maintain_order=True):
            if rows["n"].sum():
                yield _line(world, str(group), str(what), rows)
        yield _alarm_line(world, mine.filter(what="alarms"))
        asked = mine.filter(what="sound tows")
        for (group,), rows in asked.group_by("group", maintain_order=True):
            yield _write_asked_line(world, str(group), rows)
        equal = mine.filter(what="equal boats")
        if equal.height:
            share, error = mean_and_error(equal["rejected"].to_numpy(), equal["tested"].to_numpy())
            said = f"identical boats told apart {100 * share:.0f} ± {100 * error:.1f} %"
            yield f"| {world} | all | equal boats | {equal.height} | {said} | | | | | |"


def _line(world: str, group: str, what: str, rows: pl.DataFrame) -> str:
    column = {name: rows[name].to_numpy() for name in SUMS}
    n = column["n"]
    mean_square, its_error = mean_and_error(column["squared"], n)
    rmse = np.sqrt(mean_square)
    figures = [
        mean_and_error(column["error"], n),
        (rmse, its_error / (2.0 * rmse)),
        mean_and_error(column["covered"], n),
        mean_and_error(column["half_width"], column["intervals"]),
        mean_and_error(column["flagged"], n),
        mean_and_error(column["silent"], n),
    ]
    decimals = (2, 2, 0, 2, 0, 0)
    cells = [
        f"{100 * value:.{d}f} ± {100 * error:.{max(d, 1)}f}"
        for (value, error), d in zip(figures, decimals, strict=True)
    ]
    return f"| {world} | {group} | {what} | {rows.height} | " + " | ".join(cells) + " |"


def _write_asked_line(world: str, group: str, rows: pl.DataFrame) -> str:
    pairs = {
        "asked about": ("asked", "sound_tows"),
        f"within {NEAR:.0%} and asked about": ("near_asked", "near_tows"),
        "of a doubted season": ("of_season", "sound_tows"),
    }
    said = []
    for name, (count, of) in pairs.items():
        value, error = mean_and_error(rows[count].to_numpy(), rows[of].to_numpy())
        said.append(f"{name} {100 * value:.1f} ± {100 * error:.1f} %")
    return f"| {world} | {group} | sound tows | {rows.height} | {'; '.join(said)} | | | | | |"


def _alarm_line(world: str, rows: pl.DataFrame) -> str:
    found = mean_and_error(rows["found"].to_numpy(), rows["faulty"].to_numpy())
    false = mean_and_error(rows["false"].to_numpy(), rows["sound"].to_numpy())
    said = [
        f"{name} {100 * value:.0f} ± {100 * error:.1f} %"
        for name, (value, error) in (
            ("faulty seasons alarmed", found),
            ("sound seasons alarmed", false),
        )
        if np.isfinite(value)
    ]
    return f"| {world} | all | alarms | {rows.height} | {'; '.join(said)} | | | | | |"
