"""What the archive holds: boats, tows, their runs, windows given by hand, and what is set aside."""

from functools import partial
from typing import Final

from herijk.tables import column
from herijk.tables.declare import dy

LOST: Final = partial(
    column.text,
    "what it costs: seconds, run, tow, file, or a row of a list, or a cell, that costs no tow",
    regex="^(seconds|run|tow|file|row|cell)$",
)


class Boats(dy.Schema):
    """Boats of `sloependata.csv`, one row each."""

    fsn_no = column.fsn_no(primary_key=True)
    ht_no = column.text("number in the HT register", nullable=True)
    name = column.text("name of the boat")
    boat_type = column.text("type, empty where not known", nullable=True)
    waterline_length_m = column.waterline_length("length on the waterline", nullable=True)
    beam_m = column.beam("breadth", nullable=True)
    bow_height_m = column.bow_height("height of the bow", nullable=True)
    weight_kg = column.boat_weight("empty boat with oars", nullable=True)


class Seasons(dy.Schema):
    """What a rebuild read of each season."""

    season = column.season(primary_key=True)
    listed = dy.Int32(description="tows in the tow list that could be read", min=0)
    tows = dy.Int32(description="of which used; the others are in quarantine", min=0)
    runs_set_aside = dy.Int32(description="runs of these that are set aside", min=0)
    lost_s = column.number("s", "time left out of the other runs, all channels", min=0)


class TowFacts(dy.Schema):
    """What the lists say of a tow, one row each."""

    tow_id = column.tow_id(primary_key=True)
    season = column.season()
    tow_date = dy.Date(description="day of the tow")
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
    crew_weight_kg = column.number(
        "kg", "crew and ballast on board", nullable=True, min=0, max=6_000
    )
    water_temperature_c = column.number("C", "water temperature", nullable=True, min=0, max=35)
    speed_correction_ratio = column.number(
        "1", "speed correction entered by hand, 0.06 for 6 %", nullable=True, min=-0.5, max=0.5
    )
    altered = dy.Bool(description="the boat was altered since its previous tow")
    sample_rate_hz = dy.Int32(
        description="samples per second", metadata={"unit": "Hz"}, min=1, max=100_000
    )
    empty_thwart = column.text("thwart left free", nullable=True)
    freeboard_lowest_m = column.freeboard("freeboard at its lowest")
    freeboard_bow_m = column.freeboard("freeboard at the bow")
    freeboard_stern_m = column.freeboard("freeboard at the stern")
    load_cell_ratio = column.number(
        "1", "load cell / known weight, when it was last checked", nullable=True, min_exclusive=0
    )
    load_cell_sd = column.number("1", "its standard uncertainty", nullable=True, min=0)
    lamp_ratio = column.number(
        "1",
        "largest part of a run in which a warning lamp burned; empty where nobody noted it",
        nullable=True,
        min=0,
    )
    remark = column.text("remark in the tow list", nullable=True)
    wind_measured = dy.Bool(description="there was an anemometer whose wind can be used")
    log2_measured = dy.Bool(description="there was a second log that can be used")
    log1_part = dy.Int32(description="times log 1 had been replaced that season", min=0)
    log2_part = dy.Int32(description="times log 2 had been replaced that season", min=0)
    samples_path = column.text("samples file in the archive")
    samples_sha256 = column.sha256("its content hash")
    second_path = column.text("second samples file, if two tows were combined", nullable=True)
    second_sha256 = column.sha256("its content hash", nullable=True)


class Tows(TowFacts):
    """Tows accepted into the warehouse, one row each."""

    runs_set_aside = dy.Int32(description="runs to be used that are in quarantine", min=0)
    gps_step_m_s = column.number(
        "m/s", "step in which its GPS is written; empty without GPS", nullable=True, min=0
    )
    force_step_n = column.number(
        "N",
        "step in which its force is written",
        nullable=True,
        min=0,
    )
    doubts = dy.List(
        dy.String(),
        description="checks by which all other tows rule this one out: it needs a look, and takes "
        "no part in what tows share",
    )
    unusual = dy.List(
        dy.String(),
        description="checks by which it stands out among all other tows, though chance can do "
        "that: it needs a look, and its numbers stand",
    )
    unseen_force_ratio = column.number(
        "1",
        "smallest relative error of its force that size, type, day and all other tows would show "
        "in 19 of 20 cases; empty where nothing tells",
        nullable=True,
        min=0,
    )


class RunList(dy.Schema):
    """Runs of every tow; runs 21 and on are runs 1 and on of the second file."""

    tow_id = column.tow_id(primary_key=True)
    run = column.run(primary_key=True)
    direction = dy.Int8(description="1 out, -1 back", min=-1, max=1)
    target_speed_ratio = column.number("1", "intended speed / declared speed", min_exclusive=0)
    selected = dy.Bool(description="the tow list says to use it")


class TowRuns(RunList):
    """Runs of every tow of which samples can be used."""

    lost_s = column.number("s", "most that is left out of a channel: dropouts, spikes", min=0)


class HandWindows(dy.Schema):
    """Windows that a person gave, one row per run; a method may use them (`by_hand`)."""

    tow_id = column.tow_id(primary_key=True)
    run = column.run(primary_key=True)
    start_s = dy.Int16(description="start of the window", metadata={"unit": "s"}, min=0, max=600)
    end_s = dy.Int16(description="end of the window", metadata={"unit": "s"}, min=1, max=600)
    reason = column.text("why, in the person's words")


class TraceSeconds(dy.Schema):
    """Means over every second of every run: what the instruments said."""

    tow_id = column.tow_id(primary_key=True)
    run = column.run(primary_key=True)
    second = dy.Int16(primary_key=True, description="second of the run, from 0", min=0)
    speed_m_s = column.speed("log 1: speed through the water as the log said")
    gps_m_s = column.speed("speed over ground; empty without GPS", nullable=True)
    force_n = column.number("N", "tow force")
    wind_m_s = column.number("m/s", "apparent wind speed")
    wind_angle_deg = column.number("deg", "circular mean of the apparent wind", min=0, max=360)


class Quarantine(dy.Schema):
    """What is set aside, from seconds to files, each with the reason in a plain sentence."""

    path = column.text("file, relative to the archive")
    tow_id = column.tow_id(nullable=True)
    line = dy.Int64(description="line in the file", nullable=True, min=1)
    reason_code = column.text("short stable code")
    message = column.text("what is wrong and what to do, in a sentence")
    message_nl = column.text("the same in Dutch")
    cause = column.text("what faults of one cause share: the sentence, with what differs left open")
    lost = LOST()
    run = column.run(nullable=True)
    lost_s = column.number("s", "time that is lost", nullable=True, min=0)
    first_seen = dy.Date(description="day on which this fault was first found")


class About(dy.Schema):
    """What the database says of itself."""

    key = column.text(
        "simulated: made by a simulator, or measured; code_version: of the code that made it; "
        "publisher, licence: as the archive declares them",
        primary_key=True,
    )
    value = column.text("its value")


class Contents(dy.Schema):
    """The tables of the database."""

    table = column.text("name of the table", primary_key=True)
    rows = dy.Int64(description="rows in it", min=0)
    meaning = column.text("what the table is")
