"""Methods for tests: every step switched off, but for what a test names."""

from pipeline.method.definition import Method
from pipeline.method.reading import parse_method

PLAIN = {
    "speed": '{ correction = "none" }',
    "calibration": '{ rule = "none" }',
    "window": '{ rule = "all" }',
    "wind": '{ model = "oblique", ahead = 0.0, behind = 0.0, side = 0.0 }',
    "run_point": '{ estimator = "mean_of_ratios" }',
    "temperature": '{ rule = "none" }',
    "runs": "{ highest_target_ratio = 1.5 }",
    "curve": '{ b = "free" }',
}


def write_method_text(name: str = "test", **steps: str) -> str:
    lines = [f"{step} = {options}" for step, options in (PLAIN | steps).items()]
    return "\n".join([f'name = "{name}"', 'title = "Test"', "[steps]", *lines]) + "\n"


def method(name: str = "test", **steps: str) -> Method:
    return parse_method(write_method_text(name, **steps), f"{name}.toml")
