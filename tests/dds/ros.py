# SPDX-License-Identifier: MIT
"""Messages of ROS 2 put together by hand, and the ends of its wire, for tests."""
import fcntl
import functools
import os
import pathlib
import struct
import subprocess
import tempfile
import time

START_S = 1_700_000_000  # of stamps


@functools.cache
def own_domain() -> tuple[int, object]:
    """One that no other test talks in, and the lock on it, which this process holds as long as it lives. Higher ones
    have ports that the system gives to anybody."""
    domains = 98
    for i in range(domains):
        domain = 1 + (os.getpid() + i) % domains
        lock = open(pathlib.Path(tempfile.gettempdir()) / f"seqloop-test-domain-{domain}", "a", encoding="ascii")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return domain, lock
        except BlockingIOError:
            lock.close()
    raise RuntimeError("all domains are taken by other tests")


def environment() -> dict:
    """Of programs that find each other, and nobody else: on the loopback interface, in a domain of
    this process's own."""
    lo = ('<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="true"/>'
          "</Interfaces></General></Domain></CycloneDDS>")
    return {**os.environ, "CYCLONEDDS_URI": lo, "ROS_DOMAIN_ID": str(own_domain()[0]),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "", "ROS_LOCALHOST_ONLY": ""}


class Cdr:
    """CDR as the OMG's document has it: little-endian, values at multiples of their size."""

    def __init__(self) -> None:
        self.body = b""

    def put(self, kind: str, value: float) -> "Cdr":
        size = struct.calcsize("<" + kind)
        self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, words: str) -> "Cdr":
        return self.octets(words.encode() + b"\0")

    def octets(self, data: bytes) -> "Cdr":
        self.put("I", len(data))
        self.body += data
        return self

    def header(self, stamp_ns: int) -> "Cdr":
        self.put("i", stamp_ns // 1_000_000_000).put("I", stamp_ns % 1_000_000_000)
        return self.text("camera")

    def message(self) -> bytes:
        return b"\0\1\0\0" + self.body


def image(stamp_ns: int, width: int, height: int, encoding: str, step: int, data: bytes) -> bytes:
    cdr = Cdr().header(stamp_ns).put("I", height).put("I", width).text(encoding)
    return cdr.put("B", 0).put("I", step).octets(data).message()


def compressed_image(stamp_ns: int, data: bytes) -> bytes:
    return Cdr().header(stamp_ns).text("jpeg").octets(data).message()


def odometry(stamp_ns: int, x: float, y: float, orientation: tuple) -> bytes:
    cdr = Cdr().header(stamp_ns).text("base_link")
    for value in (x, y, 0.0, *orientation, *[0.0] * 36, *[0.0] * 6, *[0.0] * 36):
        cdr.put("d", value)
    return cdr.message()


class Publisher:
    """Fast DDS as a publisher of messages that are due at times, in seconds after the first."""

    def __init__(self, fast_end: pathlib.Path, topic: str, kind: str, reliable: bool = True,
                 before: tuple = ()) -> None:
        """`before`: a command that starts it."""
        package, name = kind.split("/msg/")
        self.process = subprocess.Popen(
            [*before, fast_end, "publish", "rt" + topic, f"{package}::msg::dds_::{name}_",
             "reliable" if reliable else "best_effort"],
            stdin=subprocess.PIPE, stderr=subprocess.PIPE, env=environment())

    def wait_until_heard(self) -> None:
        line = self.process.stderr.readline()
        assert line == b"heard\n", line
        self.start_ns = time.time_ns()  # from which on it counts when messages are due

    def send(self, message: bytes, due_s: float = 0.0) -> None:
        self.process.stdin.write(struct.pack("<II", len(message), int(due_s * 1e6)) + message)
        self.process.stdin.flush()

    def end(self) -> str:
        """What it had to say."""
        self.process.stdin.close()
        said = self.process.stderr.read().decode()
        self.process.wait()
        return said

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()


class Listener:
    """Fast DDS as a subscriber."""

    def __init__(self, fast_end: pathlib.Path, topic: str, kind: str, reliable: bool = True) -> None:
        package, name = kind.split("/msg/")
        self.process = subprocess.Popen(
            [fast_end, "listen", "rt" + topic, f"{package}::msg::dds_::{name}_",
             "reliable" if reliable else "best_effort"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment())
        assert self.process.stderr.readline() == b"listening\n"

    def wait_until_heard(self) -> None:
        """Returns when it has found who publishes."""
        assert self.process.stderr.readline() == b"heard\n"

    def messages(self) -> list[bytes]:
        """All that came until now; ends it."""
        data = self.process.communicate()[0]
        found = []
        while len(data) >= 8:
            size = struct.unpack_from("<I", data)[0]
            found.append(data[8:8 + size])
            data = data[8 + size:]
        return found
