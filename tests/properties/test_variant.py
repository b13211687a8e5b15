"""Whatever is changed at the controls, the saved file reads back as the scenario."""

import tomllib

from hypothesis import given
from hypothesis import strategies as st

from dashboards.workbench.form import CONTROLS as OF_MODEL
from pipeline.method.definition import SeasonSteps
from pipeline.method.options import Steps
from pipeline.method.reading import list_shipped_methods, parse_method, read_shipped_method
from pipeline.method.variant import cut_at, list_differences, variant, write_variant_text

SEASONS = range(2008, 2020)
CONTROLS = [(one.step, one) for one in OF_MODEL.values()]


def values(control):
    """Values that a control can give."""
    if control.kind == "choice":
        return st.sampled_from(control.values)
    if control.kind == "several":
        return st.lists(st.sampled_from(control.values), unique=True)
    number = st.integers if isinstance(control.most, int) else st.floats
    return number(control.least, control.most)


changes = st.sampled_from(CONTROLS).flatmap(
    lambda held: st.tuples(
        st.just((held[0], held[1].option)),
        values(held[1]),
        st.sets(st.sampled_from(SEASONS), max_size=12),
    )
)


@st.composite
def variants(draw):
    """A shipped method with some options changed, each in some of its ranges, or in all."""
    base = read_shipped_method(draw(st.sampled_from(list_shipped_methods())))
    ranges = cut_at(base, SEASONS)
    steps = [held.steps.model_dump() for held in ranges]
    for (step, option), value, seasons in draw(st.lists(changes, max_size=6)):
        for held, options in zip(ranges, steps, strict=True):
            if not seasons or held.first in seasons:
                options[step] = options[step] | {option: value}
    changed = [
        SeasonSteps(first=held.first, last=held.last, steps=Steps.model_validate(options))
        for held, options in zip(ranges, steps, strict=True)
    ]
    text = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
    return base, variant(base, "own", draw(text), draw(text), changed)


@given(variants())
def test_a_file_reads_back_as_the_method_that_was_written(made):
    _, method = made
    read = parse_method(write_variant_text(method), "own.toml")
    assert read == method


@given(variants())
def test_a_file_names_only_what_differs(made):
    base, method = made
    text = tomllib.loads(write_variant_text(method))
    assert text["extends"] == base.name
    named = {(step, option) for step, held in text.get("steps", {}).items() for option in held}
    for block in text.get("overrides", []):
        steps = {key: held for key, held in block.items() if key != "range"}
        named |= {(step, option) for step, held in steps.items() for option in held}
    found = list_differences(method, base)
    assert named == {(one.step, one.option) for one in found}
    for one in found:
        changed = getattr(getattr(method.get_steps(one.first), one.step), one.option)
        assert changed == one.after
        assert one.after not in one.before
