"""Tasks before a flight."""

import pathlib
import re

from screen import NUMBER, ROW, TEXT, TICK, wait_for
from trial import Trial

ROAD = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>The road</name><LineString><coordinates>
  -84.1780,36.3060,0 -84.1690,36.3075,0 -84.1600,36.3062,0
</coordinates></LineString></Placemark></Document></kml>"""


def survey_with_alternates(trial: Trial) -> None:
    """From an empty map, in at most 40 gestures and 3 minutes."""
    window = trial.open()
    window.click("Among the example's hills")
    window.click("✏ Draw the area")
    window.click_map((140, -60), (230, -70), (240, -150), (150, -140))
    window.press("Return")
    window.click("Create")
    # another runway, and the way there
    window.click("Draw a runway (R)")
    window.click("Both directions", TICK)
    window.click_map((120, 120), (170, 100))
    window.press("v")
    window.click("Add to emergency plans")
    window.click("Land on *", which=-1)
    # the survey goes there, unless the engine fails
    window.click("SCAN Scan the area", ROW)
    window.choose("Alternate", "Return to R07*")
    window.click("Add alternate by cause")
    window.choose("Alternate by cause 1: Plan", "Return to R05*")
    window.save_as(trial.file, '<scan id="scan"[^>]* emergency="', '<emergency cause="engine"')
    assert window.gestures <= 40, f"{window.gestures} gestures"
    assert trial.seconds <= 180, f"{trial.seconds:.0f} s"
    trial.can_be_flown()


def corridor_along_a_pasted_line(trial: Trial) -> None:
    window = trial.open_square()
    window.click("TF side2", ROW)
    window.paste(ROAD)
    window.fill_in(NUMBER, "Width", "200")
    window.save(trial.file, 'name="The road"', "<corridor", 'width="200"')
    trial.can_be_flown()


def fork_with_a_close_look(trial: Trial) -> None:
    window = trial.open_square()
    window.click("TF side2", ROW)
    window.press("o")
    window.click_map((60, 60), (100, 60))
    window.press("v")
    window.row_menu("ORB orbit1", "Fork before it*")
    window.fill_in(TEXT, "Branch 1: Label", "Close look")
    window.fill_in(TEXT, "Branch 2: Label", "Go on")
    window.choose("Default", "Go on (skip)")
    window.save(trial.file, '<intersection[^>]* default="skip"', 'label="Close look"', 'label="Go on"')
    trial.can_be_flown()


def procedure_at_three_pylons(trial: Trial) -> None:
    window = trial.open_square()
    window.click("TF side2", ROW)
    window.press("o")
    window.click_map((60, 40), (100, 40))
    window.press("v")
    window.row_menu("ORB orbit1", "Make a procedure of it*")
    window.press("t")
    window.choose("Kind: *", "Call of a procedure")
    window.click_map((160, 60), (200, -60))
    window.press("v")
    saved = window.save(trial.file, "(?s)<call.*<call.*<call", "<procedure ")
    assert len(set(re.findall('<call [^>]*procedure="([^"]*)"', saved))) == 1, saved
    trial.can_be_flown()


def zone_around_a_village(trial: Trial) -> None:
    window = trial.open_square()
    window.press("z")
    window.click("outline")
    right, down = window.find("Fix B").middle
    for east, south in ((-30, -30), (30, -30), (30, 30), (-30, 30)):
        window.click_at((right + east, down + south))
    window.press("Return", "v")
    window.fill_in(TEXT, "Name", "Village")
    window.wait_until_shown("it goes into the zone “Village”")
    # above it is free
    window.click("Upper limit: *")
    window.fill_in(NUMBER, "Up to", "360")
    window.wait_until_shown("This plan can be flown")
    window.save(trial.file, '<keepOut[^>]* name="Village"', 'ceiling="360"')
    trial.can_be_flown()


def all_altitudes_30_m_higher(trial: Trial) -> None:
    window = trial.open_square()
    window.ask_for("raise or", "Edit Raise or lower all altitudes*")
    window.click("Raise them")
    legs = [f'<TF id="{leg}"[^>]* altitude="{altitude}"' for leg, altitude in (("side1", 130), ("side4", 140))]
    # of the stage the two others inherit theirs
    window.save(trial.file, *legs, '<stage id="circuit"[^>]* altitude="180"')
    trial.can_be_flown()


def three_faults(trial: Trial) -> None:
    """A fix that there is none of, a speed that nothing flies, a landing without a runway."""
    window = trial.open_square(
        ('id="side2" fix="B"', 'id="side2" fix="BB"'),
        ('id="side3" fix="C"', 'id="side3" fix="C" speed="90"'),
        ('id="land" type="land" runway="R05"', 'id="land" type="land"'),
    )
    for of, mend in (
        ("side2", lambda: window.choose("Fix", "B")),
        ("side3", lambda: window.fill_in(NUMBER, "Airspeed", "22")),
        ("land", lambda: window.choose("Runway", "R05*")),
    ):
        window.click(f"Problem: {of}*")
        mend()
    window.wait_until_shown("This plan can be flown")
    window.save(trial.file, 'id="side2" fix="B"', 'id="side3"[^>]* speed="22"', 'id="land"[^>]* runway="R05"')
    trial.can_be_flown()


def engine_fails_here(trial: Trial) -> None:
    window = trial.open_square()
    before = trial.file.read_text(encoding="utf-8")
    window.click("What if")
    window.click("Timeline")
    window.ask_for("engine fails", "What if The engine fails here*")
    window.wait_until_shown("Engine failure: R05 is reached without the engine on return")
    assert trial.file.read_text(encoding="utf-8") == before


def scan_bound_to_a_variable(trial: Trial) -> None:
    window = trial.open_square()
    window.click("Add to variables")
    window.click("Position")
    window.fill_in(TEXT, "Name", "fire")
    window.click("TF side2", ROW)
    window.press("a")
    window.click("circle")
    window.click_map((60, 60), (130, 60))
    window.press("v")
    window.choose("Area", "a circle at a formula")
    window.fill_in(TEXT, "Centre", "fire")
    window.save(trial.file, '<variable name="fire" type="position"', '<area centre="= fire"')
    trial.can_be_flown()


def recovered_after_a_kill(trial: Trial) -> None:
    window = trial.open_square()
    window.click("TF side2", ROW)
    window.fill_in(TEXT, "Name", "Along the road")
    # the copy is there for the next one
    wait_for("the copy", lambda: any(b"Along the road" in file.read_bytes() for file in copies(trial)))
    window.kill()
    window.open()
    window.click("Recover the changes")
    window.save(trial.file, 'id="side2"[^>]* name="Along the road"')
    trial.can_be_flown()


def copies(trial: Trial) -> list[pathlib.Path]:
    """Files that the window keeps for itself."""
    return [file for file in trial.home.rglob("*") if file.is_file() and file != trial.file]
