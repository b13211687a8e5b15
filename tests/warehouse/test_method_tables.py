"""What a process found of the runs is used again as long as the runs are what they were."""

from herijk.warehouse.build.method_tables import RUNS, run_cache


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
