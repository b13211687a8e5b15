"""Charts as Vega-Lite, and drawn without a browser in the font of the pages.

They are the same on every machine.
"""

import json
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, Final

import altair as alt
import polars as pl
import vl_convert
from altair.utils.schemapi import debug_mode

from dashboards import fonts
from dashboards.figures import FIGURES
from pipeline.messages import speaker

VEGA_LITE: Final = ".".join(alt.SCHEMA_VERSION.removeprefix("v").split(".")[:2])
"""The version of the charts."""

LOCALES: Final = {
    "nl": {"decimal": ",", "thousands": ".", "grouping": [3], "currency": ["€ ", ""]},
    "en": {"decimal": ".", "thousands": ",", "grouping": [3], "currency": ["€", ""]},
}
"""How numbers on axes are written."""

FONTS_OF_MACHINE: Final = "FONTCONFIG_FILE"
"""The variable that says where fontconfig learns which fonts there are; browsers use it, too."""


@contextmanager
def _only_our_fonts() -> Iterator[None]:
    """Hides the machine's fonts: one may be named like ours, and each is opened per chart."""
    before = os.environ.get(FONTS_OF_MACHINE)
    os.environ[FONTS_OF_MACHINE] = str(fonts.SETTINGS)
    try:
        yield
    finally:
        del os.environ[FONTS_OF_MACHINE]
        if before is not None:
            os.environ[FONTS_OF_MACHINE] = before


with _only_our_fonts():
    vl_convert.register_font_directory(str(fonts.FOLDER))


CONFIG: Final = {
    "font": fonts.FAMILY,
    "legend": {
        "orient": "top", "columns": 3, "offset": 26, "labelLimit": 0, "titleLimit": 0,
        "labelFontSize": 12, "titleFontSize": 12,
    },
    "axis": {"labelFontSize": 12, "titleFontSize": 12, "titleFontWeight": "normal"},
    "axisY": {"titleAngle": 0, "titleAlign": "left", "titleX": -30, "titleY": -8},
    "header": {"labelFontSize": 12, "titleFontSize": 12, "labelPadding": 24},
    "view": {"stroke": None},
}  # fmt: skip
"""What all charts look like: the title of an axis at the side lies above it."""


def specification(figure: str, language: str) -> dict[str, Any]:
    """A figure's Vega-Lite without data: it draws a dataset called `rows`."""
    return dict(json.loads(_specification(figure, language)))


@cache
def _specification(figure: str, language: str) -> str:
    # Validating takes as long as all else of a small site; the tests of figures do it.
    with debug_mode(False):
        empty = FIGURES[figure](pl.DataFrame({"kind": ["x"]}), speaker(language))
        spec: dict[str, Any] = empty.to_dict(validate=False)
    (placeholder,) = spec.pop("datasets")
    spec.pop("$schema")
    return json.dumps(spec | {"config": CONFIG}).replace(f'"{placeholder}"', '"rows"')


LIVE: Final = ("href", "tooltip")
"""What a picture cannot keep: a link that leads nowhere here would lead to vega.github.io."""


def svg(spec: dict[str, Any], rows: pl.DataFrame, language: str) -> str:
    """A chart of these rows as SVG, its numbers as people of a language write them."""
    still = json.loads(
        json.dumps(spec),
        object_hook=lambda part: {name: held for name, held in part.items() if name not in LIVE},
    )
    drawn = vl_convert.vegalite_to_svg(
        json.dumps(still | {"datasets": {"rows": rows.to_dicts()}}, default=str),
        vl_version=VEGA_LITE,
        format_locale=LOCALES[language],
    )
    # Names of clipping areas from 0: Vega counts on from one picture to the next.
    names = dict.fromkeys(re.findall(r'id="(clip\d+)"', drawn))
    places = {name: f"clip{place}" for place, name in enumerate(names)}
    return re.sub(r"\bclip\d+\b", lambda name: places[name[0]], drawn)
