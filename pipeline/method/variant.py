"""A variant: a method made from another by changing options, and its text as a method file.

Here options of some seasons are replaced, the differences from the method it extends are found,
and a file is written that names only those. Reading a file is in `pipeline.method.definition`.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from pipeline.method.definition import Method, SeasonSteps, join_equal_ranges
from pipeline.method.options import Steps
from pipeline.method.reading import (
    MethodFileError,
    list_shipped_methods,
    parse_method,
    read_shipped_method,
)
from pipeline.method.writing import (
    covered,
    key_lines,
    range_text,
    step_lines,
    write_method_text,
    write_override_lines,
)


@dataclass(frozen=True)
class Difference:
    """An option that is not what it was, in neighbouring seasons.

    Attributes:
        step, option: names as in a method file.
        first, last: seasons, both included.
        before: the values it replaces, the oldest season's first.
        after: the value.
    """

    step: str
    option: str
    first: int
    last: int
    before: tuple[object, ...]
    after: object


def cut_at(method: Method, seasons: Iterable[int]) -> tuple[SeasonSteps, ...]:
    """Return the ranges of a method, cut before each of the given seasons that it covers."""
    whole_first, whole_last = method.ranges[0].first, method.ranges[-1].last
    cuts = {block.first for block in method.ranges}
    firsts = sorted(cuts | {s for s in seasons if whole_first < s <= whole_last})
    lasts = [*(first - 1 for first in firsts[1:]), whole_last]
    return tuple(
        SeasonSteps(first=first, last=last, steps=method.get_steps(first))
        for first, last in zip(firsts, lasts, strict=True)
    )


def variant(
    base: Method, name: str, title: str, description: str, ranges: Sequence[SeasonSteps]
) -> Method:
    """Return a method with the given steps; it extends its base, or what a base file extends.

    Args:
        base: where it comes from; its register rule is kept.
        name, title, description: of the new method.
        ranges: its steps, in order, over the seasons of `base`.

    Raises:
        MethodFileError: the ranges leave out a season of `base`, or have one twice.
    """
    seasons = [(block.first, block.last) for block in ranges]
    if seasons != [(block.first, block.last) for block in cut_at(base, (s[0] for s in seasons))]:
        raise MethodFileError("{}: the seasons {} are not those of {}", name, seasons, base.name)
    ships = base.name in list_shipped_methods() and base == read_shipped_method(base.name)
    return Method(
        name=name,
        title=title,
        title_en=title,
        description=description,
        description_en=description,
        extends=base.name if ships else base.extends,
        ranges=join_equal_ranges(ranges),
        validity=base.validity,
    )


def differences(method: Method, parent: Method) -> list[Difference]:
    """Return options in which a method differs from another that covers its seasons.

    Returns:
        By step and option in the order of `Steps`, then by season.
    """
    pieces = cut_at(method, (block.first for block in parent.ranges))
    changed: list[Difference] = []
    for step, option in _options():
        for block in pieces:
            old = getattr(getattr(parent.get_steps(block.first), step), option)
            new = getattr(getattr(block.steps, step), option)
            if old != new:
                one = Difference(step, option, block.first, block.last, (old,), new)
                changed[-1:] = _together(changed[-1:], one)
    return changed


def write_variant_text(method: Method) -> str:
    """Return the text of a method file that names only what differs from what it extends.

    A method that extends none is written out in full. Reading the text gives a method with the
    same content hash and register rule.

    Raises:
        MethodFileError: the method it extends says nothing about one of its seasons.
    """
    if method.extends is None:
        return write_method_text(method)
    head = key_lines(
        {
            "name": method.name,
            "title": method.title,
            "description": method.description,
            "extends": method.extends,
            "seasons": covered(method),
        }
    )
    parent = parse_method("\n".join(head), f"{method.name}.toml")
    changed: dict[str, dict[str, dict[str, object]]] = {}
    for one in differences(method, parent):
        steps = changed.setdefault(range_text(one.first, one.last), {})
        steps.setdefault(one.step, {})[one.option] = one.after
    everywhere = changed.pop(covered(method), {})
    blocks = [_register_lines(method, parent)]
    blocks.append(["[steps]", *step_lines(everywhere)] if everywhere else [])
    blocks += [write_override_lines(seasons, steps) for seasons, steps in changed.items()]
    return "\n\n".join("\n".join(block) for block in [head, *blocks] if block) + "\n"


def _register_lines(method: Method, parent: Method) -> list[str]:
    inherited = parent.validity.model_dump()
    own = {k: v for k, v in method.validity.model_dump().items() if v != inherited[k]}
    return ["[register]", *key_lines(own)] if own else []


def _options() -> Iterator[tuple[str, str]]:
    for step, field in Steps.model_fields.items():
        options = field.annotation
        assert options is not None  # noqa: S101 - every step of `Steps` is a model
        yield from ((step, option) for option in options.model_fields)


def _together(last: list[Difference], one: Difference) -> list[Difference]:
    """Join a difference to the one before it, where it goes on in the next season."""
    for block in last:
        here = (block.step, block.option, block.last + 1, block.after)
        if here == (one.step, one.option, one.first, one.after):
            before = block.before + tuple(v for v in one.before if v not in block.before)
            return [replace(block, last=one.last, before=before)]
    return [*last, one]
