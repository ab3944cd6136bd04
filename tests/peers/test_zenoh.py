"""The Zenoh Python client reads telemetry, answers an intersection, and is refused a malformed command."""

import json

import cbor2
import pytest
import zenoh
from conftest import TOP, free_port, until

VEHICLE = "legwork/peer"
HOME = "36.3190,-84.1730,349,52"


def opened(endpoint):
    """A session of a client, or None while the hub is not there."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    try:
        return zenoh.open(config)
    except zenoh.ZError:
        return None


def simulated(start):
    """A simulator in lockstep, as fast as it can; gives where it listens."""
    simulator = start("legwork-sim", "--tcp", "127.0.0.1:0", "--lockstep", "--speed", "0", "--home", HOME)
    return "tcp:127.0.0.1:" + simulator.wait_for(r"listening on tcp 127\.0\.0\.1:(\d+)")[1]


@pytest.fixture
def endpoint():
    """Where the agent listens."""
    return f"tcp/127.0.0.1:{free_port()}"


@pytest.fixture
def agent(start, tmp_path, endpoint):
    """Simulator and agent, as their users start them; gives an open Zenoh session."""
    start(
        "onboard-agent", "run", "--vehicle", "peer", "--listen", endpoint, "--simulated",
        "--autopilot", simulated(start), "--state-dir", tmp_path / "state",
    )
    session = until(lambda: opened(endpoint), 30, "the hub listens")
    yield session
    session.close()


def decode(sample):
    return cbor2.loads(sample.payload.to_bytes())


def call(session, service, name, request, parameters="from=peer"):
    """One invocation in JSON; the decoded answer, or None. Who asks is a parameter of the selector."""
    key = f"{VEHICLE}/{service}/invocation/{name}?{parameters}"
    payload = json.dumps(request)
    for reply in session.get(key, payload=payload, encoding=zenoh.Encoding.APPLICATION_JSON, timeout=5.0):
        body = reply.ok if reply.ok is not None else reply.err
        return json.loads(body.payload.to_string())
    return None


def latest(session, key):
    """A box that always holds the newest decoded value of a key."""
    box = {}

    def keep(sample):
        box["value"] = decode(sample)

    box["subscriber"] = session.declare_subscriber(f"{VEHICLE}/{key}", keep)
    return box


def test_it_reads_telemetry(agent):
    box = latest(agent, "gateway/variable/position")
    value = until(lambda: box.get("value"), 20, "a position")
    assert value["value"]["position"]["lat_deg"] == pytest.approx(36.319, abs=0.01)
    assert value["validity_s"] > 0


def events(session):
    """A list that grows with the FP Manager's events."""
    seen = []
    session_events = session.declare_subscriber(
        f"{VEHICLE}/fp-manager/event/events", lambda sample: seen.append(decode(sample)["value"])
    )
    return seen, session_events


def test_it_answers_an_intersection(agent):
    seen, _keep = events(agent)
    plan = (TOP / "assets/plans/fire-watch.xml").read_text()
    report = until(lambda: call(agent, "fp-manager", "propose", {"xml": plan, "seen_revision": None}), 20, "a report")
    assert report["acceptable"], report
    call(agent, "fp-manager", "command", {"command": "commit", "hash": report["hash"], "entry": None})
    call(agent, "fp-manager", "command", {"command": "start"})
    asked = until(lambda: [e for e in seen if e["event"] == "decision-requested"], 120, "a decision is asked for")[0]
    assert {option["branch"] for option in asked["options"]} == {"again", "close"}
    answer = call(agent, "fp-manager", "command", {"command": "decide", "leg": "ask", "branch": "close"})
    assert "code" not in (answer or {}), answer
    until(
        lambda: [e for e in seen if e["event"] == "leg-entered" and e["place"]["leg"] == "look"], 240, "the close look"
    )


@pytest.mark.parametrize(
    "request_", [{"command": "fly-to-the-moon"}, {"command": "decide"}, 42, "start", {"command": "start", "x": [0] * 1000}],
    ids=["unknown", "incomplete", "number", "text", "no-plan"],
)
def test_a_malformed_command_is_refused_with_a_reason(agent, request_):
    answer = until(lambda: call(agent, "fp-manager", "command", request_), 20, "an answer")
    assert answer["code"] and answer["reason"], answer


def test_garbage_on_a_variable_does_no_harm(agent):
    for _ in range(100):
        agent.put(f"{VEHICLE}/fp-manager/variable/heartbeat", b"\xff\x00garbage")
    answer = until(lambda: call(agent, "gateway", "describe", {}), 20, "an answer")
    assert answer["service"] == "gateway", answer


def test_who_does_not_say_a_name_may_only_read(agent):
    answer = until(lambda: call(agent, "fp-manager", "command", {"command": "start"}, ""), 20, "an answer")
    assert answer["code"] == "anonymous" and "from=" in answer["reason"], answer
    answer = call(agent, "fp-manager", "command", {"command": "start"}, "from=a b")
    assert answer["code"] == "bad-name", answer
    answer = call(agent, "gateway", "describe", {}, "")
    assert answer["service"] == "gateway", answer


@pytest.mark.parametrize("version, code", [("1", None), ("2", "version"), ("one", "version")])
def test_another_version_of_the_contract_is_told(agent, version, code):
    answer = until(lambda: call(agent, "gateway", "describe", {}, f"from=peer;version={version}"), 20, "an answer")
    assert answer.get("code") == code, answer
    if code:
        assert "version" in answer["reason"], answer
