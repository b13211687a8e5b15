"""Which texts the program says, and their Dutch: `make texts` brings the catalogue up to date.

A text is marked by the call that says it, in Python and in templates. Of what the help of commands
and the declarations of tables say, these themselves are asked.
"""

import ast
import io
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from string import Formatter

import jinja2
from babel.messages.catalog import Catalog, Message
from babel.messages.pofile import read_po, write_po
from jinja2 import nodes

from herijk.cli.main import app
from pipeline import errors
from pipeline.messages import CATALOGUES, DOMAIN
from pipeline.tables.schemas import ABOUT, TABLES, summarize_table
from tests.architecture.repository import ROOT, modules

PO = Path(CATALOGUES) / "nl" / "LC_MESSAGES" / f"{DOMAIN}.po"
WHAT_TO_DO = f"Run `make texts`, and give what has none its Dutch in {PO.relative_to(ROOT)}."
MARKS = {
    *("say", "tell", "wrong", "fault", "headings", "NamedWorld"),
    *("MethodFileError", "ArchiveChangedError"),
    *(name for name in dir(errors) if name.endswith("Error")),
} - {"DefectiveInputError"}
OF_CLICK = (
    *("Usage:", "Options", "Commands", "Positional arguments", "Show this message and exit."),
    *("Error: {message}", "Try '{command} {option}' for help.", "Missing command."),
    *("Missing option", "Missing argument", "No such option {name!r}."),
    *("No such command {name!r}.", "env var: {var}", "default: {default}", "required"),
    *("Invalid value: {message}", "Invalid value for {param_hint}: {message}"),
    *("{value!r} is not a valid {number_type}.", "{value} is not in the range {range}."),
    ("Did you mean {possibility}?", "(Did you mean one of: {possibilities}?)"),
    ("Got unexpected extra argument ({args})", "Got unexpected extra arguments ({args})"),
    (
        "Option {name!r} requires an argument.",
        "Option {name!r} requires {nargs} arguments.",
    ),
    ("{value!r} is not {choice}.", "{value!r} is not one of {choices}."),
)
"""What the library of the command line says itself, which it looks up in our catalogue."""
IN_TEMPLATES = ("_", "say", "mark")
"""What marks a text in a template; besides, `pgettext` and `ngettext`."""
WIDTH = 100
CODE = re.compile("[a-z]+(_[a-z]+)+")

Text = tuple[str | tuple[str, str], str | None]
"""A text, or one about one and one about several; and its context."""


def in_python(source: str) -> Iterator[Text]:
    """The marked texts of a module."""
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call) or not node.args:
            continue
        name = getattr(node.func, "attr", None) or getattr(node.func, "id", "")
        if name == "headings":
            yield from ((text, None) for argument in node.args for text in written(argument))
        elif name in MARKS:
            yield from ((text, None) for text in written(node.args[0]))
        elif name in ("pgettext", "ngettext"):
            for first, second in zip(*map(written, node.args[:2]), strict=True):
                yield (second, first) if name == "pgettext" else ((first, second), None)


def written(node: ast.expr) -> Iterator[str]:
    """The texts that an expression can be, as far as they are written in it."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.IfExp):
        yield from written(node.body)
        yield from written(node.orelse)


def in_template(source: str) -> Iterator[Text]:
    """The marked texts of a template, as Jinja reads it."""
    for call in jinja2.Environment(autoescape=True).parse(source).find_all(nodes.Call):
        name = call.node.name if isinstance(call.node, nodes.Name) else ""
        if name in IN_TEMPLATES:
            yield from ((text, None) for text in written_in_template(call.args[0]))
        elif name in ("pgettext", "ngettext"):
            for first, second in zip(*map(written_in_template, call.args[:2]), strict=True):
                yield (second, first) if name == "pgettext" else ((first, second), None)


def written_in_template(node: nodes.Node) -> Iterator[str]:
    """The texts that an expression of a template can be, as far as they are written in it."""
    if isinstance(node, nodes.Const) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, nodes.CondExpr):
        yield from written_in_template(node.expr1)
        if node.expr2 is not None:
            yield from written_in_template(node.expr2)


def in_help(command) -> Iterator[Text]:
    """What a command says of itself, of its options and of the commands below it."""
    for described in (command, *command.params):
        text = getattr(described, "english", getattr(described, "help", ""))
        yield " ".join((text or "").split()), None
    for inner in getattr(command, "commands", {}).values():
        yield from in_help(inner)


def has_words(text: Text) -> bool:
    """Whether there is anything to translate: letters that are no code and not filled in."""
    parts = text[0] if isinstance(text[0], tuple) else text[:1]
    literals = [literal for part in parts for literal, *_ in Formatter().parse(part)]
    return any(map(str.isalpha, "".join(literals))) and not CODE.fullmatch(parts[0])


def said() -> Iterator[tuple[str, Text]]:
    """Every text that is said, with the file in which it is."""
    for file in modules():
        name = file.relative_to(ROOT).as_posix()
        yield from ((name, text) for text in in_python(file.read_text(encoding="utf-8")))
    for file in sorted((ROOT / "dashboards").rglob("*.j2")):
        name = file.relative_to(ROOT).as_posix()
        yield from ((name, text) for text in in_template(file.read_text(encoding="utf-8")))
    yield from (("herijk/cli", text) for text in in_help(app))
    yield from (("herijk/cli", (text, None)) for text in OF_CLICK)
    tables = (TABLES | ABOUT).values()
    yield from (("pipeline/tables", (summarize_table(table), None)) for table in tables)


def catalogue() -> Catalog:
    """The Dutch of all that is said, as far as it is known."""
    with PO.open("rb") as file:
        known = read_po(file, locale="nl", domain=DOMAIN)
    wanted = Catalog(creation_date=known.creation_date)
    for file, (text, context) in said():
        if has_words((text, context)):
            wanted.add(text, locations=[(file, 0)], context=context)
    known.update(wanted, no_fuzzy_matching=True)
    for message in known:
        message.flags.discard("python-format")  # per cent signs
    return known


def as_file(texts: Catalog) -> bytes:
    """The catalogue as it is kept."""
    file = io.BytesIO()
    write_po(file, texts, WIDTH, ignore_obsolete=True, sort_by_file=True, include_lineno=False)
    return file.getvalue()


def list_untranslated(texts: Iterable[Message]) -> list[str]:
    """The texts that have no Dutch yet, or of one about several not both forms."""
    bare = [m.id for m in texts if m.id and not (m.string and all(m.string))]
    return [text if isinstance(text, str) else text[0] for text in bare]


def main(arguments: list[str]) -> None:
    """Writes the catalogue and says what has no Dutch.

    With `--check` it writes nothing, and ends with 1 where either asks for work.
    """
    texts = catalogue()
    made, bare = as_file(texts), list_untranslated(texts)
    if "--check" not in arguments:
        PO.write_bytes(made)
        sys.stdout.writelines(f"Without Dutch in {PO.relative_to(ROOT)}: {text}\n" for text in bare)
    elif made != PO.read_bytes() or bare:
        sys.exit(f"The texts have changed. {WHAT_TO_DO}")


if __name__ == "__main__":
    main(sys.argv[1:])
