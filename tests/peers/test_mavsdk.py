"""MAVSDK uploads to, downloads from, arms and flies the simulator."""

import asyncio

from mavsdk import System
from mavsdk.mission_raw import MissionItem

TAKE_OFF, WAYPOINT, LOITER = 22, 16, 17
GLOBAL_RELATIVE_ALT_INT = 6


def item(seq, command, lat, lon, alt):
    return MissionItem(
        seq, GLOBAL_RELATIVE_ALT_INT, command, 1 if seq == 0 else 0, 1, 0.0, 0.0, 0.0, 0.0,
        int(lat * 1e7), int(lon * 1e7), alt, 0,
    )


MISSION = [
    item(0, WAYPOINT, 36.4905, -84.2710, 0.0),
    item(1, TAKE_OFF, 36.4930, -84.2668, 60.0),
    item(2, WAYPOINT, 36.4960, -84.2620, 100.0),
    item(3, LOITER, 36.4960, -84.2760, 100.0),
]


async def first(stream, accept, seconds, what):
    """The first value of a stream that is accepted."""

    async def search():
        async for value in stream:
            if accept(value):
                return value

    try:
        return await asyncio.wait_for(search(), seconds)
    except asyncio.TimeoutError:
        raise AssertionError(f"not within {seconds} s: {what}") from None


async def fly(port):
    drone = System()
    await drone.connect(system_address=f"tcpout://127.0.0.1:{port}")
    await first(drone.core.connection_state(), lambda state: state.is_connected, 20, "connected")
    await drone.mission_raw.upload_mission(MISSION)
    back = await drone.mission_raw.download_mission()
    assert [(i.command, i.x, i.y) for i in back[1:]] == [(i.command, i.x, i.y) for i in MISSION[1:]]
    await first(drone.telemetry.health(), lambda health: health.is_global_position_ok, 30, "position known")
    await drone.action.arm()
    await drone.mission_raw.start_mission()
    await first(drone.telemetry.position(), lambda p: p.relative_altitude_m > 50.0, 60, "airborne")
    await first(drone.mission_raw.mission_progress(), lambda p: p.current >= 2, 60, "the take-off was passed")


def test_mavsdk_uploads_downloads_arms_and_flies(simulator):
    asyncio.run(fly(simulator))
