"""The commands that work on a data folder: `rebuild`, `serve` and `workbench`."""

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from herijk.cli.options import Seasons, archive_option, data_option, form_options, show
from herijk.cli.speaking import Command, flag, option
from pipeline.errors import BrokenPromiseError, NoTowsYetError
from pipeline.messages import LANGUAGE, tell, write_in_language
from warehouse.store.machine_faults import explain_machine_faults

if TYPE_CHECKING:
    from warehouse.store.store import Store


@click.command(
    cls=Command,
    examples=("herijk rebuild --archive archief --data data",),
)
@archive_option
@data_option
@option(
    "--method",
    "methods",
    multiple=True,
    metavar="METHOD_OR_FILE",
    help="Method to add to those of the data folder, or to renew; repeat for more. A file is kept "
    "there. Default: those that beheer.toml lists, or all that ship.",
)
@option("--seasons", type=Seasons(), help="Read these seasons only.")
@form_options
def rebuild(archive: Path, store: "Store", methods: tuple[str, ...], seasons: range | None) -> None:
    """From the archive to registers and tables; only what changed is done again."""
    from assets.rebuild import rebuild as run
    from assets.report import failed_checks
    from assets.settings import choose_methods
    from herijk.cli.progress import rebuild_shown
    from warehouse.queries.reports import rebuild_report
    from warehouse.store.methods import KnownMethods

    known = KnownMethods.from_store(store)
    chosen = choose_methods(store.root, list(map(known.keep, methods)))
    try:
        with explain_machine_faults(store.root), rebuild_shown():
            news = run(archive, store.root, chosen, seasons)
    except NoTowsYetError as error:  # a new archive is no failure
        show("no_tows", {"reason": write_in_language(error, LANGUAGE.get())}, ("reason",))
        return
    report = rebuild_report(store)
    data = {
        "report": report,
        "since": news,
        "simulated": report.simulated,
        "counts": [row | {"lost": f"lost_{row['lost']}"} for row in report.set_aside],
        "tows_by_season": ", ".join(f"{row['season']}: {row['tows']}" for row in report.seasons),
    }
    show("rebuild", data, ("report", "since"))
    if failed := failed_checks(news.checks):
        raise BrokenPromiseError("a check failed: {}", "; ".join(failed))


@click.command(
    cls=Command,
    examples=("herijk serve --archive archief --data data",),
)
@archive_option
@data_option
@option("--host", default="127.0.0.1", help="Address on which the site is served.")
@option(
    "--port",
    type=click.IntRange(1, 65534),
    default=3000,
    help="Port of Dagster's page, on this machine only; the site has the next.",
)
@flag("--may-start", help="Let Dagster's page start rebuilds and switch schedules.")
def serve(archive: Path, store: "Store", host: str, port: int, may_start: bool) -> None:
    """Rebuild by itself: schedules and sensor, with Dagster's page and the site, until stopped."""
    from assets.instance import end_lost_runs, open_instance, prepare_home
    from assets.rebuild import check_apart
    from assets.settings import read_settings
    from herijk.cli.serving import Served, serve_until_stopped

    check_apart(archive, store.root)
    read_settings(store.root)
    with explain_machine_faults(store.root):
        with open_instance(store) as instance:
            end_lost_runs(instance, {})
        served = Served(archive, store.root, host, port, may_start)
        serve_until_stopped(served, prepare_home(store), lambda line: click.echo(line, err=True))


@click.command(
    cls=Command,
    examples=("herijk workbench",),
)
@data_option
@option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8765,
    help="Port on this machine; 0 for any that is free.",
)
def workbench(store: "Store", port: int) -> None:
    """Try other values of a method's options in a browser and see what happens to all boats."""
    from dashboards.guard import listen
    from dashboards.workbench.bench import Bench
    from dashboards.workbench.server import LOOPBACK, get_address, serve_bench
    from warehouse.queries.history import History

    listening = listen(LOOPBACK, port)
    bench = Bench(store, History.from_store(store))
    where = get_address(listening)
    click.echo(tell("The workbench is at {} (on this machine only); Ctrl-C stops it.", where))
    with suppress(KeyboardInterrupt):
        serve_bench(bench).run(sockets=[listening])
