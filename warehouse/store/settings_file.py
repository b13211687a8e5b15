"""Files of settings in the data folder: TOML, written by whoever runs Herijk, read into a model."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from pipeline.errors import MissingKnowledgeError
from pipeline.toml_text import decode_toml, describe_problem, parse_toml

Model = TypeVar("Model", bound=BaseModel)


def read_settings_file(path: Path, model: type[Model], may_hold: str) -> Model:
    """Read the settings in a file; the model's defaults where there is no file.

    Args:
        path: the file.
        model: what it can say. Where it hides its input in errors, as a value could be a password,
            no message repeats one.
        may_hold: what the file can say in words, for anyone who made a mistake.

    Raises:
        MissingKnowledgeError: the file cannot be understood.
    """
    if not path.exists():
        return model()
    try:
        return model.model_validate(parse_toml(decode_toml(path.read_bytes())))
    except ValidationError as error:
        shown = not model.model_config.get("hide_input_in_errors")
        first = error.errors(include_input=shown)[0]
        where = f"'{'.'.join(map(str, first['loc']))}'"
        raise MissingKnowledgeError(
            "{}: {}: {}; it may hold {}", path, where, describe_problem(first), may_hold
        ) from error
    except ValueError as error:  # also numbers too large, tables too deep
        raise MissingKnowledgeError("{}: not valid TOML: {}", path, error) from error
