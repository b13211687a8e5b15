"""The command `herijk`: arguments in, results out. Messages go to stderr, results to stdout.

Exit status: 0 done (also with tows set aside: they are listed), 1 could not do it, 2 wrong
arguments, 130 stopped. What a command does is in `assets`, `warehouse` and `pipeline`.

A command imports what it needs when it runs: Polars, SciPy and Dagster take seconds
together, and `herijk --help` needs none of them.
"""

import os
import signal
import sys
from pathlib import Path
from typing import Final, NoReturn

import click
from click.shell_completion import get_completion_class

from herijk.cli.archive import check, init, simulate
from herijk.cli.audit import assess, audit
from herijk.cli.export import export
from herijk.cli.methods import compare, methods
from herijk.cli.registers import publish, register, seasons, verify
from herijk.cli.running import rebuild, serve, workbench
from herijk.cli.speaking import Command, Group, argument, option
from pipeline.errors import HerijkError, describe_unforeseen
from pipeline.messages import LANGUAGE, say, tell, write_in_language
from warehouse.store.machine_faults import REASSURANCE, explain_machine_faults

INTERRUPTED: Final = 130
"""The exit status after Ctrl-C or SIGTERM: 128 and the number of SIGINT."""

BLAS_THREADS: Final = "OPENBLAS_NUM_THREADS"
"""Read when NumPy is imported. Both processes of a rebuild work on small matrices: more threads in
each only wait for each other (5.4 s instead of 3.2 for the consistency of 1,020 tows)."""

ARROW_MEMORY: Final = "ARROW_DEFAULT_MEMORY_POOL"
"""Read when Arrow is imported. Its own pool keeps what a table took: 0.1 GB in a rebuild of 1,020
tows, and nothing is quicker for it."""


def _show_version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        click.echo(f"herijk {version('herijk')}")
        context.exit()


@click.group(cls=Group)
@option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_version,
    help="Print the version.",
)
def app() -> None:
    """Recomputes the history of the Dutch rowing-sloop register from its tow tests."""


@click.command(
    cls=Command,
    examples=("herijk completion bash >> ~/.bashrc", "herijk completion zsh >> ~/.zshrc"),
)
@argument("shell", type=click.Choice(("bash", "zsh", "fish")), help="Shell that completes.")
def completion(shell: str) -> None:
    """Print what makes a shell complete commands and options with the Tab key."""
    complete = get_completion_class(shell)
    assert complete is not None, "click knows these shells"  # noqa: S101 - the type is wider
    click.echo(complete(app, {}, "herijk", "_HERIJK_COMPLETE").source())


app.add_section(say("Begin"), init, check, rebuild, simulate)
app.add_section(say("Look"), assess, audit, register, seasons, workbench)
app.add_section(say("Change the method"), methods, compare)
app.add_section(say("Publish"), publish, verify, export)
app.add_section(say("Run it as a service"), serve, completion)


def main() -> None:
    """Run the command; an error that a user can act on becomes one sentence and status 1."""
    os.environ.setdefault(BLAS_THREADS, "1")
    os.environ.setdefault(ARROW_MEMORY, "system")
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # as Ctrl-C; it is what systemd sends
    try:
        with explain_machine_faults(Path(os.environ.get("HERIJK_DATA", "data"))):
            sys.exit(app.main(standalone_mode=False))
    except HerijkError as error:
        click.echo(f"herijk: {write_in_language(error, LANGUAGE.get())}", err=True)
        sys.exit(1)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except click.Abort:
        _exit_stopped()
    except SystemExit:
        raise
    except BaseException as error:  # a panic of a library in Rust is no Exception
        if _is_interrupt(error):
            _exit_stopped()
        click.echo(f"herijk: {_write_down(error)}", err=True)
        sys.exit(1)


def _is_interrupt(error: BaseException) -> bool:
    """Return whether an error is what a library makes of Ctrl-C or SIGTERM."""
    is_query = type(error) is RuntimeError and str(error) == "Query interrupted"  # by DuckDB
    return is_query or type(error).__name__ == "DagsterExecutionInterruptedError"


def _exit_stopped() -> NoReturn:
    said = tell("stopped as requested. {} Run it again to continue", REASSURANCE)
    click.echo(f"herijk: {said}", err=True)
    sys.exit(INTERRUPTED)


def _write_down(error: BaseException) -> str:
    """Return a sentence about an error that nobody foresaw, and where to read the rest."""
    import tempfile
    import traceback

    with tempfile.NamedTemporaryFile(
        "w", prefix="herijk-error-", suffix=".txt", encoding="utf-8", delete=False
    ) as file:
        file.write("".join(traceback.format_exception(error)))
    return tell(
        "{}. Nothing was published. Details are in {}; please send it to the maintainer of Herijk",
        describe_unforeseen(error),
        file.name,
    )
