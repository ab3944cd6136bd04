"""What a stranger on the network can't do by mistake: speak in a service's name, lock others out, find an open door."""

import json
import socket
import subprocess

import zenoh
from conftest import BIN, TOP, free_port, until
from test_zenoh import VEHICLE, agent, call, endpoint, events, opened  # noqa: F401 (two are fixtures)


def put(session, key, value):
    session.put(f"{VEHICLE}/{key}", json.dumps(value), encoding=zenoh.Encoding.APPLICATION_JSON)


def flying(session):
    """A plan is flown; gives the events of the FP Manager, and their subscriber."""
    seen, keep = events(session)
    plan = (TOP / "assets/plans/square.xml").read_text()
    report = until(lambda: call(session, "fp-manager", "propose", {"xml": plan, "seen_revision": None}), 20, "a report")
    call(session, "fp-manager", "command", {"command": "commit", "hash": report["hash"], "entry": None})
    call(session, "fp-manager", "command", {"command": "start"})
    until(lambda: entered(seen, "side1"), 120, "it flies")
    return seen, keep


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
    until(lambda: entered(seen, "land"), 240, "the plan is flown on")
    assert not [e for e in seen if e["event"] == "emergency-started"]
    assert all(entered(seen, leg) for leg in ["side2", "side3", "side4"]), "no leg was passed over"


def test_idle_connections_lock_nobody_out(agent, endpoint):  # noqa: F811
    host, port = endpoint.removeprefix("tcp/").rsplit(":", 1)
    idle = [socket.create_connection((host, int(port))) for _ in range(300)]
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    late = until(lambda: opened(config), 2, "a new client is let in")
    answer = until(lambda: call(late, "gateway", "describe", {}), 10, "an answer")
    assert answer["service"] == "gateway", answer
    late.close()
    for connection in idle:
        connection.close()


def test_no_door_is_opened_to_the_network_unless_asked_for_by_name():
    command = [BIN / "onboard-agent", "run", "--listen", f"tcp/0.0.0.0:{free_port()}"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    assert ended.returncode == 2, ended
    assert "--insecure" in ended.stderr and "commit plans" in ended.stderr, ended.stderr
