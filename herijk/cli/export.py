"""`herijk export`: pages of the site, certificates, inspection sheets, a proposal to vote on."""

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING

import click

from herijk.cli.options import PATH, Day, as_of_option, data_option, json_option, show_files
from herijk.cli.speaking import Group, argument, option
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from dashboards.queries.results import Data
    from warehouse.store.store import Store

out_option = option("--out", type=PATH, help="PDF to write, or a folder for it.")


@click.group(
    cls=Group, examples=("herijk export certificate FSN114", "herijk export proposal rebased")
)
def export() -> None:
    """Write pages of the site, certificates, inspection sheets or a proposal as files."""


@export.command(
    examples=(
        "herijk export certificate FSN114",
        "herijk export certificate --edition 2026-1 --out brieven.pdf",
    )
)
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
    """Write the certificate of a boat, a page per crew, or those of an edition in one file."""
    from assets.settings import read_settings
    from dashboards.queries.papers import read_certificates
    from dashboards.queries.results import Results
    from warehouse.queries.views import Views
    from warehouse.store.boats import choose_boat
    from warehouse.store.unforeseen import documents

    with documents(store.root, "certificate") as border, Views(store) as views:
        chosen = Results(views).choose_edition(edition)
        fsn_no = boat and choose_boat(views.table("boats"), boat)
        settings = read_settings(store.root)
        made = read_certificates(
            views,
            chosen,
            fsn_no,
            day=as_of,
            issuer=settings.issuer,
            site=settings.site,
            border=border,
        )
        name = "-".join(filter(None, ("certificate", chosen, fsn_no)))
        title = " ".join(filter(None, (tell("Certificate"), fsn_no, chosen)))
        _write(store, "certificate", made, name, title, out, views.simulated(chosen), views.about())


@export.command(
    examples=("herijk export inspection FSN114", "herijk export inspection --race Spiegelrace")
)
@argument("boat", required=False, help="A boat by number or name.")
@data_option
@option("--race", help="The boats that took part in a race, the last time that it was held.")
@out_option
@json_option
def inspection(boat: str | None, store: "Store", race: str | None, out: Path | None) -> None:
    """Write what was last measured of boats, to be checked on the day of a race.

    Without a boat or race: all boats with a valid line.
    """
    from dashboards.queries.inspections import choose_race, read_sheets
    from dashboards.queries.results import Results
    from warehouse.queries.views import Views
    from warehouse.store.boats import choose_boat
    from warehouse.store.unforeseen import documents

    if boat and race:
        raise click.UsageError(tell("give a boat or a race, not both"))
    with documents(store.root, "inspection"), Views(store) as views:
        results = Results(views)
        about: Data = {"race": None, "race_date": None, "key": None}
        boats = results.valid_boats
        fsn_no = boat and choose_boat(views.table("boats"), boat)
        if fsn_no:
            boats = {fsn_no}
        if race:
            about = choose_race(results, race)
            boats = about.pop("boats")
        if not boats:
            raise MissingKnowledgeError("no boat has a valid line; name a boat or a race")
        name = "-".join(filter(None, ("inspection", about["key"], fsn_no)))
        title = " ".join(filter(None, (tell("Inspection on the race day"), about["race"], fsn_no)))
        facts = views.about()
        made = read_sheets(results, boats) | about | {"code_version": facts.get("code_version", "")}
        simulated = facts.get("simulated") == "true"
        _write(store, "inspection", [made], name, title, out, simulated, facts)


@export.command(examples=("herijk export pages --out site-2015 --as-of 2015-06-01",))
@option("--out", type=PATH, required=True, help="Folder for them, new or of pages.")
@data_option
@as_of_option
def pages(out: Path, store: "Store", as_of: dt.date | None) -> None:
    """Write all pages of the site into a folder, for instance as of an earlier day."""
    from dashboards.site import build_site
    from warehouse.store.unforeseen import documents

    is_new = not out.exists() or (out.is_dir() and not any(out.iterdir()))
    if not is_new and not (out / "static" / "site.css").is_file():
        raise MissingKnowledgeError("{} is there and holds no pages; give a new folder", out)
    with documents(store.root, "pages") as border:
        made = build_site(store, out, as_of, bordered=border)
        click.echo(tell("{} files in {}; begin with index.html", made["files"], out))


@export.command(examples=("herijk export proposal rebased --against 2018-1",))
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
    """Write what a board sends its members before a vote: what changes, for whom, how uncertain."""
    from dashboards.queries.papers import read_proposal
    from warehouse.queries.views import Views
    from warehouse.store.methods import KnownMethods
    from warehouse.store.unforeseen import documents

    name = "-".join(("proposal", *methods))
    letter = {"sender": sender, "date": date, "valid_from": valid_from}
    with documents(store.root, name), Views(store) as views:
        known = KnownMethods.from_store(store)
        titles = {method: known.get(method).get_title(LANGUAGE.get()) for method in methods}
        made = read_proposal(views, methods, against, titles, letter)
        simulated = views.about().get("simulated") == "true"
        title = "; ".join(titles.values())
        _write(store, "proposal", [made], name, title, out, simulated, views.about())


def _write(
    store: "Store",
    template: str,
    pages: "list[Data]",
    name: str,
    title: str,
    out: Path | None,
    simulated: bool,
    about: dict[str, str],
) -> None:
    """Write a document whole, and print where; do nothing where nothing could be made.

    Args:
        store: the data folder, which has the file where `out` is not given.
        template: the name of the template.
        pages: what a query found, a page each.
        name: usual name of the file, without suffix.
        title: of the document.
        out: the file, which ends in `.pdf`, or a folder.
        simulated: whether its boats are.
        about: facts about the database.
    """
    if not pages:
        return
    from dashboards.paper import make_pdf
    from warehouse.store.files import write_beside
    from warehouse.store.machine_faults import explain_machine_faults

    made_by = pages[0].get("made_by") or pages[0].get("code_version", "")
    footing = f"{tell('Made by code')} {made_by}"
    content = make_pdf(
        template,
        pages,
        LANGUAGE.get(),
        title,
        simulated=simulated,
        footing=footing,
        about=about,
    )
    usual = f"{name}.pdf"
    path = out or store.root / "documents" / usual
    if path.is_dir() or path.suffix.lower() != ".pdf":
        path /= usual
    with explain_machine_faults(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
        with write_beside(path) as beside:
            beside.write_bytes(content)
    show_files([path])
