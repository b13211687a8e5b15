"""Columns that several tables begin with, and inherit."""

from pipeline.tables import column
from pipeline.tables.declare import dy


class PerMethod(dy.Schema):
    """Rows that a method made."""

    method = column.method(primary_key=True)


class PerTow(PerMethod):
    """Rows per method and tow."""

    tow_id = column.tow_id(primary_key=True)


class PerCrewTow(PerTow):
    """The same, with the boat and crew that was towed."""

    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()


class PerPart(PerMethod):
    """Rows per method, season and part of it."""

    season = column.season(primary_key=True)
    part = dy.Int32(primary_key=True, description="part of the season, until a log was replaced")


class PerRun(dy.Schema):
    """Rows per run, whatever the method."""

    tow_id = column.tow_id(primary_key=True)
    run = column.run(primary_key=True)


class RunList(PerRun):
    """Runs of every tow; runs 21 and on are runs 1 and on of the second file."""

    direction = dy.Int8(description="1 out, -1 back", min=-1, max=1)
    target_speed_ratio = column.number("intended speed / declared speed", min_exclusive=0)
    selected = column.flag("the tow list says to use it")


class TowFacts(dy.Schema):
    """What the lists say of a tow, one row each."""

    tow_id = column.tow_id(primary_key=True)
    season = column.season()
    tow_date = column.day("day of the tow")
    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()
    declared_speed_m_s = column.declared_speed()
    waterline_length_m = column.waterline_length("length on the waterline that day")
    beam_m = column.beam("breadth that day")
    bow_height_m = column.bow_height(
        "height of the bow that day; empty only where no wind was measured", nullable=True
    )
    weight_kg = column.boat_weight("empty boat with oars, before", nullable=True)
    weight_after_kg = column.boat_weight("the same, after", nullable=True)
    crew_weight_kg = column.optional("crew and ballast on board", min=0, max=6_000)
    water_temperature_c = column.optional("water temperature", min=0, max=35)
    salinity_g_kg = column.optional("salt in the water; empty counts as fresh", min=0, max=42)
    water_depth_m = column.optional("depth of the water", min=0.2, max=500)
    speed_correction_ratio = column.optional(
        "speed correction entered by hand, 0.06 for 6 %", min=-0.5, max=0.5
    )
    altered = column.flag("the boat was altered since its previous tow")
    sample_rate_hz = dy.Float64(description="samples per second", min=1, max=100_000)
    empty_thwart = column.text("thwart left free", nullable=True)
    freeboard_lowest_m = column.freeboard("freeboard at its lowest")
    freeboard_bow_m = column.freeboard("freeboard at the bow")
    freeboard_stern_m = column.freeboard("freeboard at the stern")
    load_cell_ratio = column.optional(
        "load cell / known weight, when it was last checked", min_exclusive=0
    )
    load_cell_sd = column.optional("its standard uncertainty", min=0)
    lamp_ratio = column.optional(
        "largest part of a run in which a warning lamp burned; empty where nobody noted it",
        min=0,
    )
    wind_measured = column.flag("there was an anemometer whose wind can be used")
    log2_measured = column.flag("there was a second log that can be used")
    log1_part = column.count("times log 1 had been replaced that season")
    log2_part = column.count("times log 2 had been replaced that season")
    samples_path = column.text("samples file in the archive")
    samples_sha256 = column.sha256("its content hash")
    second_path = column.text("second samples file, if two tows were combined", nullable=True)
    second_sha256 = column.sha256("its content hash", nullable=True)


class Fault(dy.Schema):
    """What cannot be used, and why."""

    path = column.text("file, relative to the archive")
    tow_id = column.tow_id(nullable=True)
    line = dy.Int64(description="line in the file", nullable=True, min=1)
    reason_code = column.text("short stable code")
    message = column.text("what is wrong and what to do, in a sentence")
    message_nl = column.text("the same in Dutch")
    cause = column.text("what faults of one cause share: the sentence, with what differs left open")
