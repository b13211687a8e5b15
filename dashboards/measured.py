"""What a tow test measures, as a picture: ship, boom and boat from above, and the six runs."""

from pathlib import Path
from typing import Final

from markupsafe import Markup

from dashboards.html import environment
from dashboards.speech import Speech
from pipeline.messages import pgettext, say

CAPTION: Final = say(
    "A tow test from above, and its six runs. Not to scale; where log and GPS hang is inferred."
)
TEMPLATES: Final = Path(__file__).parent / "site" / "templates"


def picture(speech: Speech) -> Markup:
    """The picture as SVG."""
    template = environment(TEMPLATES).get_template("measured.svg.j2")
    return Markup(template.render(_=speech.text, pgettext=pgettext, caption=CAPTION))  # noqa: S704 - escaped
