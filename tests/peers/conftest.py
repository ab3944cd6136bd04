"""Starts the real binaries on loopback and ends them, for every outside client."""

import os
import re
import select
import socket
import subprocess
import time
from pathlib import Path

import pytest

# pymavlink looks at this when it is imported, by whichever test comes first
os.environ["MAVLINK20"] = "1"

BIN = Path(os.environ["LEGWORK_BIN"])
TOP = Path(os.environ["LEGWORK_TOP"])
# where the missions of pymavlink and MAVSDK begin
HOME = "36.4905,-84.2710,322,52"


class Process:
    """A binary whose lines can be waited for."""

    def __init__(self, *command, log):
        self.log = open(log, "w+b")
        self.child = subprocess.Popen(
            [str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, bufsize=0
        )

    def wait_for(self, pattern, seconds=20):
        """The first line of standard output that matches, as a match."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            ready, _, _ = select.select([self.child.stdout], [], [], 0.2)
            if not ready:
                continue
            line = self.child.stdout.readline().decode(errors="replace")
            match = re.search(pattern, line)
            if match:
                return match
            if not line and self.child.poll() is not None:
                break
        self.log.seek(0)
        raise AssertionError(f"never saw {pattern!r}; standard error: {self.log.read().decode(errors='replace')}")

    def stop(self):
        self.child.terminate()
        try:
            self.child.wait(1)
        except subprocess.TimeoutExpired:
            # in flight the agent stays until it is told twice
            self.child.terminate()
        try:
            self.child.wait(10)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self.log.close()


@pytest.fixture
def start(tmp_path):
    """Starts a binary by name; everything started is ended with the test."""
    running = []

    def go(name, *arguments):
        process = Process(BIN / name, *arguments, log=tmp_path / f"{name}-{len(running)}.log")
        running.append(process)
        return process

    yield go
    for process in reversed(running):
        process.stop()


@pytest.fixture
def simulator(start):
    """A simulator on a free TCP port, five times as fast as life; gives the port."""
    process = start("legwork-sim", "--tcp", "127.0.0.1:0", "--speed", "5", "--home", HOME)
    return int(process.wait_for(r"listening on tcp 127\.0\.0\.1:(\d+)")[1])


def free_port():
    """A TCP port that nobody uses now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(condition, seconds, what):
    """Waits until the condition gives something true, and gives that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"not within {seconds} s: {what}")
