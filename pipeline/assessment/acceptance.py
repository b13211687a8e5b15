"""Acceptances of tows, held against what the checks say of these tows now."""

from typing import Final

import polars as pl

SET_ASIDE: Final = "set_aside"
"""Stands among the checks that doubt a tow, where the tow has no curve because it is set aside."""


def judge_acceptances(
    listed: pl.DataFrame, tows: pl.DataFrame, curves: pl.DataFrame
) -> pl.DataFrame:
    """Return each acceptance under each method, with the checks that doubt the tow since.

    A person who accepts a tow knows what marked it that day. Only what marks it besides is a doubt.
    The newest acceptance of a tow counts, so accepting it again settles a doubt.

    Args:
        listed: rows of `ListedAcceptances`.
        tows: `tow_id` and `fsn_no` of the listed tows.
        curves: `method`, `tow_id` and `flags` of all tows that are not set aside.

    Returns:
        Rows of `Acceptances`.
    """
    methods = curves.select("method").unique(maintain_order=True)
    judged = (
        listed.join(methods, how="cross", maintain_order="left_right")
        .join(tows.select("tow_id", "fsn_no"), on="tow_id", how="left", maintain_order="left")
        .join(
            curves.select("method", "tow_id", "flags"),
            on=["method", "tow_id"],
            how="left",
            maintain_order="left",
        )
    )
    is_newest = pl.col("accepted_on") == pl.col("accepted_on").max().over("method", "tow_id")
    known = pl.col("known_checks").str.extract_all("[a-z0-9_]+").fill_null([])
    marks = pl.col("flags").fill_null([SET_ASIDE])
    doubts = marks.list.set_difference(known).list.sort()
    return judged.with_columns(
        newest=is_newest,
        known_checks=known,
        doubted_by=pl.when(is_newest).then(doubts).otherwise(pl.lit([], pl.List(pl.String))),
    )
