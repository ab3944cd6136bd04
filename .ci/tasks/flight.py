"""Tasks in flight: the window, the agent and the simulated autopilot are three programs, as they are in the field."""

import csv
import json
import math
import re
import socket

from screen import BUTTON, TEXT, wait_for
from trial import Trial
from window import Window

# of the example's runway
HOME = "36.3190,-84.1730,349,52"
# simulated seconds per second
SPEED = 3
# as far as a turn leads past a corner
NEAR_M = 200


def leg_moved_and_pushed(trial: Trial) -> None:
    window = take_off(trial)
    window.drag(window.find("Fix C").middle, (40, 40))
    window.click("Push")
    window.click("Commit")
    window.wait_until_shown("▸ side4")
    saved = window.save(trial.file, 'id="C" lat="(?!36.305396")')
    window.kill()
    events = recorded(trial)
    first, second = [event["hash"] for event in events if event["event"] == "plan-activated"]
    assert first != second, "the plan that was pushed has another hash"
    entered = next(event for event in events if event.get("place", {}).get("leg") == "side4")
    corner = re.search('id="C" lat="([^"]+)" lon="([^"]+)"', saved)
    assert corner, saved
    off_m = distance_m(entered["at"], (float(corner[1]), float(corner[2])))
    assert off_m < NEAR_M, f"it turned {off_m:.0f} m from where the fix was moved to"


def emergency_and_back(trial: Trial) -> None:
    window = take_off(trial)
    window.hold("Emergency: fly return*", until="EMERGENCY: flying return")
    window.click("Return to the main plan at*", BUTTON)
    # what would follow is looked at first
    window.wait_until_shown("Flies next: side")
    window.hold("Return to the main plan at*", until="En route ▸ side", which=-1)
    window.kill()
    events = recorded(trial)
    started = next(event for event in events if event["event"] == "emergency-started")
    assert (started["plan"], started["cause"]) == ("return", "operator"), started
    plans = [event["place"]["plan"] for event in events if event["event"] == "leg-entered"]
    assert plans[-2:] == [{"emergency": "return"}, "main"], plans


def take_off(trial: Trial) -> Window:
    """A window beside a vehicle that is flying its second leg."""
    trial.begin("legwork-sim", "--tcp", "127.0.0.1:0", "--speed", SPEED, "--home", HOME)
    autopilot = trial.said_by("legwork-sim", r"listening on tcp (\S+)")
    gateway = f"tcp/127.0.0.1:{free_port()}"
    trial.begin(
        "onboard-agent", "run", "--listen", gateway, "--autopilot", f"tcp:{autopilot}", "--state-dir", trial.home / "aboard"
    )
    trial.said_by("onboard-agent", "(joined the gateway)")
    window = trial.open_square()
    window.click("○ Connect")
    window.fill_in(TEXT, "Where the vehicle's gateway listens*", gateway)
    window.find("● uav1*")
    window.click("Push")
    window.click("Commit")
    window.hold("Start and take off*", until="Start and take off: accepted")
    window.wait_until_shown("En route ▸ side2")
    return window


def free_port() -> int:
    with socket.socket() as asked:
        asked.bind(("127.0.0.1", 0))
        return asked.getsockname()[1]


def recorded(trial: Trial) -> list[dict]:
    """The FP Manager's events, each with the place of the aircraft: the agent is ended, its recording exported."""
    trial.end("onboard-agent")
    files = list((trial.home / "aboard" / "recordings").glob("*.mcap"))
    trial.ask("log", "--check", *files)
    trial.ask("log", "--export", trial.home / "flight.csv", *files)
    with open(trial.home / "flight.csv", encoding="utf-8", newline="") as lines:
        return [told(row) for row in csv.DictReader(lines) if is_event(row)]


def is_event(row: dict[str, str]) -> bool:
    """Questions and answers are there, too."""
    return f'"event":"{row["event"].removeprefix("fp-manager: ")}"' in row["description"]


def told(row: dict[str, str]) -> dict:
    at = (float(row["latitude_deg"]), float(row["longitude_deg"]))
    return {**json.loads(row["description"]), "at": at}


def distance_m(one: tuple[float, float], other: tuple[float, float]) -> float:
    """On a plane: it is a few hundred metres."""
    north = (one[0] - other[0]) * 111_200
    east = (one[1] - other[1]) * 111_200 * math.cos(math.radians(one[0]))
    return math.hypot(north, east)
