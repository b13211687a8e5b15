"""What Dagster's page shows of a table besides its columns: its first rows, and its page."""

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import dagster as dg
import polars as pl

FIRST_ROWS: Final = 20

PAGES: Final[Mapping[str, str]] = {
    "site": "index.html",
    "register": "register.html",
    "due_list": "due.html",
    "type_consistency": "types.html",
    "type_homogeneity": "types.html",
    "race_changes": "races.html",
    "log_factors": "corrections.html",
    "season_diagnosis": "corrections.html",
    "season_ladder": "corrections.html",
    "reproducibility": "reproducibility.html",
    "register_changes": "changes.html",
    "quality_counts": "quality.html",
    "quarantine": "quality.html",
}
"""The page of the site that shows a table; these tables are shown in Dagster too."""

COLUMNS: Final = 12


def columns_of(schema: Mapping[str, pl.DataType]) -> dict[str, dg.TableSchema]:
    """The columns of what the lake holds beside tables, as metadata of its asset."""
    columns = [dg.TableColumn(name, str(kind)) for name, kind in schema.items()]
    return {"dagster/column_schema": dg.TableSchema(columns)}


def preview(table: str, read: Callable[[], pl.DataFrame]) -> dict[str, dg.MetadataValue]:
    """The first rows of a table that people look for; nothing of others."""
    if table not in PAGES or (frame := read()).is_empty():
        return {}
    with pl.Config(
        tbl_formatting="MARKDOWN",
        tbl_hide_column_data_types=True,
        tbl_hide_dataframe_shape=True,
        tbl_rows=FIRST_ROWS,
        tbl_cols=COLUMNS,
        tbl_width_chars=10_000,
        fmt_str_lengths=60,
        float_precision=4,
    ):
        return {"preview": dg.MetadataValue.md(str(frame.head(FIRST_ROWS)))}


def with_site(
    assets: Sequence[dg.AssetsDefinition | dg.AssetSpec], address: str
) -> Sequence[dg.AssetsDefinition | dg.AssetSpec]:
    """Assets that link to their pages of the site, where it is served."""
    return dg.map_asset_specs(
        lambda spec: spec.merge_attributes(metadata=_link(spec.key, address)), assets
    )


def _link(key: dg.AssetKey, address: str) -> dict[str, dg.MetadataValue]:
    page = PAGES.get(key.to_user_string())
    return {"page": dg.MetadataValue.url(f"{address}/{page}")} if page else {}
