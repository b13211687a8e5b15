"""A folder is put in place of another at once."""

import threading

from warehouse.store.files import put_in_place


def filled(folder, text):
    folder.mkdir()
    (folder / "page.html").write_text(text, encoding="utf-8")
    return folder


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
