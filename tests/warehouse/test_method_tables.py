"""What was found of the runs is used again as long as the runs are what they were."""

from herijk.pipeline.method.definition import shipped_method
from herijk.warehouse.build.graph import ARCHIVE, METHOD
from herijk.warehouse.build.method_tables import RUNS, run_cache
from tests.intake import bring_in
from tests.warehouse.edition_bench import DAY


class Runs:
    """Inputs of a step, of which only the fingerprint is asked."""

    def __init__(self, made_from):
        self.known = made_from

    def made_from(self, *names):
        assert names == RUNS
        return self.known


def test_what_was_found_lasts_as_long_as_the_runs_are_the_same():
    with run_cache(Runs("these")) as first, run_cache(Runs("these")) as again:
        assert again is first
    with run_cache(Runs("others")) as other:
        assert other is not first
    with run_cache(Runs("these")) as later:
        assert later is not first


def test_a_fault_in_a_list_of_races_leaves_the_curves_as_they_are(bench_of_editions):
    store, method = bench_of_editions.store, shipped_method("as-published")
    races = bench_of_editions.archive / "wedstrijden" / "grachtenrace_2014.csv"
    races.parent.mkdir(exist_ok=True)
    races.write_text("wedstrijd;datum\nGrachtenrace;gisteren\n")
    bring_in(store, bench_of_editions.archive)
    assert ARCHIVE.is_stale(store, ())
    ARCHIVE.make(store, (), today=DAY)
    assert store.read("quarantine")["path"].str.ends_with(races.name).any()
    assert not METHOD.is_stale(store, [method])
