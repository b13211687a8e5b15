"""Reading `archief.toml`, and saying what is wrong in it."""

from functools import reduce
from pathlib import Path

from pydantic import ValidationError

from pipeline.errors import DefectiveInputError, MissingKnowledgeError
from pipeline.messages import Sentence, say
from pipeline.toml_text import decoded, parse_toml, problem_in_words
from warehouse.archive.files.finding import path_inside
from warehouse.archive.files.names import PROFILE_FILE
from warehouse.archive.profile.definition import Profiles


def read_profiles(root: Path) -> Profiles:
    """Reads `archief.toml` of an archive; defaults when it is absent.

    Raises:
        MissingKnowledgeError: the file cannot be understood; it names the file and the key.
    """
    try:
        path = _profile_path(root)
        return parse_profiles("" if path is None else decoded(path.read_bytes()))
    except DefectiveInputError as error:
        raise MissingKnowledgeError(error.message) from error
    except ValueError as error:
        raise MissingKnowledgeError("{} is not valid TOML: {}", PROFILE_FILE, error) from error


def parse_profiles(text: str) -> Profiles:
    """Reads the text of an `archief.toml`.

    Raises:
        MissingKnowledgeError: it cannot be understood; the message names the key.
    """
    try:
        return Profiles.model_validate(parse_toml(text))
    except ValidationError as error:
        raise MissingKnowledgeError("{}: {}", PROFILE_FILE, _explain(error)) from error
    except ValueError as error:
        raise MissingKnowledgeError("{} is not valid TOML: {}", PROFILE_FILE, error) from error


def _profile_path(root: Path) -> Path | None:
    """The profile, however its name is capitalised; None when there is none.

    Raises:
        MissingKnowledgeError: there are two, or it is a folder, a pipe or a link to nothing.
    """
    if not root.is_dir():
        return None
    names = sorted(p.name for p in root.iterdir() if p.name.casefold() == PROFILE_FILE)
    if len(names) > 1:
        raise MissingKnowledgeError("{} both are in {}; keep one", " and ".join(names), root)
    if not names:
        return None
    path = path_inside(root, names[0])
    if not path.is_file():
        raise MissingKnowledgeError("{} is no file; remove it, or put the file there", path)
    return path


def _explain(error: ValidationError) -> Sentence:
    """One clause per problem, each with its key."""
    clauses = [
        say(
            "{}: {}", f"'{'.'.join(map(str, problem['loc'])) or 'file'}'", problem_in_words(problem)
        )
        for problem in error.errors(include_input=False)
    ]
    return reduce(lambda said, clause: say("{}; {}", said, clause), clauses)
