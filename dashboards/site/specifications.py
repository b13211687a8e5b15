"""Every figure's Vega-Lite without data: pages load it once, and fill in what they draw."""

import json
from collections.abc import Callable
from functools import cache
from typing import Any

import polars as pl
from altair.utils.schemapi import debug_mode

from dashboards import drawn
from dashboards.figures import FIGURES
from pipeline.messages import speaker


@cache
def chart_specifications(language: str) -> dict[str, Any]:
    """Every figure's Vega-Lite in a language, without data."""
    say = speaker(language)
    return {name: specification(figure, say) for name, figure in FIGURES.items()}


def specification(figure: Callable[..., Any], say: Callable[[str], str]) -> dict[str, Any]:
    """A figure's Vega-Lite with the data left to the page: a dataset called `rows`."""
    # Validating takes as long as all else of a small site; the tests of figures do it.
    with debug_mode(False):
        spec: dict[str, Any] = figure(pl.DataFrame({"kind": ["x"]}), say).to_dict(validate=False)
    (placeholder,) = spec.pop("datasets")
    spec.pop("$schema")
    text = json.dumps(spec | {"config": drawn.CONFIG}).replace(f'"{placeholder}"', '"rows"')
    return dict(json.loads(text))
