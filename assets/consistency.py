"""Whether equal boats are equal: a model of each type, and repeated tows."""

import dagster as dg
import polars as pl

from assets.lake import Folders, incremental, make_outs
from pipeline.consistency import compared, prediction, repeats
from pipeline.consistency.observed import observe_trusted, select_trusted


@dg.asset
@incremental()
def differences_that_matter(folders: Folders) -> pl.DataFrame:
    """Return the spread between boats from which a type is not equal: what `beheer.toml` says."""
    settings = folders.settings
    return pl.DataFrame(
        {
            "quantity": ["cw_standard_kg_m", "b_m_s", "a_kg_m"],
            "ratio": [settings.difference_cw, settings.difference_b, settings.difference_a],
        }
    )


@dg.multi_asset(
    outs=make_outs("compared_tows", "type_consistency", "type_line_points"), can_subset=True
)
@incremental(may_fail=True)
def comparison_of_types(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    run_points: pl.DataFrame,
    repeat_pairs: pl.DataFrame,
    listed_races: pl.DataFrame,
    differences_that_matter: pl.DataFrame,
    crew_classes: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Whether boats of a type are equal, and each tow beside the others of its type."""
    return compared.type_tables(
        observe_trusted(curves, tows, boats, run_points),
        repeat_pairs,
        listed_races,
        dict(differences_that_matter.rows()),
        crew_classes,
    )


@dg.asset
@incremental(may_fail=True)
def predicted_cw(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Cw of each boat as the other boats predict it, without a tow."""
    return prediction.predict_cw(observe_trusted(curves, tows, boats, run_points))


@dg.asset
@incremental(may_fail=True)
def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Boats and crews that were towed again."""
    return repeats.repeat_pairs(select_trusted(curves, tows), tows)


@dg.asset
@incremental(may_fail=True)
def era_shifts(repeat_pairs: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Shift of Cw from the tows of an era to the next tow of the same boat and crew."""
    return repeats.era_shifts(repeat_pairs, boats)


@dg.asset
@incremental(may_fail=True)
def reproducibility(
    repeat_pairs: pl.DataFrame,
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    run_points: pl.DataFrame,
) -> pl.DataFrame:
    """Return the standard deviation of one tow from repeat pairs, per method and era."""
    return repeats.reproducibility(repeat_pairs, observe_trusted(curves, tows, boats, run_points))
