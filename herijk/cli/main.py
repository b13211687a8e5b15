"""The command `herijk`: arguments in, results out. Messages go to stderr, results to stdout.

Exit status: 0 done (also with tows set aside: they are listed), 1 could not do it, 2 wrong
arguments, 130 stopped. What a command does is in `assets`, `warehouse` and `pipeline`; how a result
looks as text, in `cli.text`.

A command imports what it needs when it runs: Polars, SciPy, Altair and Dagster take seconds
together, and `herijk --help` needs none of them.
"""

import os
import re
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, NoReturn

import typer

from herijk.cli import documents as commands_documents
from herijk.cli import editions as commands_editions
from herijk.cli import methods, text
from herijk.cli.archive import check, init
from herijk.cli.arguments import ArchiveFolder, AsJson, DataFolder, as_json_text, show, show_files
from herijk.cli.doctor import doctor
from herijk.cli.fit import fit
from herijk.cli.overview import Overview, defaults_of, folders_here
from pipeline.errors import BrokenPromiseError, HerijkError, unexpected
from pipeline.messages import LANGUAGE, say, spoken, tell
from warehouse.store.machine_faults import REASSURANCE, machine_faults_explained

if TYPE_CHECKING:
    from warehouse.queries.audit import BoatAudit
    from warehouse.queries.audit_types import TypesAudit
    from warehouse.store.store import Store

app = typer.Typer(
    help="Recomputes the history of the Dutch rowing-sloop register from its tow tests.",
    no_args_is_help=True,
    cls=Overview,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.add_typer(methods.app, name="methods", invoke_without_command=True)

commands_editions.add_to(app)
commands_documents.add_to(app)
app.command()(fit)
app.command()(check)
app.command()(init)
app.command()(doctor)

MOST_TYPES: Final = 2

INTERRUPTED: Final = 130
"""The exit status after Ctrl-C or SIGTERM: 128 and the number of SIGINT."""

BLAS_THREADS: Final = "OPENBLAS_NUM_THREADS"
"""Read when NumPy is imported. Both processes of a rebuild work on small matrices: more threads in
each only wait for each other (5.4 s instead of 3.2 for the consistency of 1,020 tows)."""

ARROW_MEMORY: Final = "ARROW_DEFAULT_MEMORY_POOL"
"""Read when Arrow is imported. Its own pool keeps what a table took: 0.1 GB in a rebuild of 1,020
tows, and nothing is quicker for it."""


def main() -> None:
    """Runs the command; an error that a user can act on becomes one sentence and status 1."""
    os.environ.setdefault(BLAS_THREADS, "1")
    os.environ.setdefault(ARROW_MEMORY, "system")
    if sys.getfilesystemencoding() != "utf-8":
        _begin_in_utf8()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # as Ctrl-C; it is what systemd sends
    try:
        with machine_faults_explained(Path(os.environ.get("HERIJK_DATA", "data"))):
            app()
    except HerijkError as error:
        typer.echo(f"herijk: {spoken(error, LANGUAGE.get())}", err=True)
        sys.exit(1)
    except SystemExit as ending:
        if ending.code == INTERRUPTED:
            _tell_stopped()
        raise
    except BaseException as error:  # a panic of a library in Rust is no Exception
        if type(error).__name__ == "DagsterExecutionInterruptedError":
            _tell_stopped()
            sys.exit(INTERRUPTED)
        typer.echo(f"herijk: {_written_down(error)}", err=True)
        sys.exit(1)


def _tell_stopped() -> None:
    said = say("stopped, as it was told to. {} Run it again to go on", REASSURANCE)
    typer.echo(f"herijk: {said.spoken(LANGUAGE.get())}", err=True)


def _begin_in_utf8() -> NoReturn:
    """Begins this command again with names of files in UTF-8, also for the processes it starts.

    In an old locale `Tréwes 8h.csv` would be another name than the one in the list.
    """
    os.environ["PYTHONUTF8"] = "1"
    os.execv(sys.executable, [sys.executable, "-X", "utf8", *sys.orig_argv[1:]])  # noqa: S606


def _written_down(error: BaseException) -> str:
    """A sentence about an error that nobody foresaw, and where to read the rest."""
    import tempfile
    import traceback

    with tempfile.NamedTemporaryFile(
        "w", prefix="herijk-error-", suffix=".txt", encoding="utf-8", delete=False
    ) as file:
        file.write("".join(traceback.format_exception(error)))
    said = say(
        "{}. Nothing was published. Details are in {}; please send it to whoever maintains Herijk",
        unexpected(error),
        file.name,
    )
    return said.spoken(LANGUAGE.get())


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"herijk {version('herijk')}")
        raise typer.Exit


@app.callback()
def begin(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001 - its callback answers
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Recomputes the history of the Dutch rowing-sloop register from its tow tests."""
    context.default_map = defaults_of(context.command, folders_here(Path.cwd()))


def _seasons(value: str) -> range:
    match = re.fullmatch(r"(\d{4})(?::(\d{4}))?", value)
    if match is None or int(match[2] or match[1]) < int(match[1]):
        raise typer.BadParameter("write a season, 2014, or a range, 2009:2018")
    return range(int(match[1]), int(match[2] or match[1]) + 1)


Seasons = Annotated[
    range,
    typer.Option(parser=_seasons, metavar="A:B", help="Seasons, both ends included."),
]


@app.command()
def rebuild(
    archive: ArchiveFolder,
    data: DataFolder = Path("data"),
    method: Annotated[
        list[str] | None,
        typer.Option(
            metavar="METHOD_OR_FILE",
            help="Method to add to those of the data folder, or to renew; repeat for more. A file "
            "is kept there. Default: those that beheer.toml lists, or all that ship.",
        ),
    ] = None,
    seasons: Annotated[
        range | None,
        typer.Option(parser=_seasons, metavar="A:B", help="Read these seasons only."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """From the archive to registers and tables; only what changed is done again."""
    from assets.rebuild import rebuild as run
    from assets.report import failed_checks
    from assets.settings import applied
    from dashboards.report import headlines
    from herijk.cli.progress import log_shown
    from pipeline.messages import speaker
    from warehouse.queries import reports
    from warehouse.store.store import Store

    known = methods.known_methods(data)
    chosen = applied(data, [known.kept(name) for name in method or ()])
    with log_shown():
        news = run(archive, data, chosen, seasons)
    report = reports.rebuild_report(Store(data))
    if as_json:
        typer.echo(as_json_text({**vars(report), "done": news.done, "since": news}))
    else:
        lines = headlines(news, news.checks, speaker(LANGUAGE.get()))
        typer.echo(text.rebuild(report, news.done, lines))
    if failed := failed_checks(news.checks):
        raise BrokenPromiseError("a check failed: {}", "; ".join(failed))


@app.command()
def serve(
    archive: ArchiveFolder,
    data: DataFolder = Path("data"),
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=1, max=65534, help="Port of Dagster's page; the site has the next.")
    ] = 3000,
    may_start: Annotated[
        bool,
        typer.Option(help="Let Dagster's page start rebuilds and switch schedules."),
    ] = False,
) -> None:
    """Rebuild by itself: schedules and sensor, with Dagster's page and the site, until stopped."""
    from assets.instance import end_lost_runs, instance_of, prepare_home
    from assets.rebuild import check_apart
    from assets.settings import read_settings
    from herijk.cli.serving import Served, serve_until_stopped
    from warehouse.store.store import Store

    check_apart(archive, data)
    read_settings(data)
    store = Store(data)
    with machine_faults_explained(data):
        with instance_of(store) as instance:
            end_lost_runs(instance, {})
        served = Served(archive, data, host, port, may_start)
        serve_until_stopped(served, prepare_home(store), lambda line: typer.echo(line, err=True))


@app.command()
def rebase(
    method: Annotated[
        str, typer.Argument(metavar="METHOD_OR_FILE", help="A method's name, or a TOML file.")
    ],
    data: DataFolder = Path("data"),
    against: Annotated[
        str,
        typer.Option(metavar="EDITION", help="Edition, method or file it is compared with."),
    ] = "as-published",
    as_json: AsJson = False,
) -> None:
    """All of history under a method: what changes and why. Nothing is published or stored."""
    from pipeline.register.register import draft_name
    from warehouse.queries.rebase import rebase as rebase_history
    from warehouse.store.editions import edition_names, method_of_edition
    from warehouse.store.store import Store

    store, known = Store(data), methods.known_methods(data)
    if against in edition_names(store):
        old = method_of_edition(store, against)
    else:
        old = known.named(against.removeprefix(draft_name("")))
    report = rebase_history(store, known.named(method.removeprefix(draft_name(""))), old)
    show(report, text.rebase, as_json)


@app.command()
def audit(
    names: Annotated[
        list[str],
        typer.Argument(
            metavar="BOAT|TYPE [TYPE]",
            help='A boat by number or name, FSN211 or "Razende Snol", or one or two types.',
        ),
    ],
    data: DataFolder = Path("data"),
    method: Annotated[str | None, typer.Option(help="Show this method only.")] = None,
    tows: Annotated[
        str,
        typer.Option(
            metavar="all|newest|SEASON|A:B", help="Which tows a type's statistics rest on."
        ),
    ] = "newest",
    plots: Annotated[
        Path | None,
        typer.Option(help="Folder for the plots. Default: audit/NAME in --data.", metavar="DIR"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Where a boat's numbers come from, step by step; or whether boats of a type are equal."""
    from herijk.cli import audit_text
    from warehouse.queries.audit import audit as audit_report
    from warehouse.store.store import Store

    if len(names) > MOST_TYPES:
        raise typer.BadParameter("give a boat, or one or two types; quote a name with blanks")
    if method is not None:
        methods.known_methods(data).text(method)
    store = Store(data)
    report = audit_report(store, names, method, tows)
    if not as_json:
        typer.echo(audit_text.audit(report))  # the plots take longer than the text
    drawn = _plots(store, report, plots, " ".join(names))
    if as_json:
        typer.echo(as_json_text({**vars(report), "plots": drawn}))
    elif drawn:
        typer.echo("\n" + tell("{} plots in {}", len(drawn), drawn[0].parent))


@app.command()
def slides(
    data: DataFolder = Path("data"),
    out: Annotated[
        Path | None, typer.Option(help="Folder for them. Default: slides in --data.", metavar="DIR")
    ] = None,
    boat_type: Annotated[
        list[str] | None,
        typer.Option("--type", help="Type of boat; repeat for two together."),
    ] = None,
    tows: Annotated[
        str, typer.Option(metavar="all|newest|SEASON|A:B", help="Which tows are drawn.")
    ] = "all",
    boat: Annotated[
        list[str] | None,
        typer.Option(help="Boat through the years, by number or name; repeat for more."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Every chart of the 2015 presentation over this archive, as SVG and PNG and in one PDF."""
    from dashboards.slide_book import Asked
    from dashboards.slides import write_slides
    from warehouse.store.store import Store
    from warehouse.store.unforeseen import documents

    if len(boat_type or ()) > MOST_TYPES:
        raise typer.BadParameter("give one or two types")
    store = Store(data)
    asked = Asked(boat_type or (), tows, boat or ())
    with documents(store.root, "slides") as border:
        written = write_slides(store, out or store.root / "slides", LANGUAGE.get(), asked, border)
        show_files(written, as_json)


def _plots(
    store: "Store", report: "BoatAudit | TypesAudit", asked: Path | None, name: str
) -> list[Path]:
    """The plots of an audit; none, and said so, where they cannot be written: the page stands."""
    from dashboards.audit_plots import file_name, write_audit_plots

    folder = asked or store.root / "audit" / file_name(name)
    try:
        return write_audit_plots(store, report, folder, LANGUAGE.get())
    except OSError as error:
        said = tell(
            "no plots, for {} cannot be written ({}); give another folder with --plots",
            folder,
            error.strerror,
        )
        typer.echo(f"herijk: {said}", err=True)
        return []


@app.command()
def workbench(
    data: DataFolder = Path("data"),
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port on this machine; 0 for any that is free.")
    ] = 8765,
) -> None:
    """Change a method's options in a browser and see at once what happens to all boats."""
    from dashboards.guard import listen
    from dashboards.workbench.bench import Bench
    from dashboards.workbench.server import LOOPBACK, address, serving
    from warehouse.queries.history import History
    from warehouse.store.store import Store

    listening, store = listen(LOOPBACK, port), Store(data)
    bench = Bench(store, History.of(store))
    typer.echo(
        tell("The workbench is at {} (on this machine only); Ctrl-C stops it.", address(listening))
    )
    with suppress(KeyboardInterrupt):
        serving(bench).run(sockets=[listening])


@app.command("log-error")
def log_error(
    data: DataFolder = Path("data"),
    method: Annotated[str, typer.Option(help="Method whose factors are shown.")] = "rebased",
    as_json: AsJson = False,
) -> None:
    """How wrong the speed log was in each season, with its uncertainty and what it rests on."""
    from warehouse.queries import reports
    from warehouse.store.store import Store

    methods.known_methods(data).text(method)
    show(reports.log_error_report(Store(data), method), text.log_error, as_json)


@app.command()
def simulate(
    directory: Annotated[Path | None, typer.Argument(metavar="DIR", help="Folder to make.")] = None,
    seasons: Seasons = "2009:2018",  # type: ignore[assignment]
    tows_per_season: Annotated[int, typer.Option(min=1, max=1000, help="Tows in each.")] = 24,
    rate: Annotated[int, typer.Option(min=5, max=1000, help="Samples per second.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Decides all that is drawn.")] = 1,
    world: Annotated[str, typer.Option(help="What is wrong in it; see --worlds.")] = "history",
    worlds: Annotated[bool, typer.Option("--worlds", help="List the worlds, and stop.")] = False,
    as_json: AsJson = False,
) -> None:
    """Write a simulated archive with known truth (the truth lies beside it, not in it)."""
    from herijk.cli.progress import tows_counted
    from herijk.simulate import WORLDS, simulate_world, world_settings
    from herijk.simulate.archive_writer import write_simulated_archive

    if worlds:
        typer.echo("\n".join(f"{name:18s}{tell(named.about)}" for name, named in WORLDS.items()))
        return
    if directory is None:
        raise typer.BadParameter("name the folder to make", param_hint="DIR")
    settings = world_settings(
        world, seasons=tuple(seasons), tows_per_season=tows_per_season, rate_hz=rate, seed=seed
    )
    with machine_faults_explained(directory), tows_counted() as counted:
        truth = write_simulated_archive(directory, simulate_world(settings), counted)
    made = {"archive": str(directory), "truth": str(truth)}
    show(made, lambda m: tell("Simulated archive: {archive}\nIts truth: {truth}", **m), as_json)


@app.command()
def schema(
    command: Annotated[
        list[str] | None, typer.Argument(metavar="[COMMAND]", help="A command, such as: due.")
    ] = None,
) -> None:
    """What --json of a command prints, as JSON Schema; without a command, of which there is one."""
    import json

    from herijk.cli.json_schemas import schema_of, schemas

    if not command:
        typer.echo("\n".join(schemas()))
        return
    name = " ".join(command)
    if name not in schemas():
        raise typer.BadParameter(
            say("{!r} has no --json; these have: {}", name, ", ".join(schemas()))
        )
    typer.echo(json.dumps(schema_of(name), indent=1, ensure_ascii=False))
