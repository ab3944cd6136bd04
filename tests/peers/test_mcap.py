"""An outside MCAP reader opens what the flight recorder wrote: channels, schemas, Foxglove's messages, a torn file."""

import json
import math
import subprocess

import jsonschema
import pytest
from conftest import BIN, HOME, TOP, free_port, until
from foxglove.messages import GeoJson, LocationFix, LocationFixPositionCovarianceType, Log, LogLevel, Timestamp
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap.records import Channel, Message
from test_zenoh import call, opened

CONTRACT = json.loads((TOP / "shared/usal/contract.json").read_text())


@pytest.fixture
def agent(start, simulator, tmp_path):
    """Starts the agent beside a simulator, with its recordings in a folder; gives that folder and how to start it."""

    def go(endpoint=None):
        return start(
            "onboard-agent", "run", "--vehicle", "peer", "--listen", endpoint or f"tcp/127.0.0.1:{free_port()}",
            "--autopilot", f"tcp:127.0.0.1:{simulator}", "--state-dir", tmp_path / "state",
            "--plan", TOP / "assets/plans/square.xml",
        )

    return tmp_path / "state" / "recordings", go


def streamed(data):
    """Topics of the messages that can be read from the beginning, and whether the reader came to an end."""
    channels, topics = {}, []
    from io import BytesIO

    try:
        for record in StreamReader(BytesIO(data), record_size_limit=None).records:
            if isinstance(record, Channel):
                channels[record.id] = record.topic
            elif isinstance(record, Message):
                topics.append(channels[record.channel_id])
    except (McapError, EOFError, Exception) as error:  # noqa: B014: it has an exception of its own for each kind of end
        return topics, error
    return topics, None


def recordings(folder):
    return sorted(folder.glob("*.mcap")) if folder.exists() else []


def flown(folder):
    """The bytes of a recording that has been going for a while."""
    files = recordings(folder)
    if not files:
        return None
    data = files[0].read_bytes()
    topics, _ = streamed(data)
    wanted = {"foxglove/peer/location", "foxglove/peer/plan", "foxglove/peer/log", "legwork/peer/fp-manager/variable/plan"}
    return data if wanted <= set(topics) and len(topics) > 500 else None


def test_recording_is_whole_valid_and_foxgloves(agent):
    folder, go = agent
    process = go()
    until(lambda: flown(folder), 60, "a recording with place, plan and log")
    process.stop()
    path = recordings(folder)[0]
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        counts = summary.statistics.channel_message_counts
        seen, first = {}, {}
        for schema, channel, message in reader.iter_messages():
            seen[channel.topic] = seen.get(channel.topic, 0) + 1
            value = json.loads(message.data)
            if channel.topic not in first:
                first[channel.topic] = (schema, value)
            if schema is not None:
                assert schema.encoding == "jsonschema" and channel.message_encoding == "json"
                jsonschema.validate(value, json.loads(schema.data))
    topics = {channel.topic: channel.id for channel in summary.channels.values()}
    assert {topic: counts[id] for topic, id in topics.items()} == seen
    assert summary.statistics.message_count == sum(seen.values())

    # the contract's channels carry the contract's schemas
    for service in CONTRACT:
        for said in service["primitives"]:
            topic = f"legwork/peer/{service['service']}/{said['kind']}/{said['name']}"
            if topic in first:
                assert json.loads(first[topic][0].data) == said["schema"], topic
    assert first["legwork/peer/fp-manager/invocation/plan"][1]["xml"].startswith("<")

    # Foxglove's own types take what we wrote, field by field
    schema, fix = first["foxglove/peer/location"]
    assert schema.name == "foxglove.LocationFix"
    assert fix["position_covariance_type"] == 0
    covariance = LocationFixPositionCovarianceType.Unknown
    LocationFix(**{**fix, "timestamp": Timestamp(**fix["timestamp"]), "position_covariance_type": covariance})
    assert math.hypot(fix["latitude"] - float(HOME.split(",")[0]), fix["longitude"] - float(HOME.split(",")[1])) < 0.01
    schema, line = first["foxglove/peer/log"]
    assert schema.name == "foxglove.Log"
    Log(**{**line, "timestamp": Timestamp(**line["timestamp"]), "level": LogLevel.Info})
    schema, drawing = first["foxglove/peer/plan"]
    assert schema.name == "foxglove.GeoJSON"
    GeoJson(**drawing)
    features = json.loads(drawing["geojson"])["features"]
    assert "LineString" in {feature["geometry"]["type"] for feature in features}

    # and our own command agrees
    listed = subprocess.run([BIN / "legwork", "log", "--check", "--json", path], capture_output=True, text=True, check=True)
    document = json.loads(listed.stdout)[0]
    assert document["state"] == "whole" and document["messages"] == sum(seen.values())


def of_topic(path, topic):
    """The values of a topic in a recording."""
    with path.open("rb") as file:
        return [json.loads(message.data) for _, _, message in make_reader(file).iter_messages(topics=[topic])]


def test_requests_stand_in_it_with_who_asked_and_each_plan_with_its_document(agent):
    folder, go = agent
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    process = go(endpoint)
    session = until(lambda: opened(endpoint), 30, "the hub listens")
    until(lambda: flown(folder), 60, "a recording with the first plan")
    plan = (TOP / "assets/plans/square.xml").read_text().replace('name="', 'name="Another ', 1)
    report = call(session, "fp-manager", "propose", {"xml": plan, "seen_revision": None}, "from=planner")
    assert report["acceptable"], report
    call(session, "fp-manager", "command", {"command": "commit", "hash": report["hash"], "entry": None}, "from=planner")
    assert call(session, "fp-manager", "command", {"command": "start"}, "")["code"] == "anonymous"
    # a name is a claim: whoever says so is recorded as the FP Manager
    call(session, "gateway", "describe", {}, "from=fp-manager")
    topic = "legwork/peer/fp-manager/invocation/plan"
    until(lambda: streamed(recordings(folder)[0].read_bytes())[0].count(topic) >= 2, 30, "the second plan's document")
    session.close()
    process.stop()

    path = recordings(folder)[0]
    documents = of_topic(path, topic)
    assert len({document["info"]["hash"] for document in documents}) == 2
    assert documents[-1]["info"]["hash"] == report["hash"]
    asked = [entry["value"] for entry in of_topic(path, "legwork/peer/fp-manager/event/audit")]
    commits = [a for a in asked if a["caller"] == "planner" and a["invocation"] == "command"]
    assert [a["accepted"] for a in commits] == [True], asked
    nameless = [a for a in asked if a["caller"] is None and a["invocation"] == "command"]
    assert [(a["accepted"], a["answer"]["code"]) for a in nameless] == [(False, "anonymous")], asked


def test_recording_of_the_demo_is_whole_and_holds_the_flight(tmp_path):
    command = [BIN / "legwork", "demo", "--headless", "--plan", TOP / "assets/plans/square.xml", "--report", tmp_path]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    [path] = recordings(tmp_path / "recordings")
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        topics = {channel.topic for _, channel, _ in reader.iter_messages()}
    assert {"foxglove/demo/location", "foxglove/demo/path", "foxglove/demo/plan"} <= topics
    events = [entry["value"]["event"] for entry in of_topic(path, "legwork/demo/fp-manager/event/events")]
    assert "leg-entered" in events and events.count("plan-finished") <= 1
    places = of_topic(path, "legwork/demo/simulator/variable/truth")
    times = [place["time_s"] for place in places]
    assert len(times) > 100 and times == sorted(times)
    assert max(place["value"]["altitude_amsl_m"] for place in places) - places[0]["value"]["altitude_amsl_m"] > 50


def test_torn_recording_is_read_up_to_its_tear_and_mended_by_the_next_recorder(agent, tmp_path):
    folder, go = agent
    go()
    data = until(lambda: flown(folder), 60, "a recording")
    torn = folder / "peer-20200101T000000Z-001.mcap"
    cut = len(data) * 2 // 3
    torn.write_bytes(data[:cut])
    topics, error = streamed(data[:cut])
    # how many that are depends on the machine: the first ones come with their schemas, and the plan's drawing is large
    assert error is not None and len(topics) > 20, "the outside reader comes to the tear"
    checked = subprocess.run([BIN / "legwork", "log", "--check", torn], capture_output=True, text=True)
    assert checked.returncode == 1 and "byte " in checked.stderr, checked

    # a second recorder, in a folder of its own: it mends what it finds
    state = tmp_path / "other" / "recordings"
    state.mkdir(parents=True)
    (state / torn.name).write_bytes(data[:cut])
    return_code = mend(state)
    assert return_code is None
    with (state / torn.name).open("rb") as file:
        summary = make_reader(file).get_summary()
        mended = [channel.topic for _, channel, _ in make_reader(file).iter_messages()]
    assert summary is not None and sorted(mended) == sorted(topics)


def mend(folder):
    """Has a recorder started over a folder, until the torn file in it is whole."""
    command = [BIN / "onboard-agent", "storage", "--vehicle", "other", "--connect", f"tcp/127.0.0.1:{free_port()}",
               "--state-dir", folder.parent]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        torn = next(iter(recordings(folder)))
        until(lambda: torn.read_bytes().endswith(b"\x89MCAP0\r\n"), 30, "the torn recording is mended")
    finally:
        process.terminate()
        process.wait(10)
