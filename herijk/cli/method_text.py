"""A method in words for a committee member: one sentence per step and range of seasons."""

from herijk.pipeline.method.definition import (
    LAST_SEASON,
    Assessment,
    Calibration,
    Curve,
    Method,
    RunPoint,
    Runs,
    SeasonSteps,
    Speed,
    Steps,
    Temperature,
    Wind,
    Window,
)
from herijk.words import LANGUAGE, tell

DIFFERS = "*"


def method_in_words(shown: Method, parent: Method | None) -> str:
    """The whole method; sentences that differ from those of `parent` are marked."""
    lines = [f"{shown.name}: {shown.titled(LANGUAGE.get())}", "", shown.description.strip(), ""]
    if parent is not None:
        lines += [tell("Extends {}; what differs from it is marked {}.", parent.name, DIFFERS), ""]
    for block in shown.ranges:
        lines += [_seasons(block), *_sentences(block, parent), ""]
    lines.append(tell("Content hash {}", shown.content_hash))
    return "\n".join(lines)


def _seasons(block: SeasonSteps) -> str:
    if block.first == block.last:
        return tell("Season {}", block.first)
    last = tell("the present") if block.last == LAST_SEASON else str(block.last)
    return tell("Seasons {} to {}", block.first, last)


def _sentences(block: SeasonSteps, parent: Method | None) -> list[str]:
    sentences = steps_in_words(block.steps)
    before = sentences if parent is None else steps_in_words(parent.for_season(block.first))
    return [
        f"  {DIFFERS if before[step] != words else ' '} {step:12} {words}"
        for step, words in sentences.items()
    ]


def steps_in_words(steps: Steps) -> dict[str, str]:
    """One sentence per step."""
    return {
        "speed": _speed(steps.speed),
        "calibration": _calibration(steps.calibration),
        "window": _window(steps.window),
        "wind": _wind(steps.wind),
        "run_point": _run_point(steps.run_point),
        "temperature": _temperature(steps.temperature),
        "runs": _runs(steps.runs),
        "curve": _curve(steps.curve),
        "assessment": _assessment(steps.assessment),
    }


def _speed(step: Speed) -> str:
    source = {
        "log1": tell("log 1"),
        "log2": tell("log 2"),
        "mean": tell("mean of both logs where they agree"),
    }
    words = source[step.source]
    if step.correction == "none":
        return tell("{}, as it reads.", words)
    if step.correction == "estimated":
        return tell("{}, with the season's factor as estimated from repeat tows and GPS.", words)
    factor = (
        tell("multiplied by {:g}", 1 + step.correction_ratio)
        if step.operation == "multiply"
        else tell("divided by {:g}", 1 - step.correction_ratio)
    )
    return tell("{}, {}; a percentage in the tow list goes before.", words, factor)


def _calibration(step: Calibration) -> str:
    without = [] if step.without_gps == "no_curve" else [tell("Without GPS: as estimated.")]
    stream = [] if step.stream == "none" else [tell("A drift of the stream is taken off.")]
    late = [] if step.delay == "none" else [tell("What the GPS is late is taken off.")]
    return " ".join([_calibration_rule(step), *late, *stream, *without])


def _calibration_rule(step: Calibration) -> str:
    return {
        "none": tell("none."),
        "gps_per_tow": tell(
            "one factor per file from GPS speed / log speed, as many runs out as back."
        ),
        "gps_per_season": tell(
            "one factor per season, the mean of its tows' GPS speed / log speed."
        ),
    }[step.rule]


def _window(step: Window) -> str:
    if step.rule == "all":
        return tell("all samples of a run.")
    return tell(
        "the steady part of a run, at least {:g} s; ends equal within {:g} m/s, {:g} "
        "% of force and {:g} m/s of wind where that can be; without ramps over {:g} "
        "m/s, force peaks over {:g} and gusts over {:g} deviations.",
        step.minimum_s,
        step.speed_drift_m_s,
        100 * step.force_ends_ratio,
        step.wind_ends_m_s,
        step.ramp_m_s,
        step.peak_sd,
        step.gust_sd,
    )


def _wind(step: Wind) -> str:
    if step.model == "none":
        return tell("no correction.")
    model = (
        tell("head wind only") if step.model == "head" else tell("oblique wind on front and side")
    )
    values = tell("{:g} from ahead, {:g} from behind", step.ahead, step.behind)
    if step.model == "oblique":
        values += tell(", {:g} on the side", step.side)
    coefficients = {
        "fixed": tell("fixed coefficients ({})", values),
        "per_run": tell("coefficients searched run by run between 0 and 1"),
        "per_tow": tell("one coefficient per tow, searched between 0.3 and 0.7"),
        "archive": tell("one coefficient found for the whole archive"),
    }[step.coefficients]
    taken = (
        tell("wind averaged over {} s", step.averaging_s)
        if step.averaging_s
        else tell("sample by sample")
    )
    if step.anemometer == "estimated":
        taken += tell(", scaled per season by runs out and back")
    if step.unmeasured == "expected":
        taken += tell(", where it was not measured as other tows let expect")
    reading = {
        "as_felt": "",
        "cw_vac_2014": tell("; 'Cw vac' read as on the screens of 2014"),
        "cw_opt_2014": tell("; 'Cw opt' read as on the screens of 2014: no still air put back"),
    }[step.reading]
    return f"{model}, {coefficients}, {taken}{reading}."


def _run_point(step: RunPoint) -> str:
    words = (
        tell("mean of force / speed squared of all samples")
        if step.estimator == "mean_of_ratios"
        else tell("mean force / mean speed squared")
    )
    if step.inertia == "none":
        return f"{words}."
    return tell(
        "{}, less what accelerated the boat (water moved along: {:g}).",
        words,
        step.added_mass_ratio,
    )


def _temperature(step: Temperature) -> str:
    if step.rule == "none":
        return tell("the water as it was.")
    words = tell("friction brought to water of {:g} C by the ITTC-57 line.", step.reference_c)
    if step.unrecorded == "unchanged":
        return words
    return f"{words} {tell('Where nobody recorded it: as other tows let expect.')}"


def _runs(step: Runs) -> str:
    return tell(
        "at least {} runs, both ways; none faster than {:g} % of the declared speed.",
        step.minimum,
        100 * step.highest_target_ratio,
    )


def _curve(step: Curve) -> str:
    return {
        "free": tell("least squares in Cw, B free."),
        "capped": tell("least squares in Cw, B at most {:g} x hull speed.", step.cap_hull_speeds),
        "hull_speed": tell("least squares for A alone, B is the hull speed."),
    }[step.b]


def _assessment(step: Assessment) -> str:
    if not step.reject:
        return tell("flags are shown; none rejects a tow.")
    return tell("a tow is rejected for: {}.", ", ".join(step.reject))
