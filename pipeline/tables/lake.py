"""What intake keeps in the lake: the lists of the archive, and where each tow's samples lie.

These tables are not in the database and no other program relies on them.
"""

from pipeline.tables import column
from pipeline.tables.archive import LOST, Boats, HandWindows
from pipeline.tables.bases import Fault, PerRun, RunList, TowFacts
from pipeline.tables.declare import dy


class AboutArchive(dy.Schema):
    """What the archive says of itself, and where it lies; one row."""

    simulated = column.flag("made by a simulator")
    publisher = column.text("who publishes what is made from it", nullable=True)
    licence = column.text("its licence: an SPDX name or a web address", nullable=True)
    crew_names = column.text("names of its own classes of crews, as JSON", nullable=True)
    languages = column.text("languages of the site, where not Dutch and English", nullable=True)
    root = column.text("the folder")


class CrewClasses(dy.Schema):
    """Classes of crews, with the limits that power and weight are held to; see `pipeline.crews`."""

    crew_class = column.crew_class(primary_key=True)
    name = column.text("what the people of the class are called")
    lowest_power_w = column.number("lower end of the realistic power per rower", min_exclusive=0)
    highest_power_w = column.number("upper end", min_exclusive=0)
    slow_power_w = column.optional("power under which a tow is too slow")
    raced_power_w = column.optional("power that a race takes at least")
    lightest_rower_kg = column.optional("weight of a rower, the lightest")
    heaviest_rower_kg = column.optional("the heaviest")
    handicap = column.text("formula by which its races are ranked")


class Faults(Fault):
    """What cannot be used, and why."""

    lost = LOST(nullable=True)
    run = column.run(nullable=True)
    lost_s = column.optional("time that is lost", min=0)


class ListedBoats(Boats):
    """Boats with the crew they are listed with."""

    rowers = column.rowers(nullable=True)
    crew_class = column.crew_class(nullable=True)


class ListedTows(TowFacts):
    """Tows of the lists that could be read, whatever their samples are."""

    thwart_1_m = column.thwart("distance of thwart 1 from the bow")
    thwart_2_m = column.thwart("the same of thwart 2")
    thwart_3_m = column.thwart("the same of thwart 3")
    thwart_4_m = column.thwart("the same of thwart 4")
    thwart_5_m = column.thwart("the same of thwart 5")
    thwart_6_m = column.thwart("the same of thwart 6")
    thwart_7_m = column.thwart("the same of thwart 7")
    thwart_8_m = column.thwart("the same of thwart 8")
    rudder_height_m = column.rudder("height of the rudder")
    rudder_breadth_m = column.rudder("its breadth, along the boat")
    rudder_thickness_m = column.rudder("its thickness")
    photo_boat = column.text("name of the photograph of the boat", nullable=True)
    photo_rudder = column.text("the same of the rudder", nullable=True)
    samples_runs = column.text("run of each samples file, where each has its own", nullable=True)
    second_runs = column.text("the same of the second files", nullable=True)
    run_windows = column.text("begin and end of each run in a recording [s]", nullable=True)
    list_path = column.text("tow list, relative to the archive")
    list_line = column.count("line in it", least=2)


class ListedRuns(RunList):
    """Runs of the listed tows, by the plan of their season."""

    planned_s = column.optional("how long a run should last", min=0)


class ListedWindows(HandWindows):
    """Windows given by hand, before anybody knows how long the runs are."""

    tow_id = column.tow_id()
    run = column.run()
    path = column.text("list of windows, relative to the archive")
    line = dy.Int64(description="line in it", min=2)


class WrittenWindows(PerRun):
    """Windows as a list has them: within a run, or of the runs within a recording."""

    tow_id = column.tow_id()
    run = column.run()
    start_s = column.number("start of the window", min=0, max=86_400)
    end_s = column.number("end of the window", min=0, max=86_400)
    reason = column.text("why, in the person's words", nullable=True)


class ListedFiles(dy.Schema):
    """Every file that was looked at."""

    path = column.text("file, relative to the archive", primary_key=True)
    kind = column.text("what it is, as `[files]` of archief.toml calls it, or profile")
    sha256 = column.sha256("its content hash")
    size_bytes = dy.Int64(description="its size", min=0)


class ListedRaces(dy.Schema):
    """Race results."""

    season = column.season()
    race = column.text("name of the race")
    race_date = column.day("day of the race")
    distance_m = column.number("distance along the course", min=100, max=500_000)
    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()
    empty_thwart = column.text("thwart left free, where it is given", nullable=True)
    rowing_time_s = column.number("time rowed", min_exclusive=0)
    stream_m = column.optional(
        "distance that the current carried the boat", min=-500_000, max=500_000
    )
    penalty_w = column.optional("penalty", min=-1000, max=1000)
    path = column.text("file, relative to the archive")
    line = column.count("line in it", least=2)


class ListedForceChecks(dy.Schema):
    """Readings of the load cell while a known weight hung on it."""

    season = column.season()
    day = column.day("day of the reading")
    weight_kg = column.number("known weight", min=1, max=2000)
    reading_n = column.number("what the load cell read", min=1, max=30_000)
    path = column.text("file, relative to the archive")
    line = column.count("line in it", least=2)


class ListedLamps(dy.Schema):
    """When a warning lamp burned: the tow line was not square."""

    season = column.season()
    tow_id = column.tow_id()
    run = column.run()
    start_s = column.number("from the start of the run", min=0, max=600)
    end_s = column.number("the same, when it went out", min=0, max=600)
    path = column.text("file, relative to the archive")
    line = column.count("line in it", least=2)


class ListedAcceptances(dy.Schema):
    """Tows that were accepted after the first assessment, as the list has them."""

    tow_id = column.tow_id()
    accepted_on = column.day("day of the acceptance")
    accepted_by = column.text("who accepted the tow")
    redone_runs = column.text("runs that were towed again, as `1,2,b3`", nullable=True)
    explanation = column.text("why, in the person's words", nullable=True)
    known_checks = column.text("codes of checks that marked the tow then", nullable=True)
    path = column.text("file, relative to the archive")
    line = column.count("line in it", least=2)


class PrintedLines(dy.Schema):
    """Lines of registers as they were published."""

    season = column.season()
    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()
    empty_thwart = column.empty_thwart()
    has_valid_curve = column.flag("A, B and Cw are of a measured curve")
    a_kg_m = column.optional("A", min=0, max=1000)
    b_m_s = column.optional("B", min=0.1, max=1000)
    cw_kg_m = column.optional("Cw", min=0.9, max=1000)
    declared_speed_m_s = column.declared_speed(nullable=True)
    tow_date = column.day("day of the tow", nullable=True)
    path = column.text("file, relative to the archive")
    line = column.count("line in it", least=2)


class SeasonIndex(dy.Schema):
    """Where each listed tow's samples and blocks lie, or the fault that was found.

    Of a tow that can be used, also what it lost: runs and seconds.
    """

    tow_id = column.tow_id()
    samples_key = column.text("name of its samples in the lake", nullable=True)
    blocks_key = column.text("name of its blocks in the lake", nullable=True)
    samples = dy.Int64(description="number of samples", nullable=True, min=0)
    wind_read = column.flag("its wind is that of an anemometer", nullable=True)
    gps_step_m_s = column.optional("step in which its GPS is written", min=0)
    force_step_n = column.optional("step in which its force is written", min=0)
    path = column.text("faulty file, relative to the archive", nullable=True)
    line = dy.Int64(description="line in it", nullable=True, min=1)
    reason_code = column.text("short stable code of the fault", nullable=True)
    message = column.text("what is wrong, in a sentence", nullable=True)
    message_nl = column.text("the same in Dutch", nullable=True)
    cause = column.text("what faults of one cause share", nullable=True)
    losses = dy.List(
        dy.Struct(Faults.columns()), nullable=True, description="faults that did not cost the tow"
    )
