"""The commands about an archive that come before a rebuild: `init`, `simulate` and `check`."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from herijk.cli.options import PATH, Seasons, data_option, form_options, show, show_files
from herijk.cli.speaking import Command, argument, flag, option
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import tell
from warehouse.store.machine_faults import explain_machine_faults

if TYPE_CHECKING:
    from warehouse.store.store import Store


@click.command(
    cls=Command,
    examples=("herijk init archief", "herijk init archive --profile skiffs.toml"),
)
@argument("directory", type=PATH, help="Folder to make.")
@option(
    "--profile",
    type=PATH,
    help="An archief.toml of another federation: folders, files, columns and classes are named by "
    "it.",
)
@form_options
def init(directory: Path, profile: Path | None) -> None:
    """Make an empty archive with examples, spreadsheets to fill in, and a page that explains it."""
    from warehouse.archive.empty_archive import write_templates

    try:
        write_templates(directory, profile)
    except OSError as error:
        raise MissingKnowledgeError(
            "no archive can be made in {}: {}. Name another folder", directory, error.strerror
        ) from error
    files = sorted(file for file in directory.rglob("*") if file.is_file())
    said = tell("An empty archive is in {}; begin with LEESMIJ.md.", directory)
    if profile is not None:
        said = tell("An empty archive with the names of {} is in {}.", profile, directory)
    show_files(files, said)


@click.command(
    cls=Command,
    examples=(
        "herijk simulate archief",
        "herijk simulate archief --seasons 2009:2012 --world rough",
    ),
)
@argument("directory", type=PATH, required=False, help="Folder to make.")
@option("--seasons", type=Seasons(), default="2009:2018", help="Seasons, both ends included.")
@option("--tows-per-season", type=click.IntRange(1, 1000), default=24, help="Tows in each.")
@option("--rate", type=click.IntRange(5, 1000), default=1000, help="Samples per second.")
@option("--seed", type=click.IntRange(0), default=1, help="Seed of the random numbers.")
@option("--world", default="history", help="What is wrong in it; see --worlds.")
@flag("--worlds", help="List the worlds, and stop.")
@form_options
def simulate(
    directory: Path | None,
    seasons: range,
    tows_per_season: int,
    rate: int,
    seed: int,
    world: str,
    worlds: bool,
) -> None:
    """Write a simulated archive with known truth (the truth lies beside it, not in it)."""
    from herijk.cli.progress import show_tow_count
    from herijk.simulate import WORLDS, simulate_world, world_settings
    from herijk.simulate.archive_writer import write_simulated_archive

    if worlds:
        click.echo("\n".join(f"{name:18s}{tell(named.about)}" for name, named in WORLDS.items()))
        return
    if directory is None:
        raise click.UsageError(tell("name the folder to make"))
    settings = world_settings(
        world, seasons=tuple(seasons), tows_per_season=tows_per_season, rate_hz=rate, seed=seed
    )
    with explain_machine_faults(directory), show_tow_count() as counted:
        truth = write_simulated_archive(directory, simulate_world(settings), counted)
    made = {"archive": str(directory), "truth": str(truth)}
    show("simulated", made, ("archive", "truth"))


@click.command(
    cls=Command,
    examples=("herijk check archief",),
)
@argument(
    "archive",
    type=PATH,
    required=False,
    envvar="HERIJK_ARCHIVE",
    help="The archive folder. Without it only the machine and the data folder are checked.",
)
@data_option
@form_options
def check(archive: Path | None, store: "Store") -> None:
    """Say what is wrong in an archive, by cause, and whether this machine can rebuild.

    Reads lists, headers and a sample of the data; then settings, methods, tables and disk space.
    """
    from herijk.cli.checking import check_everything, list_answers

    report = check_everything(archive, store)
    data = vars(report) | {"answers": list_answers}
    show("check", data, ("findings", "archive"))
    if not report.sound:
        raise click.exceptions.Exit(1)
