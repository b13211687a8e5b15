"""`herijk doctor` says what is in order and what is not."""

import json


def test_a_sound_folder_is_in_order(herijk, built):
    status, out, _ = herijk("doctor", "--data", built.data, "--archive", built.archive, "--json")
    assert status == 0
    found = {f["what"]: f["found"] for f in json.loads(out)["findings"]}
    assert found["tables"] == "40 tows in 2 seasons"


def test_what_is_wrong_is_said_and_the_rest_is_looked_at(herijk, tmp_path):
    (tmp_path / "beheer.toml").write_text("nightly = 3\n", encoding="utf-8")
    (tmp_path / "methods").mkdir()
    (tmp_path / "methods" / "ours.toml").write_text('name = "theirs"\n', encoding="utf-8")
    status, out, _ = herijk("doctor", "--data", tmp_path, "--archive", tmp_path / "none")
    assert status == 1
    wrong = [line.split(":")[0] for line in out.splitlines() if line.startswith("WRONG")]
    assert wrong == ["WRONG  settings", "WRONG  method ours", "WRONG  tables", "WRONG  archive"]
