"""pymavlink uploads to, downloads from, arms and flies the simulator."""

from conftest import until
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mav

HOME = (36.4905, -84.2710)
MISSION = [
    (mav.MAV_CMD_NAV_WAYPOINT, *HOME, 0.0),
    (mav.MAV_CMD_NAV_TAKEOFF, 36.4930, -84.2668, 60.0),
    (mav.MAV_CMD_NAV_WAYPOINT, 36.4960, -84.2620, 100.0),
    (mav.MAV_CMD_NAV_WAYPOINT, 36.5000, -84.2660, 100.0),
    (mav.MAV_CMD_NAV_LOITER_UNLIM, 36.4960, -84.2760, 100.0),
]


def connect(port):
    link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}", source_system=255)
    assert link.wait_heartbeat(timeout=10), "no heartbeat"
    return link


def upload(link, mission):
    link.mav.mission_count_send(link.target_system, link.target_component, len(mission))
    while True:
        message = link.recv_match(type=["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"], blocking=True, timeout=5)
        assert message, "the upload stopped"
        if message.get_type() == "MISSION_ACK":
            assert message.type == mav.MAV_MISSION_ACCEPTED
            return
        command, lat, lon, alt = mission[message.seq]
        link.mav.mission_item_int_send(
            link.target_system, link.target_component, message.seq, mav.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, command,
            0, 1, 0, 0, 0, 0, int(lat * 1e7), int(lon * 1e7), alt,
        )


def download(link):
    link.mav.mission_request_list_send(link.target_system, link.target_component)
    count = link.recv_match(type="MISSION_COUNT", blocking=True, timeout=5).count
    items = []
    for seq in range(count):
        link.mav.mission_request_int_send(link.target_system, link.target_component, seq)
        items.append(link.recv_match(type="MISSION_ITEM_INT", condition=f"MISSION_ITEM_INT.seq=={seq}", blocking=True, timeout=5))
    return items


def test_mission_comes_back_as_it_was_sent(simulator):
    link = connect(simulator)
    upload(link, MISSION)
    items = download(link)
    assert len(items) == len(MISSION)
    for item, (command, lat, lon, alt) in list(zip(items, MISSION))[1:]:  # item 0 becomes home
        assert item.command == command
        assert abs(item.x - lat * 1e7) <= 1 and abs(item.y - lon * 1e7) <= 1
        assert abs(item.z - alt) < 0.01


def test_it_arms_takes_off_and_flies_the_mission(simulator):
    link = connect(simulator)
    upload(link, MISSION)
    link.mav.request_data_stream_send(link.target_system, link.target_component, mav.MAV_DATA_STREAM_ALL, 10, 1)
    link.set_mode_auto()

    def armed():
        link.mav.command_long_send(
            link.target_system, link.target_component, mav.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0
        )
        heartbeat = link.recv_match(type="HEARTBEAT", blocking=True, timeout=1)
        return heartbeat and heartbeat.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED

    until(armed, 20, "armed")

    def last_item():
        message = link.recv_match(type="MISSION_CURRENT", blocking=True, timeout=1)
        return message and message.seq == len(MISSION) - 1

    until(last_item, 90, "the last item was reached")
    position = link.recv_match(type="GLOBAL_POSITION_INT", blocking=True, timeout=5)
    assert 60 < position.relative_alt / 1000 < 130


def test_garbage_before_a_message_does_no_harm(simulator):
    link = connect(simulator)
    link.port.sendall(bytes(range(256)) * 40 + b"\xfd\xff\x00\x00")
    for _ in range(20):  # the last garbage promises a frame of 255 bytes: let it end
        link.mav.heartbeat_send(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0)
    upload(link, MISSION)
    assert len(download(link)) == len(MISSION)
