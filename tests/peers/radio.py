"""A narrow radio between a client and the simulator: it loses and doubles frames by a seed, and takes its time for each byte."""

import queue
import random
import socket
import threading
import time
from dataclasses import dataclass, field

# What a telemetry radio is set to; a byte has a start bit and a stop bit
BITS_PER_S = 57_600
BITS_A_BYTE = 10
ONE_WAY_S = 0.05
# What would wait longer before the line has no room in the radio
LATEST_S = 1.0

MISSION_COUNT, MISSION_ACK = 44, 47
ACCEPTED = 0


@dataclass
class Conditions:
    """What the radio does to frames; the same seed does the same to both directions of every run."""

    loss: float
    duplicates: float = 0.02
    bits_per_s: float = BITS_PER_S
    seed: int = 1


def frames(buffer):
    """Takes the whole MAVLink frames out of a buffer; gives their number of message, payload and bytes."""
    while buffer:
        if buffer[0] == 0xFD and len(buffer) >= 10:
            size = 12 + buffer[1] + (13 if buffer[2] & 1 else 0)
            number, payload = int.from_bytes(buffer[7:10], "little"), slice(10, 10 + buffer[1])
        elif buffer[0] == 0xFE and len(buffer) >= 6:
            size = 8 + buffer[1]
            number, payload = buffer[5], slice(6, 6 + buffer[1])
        elif buffer[0] in (0xFD, 0xFE):
            return
        else:
            del buffer[0]
            continue
        if len(buffer) < size:
            return
        yield number, bytes(buffer[payload]), bytes(buffer[:size])
        del buffer[:size]


@dataclass
class Seen:
    """What a transfer looks like from the middle."""

    begun: float | None = None
    aboard: float | None = None
    sent_bytes: int = 0
    lock: threading.Lock = field(default_factory=threading.Lock)

    def from_client(self, number, data):
        with self.lock:
            if number == MISSION_COUNT and self.begun is None:
                self.begun = time.monotonic()
            if self.begun is not None:
                self.sent_bytes += len(data)

    def from_autopilot(self, number, payload):
        """The autopilot has taken the whole list, whether or not its answer arrives. Zeros at the end of a payload may be cut."""
        with self.lock:
            if number == MISSION_ACK and self.begun and self.aboard is None and payload.ljust(3, b"\0")[2] == ACCEPTED:
                self.aboard = time.monotonic()


class Datagrams:
    """A socket that hears whoever sends datagrams to a port, and answers whom it heard last."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        # else the thread that listens would keep the port for as long as nothing comes
        self.socket.settimeout(0.2)
        self.peer = None

    def recv(self, size):
        while True:
            try:
                data, self.peer = self.socket.recvfrom(size)
                return data
            except TimeoutError:
                pass

    def sendall(self, data):
        if self.peer:
            self.socket.sendto(data, self.peer)

    def shutdown(self, how):
        self.socket.shutdown(how)

    def close(self):
        self.socket.close()


def connect(address):
    """To an autopilot at `tcp:HOST:PORT`, or to one that sends datagrams to `udp:HOST:PORT`."""
    kind, host, port = address.split(":")
    if kind == "udp":
        return Datagrams(int(port))
    far = socket.create_connection((host, int(port)))
    far.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return far


class Radio:
    """Listens for one client, and carries its frames to and from the autopilot at an address."""

    def __init__(self, autopilot, conditions):
        self.conditions = conditions
        self.seen = Seen()
        self.autopilot = autopilot
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.ended = threading.Event()
        self.sockets = []
        self.threads = [threading.Thread(target=self.run, daemon=True)]
        self.threads[0].start()

    def run(self):
        try:
            near, _ = self.listener.accept()
        except OSError:
            return
        near.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        far = connect(self.autopilot)
        self.sockets = [near, far]
        self.carry(near, far, self.conditions.seed, lambda number, _, data: self.seen.from_client(number, data))
        self.carry(far, near, self.conditions.seed + 1, lambda number, payload, _: self.seen.from_autopilot(number, payload))

    def carry(self, source, target, seed, hear):
        waiting = queue.Queue()
        for work in (lambda: self.take(source, waiting, seed, hear), lambda: self.give(target, waiting)):
            thread = threading.Thread(target=work, daemon=True)
            self.threads.append(thread)
            thread.start()

    def take(self, source, waiting, seed, hear):
        dice, free_at, buffer = random.Random(seed), 0.0, bytearray()
        while data := self.receive(source):
            buffer += data
            for number, payload, frame in frames(buffer):
                hear(number, payload, frame)
                # lost on the air: it takes its time all the same
                passed_at = max(free_at, time.monotonic()) + len(frame) * BITS_A_BYTE / self.conditions.bits_per_s
                if passed_at > time.monotonic() + LATEST_S:
                    continue
                free_at = passed_at
                lost, twice = dice.random() < self.conditions.loss, dice.random() < self.conditions.duplicates
                for _ in range(0 if lost else 2 if twice else 1):
                    waiting.put((free_at + ONE_WAY_S, frame))
        waiting.put(None)

    def receive(self, source):
        try:
            return source.recv(4096)
        except OSError:
            return b""

    def give(self, target, waiting):
        while entry := waiting.get():
            due, frame = entry
            time.sleep(max(0.0, due - time.monotonic()))
            try:
                target.sendall(frame)
            except OSError:
                return

    def close(self):
        self.listener.close()
        for end in self.sockets:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            end.close()
