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

DIFFERS = "*"


def method_in_words(shown: Method, parent: Method | None) -> str:
    """The whole method; sentences that differ from those of `parent` are marked."""
    lines = [f"{shown.name}: {shown.title_en}", "", shown.description.strip(), ""]
    if parent is not None:
        lines += [f"Extends {parent.name}; what differs from it is marked {DIFFERS}.", ""]
    for block in shown.ranges:
        lines += [_seasons(block), *_sentences(block, parent), ""]
    lines.append(f"Content hash {shown.content_hash}")
    return "\n".join(lines)


def _seasons(block: SeasonSteps) -> str:
    if block.first == block.last:
        return f"Season {block.first}"
    last = "the present" if block.last == LAST_SEASON else str(block.last)
    return f"Seasons {block.first} to {last}"


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
    source = {"log1": "log 1", "log2": "log 2", "mean": "mean of both logs where they agree"}
    words = source[step.source]
    if step.correction == "none":
        return f"{words}, as it reads."
    if step.correction == "estimated":
        return f"{words}, with the season's factor as estimated from repeat tows and GPS."
    factor = (
        f"multiplied by {1 + step.correction_ratio:g}"
        if step.operation == "multiply"
        else f"divided by {1 - step.correction_ratio:g}"
    )
    return f"{words}, {factor}; a percentage in the tow list goes before."


def _calibration(step: Calibration) -> str:
    return {
        "none": "none.",
        "gps_per_tow": "one factor per file from GPS speed / log speed, as many runs out as back.",
        "gps_per_season": "one factor a season, the mean of its tows' GPS speed / log speed.",
    }[step.rule]


def _window(step: Window) -> str:
    if step.rule == "all":
        return "all samples of a run."
    return (
        f"the steady part of a run, at least {step.minimum_s:g} s; ends equal within "
        f"{step.speed_drift_m_s:g} m/s, {100 * step.force_ends_ratio:g} % of force and "
        f"{step.wind_ends_m_s:g} m/s of wind where that can be; without "
        f"ramps over {step.ramp_m_s:g} m/s, force peaks over {step.peak_sd:g} and gusts over "
        f"{step.gust_sd:g} deviations."
    )


def _wind(step: Wind) -> str:
    if step.model == "none":
        return "no correction."
    model = "head wind only" if step.model == "head" else "oblique wind on front and side"
    values = f"{step.ahead:g} from ahead, {step.behind:g} from behind"
    if step.model == "oblique":
        values += f", {step.side:g} on the side"
    coefficients = {
        "fixed": f"fixed coefficients ({values})",
        "per_run": "coefficients searched run by run between 0 and 1",
        "per_tow": "one coefficient a tow, searched between 0.3 and 0.7",
        "archive": "one coefficient found for the whole archive",
    }[step.coefficients]
    taken = f"wind averaged over {step.averaging_s} s" if step.averaging_s else "sample by sample"
    if step.anemometer == "estimated":
        taken += ", scaled per season by runs out and back"
    reading = {
        "as_felt": "",
        "cw_vac_2014": "; 'Cw vac' read as on the screens of 2014",
        "cw_opt_2014": "; 'Cw opt' read as on the screens of 2014: no still air put back",
    }[step.reading]
    return f"{model}, {coefficients}, {taken}{reading}."


def _run_point(step: RunPoint) -> str:
    words = (
        "mean of force / speed squared of all samples"
        if step.estimator == "mean_of_ratios"
        else "mean force / mean speed squared"
    )
    if step.inertia == "none":
        return f"{words}."
    return (
        f"{words}, less what accelerated the boat (water moved along: {step.added_mass_ratio:g})."
    )


def _temperature(step: Temperature) -> str:
    if step.rule == "none":
        return "the water as it was."
    return f"friction brought to water of {step.reference_c:g} C by the ITTC-57 line."


def _runs(step: Runs) -> str:
    return (
        f"at least {step.minimum} runs, both ways; none faster than "
        f"{100 * step.highest_target_ratio:g} % of the declared speed."
    )


def _curve(step: Curve) -> str:
    return {
        "free": "least squares in Cw, B free.",
        "capped": f"least squares in Cw, B at most {step.cap_hull_speeds:g} x hull speed.",
        "hull_speed": "least squares for A alone, B is the hull speed.",
    }[step.b]


def _assessment(step: Assessment) -> str:
    if not step.reject:
        return "flags are shown; none rejects a tow."
    return f"a tow is rejected for: {', '.join(step.reject)}."
