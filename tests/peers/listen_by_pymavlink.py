"""Decodes whatever an autopilot says, and does nothing with it: `listen_by_pymavlink.py PORT`."""

import sys

from pymavlink import mavutil

link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{sys.argv[1]}", source_system=255)
while True:
    link.recv_match(blocking=True, timeout=1)
