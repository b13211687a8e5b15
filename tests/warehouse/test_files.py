"""A folder takes the place of another, whole or not at all."""

import pytest

from warehouse.store.files import folder_written_beside


def write(target, text, error=None):
    with folder_written_beside(target) as beside:
        (beside / "page.html").write_text(text, encoding="utf-8")
        if error:
            raise error


def test_a_folder_is_replaced_whole_and_after_an_error_the_older_one_is_there(tmp_path):
    target = tmp_path / "site"
    write(target, "old")
    with pytest.raises(OSError, match="full"):
        write(target, "half", OSError("full"))
    assert (target / "page.html").read_text("utf-8") == "old"
    write(target, "new")
    assert (target / "page.html").read_text("utf-8") == "new"
    assert list(tmp_path.iterdir()) == [target]
