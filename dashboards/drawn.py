"""Charts drawn without a browser, with the font of the pages: the same on every machine."""

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import altair as alt
import vl_convert

from dashboards import fonts

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


def svg(spec: dict[str, object], language: str) -> str:
    """A chart as SVG, its numbers as people of a language write them."""
    return str(
        vl_convert.vegalite_to_svg(
            json.dumps(spec, default=str),
            vl_version=VEGA_LITE,
            config=CONFIG,
            format_locale=LOCALES[language],
        )
    )
