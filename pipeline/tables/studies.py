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


_STUDY = "judgement: what could be chosen either way; tool: what the tool of 2015 let one tick"


class OptionEffects(PerMethod):
    """How much choices matter, on top of a method: of judgement, and those of the tool of 2015.

    Choices of judgement have no rows for a tow whose log is estimated: there, another option would
    also move the factor of the season.
    """

    study = column.text(_STUDY, primary_key=True, regex="^(judgement|tool)$")
    tow_id = column.tow_id(primary_key=True)
    option = column.text("option of a step", primary_key=True)
    cw_effect_ratio = column.number("Cw with the second value / with the first")


class OptionCurves(PerTow):
    """Curves of a tow under every combination of the ticks of the tool of 2015, at each speed."""

    speed = column.text(
        "the log as_read, with the method's dgps or estimated factor, or its percentage by which "
        "to multiply or divide",
        primary_key=True,
        regex="^(as_read|dgps|estimated|multiply|divide)$",
    )
    optimisation = column.flag("air coefficients searched per run", primary_key=True)
    trimming = column.flag("only the steady part of a run", primary_key=True)
    vane = column.flag("wind averaged over 3 s", primary_key=True)
    b_from_length = column.flag("B is hull speed", primary_key=True)
    a_kg_m = column.number("A")
    b_m_s = column.optional("B; empty where Cw does not rise")
    cw_kg_m = column.number("Cw at the declared speed")


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
