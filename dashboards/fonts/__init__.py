"""The font of pages, charts and documents, so that all are laid out alike on every machine.

Open Sans, Apache License 2.0 (`LICENSE`), regular and bold, cut down to Latin, Greek and the signs
in use: as TTF for what draws without a browser, as WOFF2 for browsers.
"""

import base64
from functools import cache
from pathlib import Path
from typing import Final

FAMILY: Final = "Open Sans"
FOLDER: Final = Path(__file__).parent
SETTINGS: Final = FOLDER / "fonts.conf"
"""Tells fontconfig of this folder only."""
WEIGHTS: Final = {"Regular": 400, "Bold": 700}

_FACE: Final = (
    '@font-face {{ font-family: "{family}"; font-weight: {weight}; font-display: swap; '
    'src: url(data:font/woff2;base64,{data}) format("woff2"); }}\n'
)


@cache
def style_sheet() -> str:
    """Return a style sheet that brings the font along."""
    faces = []
    for name, weight in WEIGHTS.items():
        font = (FOLDER / f"OpenSans-{name}.woff2").read_bytes()
        data = base64.b64encode(font).decode("ascii")
        faces.append(_FACE.format(family=FAMILY, weight=weight, data=data))
    return "".join(faces)
