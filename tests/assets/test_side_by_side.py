"""Steps shared by two processes: none twice, none lost, in their order; errors come out."""

import copy
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from threading import Event

import pytest

from herijk.assets.side_by_side import helper, shared, side_by_side, stages
from herijk.pipeline.errors import UnavailableError
from herijk.warehouse.build.graph import STEPS
from herijk.warehouse.store.store import DamagedFileError


@dataclass(frozen=True)
class Slow:
    """Takes longer, the earlier it comes."""

    place: int
    of: int

    def do(self):
        time.sleep(0.01 * (self.of - self.place))
        return self.place


def test_what_is_made_comes_in_the_order_of_the_tasks():
    with ThreadPoolExecutor(1) as other:
        tasks = [Slow(place, 5) for place in range(5)]
        assert side_by_side(tasks, other, Slow.do) == list(range(5))


def test_what_the_other_process_made_is_told():
    told, here = [], []

    def do_here(task):
        here.append(task.place)
        return task.do()

    tasks = [Slow(place, 5) for place in range(5)]
    with ThreadPoolExecutor(1) as other, shared(tasks, other, Slow.do, told.append) as join:
        assert join(do_here) == list(range(5))
    assert sorted(here + told) == list(range(5))
    assert here
    assert told


def test_the_other_process_begins_before_this_one_joins_in():
    told, came = [], Event()

    def tell(place):
        told.append(place)
        came.set()

    tasks = [Slow(place, 5) for place in range(5)]
    with ThreadPoolExecutor(1) as other, shared(tasks, other, Slow.do, tell) as join:
        assert came.wait(10)
        assert told[0] == 0
        assert join(Slow.do) == list(range(5))


def test_where_something_goes_wrong_the_rest_is_not_begun():
    begun, tasks = [], [Slow(place, 50) for place in range(50)]

    def fail(_):
        raise ValueError("spoilt")

    def noted(task):
        begun.append(task.place)
        return task.do()

    with (
        ThreadPoolExecutor(1) as other,
        pytest.raises(ValueError, match="spoilt"),
        shared(tasks, other, noted) as join,
    ):
        join(fail)
    assert len(begun) < len(tasks)


def test_steps_stand_together_where_none_reads_what_another_makes():
    found = stages(STEPS)
    assert [step for stage in found for step in stage] == list(STEPS)
    together = [{step.name for step in stage} for stage in found]
    assert {"studies", "lines", "consistency", "register"} in together
    for stage in found:
        made = {name for step in stage for name in step.outputs}
        assert made.isdisjoint(name for step in stage for name in step.inputs)


def test_a_helper_that_is_ended_is_told_with_the_way_out():
    with pytest.raises(UnavailableError, match="Run it again"), helper() as other:
        other.submit(os._exit, 1).result()


PARENT = """
import os
from herijk.assets.side_by_side import helper
if __name__ == "__main__":
    with helper() as other:
        print(other.submit(os.getpid).result(), flush=True)
        other.submit(eval, "__import__('time').sleep(60)").result()
"""


def test_a_helper_ends_with_the_process_it_helps(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(PARENT, encoding="utf-8")
    with subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True) as parent:
        other = int(parent.stdout.readline())
        parent.kill()
    assert any(_is_gone(other) or time.sleep(0.05) for _ in range(200))


QUIET = """
from herijk.assets.side_by_side import helper, stages
if __name__ == "__main__":
    with helper() as other:
        other.submit(stages, ()).result()
"""


def test_a_helper_ends_without_a_word(tmp_path):
    script = tmp_path / "quiet.py"
    script.write_text(QUIET, encoding="utf-8")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert done.stderr == ""


def _is_gone(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


def test_a_damaged_file_found_by_the_helper_is_named():
    found = copy.copy(DamagedFileError(Path("lake/tows.parquet")))  # as it is handed over
    assert found.path == Path("lake/tows.parquet")
    assert str(found).count("is damaged") == 1
