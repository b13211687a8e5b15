"""What the tables of a method follow from, and what they do not."""

from pipeline.method.definition import shipped_method
from tests.intake import bring_in
from tests.warehouse.edition_bench import DAY
from warehouse.derive.graph import ARCHIVE, METHOD
from warehouse.derive.inputs import Scope


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
