"""`herijk export`: pages of the site, certificates, and a proposal to vote on."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING

import click

from herijk.cli.options import PATH, Day, as_of_option, data_option, json_option, show_files
from herijk.cli.speaking import Group, argument, option
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from warehouse.store.store import Store

out_option = option("--out", type=PATH, help="PDF to write, or a folder for it.")


@click.group(cls=Group)
def export() -> None:
    """Pages of the site, certificates or a proposal as files."""


@export.command()
@argument(
    "boat", required=False, help="A boat by number or name; without it all boats of the edition."
)
@data_option
@option("--edition", help="Edition. Default: the newest.")
@option(
    "--as-of",
    type=Day(),
    help="Say whether it is valid on this day. Default: the day on which the register judged.",
)
@out_option
@json_option
def certificate(
    boat: str | None,
    store: "Store",
    edition: str | None,
    as_of: dt.date | None,
    out: Path | None,
) -> None:
    """The certificate of a boat, a page per crew; or of all boats of an edition in one file."""
    from assets.settings import read_settings
    from dashboards.documents.certificate import Issued, certificates
    from warehouse.queries.answers import current_edition
    from warehouse.queries.views import Views
    from warehouse.store.boats import choose_boat
    from warehouse.store.unforeseen import documents

    with documents(store.root, "certificate") as border, Views(store) as views:
        chosen = edition or current_edition(views)
        fsn_no = boat and choose_boat(views.table("boats"), boat)
        settings = read_settings(store.root)
        issued = Issued(day=as_of, issuer=settings.issuer, site=settings.site)
        made = certificates(views, chosen, fsn_no, LANGUAGE.get(), issued, border)
        _write(store, made, "-".join(filter(None, ("certificate", chosen, fsn_no))), out)


@export.command()
@option("--out", type=PATH, required=True, help="Folder for them, new or of pages.")
@data_option
@as_of_option
def pages(out: Path, store: "Store", as_of: dt.date | None) -> None:
    """All pages of the site in a folder of their own, for instance as of an earlier day."""
    from dashboards.site.render import OWN_FILES, build_pages
    from warehouse.store.unforeseen import documents

    is_new = not out.exists() or (out.is_dir() and not any(out.iterdir()))
    if not is_new and not (out / "static" / OWN_FILES[0]).is_file():
        raise MissingKnowledgeError("{} is there and holds no pages; give a new folder", out)
    with documents(store.root, "pages") as border:
        made = build_pages(store, out, as_of, bordered=border)
        click.echo(tell("{} files in {}; begin with index.html", made["files"], out))


@export.command()
@argument("methods", nargs=-1, required=True, help="Method proposed; several make a ballot.")
@data_option
@option("--against", default="concept-as-published", help="Edition that counts now, or a draft.")
@option("--sender", default="", help="Who sends it.")
@option("--date", type=Day(), help="Day of the letter.")
@option("--valid-from", type=Day(), help="First day on which the register would count.")
@out_option
@json_option
def proposal(
    methods: tuple[str, ...],
    store: "Store",
    against: str,
    sender: str,
    date: dt.date | None,
    valid_from: dt.date | None,
    out: Path | None,
) -> None:
    """What a board sends its members before they vote: what changes, for whom, how uncertain."""
    from dashboards.documents import proposal as letters
    from warehouse.queries.views import Views
    from warehouse.store.methods import KnownMethods
    from warehouse.store.unforeseen import documents

    name, letter = "-".join(("proposal", *methods)), letters.Letter(sender, date, valid_from)
    with documents(store.root, name), Views(store) as views:
        known = KnownMethods.of(store)
        made = letters.proposal(views, methods, against, LANGUAGE.get(), known, letter)
        _write(store, made, name, out)


def _write(store: "Store", content: bytes | None, name: str, out: Path | None) -> None:
    """Write the file whole, and print where; do nothing where nothing could be made.

    Args:
        store: the data folder, which has the file where `out` is not given.
        content: the document; None where it could not be made.
        name: usual name of the document, without suffix.
        out: the file, which ends in `.pdf`, or a folder.
    """
    if content is None:
        return
    from warehouse.store.files import write_beside
    from warehouse.store.machine_faults import explain_machine_faults

    usual = f"{name}.pdf"
    path = out or store.root / "documents" / usual
    if path.is_dir() or path.suffix.lower() != ".pdf":
        path /= usual
    with explain_machine_faults(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
        with write_beside(path) as beside:
            beside.write_bytes(content)
    show_files([path])
