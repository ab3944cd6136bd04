"""The processor time that a message of telemetry costs the gateway, pymavlink and MAVProxy: the same recorded telemetry into each."""

import os
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from conftest import BIN, HOME, TOP, free_port, until
from radio import frames

os.environ["MAVLINK20"] = "1"

MESSAGES = 12_000
A_SECOND = 2000
# how long each settles, and what it does without telemetry is measured
SETTLES_S, IDLES_S = 6, 3
HEARTBEAT = 0
HERE = Path(__file__).parent
# what is measured if it is there; without optimisation it takes about three times as long
OPTIMISED = TOP / "target/release/onboard-agent"
AGENT, AT_MOST = (OPTIMISED, 1.0) if OPTIMISED.exists() else (BIN / "onboard-agent", 3.0)


def record(port):
    """So many messages of the simulator, the autopilot's heartbeats among them."""
    with socket.create_connection(("127.0.0.1", port)) as link:
        buffer, recorded = bytearray(), []
        while len(recorded) < MESSAGES:
            data = link.recv(65536)
            assert data, "the simulator hung up"
            buffer += data
            recorded += frames(buffer)
        return recorded[:MESSAGES]


def used_s(pid):
    """Processor time of all threads, to the nanosecond; threads that have ended are not in it."""
    return sum(int((task / "schedstat").read_text().split()[0]) for task in Path(f"/proc/{pid}/task").iterdir()) / 1e9


class Source:
    """Listens for one client and says to it, first heartbeats, then all that was recorded."""

    def __init__(self, recorded):
        self.recorded = recorded
        self.beat = next(data for number, _, data in recorded if number == HEARTBEAT)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.client = None
        self.ended = threading.Event()
        self.accepting = threading.Thread(target=self.accept, daemon=True)
        self.accepting.start()

    def accept(self):
        self.client, _ = self.listener.accept()
        threading.Thread(target=self.swallow, daemon=True).start()

    def swallow(self):
        try:
            while self.client.recv(65536):
                pass
        except OSError:
            pass

    def beats(self, seconds):
        for _ in range(seconds):
            self.client.sendall(self.beat)
            time.sleep(1)

    def plays(self):
        begun = time.monotonic()
        for sent, (_, _, data) in enumerate(self.recorded):
            self.client.sendall(data)
            time.sleep(max(0.0, begun + sent / A_SECOND - time.monotonic()))
        # what is still in its buffers
        time.sleep(1)
        return time.monotonic() - begun

    def close(self):
        self.listener.close()
        if self.client:
            self.client.close()


def commands(port, folder):
    python, tools = sys.executable, Path(sys.executable).parent
    link = f"tcp:127.0.0.1:{port}"
    return {
        "gateway": [
            AGENT, "gateway", "--vehicle", "peer", "--listen", f"tcp/127.0.0.1:{free_port()}", "--autopilot", link,
            "--state-dir", folder / "state",
        ],
        "pymavlink": [python, HERE / "listen_by_pymavlink.py", port],
        "MAVProxy": [
            python, tools / "mavproxy.py", f"--master={link}", "--nowait", f"--state-basedir={folder}",
        ],
    }


def cost_us(name, recorded, folder):
    """Microseconds a message, without what it does when there is none."""
    source = Source(recorded)
    child = subprocess.Popen(
        [str(part) for part in commands(source.port, folder)[name]], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL, cwd=folder, env={**os.environ, "HOME": str(folder)},
    )
    try:
        until(lambda: source.client, 30, f"{name} connects")
        source.beats(SETTLES_S)
        before = used_s(child.pid)
        source.beats(IDLES_S)
        idle_share = (used_s(child.pid) - before) / IDLES_S
        before = used_s(child.pid)
        lasted_s = source.plays()
        return (used_s(child.pid) - before - idle_share * lasted_s) / MESSAGES * 1e6
    finally:
        child.kill()
        child.wait(10)
        source.close()


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="NOT TESTED: the kernel tells no processor times")
def test_a_message_costs_the_gateway_less_than_mavproxy(start, tmp_path, capsys):
    process = start("legwork-sim", "--tcp", "127.0.0.1:0", "--speed", "50", "--home", HOME)
    recorded = record(int(process.wait_for(r"listening on tcp 127\.0\.0\.1:(\d+)")[1]))
    names = ("gateway", "pymavlink", "MAVProxy")
    with ThreadPoolExecutor() as pool:
        costs = dict(zip(names, pool.map(lambda name: cost_us(name, recorded, tmp_path), names)))
    with capsys.disabled():
        print(f"\nprocessor time of a message of telemetry ({AGENT.parent.name} build of the gateway, which also publishes it)")
        for name, cost in costs.items():
            print(f"  {name:9} {cost:6.1f} us  {cost / costs['gateway']:5.1f} x")
    assert costs["gateway"] < AT_MOST * costs["MAVProxy"], costs
