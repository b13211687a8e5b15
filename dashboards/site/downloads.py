"""The sheets of published editions, put beside the pages so that the site is complete by itself."""

from pathlib import Path
from typing import Final

from dashboards.documents import pdf
from dashboards.markdown import to_blocks
from warehouse.store.editions import CSV, NOTICE, NOTICE_EN, XLSX, edition_names, edition_path
from warehouse.store.store import Store

DOWNLOADS: Final = "downloads"
SHEETS: Final = (CSV, XLSX)
PAPERS: Final = {"bericht.pdf": (NOTICE, "nl"), "notice.pdf": (NOTICE_EN, "en")}
"""What is made for paper: of which text, in which language."""


def files_of(edition: str) -> list[tuple[str, str]]:
    """Path within the site and name of all there is to download of an edition."""
    return [(f"{DOWNLOADS}/{edition}/{f}", f"{edition} {f}") for f in (*SHEETS, *PAPERS)]


def copy_sheets(store: Store, folder: Path) -> None:
    """Copies the sheets of every edition to `downloads/<edition>/`, byte for byte, with papers."""
    for edition in edition_names(store):
        source, target = edition_path(store, edition), folder / DOWNLOADS / edition
        target.mkdir(parents=True)
        for name in SHEETS:
            (target / name).write_bytes((source / name).read_bytes())
        for name, (text, language) in PAPERS.items():
            (target / name).write_bytes(notice((source / text).read_text("utf-8"), language))


def notice(text: str, language: str) -> bytes:
    """A notice to the members, written in Markdown, as PDF."""
    blocks = to_blocks(text)
    title = "".join(run["text"] for run in blocks[0]["runs"])
    content = {"title": title, "language": language, "simulated": "", "blocks": blocks}
    return pdf("notice.typ", content)
