"""A variant: a method made from another by changing options, and its text as a method file.

Here options of some seasons are replaced, the differences from the method it extends are found,
and a file is written that names only those. Reading a file is in `pipeline.method.definition`.
"""

import itertools
from collections.abc import Iterable, Sequence
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
    key_lines,
    range_text,
    step_lines,
    write_covered_seasons,
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
    firsts = {block.first for block in method.ranges}
    firsts.update(season for season in seasons if whole_first < season <= whole_last)
    edges = sorted(firsts) + [whole_last + 1]
    pieces = []
    for first, after in itertools.pairwise(edges):
        piece = SeasonSteps(first=first, last=after - 1, steps=method.get_steps(first))
        pieces.append(piece)
    return tuple(pieces)


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
    cut = cut_at(base, [block.first for block in ranges])
    if seasons != [(block.first, block.last) for block in cut]:
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


def list_differences(method: Method, parent: Method) -> list[Difference]:
    """Return options in which a method differs from another that covers its seasons.

    Returns:
        By step and option in the order of `Steps`, then by season.
    """
    changed: list[Difference] = []
    pieces = cut_at(method, [block.first for block in parent.ranges])
    for step in Steps.model_fields:
        for option in type(getattr(pieces[0].steps, step)).model_fields:
            changed += _list_differences(step, option, pieces, parent)
    return changed


def _list_differences(
    step: str, option: str, pieces: Sequence[SeasonSteps], parent: Method
) -> list[Difference]:
    """Return where an option differs from the parent's; equal ones of adjoining seasons as one."""
    found: list[Difference] = []
    for block in pieces:
        old = getattr(getattr(parent.get_steps(block.first), step), option)
        new = getattr(getattr(block.steps, step), option)
        if old == new:
            continue
        last = found[-1] if found else None
        if last is not None and (last.last + 1, last.after) == (block.first, new):
            before = last.before if old in last.before else last.before + (old,)
            found[-1] = replace(last, last=block.last, before=before)
        else:
            one = Difference(
                step=step,
                option=option,
                first=block.first,
                last=block.last,
                before=(old,),
                after=new,
            )
            found.append(one)
    return found


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
            "seasons": write_covered_seasons(method),
        }
    )
    parent = parse_method("\n".join(head), f"{method.name}.toml")
    changed: dict[str, dict[str, dict[str, object]]] = {}
    for one in list_differences(method, parent):
        steps = changed.setdefault(range_text(one.first, one.last), {})
        steps.setdefault(one.step, {})[one.option] = one.after
    everywhere = changed.pop(write_covered_seasons(method), {})
    inherited = parent.validity.model_dump()
    rule = {k: v for k, v in method.validity.model_dump().items() if v != inherited[k]}
    blocks = [head]
    if rule:
        blocks.append(["[register]"] + key_lines(rule))
    if everywhere:
        blocks.append(["[steps]"] + step_lines(everywhere))
    blocks += [write_override_lines(seasons, steps) for seasons, steps in changed.items()]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"
