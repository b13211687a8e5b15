"""The image and the wheel hold what they need."""

import re
import tomllib

from packaging.specifiers import SpecifierSet

from tests.architecture.repository import ROOT, read

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


def test_the_citation_names_the_version():
    assert f"\nversion: {PROJECT['version']}\n" in read("CITATION.cff")
