"""What was found of the runs is used again as long as the runs are what they were."""

from pipeline.method.definition import shipped_method
from tests.intake import bring_in
from tests.warehouse.edition_bench import DAY
from warehouse.derive.graph import ARCHIVE, METHOD
from warehouse.derive.inputs import Scope, argument


def test_what_was_found_lasts_as_long_as_the_runs_are_the_same(bench_of_editions):
    scope = Scope(bench_of_editions.store, [shipped_method("rebased")])
    first = argument(scope, "run_cache")
    assert argument(Scope(scope.store, [shipped_method("as-published")]), "run_cache") is first
    assert argument(scope.only(["2014-001"]), "run_cache") is not first
    assert argument(scope, "run_cache") is not first  # of one set of runs at a time


def test_a_fault_in_a_list_of_races_leaves_the_curves_as_they_are(bench_of_editions):
    store, method = bench_of_editions.store, shipped_method("as-published")
    races = bench_of_editions.archive / "wedstrijden" / "grachtenrace_2014.csv"
    races.parent.mkdir(exist_ok=True)
    races.write_text("wedstrijd;datum\nGrachtenrace;gisteren\n")
    bring_in(store, bench_of_editions.archive)
    assert ARCHIVE.is_stale(Scope(store, ()))
    ARCHIVE.make(Scope(store, (), today=DAY))
    assert store.read("quarantine")["path"].str.ends_with(races.name).any()
    assert not METHOD.is_stale(Scope(store, [method]))
