"""Printed registers of the archive as editions: which file, and its lines."""

from typing import Final

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.register.printed import AS_PRINTED
from pipeline.register.register import LINE, TOW_DAY
from warehouse.editions.inputs import INPUTS_HASH
from warehouse.store.store import Store, fingerprint

PRINTED_METHOD: Final = "as-printed"
"""What stands for the method of a line that none was applied to."""

NO_VALID_CURVE: Final = "no_valid_curve"


def find_printed_path(store: Store, season: int) -> str:
    """Return the file of the register printed in a season, to be published whole.

    Raises:
        MissingKnowledgeError: the archive holds no such register, or one with a line that cannot be
            read: an edition is kept for ever and must not lack it.
    """
    registers = store.read("printed_registers")
    paths = registers.filter(season=season)["path"].unique().sort()
    if paths.is_empty():
        known = ", ".join(str(s) for s in registers["season"].unique().sort()) or say("none")
        raise MissingKnowledgeError(
            "the archive holds no readable register printed in {}; it holds: {}", season, known
        )
    path = str(paths[0])
    for unread in store.read("list_faults").filter(path=path)["message"]:
        raise MissingKnowledgeError("{}: {} Mend the line, or take it out", path, unread)
    return path


def printed_lines(store: Store, path: str) -> pl.DataFrame:
    """Return the lines of a printed register, each with the hash of what it says.

    Raises:
        MissingKnowledgeError: it names a line twice.
    """
    printed = store.read("printed_registers").filter(path=path)
    for row in printed.filter(pl.struct(LINE).is_duplicated()).iter_rows(named=True):
        raise MissingKnowledgeError(
            "{}, line {}: {} is listed twice for {}{}; take one of the lines out",
            row["path"],
            row["line"],
            row["fsn_no"],
            row["rowers"],
            row["crew_class"],
        )
    hashes = [fingerprint(row) for row in printed.drop("path", "line").rows()]
    has_curve = pl.col("has_valid_curve")
    return printed.select(
        pl.col(TOW_DAY),
        "declared_speed_m_s",
        "a_kg_m",
        "b_m_s",
        "cw_kg_m",
        status=pl.when(has_curve).then(pl.lit("valid")).otherwise(pl.lit(NO_VALID_CURVE)),
        basis=pl.when(has_curve).then(pl.lit(AS_PRINTED)),
        **{INPUTS_HASH: pl.Series(hashes, dtype=pl.String)},
    )
