"""The agent's links beside pymavlink and MAVProxy: telemetry logs, signing, and the mirror that can change nothing."""

import hashlib
import os
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from conftest import free_port, until
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mav

# parameters of ArduPlane that the agent reads for itself
READ_BY_THE_AGENT = {"WP_LOITER_RAD", "ARMING_CHECK", "MIS_RESTART", "LAND_DISARMDELAY", "FS_GCS_ENABL"}

KEY = "correct horse battery staple"


def agent(start, tmp_path, autopilot, *more):
    """A gateway alone; gives its process."""
    listen = f"tcp/127.0.0.1:{free_port()}"
    return start(
        "onboard-agent", "gateway", "--vehicle", "peer", "--listen", listen, "--autopilot", autopilot,
        "--state-dir", tmp_path / "state", *more,
    )


def logged(process):
    """What it wrote to standard error so far."""
    return Path(process.log.name).read_text(errors="replace")


def messages(link, kind, seconds):
    """Messages of this kind for so long."""
    end, found = time.monotonic() + seconds, []
    while time.monotonic() < end:
        message = link.recv_match(type=kind, blocking=True, timeout=0.5)
        if message:
            found.append(message)
    return found


def test_pymavlink_reads_the_telemetry_log_and_the_agent_plays_it(start, simulator, tmp_path):
    process = agent(start, tmp_path, f"tcp:127.0.0.1:{simulator}", "--tlog")
    folder = tmp_path / "state" / "tlogs"
    until(lambda: sum(file.stat().st_size for file in folder.glob("*.tlog")) > 20_000, 30, "a log grows")
    process.stop()
    file = next(folder.glob("*.tlog"))
    log = mavutil.mavlink_connection(str(file))
    kinds, times, senders = {}, [], set()
    while message := log.recv_match():
        assert message.get_type() != "BAD_DATA", message
        kinds[message.get_type()] = kinds.get(message.get_type(), 0) + 1
        senders.add((message.get_srcSystem(), message.get_srcComponent()))
        times.append(message._timestamp)
    assert kinds["HEARTBEAT"] > 5 and kinds["GLOBAL_POSITION_INT"] > 10, kinds
    assert {(1, 1), (1, 191)} <= senders, "what came and what was sent"
    assert all(abs(at - time.time()) < 300 for at in times) and times == sorted(times)

    # the same file as an autopilot, seen through the mirror
    port = free_port()
    watcher = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", source_system=255)
    agent(start, tmp_path / "replay", f"tlog:{file}", "--mirror", f"udpout:127.0.0.1:{port}")
    assert messages(watcher, "GLOBAL_POSITION_INT", 5), "the log is played"
    watcher.close()


class SignedAutopilot:
    """An ArduPlane that signs, or not; it notes who spoke to it and what it did not believe."""

    def __init__(self, port, key):
        self.link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=1, source_component=1)
        if key:
            self.link.setup_signing(hashlib.sha256(key.encode()).digest(), sign_outgoing=True)
        self.heard = []
        self.beats = 0
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        while not self.ended.is_set():
            self.link.mav.heartbeat_send(mav.MAV_TYPE_FIXED_WING, mav.MAV_AUTOPILOT_ARDUPILOTMEGA, 0, 10, 3)
            self.beats += 1
            message = self.link.recv_match(blocking=True, timeout=0.3)
            if message:
                self.heard.append(message)

    def kinds(self):
        return {message.get_type() for message in self.heard}

    def end(self):
        self.ended.set()
        self.thread.join()
        self.link.close()


@pytest.fixture
def autopilots():
    running = []

    def go(*arguments):
        running.append(SignedAutopilot(*arguments))
        return running[-1]

    yield go
    for autopilot in running:
        autopilot.end()


def key_file(tmp_path, key=KEY, mode=0o600):
    path = tmp_path / "key"
    path.write_text(key + "\n")
    path.chmod(mode)
    return path


def test_pymavlink_and_the_agent_believe_each_other_with_the_same_key(start, tmp_path, autopilots):
    port = free_port()
    process = agent(start, tmp_path, f"udp:127.0.0.1:{port}", "--signing-key", key_file(tmp_path))
    autopilot = autopilots(port, KEY)
    # what it asks of an autopilot that it believes
    until(lambda: {"HEARTBEAT", "COMMAND_LONG"} <= autopilot.kinds(), 20, "the agent speaks to it")
    assert all(message.get_signed() for message in autopilot.heard if message.get_type() != "BAD_DATA")
    assert autopilot.link.mav.signing.badsig_count == 0
    assert KEY not in logged(process)


@pytest.mark.parametrize("key", [None, "another key"])
def test_an_autopilot_without_the_key_is_not_spoken_to(start, tmp_path, autopilots, key):
    port = free_port()
    agent(start, tmp_path, f"udp:127.0.0.1:{port}", "--signing-key", key_file(tmp_path))
    autopilot = autopilots(port, key)
    until(lambda: autopilot.beats > 15, 30, "it says that it is there")
    assert not autopilot.heard, autopilot.kinds()


def test_a_key_that_others_can_read_is_refused(start, tmp_path):
    key = key_file(tmp_path, mode=0o644)
    process = agent(start, tmp_path, "udp:127.0.0.1:0", "--signing-key", key)
    assert process.child.wait(20) != 0
    assert "chmod 600" in logged(process) and KEY not in logged(process)


@pytest.fixture
def mirror(start, simulator, tmp_path):
    """The port of a mirror of the simulator."""
    port = free_port()
    agent(start, tmp_path, f"tcp:127.0.0.1:{simulator}", "--mirror", f"tcp-listen:127.0.0.1:{port}")
    return port


def test_pymavlink_sees_the_vehicle_in_the_mirror_and_can_change_nothing(mirror):
    link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{mirror}", source_system=255, retries=20)
    assert link.wait_heartbeat(timeout=20).autopilot == mav.MAV_AUTOPILOT_ARDUPILOTMEGA
    assert messages(link, "GLOBAL_POSITION_INT", 3)
    to = (link.target_system, link.target_component)

    link.mav.mission_request_list_send(*to)
    count = link.recv_match(type="MISSION_COUNT", blocking=True, timeout=5)
    assert count.count == 0, "nothing of ours is aboard yet"
    link.mav.param_request_list_send(*to)
    values = {value.param_id: value.param_value for value in messages(link, "PARAM_VALUE", 2)}
    assert values["SYSID_THISMAV"] == 1 and set(values) <= {"SYSID_THISMAV"} | READ_BY_THE_AGENT

    link.mav.command_long_send(*to, mav.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, 21196, 0, 0, 0, 0, 0)
    ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=5)
    assert (ack.command, ack.result) == (mav.MAV_CMD_COMPONENT_ARM_DISARM, mav.MAV_RESULT_DENIED)
    link.mav.mission_count_send(*to, 3)
    assert link.recv_match(type="MISSION_ACK", blocking=True, timeout=5).type == mav.MAV_MISSION_DENIED
    link.mav.mission_clear_all_send(*to)
    assert link.recv_match(type="MISSION_ACK", blocking=True, timeout=5).type == mav.MAV_MISSION_DENIED
    link.mav.param_set_send(*to, b"SYSID_THISMAV", 9, mav.MAV_PARAM_TYPE_INT16)
    assert link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5).param_value == 1
    link.mav.set_mode_send(link.target_system, mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 10)
    ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=5)
    assert (ack.command, ack.result) == (mav.MAV_CMD_DO_SET_MODE, mav.MAV_RESULT_DENIED)
    beats = messages(link, "HEARTBEAT", 4)
    assert beats and not any(beat.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED for beat in beats)
    assert len({beat.custom_mode for beat in beats}) == 1, "it stays in its mode"
    link.close()


def test_mavproxy_settles_on_the_mirror_and_is_refused(mirror, tmp_path):
    mavproxy = [
        sys.executable, Path(sys.executable).parent / "mavproxy.py", f"--master=tcp:127.0.0.1:{mirror}", "--nowait",
        "--retries=20", f"--state-basedir={tmp_path}", "--default-modules=wp,param,arm,mode,cmdlong,link",
    ]
    process = subprocess.Popen(
        [str(part) for part in mavproxy], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        cwd=tmp_path, env={**os.environ, "HOME": str(tmp_path), "PYTHONUNBUFFERED": "1"}, bufsize=0,
    )
    said = []

    def read():
        for line in iter(process.stdout.readline, b""):
            said.append(line.decode(errors="replace"))

    reader = threading.Thread(target=read)
    reader.start()

    def says(pattern, seconds):
        return until(lambda: re.search(pattern, "".join(said)), seconds, f"{pattern}: {''.join(said)}")

    try:
        says(r"Detected vehicle 1:1", 40)
        # the vehicle's number, and what the agent has read for itself, if that was before
        says(r"Received [1-6] parameters", 40)
        for order, answer in [("arm throttle force", "ARM_DISARM: DENIED"), ("mode AUTO", "SET_MODE: DENIED"), ("wp list", "Requesting 0 waypoints")]:
            process.stdin.write((order + "\n").encode())
            says(answer, 20)
    finally:
        # it does not end when it is asked to
        process.kill()
        process.wait(10)
        reader.join()
