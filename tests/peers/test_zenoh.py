"""The Zenoh Python client reads telemetry, answers an intersection, and is refused a malformed command."""

import json

import cbor2
import pytest
import zenoh
from conftest import TOP, free_port, until

VEHICLE = "legwork/peer"


@pytest.fixture
def agent(start, tmp_path):
    """Simulator and agent, as their users start them; gives an open Zenoh session."""
    simulator = start("legwork-sim", "--tcp", "127.0.0.1:0", "--lockstep", "--speed", "0")
    port = simulator.wait_for(r"listening on tcp 127\.0\.0\.1:(\d+)")[1]
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    start(
        "onboard-agent", "run", "--vehicle", "peer", "--listen", endpoint, "--simulated",
        "--autopilot", f"tcp:127.0.0.1:{port}", "--state-dir", tmp_path / "state",
    )
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    session = zenoh.open(config)
    yield session
    session.close()


def decode(sample):
    return cbor2.loads(sample.payload.to_bytes())


def call(session, service, name, request):
    """One invocation in JSON; the decoded answer, or None."""
    key = f"{VEHICLE}/{service}/invocation/{name}"
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
    assert value["value"]["position"]["lat_deg"] == pytest.approx(36.49, abs=0.05)
    assert value["validity_s"] > 0
