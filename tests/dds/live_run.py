# SPDX-License-Identifier: MIT
"""A run of the program on a topic, for tests."""
import json
import pathlib
import signal
import subprocess
import sys
import time

from dds import ros

TOPIC = "/camera/image_raw"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
SECOND = 1_000_000_000


def expect(what: bool, told: str) -> None:
    if not what:
        sys.exit("not so: " + told)
    print(told, flush=True)


def stamp(frame: int, rate: float) -> int:
    return ros.START_S * SECOND + int(frame * SECOND / rate)


class Run:
    """`seqloop run` on a topic; its lines are in a file."""

    def __init__(self, seqloop: str, work: pathlib.Path, *more: object) -> None:
        self.lines, self.said = work / "lines.jsonl", work / "said"
        with self.said.open("w") as said:
            self.process = subprocess.Popen(
                [str(word) for word in (seqloop, "run", "--source", "ros:" + TOPIC, "--out", self.lines,
                                        "--summary", work / "summary.json", *more)],
                stderr=said, env=ros.environment())
        self.summary = work / "summary.json"
        # What comes before the loop runs counts for nothing; that it does, its first lines tell: nobody publishes.
        self.wait_until(lambda lines: lines)

    def so_far(self) -> list[dict]:
        parts = list(self.lines.parent.glob(".lines.jsonl*"))
        text = parts[0].read_text() if parts else ""
        return [json.loads(line) for line in text[:text.rfind("\n") + 1].splitlines()]

    def wait_until(self, holds, at_most_s: float = 120.0) -> bool:
        """Until something holds of its lines. @return whether it does"""
        end = time.monotonic() + at_most_s
        while not holds(self.so_far()):
            if self.process.poll() is not None:
                sys.exit(f"run ended: {self.said.read_text()}")
            if time.monotonic() > end:
                return False
            time.sleep(0.05)
        return True

    def wait_until_it_hears(self) -> None:
        """Until it has found the publisher: it says then that no picture comes, not that nobody publishes."""
        known = len(self.so_far())
        if not self.wait_until(lambda lines: any("no picture on" in line.get("fault", "") for line in lines[known:])):
            sys.exit("it has not found the publisher")

    def wait_until_taken(self, sent: int) -> None:
        """Until the last of so many messages is there; not for ever, since it may be lost."""
        self.wait_until(lambda lines: (frames := frames_of(lines)) and frames[-1]["sequence"] >= sent - 1, 10.0)

    def end(self, expected: int = 0) -> list[dict]:
        """@param expected the exit code. @return the lines"""
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait()
        if code != expected:
            sys.exit(f"run ended with {code}: {self.said.read_text()}")
        return [json.loads(line) for line in self.lines.read_text().splitlines()]

    def captured(self) -> dict:
        return json.loads(self.summary.read_text())["captured"]


def frames_of(lines: list[dict]) -> list[dict]:
    return [line for line in lines if line["status"] not in ("no_frame", "ended")]


def accepted(lines: list[dict]) -> list[dict]:
    return [answer for line in lines for answer in line["answers"] if answer["status"] == "match"]


def heard(run: Run, fast_end: pathlib.Path, kind: str, reliable: bool = True,
          before: tuple = ()) -> tuple[ros.Publisher, float]:
    """A publisher that the run hears. @return it, and seconds after which the first message may be due"""
    publisher = ros.Publisher(fast_end, TOPIC, kind, reliable, before)
    publisher.wait_until_heard()
    run.wait_until_it_hears()
    return publisher, time.time() - publisher.start_ns / SECOND + 0.1


def drive(run: Run, fast_end: pathlib.Path, pictures: list[pathlib.Path]) -> list[dict]:
    """Shows pictures to a run, 20 a second. @return its lines"""
    publisher, delay = heard(run, fast_end, COMPRESSED)
    for i, picture in enumerate(pictures):
        publisher.send(ros.compressed_image(stamp(i, 20), picture.read_bytes()), delay + i / 20)
    expect(publisher.end() == "", "Fast DDS published all")
    run.wait_until_taken(len(pictures))
    return run.end()
