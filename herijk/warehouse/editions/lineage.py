"""From a printed line of an edition to the files, runs and seconds behind it.

Everything is read from the edition itself, so it holds however archive and warehouse have changed.
"""

from typing import Any

import polars as pl

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.register.register import LINE
from herijk.warehouse.editions.sheets import CODE_FIELD, REGISTER_FIELDS, printed_cells
from herijk.warehouse.store.editions import Edition, edition_path, read_edition
from herijk.warehouse.store.store import Store

Report = dict[str, Any]


def lineage(store: Store, edition: str, fsn_no: str) -> Report:
    """What the lines of a boat were made from.

    Raises:
        MissingKnowledgeError: there is no such edition, or the boat is not in it.
    """
    published = read_edition(store, edition)
    lines = published.register.filter(pl.col("fsn_no") == fsn_no)
    if lines.is_empty():
        raise MissingKnowledgeError(
            "boat {} is not in edition {}; its register.csv lists the boats", fsn_no, edition
        )
    return {
        "about": published.about.model_dump(mode="json", exclude={"files", "tables"}),
        "folder": str(edition_path(store, edition)),
        "lines": [_line(published, row) for row in lines.sort(LINE).iter_rows(named=True)],
    }


def _line(edition: Edition, row: dict[str, Any]) -> Report:
    frame = pl.DataFrame([row], schema=edition.register.schema)
    cells = printed_cells(frame, REGISTER_FIELDS)[0]
    printed = {field.header: cell for field, cell in zip(REGISTER_FIELDS, cells, strict=True)}
    line: Report = {"line": row, "printed": printed, "code": row[CODE_FIELD.column]}
    if row["tow_id"] is None or "tows" not in edition.tables:
        return line | {"tow": None, "files": [], "runs": [], "curve": None}
    of_tow = {
        name: edition.tables[name].filter(pl.col("tow_id") == row["tow_id"]).to_dicts()
        for name in ("tows", "curves", "run_points")
    }
    tow = of_tow["tows"][0]
    files = [
        (tow["samples_path"], tow["samples_sha256"]),
        (tow["second_path"], tow["second_sha256"]),
    ]
    return line | {
        "tow": tow,
        "files": [{"path": path, "sha256": sha256} for path, sha256 in files if path],
        "runs": of_tow["run_points"],
        "curve": of_tow["curves"][0],
    }
