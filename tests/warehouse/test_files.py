"""A folder is put in place of another at once."""

import os
import threading
from pathlib import Path

from warehouse.store import files
from warehouse.store.files import put_in_place


def filled(folder, text):
    folder.mkdir()
    (folder / "page.html").write_text(text, encoding="utf-8")
    return folder


def test_a_first_folder_gets_its_name(tmp_path):
    put_in_place(filled(tmp_path / "beside", "new"), tmp_path / "site")
    assert (tmp_path / "site" / "page.html").read_text("utf-8") == "new"


def test_the_older_folder_is_beside_after(tmp_path):
    target = filled(tmp_path / "site", "old")
    put_in_place(filled(tmp_path / "beside", "new"), target)
    assert (target / "page.html").read_text("utf-8") == "new"
    assert (tmp_path / "beside" / "page.html").read_text("utf-8") == "old"


def test_a_reader_always_finds_a_whole_folder(tmp_path):
    target, beside = filled(tmp_path / "site", "0"), filled(tmp_path / "beside", "1")
    missed, reads, stop = [], [0], threading.Event()

    def read():
        while not stop.is_set():
            reads[0] += 1
            if not (target / "page.html").exists():
                missed.append(reads[0])

    reader = threading.Thread(target=read)
    reader.start()
    exchanges = 0
    while exchanges < 50 or reads[0] < 50:  # on a quick machine the reader has few turns
        put_in_place(beside, target)
        exchanges += 1
    stop.set()
    reader.join()
    assert missed == []


def test_all_is_written_where_folders_cannot_be_synced_nor_names_exchanged(tmp_path, monkeypatch):
    """As on Windows, where opening a folder is an error."""
    opened = os.open

    def open_no_folder(path, flags, *rest, **more):
        if Path(path).is_dir():
            raise PermissionError(path)
        return opened(path, flags, *rest, **more)

    monkeypatch.setattr(files, "WINDOWS", True)
    monkeypatch.setattr("os.open", open_no_folder)
    files.write_new(tmp_path / "new.txt", "text")
    with files.written_beside(tmp_path / "new.txt") as beside:
        beside.write_text("other")
    for text in ("first", "second"):
        files.put_in_place(filled(tmp_path / f"beside-{text}", text), tmp_path / "site")
    assert (tmp_path / "new.txt").read_text() == "other"
    assert (tmp_path / "site" / "page.html").read_text() == "second"
