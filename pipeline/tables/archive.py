"""What the archive holds: boats, tows, their runs, windows given by hand, and what is set aside."""

from functools import partial
from typing import Final

from pipeline.tables import column
from pipeline.tables.bases import Fault, PerRun, PerTow, RunList, TowFacts
from pipeline.tables.declare import dy

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
    listed = column.count("tows in the tow list that could be read")
    tows = column.count("of which used; the others are in quarantine")
    runs_set_aside = column.count("runs of these that are set aside")
    lost_s = column.number("time left out of the other runs, all channels", min=0)


class Tows(TowFacts):
    """Tows accepted into the warehouse, one row each."""

    runs_set_aside = column.count("runs to be used that are in quarantine")
    gps_step_m_s = column.optional("step in which its GPS is written; empty without GPS", min=0)
    force_step_n = column.optional("step in which its force is written", min=0)
    doubts = column.texts(
        "checks by which all other tows rule this one out: it needs a look, and takes "
        "no part in what tows share"
    )
    unusual = column.texts(
        "checks by which it stands out among all other tows, though chance can do "
        "that: it needs a look, and its numbers stand"
    )


class TowRuns(RunList):
    """Runs of every tow of which samples can be used."""

    lost_s = column.number("most that is left out of a channel: dropouts, spikes", min=0)


class HandWindows(PerRun):
    """Windows that a person gave, one row per run; they go before those that are found."""

    start_s = dy.Int16(description="start of the window", min=0, max=600)
    end_s = dy.Int16(description="end of the window", min=1, max=600)
    reason = column.text("why, in the person's words")


class Acceptances(PerTow):
    """Tows that a person accepted after the first assessment, and what doubts them since."""

    accepted_on = column.day("day of the acceptance", primary_key=True)
    accepted_by = column.text("who accepted the tow, as the list names them")
    fsn_no = column.fsn_no(nullable=True)
    redone_runs = column.text(
        "runs that were towed again, as `1,2,b3`; b3 is run 3 of the second file", nullable=True
    )
    explanation = column.text("why, in the person's words", nullable=True)
    known_checks = column.texts("codes of checks that marked the tow when it was accepted")
    newest = column.flag("the tow was not accepted again later: this acceptance counts")
    doubted_by = column.texts(
        "codes of checks that mark the tow now and were not known when it was accepted; set_aside "
        "where it gives no curve because it is set aside; none of an acceptance that does not count"
    )
    path = column.text("list of acceptances, relative to the archive")
    line = column.count("line in it", least=2)


class Inspections(dy.Schema):
    """What was last measured of each boat, and what it may be on the day of a race."""

    fsn_no = column.fsn_no(primary_key=True)
    measure = column.text(
        "what is measured: a column of the tow list, as weight_kg or thwart_1_m", primary_key=True
    )
    position = column.count("order on the sheet", least=1)
    unit = column.text("unit of its numbers; empty text of a photograph")
    value = column.optional("as last measured; empty where it never was", unit="as in unit")
    photo = column.text("name of the last photograph", nullable=True)
    source = column.text(
        "list that it comes from: tow_list or boat_list; empty where it was never measured",
        nullable=True,
        regex="^(tow_list|boat_list)$",
    )
    measured_on = column.day("day of the tow; the boat list gives none", nullable=True)
    tow_id = column.tow_id(nullable=True)
    tolerance = column.optional("how much it may differ", unit="as in unit")
    lowest = column.optional("lowest that is allowed, in whole kg or mm", unit="as in unit")
    highest = column.optional("highest that is allowed, in whole kg or mm", unit="as in unit")
    inferred = column.flag("the tolerance is inferred: nobody set it in beheer.toml", nullable=True)


class TraceSeconds(PerRun):
    """Means over every second of every run: what the instruments said."""

    second = dy.Int16(primary_key=True, description="second of the run, from 0", min=0)
    speed_m_s = column.speed("log 1: speed through the water as the log said")
    gps_m_s = column.speed("speed over ground; empty without GPS", nullable=True)
    force_n = column.number("tow force")
    wind_m_s = column.number("apparent wind speed")
    wind_angle_deg = column.number("circular mean of the apparent wind", min=0, max=360)


class Quarantine(Fault):
    """What is set aside, from seconds to files, each with the reason in a plain sentence."""

    lost = LOST()
    run = column.run(nullable=True)
    lost_s = column.optional("time that is lost", min=0)
    first_seen = column.day("day on which this fault was first found")
