"""The image and the wheel hold what they need."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from itertools import chain

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

from tests.architecture.repository import ROOT, modules, read

SETTINGS = tomllib.loads(read("pyproject.toml"))
PROJECT = SETTINGS["project"]
IN_THE_WHEEL = SETTINGS["tool"]["hatch"]["build"]["targets"]["wheel"]


def test_the_image_copies_and_starts_what_is_there():
    text = read("Containerfile")
    copied = re.findall(r"^COPY (?!--from)(.+) \./", text, re.MULTILINE)
    sources = {source for line in copied for source in line.split()}
    assert all((ROOT / source).exists() for source in sources)
    let_in = {line[1:] for line in read(".dockerignore").splitlines() if line.startswith("!")}
    assert sources <= let_in
    to_build = {PROJECT["readme"], *PROJECT["license-files"], "pyproject.toml"}
    to_build |= {*IN_THE_WHEEL["packages"], *IN_THE_WHEEL["force-include"]}
    assert to_build <= sources
    assert re.findall(r'^ENTRYPOINT \["(.+)"\]', text, re.MULTILINE) == [*PROJECT["scripts"]]
    for python in re.findall(r"^FROM python:([\d.]+)", text, re.MULTILINE):
        assert python in SpecifierSet(PROJECT["requires-python"])
    named = re.search(r"# Of pyproject.toml: (\S+)", text)
    assert set(named[1].split(",")) <= set(PROJECT["optional-dependencies"])


BROUGHT = {"markupsafe": "jinja2", "pydantic-core": "pydantic", "pyyaml": "dagster"}
"""Packages that another always brings."""


def test_what_the_program_imports_is_installed_with_it():
    """Locks also hold what builds and tests, so an environment from them hides what is missing."""
    extras = [PROJECT["optional-dependencies"][name] for name in ("dask", "labview")]
    asked = [Requirement(line) for line in (*PROJECT["dependencies"], *chain(*extras))]
    required = {canonicalize_name(one.name) for one in asked}
    required |= {name for name, by in BROUGHT.items() if by in required}
    packages = packages_distributions()
    imported = {name.partition(".")[0] for file in modules() for name in find_imports(file)}
    others = imported - sys.stdlib_module_names - {*IN_THE_WHEEL["packages"]}
    assert {"polars", "dagster"} <= others
    missing = [
        name for name in others
        if required.isdisjoint(map(canonicalize_name, packages.get(name, [name])))
    ]  # fmt: skip
    assert missing == [], "add the package to `dependencies` in pyproject.toml"


def find_imports(file):
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module


def test_the_citation_names_the_version():
    assert f"\nversion: {PROJECT['version']}\n" in read("CITATION.cff")
