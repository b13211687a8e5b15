"""Every figure's Vega-Lite without data: pages load it once, and fill in what they draw."""

import copy
import json
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import polars as pl
from altair.utils.schemapi import debug_mode

from dashboards import drawn
from dashboards.figures import FIGURES, drop
from dashboards.html import as_json
from dashboards.kept import kept
from pipeline.messages import CATALOGUES, speaker
from warehouse.store.code import code_hash
from warehouse.store.store import fingerprint


@cache
def chart_specifications(language: str) -> dict[str, Any]:
    """Every figure's Vega-Lite in a language, without data."""

    def make() -> str:
        say = speaker(language)
        return as_json({name: specification(figure, say) for name, figure in FIGURES.items()})

    return _kept(f"charts-{language}", make)


@cache
def picture_specification(figure: str, language: str) -> dict[str, Any]:
    """A figure's Vega for a picture: without data, and without what a picture cannot keep."""

    def make() -> str:
        spec = copy.deepcopy(chart_specifications(language)[figure])
        drop(spec, "href", "tooltip")
        spec["config"]["aria"] = False  # described as a whole
        return json.dumps(drawn.compiled(spec))

    return _kept(f"picture-{figure}-{language}", make)


def _kept(name: str, make: Callable[[], str]) -> dict[str, Any]:
    """An object of an earlier process, if it was made by the same code."""
    return dict(json.loads(kept(name, _made_from(), make)))


@cache
def _made_from() -> str:
    versions = [version(name) for name in ("altair", "vl-convert-python")]
    texts = b"".join(file.read_bytes() for file in sorted(Path(CATALOGUES).rglob("*.mo")))
    return fingerprint(versions, sha256(texts).hexdigest(), code_hash("dashboards"))


def specification(figure: Callable[..., Any], say: Callable[[str], str]) -> dict[str, Any]:
    """A figure's Vega-Lite with the data left to the page: a dataset called `rows`."""
    # Validating takes as long as all else of a small site; the tests of figures do it.
    with debug_mode(False):
        spec: dict[str, Any] = figure(pl.DataFrame({"kind": ["x"]}), say).to_dict(validate=False)
    (placeholder,) = spec.pop("datasets")
    spec.pop("$schema")
    text = json.dumps(spec).replace(f'"{placeholder}"', '"rows"')
    return dict(json.loads(text))
