"""What lies in an archive and is not read, and what is not there though it must be."""

from pathlib import Path

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import (
    list_files,
    list_misnamed,
    list_strangers,
)
from warehouse.archive.files.list_kinds import BOATS, TOWS
from warehouse.archive.files.names import (
    BOATS_FILE,
    PACKED,
)
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.spelling.text import fold


def missing_lists(root: Path, profiles: Profiles) -> list[Fault]:
    """What is not there of that without which nothing can be read.

    Raises:
        MissingKnowledgeError: there is no archive.
    """
    if not root.is_dir():
        raise MissingKnowledgeError(
            "There is no archive at {}: expected a folder with {}, sleeplijsten/ and "
            "meetdata_<jaar>/.",
            root,
            BOATS_FILE,
        )
    named = profiles.files
    lacking = []
    if not list_files(root, BOATS, named):
        lacking.append(
            (BOATS_FILE, say("there is no list of boats: {path} is expected.", path=BOATS_FILE))
        )
    if not list_files(root, TOWS, named):
        path = "sleeplijsten/sleeplijst_<jaar>.csv"
        lacking.append((path, say("there is no list of tows: {path} is expected.", path=path)))
    return [Fault(path, None, None, "missing_list", said) for path, said in lacking]


def strangers(root: Path, profiles: Profiles) -> list[Fault]:
    """What lies in the archive and is not read."""
    message = say("The name of '{name}' has letters that cannot be read; give it another name.")
    misnamed = [
        Fault(path, None, None, "unrecognised_file", say(message, name=path))
        for path in list_misnamed(root)
    ]
    return misnamed + [
        Fault(path, None, None, "unrecognised_file", _about_stranger(root, path))
        for path in list_strangers(root, profiles.files)
        if fold(path) not in profiles.ignore
    ]


def _about_stranger(root: Path, path: str) -> str:
    """The sentence about what is not read."""
    kind = Path(path)
    if kind.suffix.lower() in PACKED:
        return say("'{path}' is not read: it is packed. Unpack it in its folder.", path=path)
    return say(
        "'{path}' is not read: it has another name than the archive's files. Say what it is under "
        "[files] in archief.toml, or put it under ignore.",
        path=path,
        inside=_lists_inside(root, path),
    )


def _lists_inside(root: Path, path: str) -> list[str]:
    """The first files in a folder, each of which can be a list."""
    inner = sorted(file for file in (root / path).rglob("*") if not file.is_dir())
    return [file.relative_to(root).as_posix() for file in inner[:3]]
