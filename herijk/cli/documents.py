"""The commands that make documents for paper: certificates, and a proposal to vote on."""

from pathlib import Path
from typing import Annotated

import typer

from herijk.cli.arguments import AsJson, AsOf, DataFolder, show_files
from pipeline.messages import LANGUAGE, tell


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the command line."""
    for command in (certificate, proposal, pages):
        app.command()(command)


def certificate(
    boat: Annotated[
        str | None,
        typer.Argument(metavar="[BOAT]", help="By number or name; all of the edition without."),
    ] = None,
    data: DataFolder = Path("data"),
    edition: Annotated[
        str | None, typer.Option(metavar="EDITION", help="Edition; the newest when left out.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File to write: a PDF, or .html for a page.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """The certificate of a boat, a page per crew; or of all boats of an edition in one file."""
    from dashboards.documents.certificate import certificates
    from warehouse.queries.answers import current_edition
    from warehouse.queries.views import Views
    from warehouse.store.boats import the_boat
    from warehouse.store.store import Store
    from warehouse.store.unforeseen import documents

    store = Store(data)
    with documents(store.root, "certificate") as border, Views(store) as views:
        chosen = edition or current_edition(views)
        fsn_no = boat and the_boat(views.table("boats"), boat)
        as_page = out is not None and out.suffix == ".html"
        made = certificates(views, chosen, fsn_no, LANGUAGE.get(), as_page, border)
        name = "-".join(filter(None, ("certificate", chosen, fsn_no)))
        _write(made, out or store.root / "documents" / f"{name}.pdf", as_json)


def pages(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for them, new or of pages.")],
    data: DataFolder = Path("data"),
    as_of: AsOf = None,
) -> None:
    """All pages of the site in a folder of their own, for instance as of an earlier day."""
    from dashboards.site.render import OWN_FILES, build_pages
    from pipeline.errors import MissingKnowledgeError
    from warehouse.store.store import Store
    from warehouse.store.unforeseen import documents

    if out.exists() and not (out / "static" / OWN_FILES[0]).is_file():
        raise MissingKnowledgeError("{} is there and holds no pages; give a new folder", out)
    store = Store(data)
    with documents(store.root, "pages") as border:
        made = build_pages(store, out, as_of, bordered=border)
        typer.echo(tell("{} files in {}; begin with index.html", made["files"], out))


def proposal(
    methods: Annotated[
        list[str],
        typer.Argument(metavar="METHOD...", help="Method proposed; several make a ballot."),
    ],
    data: DataFolder = Path("data"),
    against: Annotated[
        str, typer.Option(metavar="EDITION", help="Edition that counts now, or a draft.")
    ] = "concept-as-published",
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="File to write, a PDF.")] = None,
    as_json: AsJson = False,
) -> None:
    """What a board sends its members before they vote: what changes, for whom, how uncertain."""
    from dashboards.documents.proposal import proposal as make_proposal
    from herijk.cli.methods import known_methods
    from warehouse.queries.views import Views
    from warehouse.store.store import Store
    from warehouse.store.unforeseen import documents

    store, name = Store(data), "-".join(("proposal", *methods))
    with documents(store.root, name), Views(store) as views:
        made = make_proposal(views, methods, against, LANGUAGE.get(), known_methods(data))
        _write(made, out or store.root / "documents" / f"{name}.pdf", as_json)


def _write(content: bytes | None, path: Path, as_json: bool) -> None:
    """Writes the file whole, and says where; nothing where nothing could be made."""
    if content is None:
        return
    from warehouse.store.files import written_beside
    from warehouse.store.machine_faults import machine_faults_explained

    with machine_faults_explained(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
        with written_beside(path) as beside:
            beside.write_bytes(content)
    show_files([path], as_json)
