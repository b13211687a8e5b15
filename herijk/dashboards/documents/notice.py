"""The notice of an edition to the members, for paper."""

from herijk.dashboards.documents import pdf
from herijk.dashboards.markdown import to_blocks


def notice(text: str, language: str) -> bytes:
    """A notice, written in Markdown, as PDF."""
    blocks = to_blocks(text)
    title = "".join(run["text"] for run in blocks[0]["runs"])
    content = {"title": title, "language": language, "simulated": "", "blocks": blocks}
    return pdf("notice.typ", content)
