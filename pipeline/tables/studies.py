"""What the steps and options of a method change, and counts over many tows."""

from pipeline.tables import column
from pipeline.tables.bases import PerMethod, PerTow
from pipeline.tables.declare import dy


class CorrectionSteps(dy.Schema):
    """The ladder: what each step from one method to another does to a tow's Cw."""

    from_method = column.text("method the ladder begins with", primary_key=True)
    to_method = column.text("method it ends with", primary_key=True)
    tow_id = column.tow_id(primary_key=True)
    position = dy.Int8(primary_key=True, description="place of the step; 0 is the start", min=0)
    step = column.text("step of the method that was exchanged")
    factor = column.number(
        "Cw after / before the step; they multiply to the total", min_exclusive=0
    )
    cw_kg_m = column.number("Cw at the declared speed after the step")


class SeasonChanges(PerMethod):
    """Cw of each method / Cw of the first method, of the same tows, per season."""

    from_method = column.text("first method, which the others are compared with")
    season = column.season(primary_key=True)
    tows = column.count("tows with a curve under both", least=1)
    median_ratio = column.number("median of the ratio", min_exclusive=0)
    lowest_ratio = column.number("lowest ratio of a tow", min_exclusive=0)
    highest_ratio = column.number("highest ratio of a tow", min_exclusive=0)


class _Combination(dy.Schema):
    """Rows per combination of groups of steps that are put to the vote."""

    from_method = column.text("method that holds where nothing is on", primary_key=True)
    to_method = column.text("method that is put to the vote", primary_key=True)
    combination = column.text(
        "groups of steps that are as in to_method, joined by +: instruments (speed, force, "
        "calibration), selection (window, runs), surroundings (wind, temperature, unrecorded), fit "
        "(run_point, curve); none where every step is as in from_method",
        primary_key=True,
    )


class VoteCurves(_Combination):
    """The curve of every tow under every combination of what is put to the vote."""

    tow_id = column.tow_id(primary_key=True)
    a_kg_m = column.number("A")
    b_m_s = column.optional("B; empty where it is not determined")
    cw_kg_m = column.number("Cw at the declared speed")


class VoteLines(_Combination):
    """The register under every combination, each line beside the one where nothing is on."""

    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    tow_id = column.tow_id(nullable=True)
    cw_kg_m = column.optional("Cw at the declared speed; empty without a line")
    cw_ratio = column.optional("Cw / Cw where nothing is on, at the speed declared there")
    gain_in_two_hours_s = column.optional(
        "what it gives in a race of two hours at equal power; minus is less"
    )


class VoteRaces(_Combination):
    """Results of the last season with races under every combination."""

    race = column.text("name of the race", primary_key=True)
    race_date = column.day("day of the race", primary_key=True)
    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    old_power_w = column.optional("power per rower where nothing is on")
    new_power_w = column.optional("power per rower under the combination")
    old_rank = dy.Int32(
        description="place in race and class where nothing is on, among the crews that both rank",
        nullable=True,
    )
    new_rank = dy.Int32(description="the same under the combination", nullable=True)


class PrintReproduction(PerTow):
    """Does a method reproduce print? A, B and Cw of a tow as printed, next to each method's."""

    season = column.season()
    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()
    printed_in = dy.Int32(description="year of the first register that printed it")
    speed_m_s = column.speed("declared speed as printed; without it no Cw", nullable=True)
    printed_a_kg_m = column.optional("A as printed")
    a_kg_m = column.optional("A by the method")
    printed_b_m_s = column.optional("B as printed")
    b_m_s = column.optional("B by the method")
    printed_cw_kg_m = column.optional("Cw as printed")
    cw_kg_m = column.optional("Cw by the method at the printed speed")
    cw_ratio = column.optional("printed / recomputed Cw")
