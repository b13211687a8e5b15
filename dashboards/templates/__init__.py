"""The templates of all documents, compiled when the environment or the wheel is made."""

import tempfile
from functools import cache
from pathlib import Path
from typing import Final

import jinja2

FOLDER: Final = Path(__file__).parent
COMPILED: Final = FOLDER / "compiled"
"""Where every template is a Python module."""

SUFFIX: Final = ".j2"


def make_environment(loader: jinja2.BaseLoader) -> jinja2.Environment:
    """Return the environment of Jinja, which escapes values and rejects unknown names."""
    return jinja2.Environment(
        loader=loader,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )


def compile_templates() -> None:
    """Write every template as a Python module into `COMPILED`, unless all are there."""
    if is_compiled():
        return
    COMPILED.mkdir(exist_ok=True)
    environment = make_environment(jinja2.FileSystemLoader(FOLDER))
    with tempfile.TemporaryDirectory(dir=COMPILED) as beside:
        environment.compile_templates(
            beside,
            zip=None,
            filter_func=lambda name: name.endswith(SUFFIX),
            ignore_errors=False,
        )
        for module in Path(beside).iterdir():
            module.replace(COMPILED / module.name)  # whole, whoever reads it meanwhile


def is_compiled() -> bool:
    """Return whether every template has a module that is as new as its source."""
    for source in FOLDER.glob(f"*{SUFFIX}"):
        module = COMPILED / jinja2.ModuleLoader.get_module_filename(source.name)
        if not module.exists() or module.stat().st_mtime_ns < source.stat().st_mtime_ns:
            return False
    return True


@cache
def _get_environment() -> jinja2.Environment:
    if is_compiled():
        return make_environment(jinja2.ModuleLoader(COMPILED))
    return make_environment(jinja2.FileSystemLoader(FOLDER))


def get_template(name: str) -> jinja2.Template:
    """Return the template of a name."""
    return _get_environment().get_template(name)
