"""Our gateway's upload of a mission beside MAVSDK's and MAVProxy's: the same list, over the same radio with the same seeds.

Times are told, and judged by their ratio only. What is said to be aboard is read there by pymavlink, over no radio at all."""

import math
import os
import re
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pytest
from conftest import BIN, HOME, Process, until
from pymavlink import mavutil
from radio import BITS_PER_S, ONE_WAY_S, Conditions, Radio

ITEMS = int(os.environ.get("LEGWORK_ITEMS", "100"))
LOSSES = [0.0, 0.1, 0.3]
LIMIT_S = 50
HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def mission(tmp_path_factory):
    """A list as QGroundControl and MAVProxy write it; the first entry stands for home."""
    lines = ["QGC WPL 110"]
    for seq in range(ITEMS):
        place = [36.4905 + seq * 1e-3, -84.2710 + (seq % 7) * 1e-3, 450.0 + seq]
        lines.append("\t".join(str(part) for part in [seq, int(seq == 0), 0, 16, 0.0, 0.0, 0.0, 0.0, *place, 1]))
    file = tmp_path_factory.mktemp("mission") / "list.txt"
    file.write_text("\n".join(lines) + "\n")
    return file


@dataclass
class Run:
    """How one transfer went."""

    claimed: bool
    true: bool
    # until the autopilot had the list; until it was read back
    aboard_s: float | None
    verified_s: float | None
    sent_bytes: int

    def __str__(self):
        if self.aboard_s is None:
            return f"  not within {LIMIT_S} s"
        read = f", read back {self.verified_s:.1f} s" if self.verified_s else ""
        return f"{self.aboard_s:5.1f} s{read}{'' if self.claimed else ' (and it does not know)'}"


@dataclass
class Client:
    """A program that uploads: how it is started, told to begin, and what it says then."""

    command: list
    claims: str
    reads: str | None = None
    # it is told this once it has said that
    order: tuple | None = None


def clients(port, mission, folder):
    python, tools = sys.executable, Path(sys.executable).parent
    yield "gateway", Client([BIN / "examples" / "upload_list", f"tcp:127.0.0.1:{port}", mission], "verified", "verified")
    yield "MAVSDK", Client([python, HERE / "upload_by_mavsdk.py", port, mission], "uploaded", "read back")
    yield "MAVProxy", Client(
        [
            python, tools / "mavproxy.py", f"--master=tcp:127.0.0.1:{port}", "--nowait", "--retries=20",
            f"--state-basedir={folder}", "--default-modules=wp,param,link",
        ],
        "MISSION_ACK: TYPE_MISSION: ACCEPTED",
        order=(r"Received \d+ parameters", f"wp load {mission}\n"),
    )


class Told:
    """A running client and what it says."""

    def __init__(self, client, folder):
        self.child = subprocess.Popen(
            [str(part) for part in client.command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            cwd=folder, env={**os.environ, "HOME": str(folder), "PYTHONUNBUFFERED": "1", "PYTHONWARNINGS": "ignore"}, bufsize=0,
        )
        self.said = ""
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        for line in iter(self.child.stdout.readline, b""):
            self.said += line.decode(errors="replace")

    def says(self, pattern, until_s):
        """When it said so; nothing if it does not, or ends before."""
        while time.monotonic() < until_s:
            if re.search(pattern, self.said):
                return time.monotonic()
            if not self.reader.is_alive() and not re.search(pattern, self.said):
                return None
            time.sleep(0.01)
        return None

    def end(self):
        # some do not end when they are asked to
        self.child.kill()
        self.child.wait(10)
        self.reader.join()


def spoken_to(address, question):
    """What pymavlink gets as an answer, over a link of its own; nothing while the autopilot serves its last client."""
    try:
        link = mavutil.mavlink_connection(address.replace("udp:", "udpin:"), source_system=255, retries=20)
    except OSError:
        # the last client's port
        return None
    try:
        # who sends datagrams is known when it was heard
        link.wait_heartbeat(timeout=5)
        return question(link)
    except ConnectionError:
        return None
    finally:
        link.close()


def read_list(link):
    """The list that is aboard; nothing while the autopilot waits for the rest of another one."""
    link.mav.mission_request_list_send(1, 1)
    count = link.recv_match(type="MISSION_COUNT", blocking=True, timeout=2)
    if not count:
        return None
    places = []
    for seq in range(count.count):
        link.mav.mission_request_int_send(1, 1, seq)
        item = link.recv_match(type="MISSION_ITEM_INT", condition=f"MISSION_ITEM_INT.seq=={seq}", blocking=True, timeout=10)
        places.append((item.command, item.x, item.y, round(item.z)))
    # else PX4 has no time for anybody else for 5 s
    link.mav.mission_ack_send(1, 1, mavutil.mavlink.MAV_MISSION_ACCEPTED)
    return places


def clear_list(link):
    """Says whether there is none any more."""
    link.mav.mission_clear_all_send(1, 1)
    answer = link.recv_match(type="MISSION_ACK", blocking=True, timeout=2)
    return answer and answer.type == mavutil.mavlink.MAV_MISSION_ACCEPTED


def wanted(mission):
    for line in mission.read_text().splitlines()[1:]:
        _, _, _, command, *_, x, y, z, _ = (float(part) for part in line.split("\t"))
        yield int(command), round(x * 1e7), round(y * 1e7), round(z)


def is_aboard(address, mission):
    """Whether all of it is; the first entry is the autopilot's own home. MAVProxy cuts degrees off where others round them."""
    # as a tuple of one: an empty list is an answer as well
    (have,) = until(lambda: None if (places := spoken_to(address, read_list)) is None else (places,), 30, "the list is read")
    want = list(wanted(mission))
    near = all(a[0] == b[0] and abs(a[1] - b[1]) < 2 and abs(a[2] - b[2]) < 2 and a[3] == b[3] for a, b in zip(have[1:], want[1:]))
    return len(have) == len(want) and near


def simulated(start, personality):
    """Where a simulator of its own listens."""
    simulator = start("legwork-sim", "--personality", personality, "--tcp", "127.0.0.1:0", "--home", HOME)
    return "tcp:" + simulator.wait_for(r"listening on tcp (127\.0\.0\.1:\d+)")[1]


def upload(name, autopilot, conditions, mission, folder):
    radio = Radio(autopilot, conditions)
    client = dict(clients(radio.port, mission, folder))[name]
    told = Told(client, folder)
    try:
        if client.order:
            told.says(client.order[0], time.monotonic() + 30)
            told.child.stdin.write(client.order[1].encode())
        until(lambda: radio.seen.begun, 40, f"{name} begins: {told.said}")
        end = radio.seen.begun + LIMIT_S
        claimed = told.says(client.claims, end)
        read = told.says(client.reads, end) if claimed and client.reads else None
    finally:
        told.end()
        radio.close()
    begun, got = radio.seen.begun, radio.seen.aboard
    return Run(
        claimed=claimed is not None, true=is_aboard(autopilot, mission), aboard_s=got and got - begun, verified_s=read and read - begun,
        sent_bytes=radio.seen.sent_bytes,
    )


# Autopilot, loss, bits per second: the radio of a telemetry link, whose line bounds what is sent at once, and one that is only as far
# away.
NARROW = [(personality, loss, BITS_PER_S) for personality in ("arduplane", "px4") for loss in LOSSES]
WIDE = [("arduplane", 0.0, 100 * BITS_PER_S), ("px4", 0.0, 100 * BITS_PER_S)]


def compared(start, condition, mission, folder):
    """The clients under the same conditions at the same time, so that whatever else the machine does hits all of them."""
    personality, loss, bits_per_s = condition
    # MAVProxy does not answer when PX4 asks it for an entry (MISSION_REQUEST_INT)
    names = [name for name in ("gateway", "MAVSDK", "MAVProxy") if (personality, name) != ("px4", "MAVProxy")]
    conditions = Conditions(loss, duplicates=0.0 if loss == 0 else 0.02, bits_per_s=bits_per_s)
    with ThreadPoolExecutor() as pool:
        def one(name):
            own = folder / f"{name}-{personality}-{loss}-{bits_per_s}"
            own.mkdir()
            return upload(name, simulated(start, personality), conditions, mission, own)

        return dict(zip(names, pool.map(one, names)))


def told(condition, runs):
    """A line for each client, with its time beside ours."""
    personality, loss, bits_per_s = condition
    yield f"{ITEMS} items, {personality}, {bits_per_s / 1000:g} kbit/s, {2 * ONE_WAY_S * 1000:.0f} ms, {loss:.0%} lost"
    ours = runs["gateway"].aboard_s
    for name, run in runs.items():
        ratio = f"  {run.aboard_s / ours:5.1f} x" if ours and run.aboard_s else ""
        yield f"  {name:8} {run}, {run.sent_bytes / 1000:.1f} kB sent{ratio}"


@pytest.fixture(scope="module")
def results(mission, tmp_path_factory):
    """All transfers, a few conditions at a time; for the longest of them the clients only wait."""
    folder, running = tmp_path_factory.mktemp("uploads"), []

    def start(name, *arguments):
        running.append(Process(BIN / name, *arguments, log=folder / f"{name}-{len(running)}.log"))
        return running[-1]

    # those in which somebody takes all the time there is come first
    conditions = sorted(NARROW + WIDE, key=lambda condition: -condition[1])
    with ThreadPoolExecutor(3) as pool:
        runs = dict(zip(conditions, pool.map(lambda condition: compared(start, condition, mission, folder), conditions)))
    yield runs
    for process in running:
        process.stop()


def test_what_we_say_is_aboard_is(results, capsys):
    with capsys.disabled():
        print()
        for condition in NARROW + WIDE:
            print("\n".join(told(condition, results[condition])))
    ours = {condition: runs["gateway"] for condition, runs in results.items()}
    assert all(run.true for run in ours.values() if run.claimed), ours
    assert all(run.claimed for (_, loss, _), run in ours.items() if loss <= 0.1), ours


@pytest.mark.parametrize(("personality", "least"), [("arduplane", 8), ("px4", 4)])
@pytest.mark.parametrize("loss", [0.0, 0.1])
def test_we_upload_much_faster_than_mavsdk(results, personality, least, loss):
    runs = results[personality, loss, BITS_PER_S]
    # where it gives up, nothing is as slow
    theirs = runs["MAVSDK"].aboard_s or math.inf
    assert theirs >= least * runs["gateway"].aboard_s, "\n".join(told((personality, loss, BITS_PER_S), runs))


def test_we_read_back_much_faster_than_mavsdk(results):
    runs = results["arduplane", 0.0, BITS_PER_S]
    assert runs["MAVSDK"].verified_s >= 8 * runs["gateway"].verified_s, runs


@pytest.mark.skipif("LEGWORK_AUTOPILOT" not in os.environ, reason="LEGWORK_AUTOPILOT=tcp:HOST:PORT or udp:HOST:PORT says where one is")
@pytest.mark.parametrize("loss", LOSSES)
def test_on_a_real_autopilot(mission, tmp_path, capsys, loss):
    """One client after the other, for there is one autopilot; at normal speed, for the radio's seconds are the machine's."""
    autopilot, runs = os.environ["LEGWORK_AUTOPILOT"], {}
    conditions = Conditions(loss, duplicates=0.0 if loss == 0 else 0.02)
    for name in ("gateway", "MAVSDK"):
        folder = tmp_path / name
        folder.mkdir()
        # a list that is aboard already is no transfer
        until(lambda: spoken_to(autopilot, clear_list), 30, "the list is cleared")
        runs[name] = upload(name, autopilot, conditions, mission, folder)
    with capsys.disabled():
        print("\n" + "\n".join(told((autopilot, loss, BITS_PER_S), runs)))
    assert runs["gateway"].claimed and runs["gateway"].true, runs
