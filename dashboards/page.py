"""A document as a page: what all pages share, and where they lie."""

from collections.abc import Mapping
from typing import Any

from dashboards.document import Document
from dashboards.language import Language, get_other_language
from pipeline.messages import LANGUAGES


def list_folders(about: Mapping[str, str]) -> dict[str, str]:
    """Return where the pages of each language lie within the site: of the first, at its root."""
    first, *others = about.get("languages", " ".join(LANGUAGES)).split()
    return {first: ""} | {tag: f"{tag}/" for tag in others}


def render_page(
    path: str,
    template: str,
    data: Mapping[str, Any],
    language: str,
    about: Mapping[str, str],
    site: str = "",
    other_page: str = "",
) -> str:
    """Return a page in one language.

    Args:
        path: where it lies within the pages of its language.
        template: its name.
        data: what its query found.
        language: `nl` or `en`.
        about: what is known about the database.
        site: the way to the site, of a page that lies outside it.
        other_page: the same page in the other language, of a page that lies outside the site.
    """
    folders = list_folders(about)
    folder = folders.get(language, "")
    other = get_other_language(language)
    if other not in folders:
        other = ""
    root = site + folder if site else "../" * path.count("/")
    site_root = site or root + "../" * bool(folder)
    document = Document(Language(language, about), root, data.get("chosen"))
    frame = {
        "path": path,
        "site_root": site_root,
        "other": other,
        "other_page": other_page or f"{site_root}{folders.get(other, '')}{path}",
        "simulated": about.get("simulated") == "true",
        "code_version": about.get("code_version", ""),
    }
    return document.render(template, **data, **frame)
