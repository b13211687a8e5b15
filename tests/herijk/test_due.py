"""What `herijk due` prints."""

import json


def test_due_groups_by_expiry_and_says_why_each_speed(herijk, built):
    call = ("due", "--method", "rebased-2015", "--data", built.data)
    status, out, err = herijk(*call)
    assert (status, err) == (0, "")
    report = json.loads(herijk(*call, "--json")[1])
    counts = {
        u: sum(line["urgency"] == u for line in report["lines"]) for u in ("expired", "later")
    }
    assert f"{len(report['lines'])} boats and crews: {counts['expired']} expired" in out
    for part in ("SIMULATED", "valid until", "tow at m/s", "70-90 W", "estimates no log error"):
        assert part in out
    for line in report["lines"]:
        assert line["fsn_no"] in out
    assert all(line["tow_speed_m_s"] > 0 for line in report["lines"] if line["power_w"])


def test_due_and_register_as_of_an_earlier_day(herijk, built):
    call = ("due", "--method", "rebased-2015", "--data", built.data, "--as-of", "2012-06-01")
    status, out, err = herijk(*call)
    assert (status, err) == (0, "")
    assert "Due list as of 2012-06-01; curves" in out
    report = json.loads(herijk(*call, "--json")[1])
    assert all(
        line["tow_date"] is None or line["tow_date"] <= "2012-06-01" for line in report["lines"]
    )
    edition = "concept-rebased-2015"
    call = ("register", edition, "--data", built.data, "--as-of", "2012-06-01")
    assert "validity judged on 2012-06-01" in herijk(*call)[1]
    lines = json.loads(herijk(*call, "--json")[1])["lines"]
    assert {line["tow_id"] for line in lines} == {line["tow_id"] for line in report["lines"]}
    status, out, err = herijk("register", "--data", built.data, "--as-of", "1995-01-01")
    assert (status, out) == (1, "")
    assert "no tow of 1995-01-01 or before" in err


def test_due_of_a_method_that_was_not_applied_says_what_to_do(herijk, built):
    status, out, err = herijk("due", "--data", built.data)
    assert (status, out) == (1, "")
    assert "herijk rebuild" in err
    assert herijk("due", "--method", "x", "--data", built.data)[0] == 1
