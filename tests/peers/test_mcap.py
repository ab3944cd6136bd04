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

CONTRACT = json.loads((TOP / "shared/usal/contract.json").read_text())


@pytest.fixture
def agent(start, simulator, tmp_path):
    """Starts the agent beside a simulator, with its recordings in a folder; gives that folder and how to start it."""

    def go():
        return start(
            "onboard-agent", "run", "--vehicle", "peer", "--listen", f"tcp/127.0.0.1:{free_port()}",
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


def test_killed_recorder_leaves_what_can_be_read_and_the_next_one_mends_it(agent, tmp_path):
    folder, go = agent
    go()
    data = until(lambda: flown(folder), 60, "a recording")
    torn = folder / "peer-20200101T000000Z-001.mcap"
    cut = len(data) * 2 // 3
    torn.write_bytes(data[:cut])
    topics, error = streamed(data[:cut])
    assert error is not None and len(topics) > 100, "the outside reader comes to the tear"
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
