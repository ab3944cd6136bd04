"""What a stranger on the network can't do by mistake: speak in a service's name, lock others out, find an open door."""

import itertools
import json
import socket
import subprocess

import zenoh
from conftest import BIN, TOP, free_port, until
from test_links import logged
from test_zenoh import (  # noqa: F401 (two are fixtures)
    VEHICLE, agent, call, endpoint, events, latest, opened, simulated,
)

SQUARE = (TOP / "assets/plans/square.xml").read_text()


def put(session, key, value):
    session.put(f"{VEHICLE}/{key}", json.dumps(value), encoding=zenoh.Encoding.APPLICATION_JSON)


def committed(session, plan=SQUARE):
    """A plan is active; gives the events of the FP Manager, and their subscriber."""
    seen, keep = events(session)
    report = until(lambda: call(session, "fp-manager", "propose", {"xml": plan, "seen_revision": None}), 20, "a report")
    call(session, "fp-manager", "command", {"command": "commit", "hash": report["hash"], "entry": None})
    return seen, keep


def flying(session):
    """A plan is flown; gives the same."""
    seen, keep = committed(session)
    call(session, "fp-manager", "command", {"command": "start"})
    until(lambda: entered(seen, "side1"), 120, "it flies")
    return seen, keep


def alarms(status):
    """The alarms of the newest status, by their names."""
    return {alarm["id"]: alarm for alarm in status.get("value", {"value": {"alarms": []}})["value"]["alarms"]}


def state(status):
    """What the gateway was doing by the newest status."""
    return status["value"]["value"]["state"] if "value" in status else None


def entered(seen, leg):
    return [e for e in seen if e["event"] == "leg-entered" and e["place"]["leg"] == leg]


def test_events_in_the_gateways_name_start_no_emergency_and_move_no_plan_on(agent):  # noqa: F811
    seen, _keep = flying(agent)
    alarm = {"id": "engine-out", "severity": "warning", "source": "engine", "advice": "", "cause": "engine"}
    stamped = {"time_s": 1e9, "validity_s": 1e9}
    put(agent, "gateway/event/events", {**stamped, "value": {"event": "alarm-raised", **alarm}})
    put(agent, "gateway/event/events", {**stamped, "value": {"event": "progress", "current": None, "taken": 9999}})
    told = until(lambda: [e for e in seen if e["event"] == "not-granted" and e["request"] == "report"], 20, "it is told")
    assert "does not count" in told[0]["reason"]
    for _ in range(10):
        put(agent, "gateway/event/events", {**stamped, "value": {"event": "progress", "current": None, "taken": 9999}})
    until(lambda: [e for e in seen if e.get("reason", "").endswith("since the join: at least 10)")], 20, "and counted")
    until(lambda: entered(seen, "land"), 240, "the plan is flown on")
    assert not [e for e in seen if e["event"] == "emergency-started"]
    assert all(entered(seen, leg) for leg in ["side2", "side3", "side4"]), "no leg was passed over"


def test_idle_connections_lock_nobody_out(agent, endpoint):  # noqa: F811
    host, port = endpoint.removeprefix("tcp/").rsplit(":", 1)
    idle = [socket.create_connection((host, int(port))) for _ in range(300)]
    late = until(lambda: opened(endpoint), 2, "a new client is let in")
    answer = until(lambda: call(late, "gateway", "describe", {}), 10, "an answer")
    assert answer["service"] == "gateway", answer
    box = latest(late, "gateway/variable/state")
    until(lambda: alarms(box).get("port-flooded"), 20, "and what goes on is told")
    late.close()
    for connection in idle:
        connection.close()


def test_no_door_is_opened_to_the_network_unless_asked_for_by_name():
    command = [BIN / "onboard-agent", "run", "--listen", f"tcp/0.0.0.0:{free_port()}"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    assert ended.returncode == 2, ended
    assert "--insecure" in ended.stderr and "commit plans" in ended.stderr, ended.stderr


def test_no_configuration_opens_a_door_that_was_not_asked_for(tmp_path):
    config = tmp_path / "agent.toml"
    config.write_text('listen = "tcp/[::]:7447"\n')
    command = [BIN / "onboard-agent", "run", "--config", config]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    assert ended.returncode == 2 and "--insecure" in ended.stderr, ended


def test_an_open_door_is_told_in_log_and_status(start, simulator, tmp_path):
    # not reached from outside, but not known as loopback either
    door = f"tcp/[::ffff:127.0.0.1]:{free_port()}"
    process = start(
        "onboard-agent", "run", "--vehicle", "peer", "--insecure", "--listen", door,
        "--autopilot", f"tcp:127.0.0.1:{simulator}", "--state-dir", tmp_path / "state",
    )
    session = until(lambda: opened(door), 30, "the hub listens")
    box = latest(session, "gateway/variable/state")
    alarm = until(lambda: alarms(box).get("exposed"), 20, "the alarm")
    assert "commit plans" in alarm["advice"] and "every command" in alarm["advice"], alarm
    session.close()
    log = logged(process)
    assert "without protection" in log and "commit plans" in log, log


def test_a_strangers_heartbeats_do_not_hide_a_dead_fp_manager(start, endpoint, tmp_path):
    common = ["--vehicle", "peer", "--listen", endpoint, "--simulated", "--state-dir", tmp_path / "state"]
    start("onboard-agent", "gateway", *common, "--autopilot", simulated(start))
    session = until(lambda: opened(endpoint), 30, "the hub listens")
    process = start("onboard-agent", "fp-manager", *common)
    flying(session)
    box = latest(session, "gateway/variable/state")
    until(lambda: state(box) == "nav", 60, "the plan is flown")
    for caller in ("peer", "fp-manager"):
        joined = call(session, "gateway", "join", {"last_token": 1, "plan": None}, f"from={caller}")
        assert joined.get("accepted") is not True, "who joins would make everybody's heartbeats count"
    process.child.kill()
    process.child.wait()
    beats = itertools.count(10**9)

    def safe():
        """Each time a heartbeat in the name of the FP Manager, always the newest."""
        beat = {"time_s": 1e9, "validity_s": 1e9, "value": {"count": next(beats), "plan": None}}
        put(session, "fp-manager/variable/heartbeat", beat)
        return state(box).startswith("safe")

    until(safe, 60, "Safe mode, in spite of the heartbeats")
    session.close()


def test_safe_mode_keeps_a_runway_in_flight_and_is_missed_on_the_ground(agent):  # noqa: F811
    def set_runways(runways):
        return call(agent, "gateway", "request", {"request": "set-runways", "runways": runways})

    box = latest(agent, "gateway/variable/state")
    far_away = {
        "id": "far", "threshold": {"lat_deg": 46.0, "lon_deg": -84.0}, "elevation_amsl_m": 300.0, "heading_deg": 90.0,
        "length_m": 900.0, "priority": 1,
    }
    seen, _keep = committed(agent)
    # the plan's own may be on their way, and are set once more then
    until(lambda: "code" not in (set_runways([]) or {}) and alarms(box).get("no-runway-stored"), 60, "done and warned of")
    call(agent, "fp-manager", "command", {"command": "start"})
    until(lambda: entered(seen, "side1"), 120, "it flies")
    assert "no-runway-stored" not in alarms(box), "start sets what the plan names"
    for runways in [[], [far_away]]:
        refused = set_runways(runways)
        assert "within reach" in refused["reason"], refused
    assert "no-runway-stored" not in alarms(box) and "no-safe-runway" not in alarms(box)


def test_a_name_that_is_given_is_held_to_the_writers_of_a_variable(agent):  # noqa: F811
    variable = '<variable name="fire_radius" type="number" initial="200" writers="camera"/>'
    committed(agent, SQUARE.replace("<mainPlan", f"<variables>{variable}</variables><mainPlan", 1))
    write = {"command": "set-variable", "name": "fire_radius", "value": {"type": "number", "value": 300.0}}

    def answer(parameters, **change):
        return call(agent, "fp-manager", "command", {**write, **change}, parameters) or {}

    assert answer("")["code"] == "anonymous"
    assert answer("from=peer")["code"] == "not-a-writer"
    misspelt = answer("from=camera", name="fire_radios")
    assert misspelt["reason"].endswith("did you mean `fire_radius`?"), misspelt
    # a name is only a claim: whoever says it may write (see the README)
    assert "code" not in answer("from=camera")
