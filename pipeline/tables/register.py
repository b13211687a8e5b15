"""The register: its lines, when they expire, and what differs between two registers."""

from functools import partial
from typing import Final

from pipeline.tables import column
from pipeline.tables.bases import PerMethod
from pipeline.tables.declare import dy

PLACE: Final = (
    "place in race and class by the old edition, among the crews that both editions rank; null for "
    "a crew that one of them does not"
)
PODIUM_CHANGED: Final = "among the first three in one of the two only; null without a place"
REMARK: Final = (
    "why there is no power (not_in_register, no_line_that_day, thwart_not_given, "
    "speed_not_below_b), or that the speed lies outside 85-115 % of the declared one "
    "(beyond_curve); by the old edition"
)


_FLAGS: Final = partial(
    column.texts, description="codes of what a person should look at in its tow", nullable=True
)


class _Line(dy.Schema):
    """What every line of a register has."""

    edition = column.text("edition; a draft is called concept-METHOD", primary_key=True)
    method = column.method()
    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    tow_id = column.tow_id(nullable=True)
    tow_date = column.day("day of the tow: from then on the line counts", nullable=True)
    valid_until = column.day("last day the line counts", nullable=True)
    declared_speed_m_s = column.speed("speed v0 the crew declared", nullable=True)
    a_kg_m = column.optional("A")
    b_m_s = column.optional("B; empty where it is not determined")
    cw_kg_m = column.optional("Cw at the declared speed")
    cw_lo_kg_m = column.optional(column.LOWER_END)
    cw_hi_kg_m = column.upper()
    basis = column.text(
        "measured; printed_rebased, printed_not_rebased: a printed line whose tow has no samples; "
        "printed: of a register as printed",
        nullable=True,
    )


class Register(_Line):
    """One line per edition, boat and crew."""

    status = column.text("valid, or why there is no valid curve")
    as_of = column.day(
        "day on which validity was judged: that of the archive's last tow or race, or "
        "from which an edition counts",
        nullable=True,
    )
    waterline_length_m = column.waterline_length("length on the waterline that day", nullable=True)
    beam_m = column.beam("breadth that day", nullable=True)
    bow_height_m = column.bow_height("height of the bow that day", nullable=True)
    weight_kg = column.boat_weight("empty boat with oars that day", nullable=True)
    flags = _FLAGS()
    verification_code = column.text(
        "ten letters and digits that follow from all that made the line; drafts have none",
        nullable=True,
    )


class RegisterHistory(_Line):
    """Every line that an edition's register had at some time, by the tow it rests on.

    On a day counts, of the lines whose tow was made by then, the one with the highest position; it
    is valid up to its last day.
    """

    position = column.count("the highest goes before", least=1, primary_key=True)
    flags = _FLAGS()


class DueList(PerMethod):
    """How long the tow of each boat and crew counts, and the speed of its next tow."""

    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    as_of = column.day("day on which it was judged: that of the last tow or race")
    status = column.text("valid, or why there is no valid curve")
    tow_id = column.tow_id(nullable=True)
    tow_date = column.day("day of the tow", nullable=True)
    valid_until = column.day("last day it counts", nullable=True)
    declared_speed_m_s = column.speed("speed that was declared for it", nullable=True)
    power_w = column.optional("power per rower at that speed")
    raced_speed_m_s = column.speed(
        "fastest race of the past year, through the water", nullable=True
    )
    lowest_speed_m_s = column.speed("speed at 70 W per rower (men) or 40 W (women)", nullable=True)
    highest_speed_m_s = column.speed("speed at 90 W or 55 W", nullable=True)
    tow_speed_m_s = column.speed("speed proposed for the next tow", nullable=True)
    speed_reason = column.text("why that speed")
    beyond_curve = column.flag("it lies outside 85-115 % of the last declared speed", nullable=True)


class RegisterChanges(dy.Schema):
    """What differs between two editions, per boat and crew."""

    from_edition = column.text("old edition", primary_key=True)
    to_edition = column.text("new edition", primary_key=True)
    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    change = column.text("added, removed, changed or same", regex="^(added|removed|changed|same)$")
    cw_ratio = column.optional("new / old Cw at the old declared speed")
    power_ratio = column.optional("new / old power at that speed")
    time_ratio = column.optional("new / old time at equal power")
    causes = column.text("what made the change, with its factor on Cw, as JSON")


class RaceChanges(dy.Schema):
    """Races replayed under two editions: power, rank and podium of every result."""

    from_edition = column.text("old edition", primary_key=True)
    to_edition = column.text("new edition", primary_key=True)
    race = column.text("name of the race", primary_key=True)
    race_date = column.day("day of the race", primary_key=True)
    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    rowing_time_s = column.number("time rowed", min_exclusive=0)
    old_power_w = column.optional("power per rower by the old edition")
    new_power_w = column.optional("the same by the new one")
    old_corrected_time_s = column.optional(
        "time rowed, corrected by the old edition; empty where power decides"
    )
    new_corrected_time_s = column.optional("the same by the new one")
    old_remark = column.text(REMARK, nullable=True)
    new_remark = column.text("the same by the new one", nullable=True)
    old_rank = dy.Int32(description=PLACE, nullable=True)
    new_rank = dy.Int32(description="the same by the new one", nullable=True)
    podium_changed = column.flag(PODIUM_CHANGED, nullable=True)


class RegisterYears(dy.Schema):
    """The register at the end of each season, under each method and as it was published."""

    year = column.count("season at whose end the lines were valid", primary_key=True)
    method = column.method(primary_key=True)
    published_method = column.text("method by which that year's register was published")
    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    empty_thwart = column.empty_thwart(primary_key=True)
    tow_id = column.tow_id(nullable=True)
    tow_date = column.day("day of the tow", nullable=True)
    valid_until = column.day("last day the line counts", nullable=True)
    basis = column.text("what the line rests on, as in register", nullable=True)
    declared_speed_m_s = column.speed("speed v0 the crew declared", nullable=True)
    a_kg_m = column.optional("A")
    b_m_s = column.optional("B; empty where it is not determined")
    cw_kg_m = column.optional("Cw at the declared speed")
    rank = dy.Int32(
        description="place in the class at equal power; 1 is the fastest", nullable=True
    )
    published_tow_id = column.tow_id(nullable=True)
    published_declared_speed_m_s = column.speed("the same as published", nullable=True)
    published_a_kg_m = column.optional("A as published")
    published_b_m_s = column.optional("B as published")
    published_cw_kg_m = column.optional("Cw as published")
    published_rank = dy.Int32(description="place in the class as published", nullable=True)
    change = column.text("added, removed, changed or same", regex="^(added|removed|changed|same)$")
    cw_ratio = column.optional("Cw / Cw as published, at the speed declared then")
    power_ratio = column.optional("power / power as published, at that speed")
    gain_in_two_hours_s = dy.Float64(
        description="what the method gives in a race of two hours; minus is less",
        nullable=True,
    )
    exceeds_interval = column.flag("the change is larger than the intervals of both", nullable=True)
    causes = column.text("what made the change, with its factor on Cw, as JSON")


class YearWinners(dy.Schema):
    """Who won each race by the register of its time, and who would have under each method."""

    year = column.count("season of the race", primary_key=True)
    method = column.method(primary_key=True)
    published_method = column.text("method by which that year's register was published")
    race = column.text("name of the race", primary_key=True)
    race_date = column.day("day of the race", primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    published_winner = column.text("boat that won; null where nobody has a power", nullable=True)
    winner = column.text("boat that wins under the method", nullable=True)
    winner_changed = column.flag("another crew wins")
    change_probability = column.optional("how likely it is that another crew than then wins")
