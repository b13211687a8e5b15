"""A small part of the fuzz suite, and that it would notice; the whole is `make fuzz`."""

from benchmarks.robustness import fuzz


def test_damaged_files_are_refused_or_read_as_they_stand():
    found = fuzz.fuzz(210, seed=2, tell=lambda line: None)
    assert found.failures == []
    assert sum(found.outcomes.values()) == 210
    assert found.outcomes["samples.csv: refused"] > 0
    assert found.outcomes["samples.csv: accepted"] > 0


def test_a_reader_that_guesses_is_noticed(monkeypatch):
    original = fuzz.read_samples

    def guessing(*arguments, **options):
        samples, line_of = original(*arguments, **options)
        return samples.with_columns(samples["log1_m_s"] * 1.001), line_of

    monkeypatch.setattr(fuzz, "read_samples", guessing)
    assert fuzz.fuzz(70, seed=2, tell=lambda line: None).failures != []
