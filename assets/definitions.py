"""The Dagster code location: what `dg`, `dagster dev` and `herijk serve` load."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Final

import dagster as dg

from assets import archive, automation, checks, consistency, curves, database, register, rules
from assets.lake import Folders, Lake, describe_table
from assets.settings import read_settings
from pipeline.tables.schemas import TABLES

DEMO: Final = Path(__file__).parents[1] / "demo"
"""What `make demo` makes in a clone."""

SUBJECTS: Final = (archive, rules, curves, consistency, register, database)
"""The modules with assets; the name of each is the group of its assets."""


def load_assets() -> list[dg.AssetsDefinition]:
    """Return the assets of all modules, each with the columns of its table.

    Raises:
        LookupError: a declared table has no asset.
    """
    loaded: list[dg.AssetsDefinition] = []
    for module in SUBJECTS:
        group = module.__name__.partition(".")[2]
        found = dg.load_assets_from_modules([module], group_name=group)
        assets = [one for one in found if isinstance(one, dg.AssetsDefinition)]
        loaded += [asset.map_asset_specs(describe_table) for asset in assets]
    require_assets(loaded, TABLES)
    return loaded


def require_assets(assets: Iterable[dg.AssetsDefinition], tables: Iterable[str]) -> None:
    """Raise LookupError unless every table has the asset that makes it.

    Dagster itself would take a table that only others read for one made elsewhere.
    """
    made = {key.to_user_string() for asset in assets for key in asset.keys}
    missing = sorted(set(tables) - made)
    if missing:
        raise LookupError(
            f"no asset makes the table {', '.join(missing)}, which `pipeline/tables/` declares: "
            "give an asset in `assets/<subject>.py` its name, or name it among the `outs` of one."
        )


ASSETS: Final = load_assets()


def build_defs(
    archive: str, data: str, methods: list[str], is_served: bool = False
) -> dg.Definitions:
    """Return the definitions of an archive and a data folder.

    Args:
        archive: the archive folder.
        data: the data folder.
        methods: names of methods to apply; none for those of the settings.
        is_served: schedule and sensors start by themselves, as `herijk serve` promises.
    """
    folders = Folders(archive=archive, data=data, methods=methods)
    settings = read_settings(Path(data))
    return dg.Definitions(
        assets=ASSETS,
        asset_checks=checks.DAGSTER_CHECKS,
        resources={"folders": folders, "io_manager": Lake(folders=folders)},
        jobs=[automation.rebuild_job],
        schedules=[automation.nightly(settings, is_served)],
        sensors=[
            automation.archive_changed(Path(archive), is_served),
            automation.rebuild_succeeded(settings, Path(data), is_served),
            automation.rebuild_failed(settings, Path(data), is_served),
        ],
        executor=dg.in_process_executor,
    )


@dg.definitions
def defs() -> dg.Definitions:
    """Return the definitions of the folders that the environment names, else of the demo's."""
    return build_defs(
        os.environ.get("HERIJK_ARCHIVE", str(DEMO / "archief")),
        os.environ.get("HERIJK_DATA", str(DEMO / "data")),
        methods=[],
        is_served="HERIJK_SITE" in os.environ,
    )
