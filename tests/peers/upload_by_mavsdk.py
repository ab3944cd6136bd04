"""Uploads a list of waypoints by MAVSDK and reads it back, as a program of its own: `upload_by_mavsdk.py PORT FILE`."""

import asyncio
import sys
from pathlib import Path

from conftest import free_port
from mavsdk import System
from mavsdk.mission_raw import MissionItem


def items(file):
    for seq, line in enumerate(Path(file).read_text().splitlines()[1:]):
        _, _, frame, command, *rest = (float(part) for part in line.split("\t"))
        *params, x, y, z, _ = rest
        yield MissionItem(seq, int(frame), int(command), int(seq == 0), 1, *params, round(x * 1e7), round(y * 1e7), z, 0)


async def connected(drone):
    async for state in drone.core.connection_state():
        if state.is_connected:
            return


async def upload(port, file):
    drone = System(port=free_port())
    await drone.connect(system_address=f"tcpout://127.0.0.1:{port}")
    await connected(drone)
    await drone.mission_raw.upload_mission(list(items(file)))
    print("uploaded", flush=True)
    await drone.mission_raw.download_mission()
    print("read back", flush=True)


asyncio.run(upload(*sys.argv[1:]))
