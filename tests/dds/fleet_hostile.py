#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A robot on a network with one that lies, floods and talks nonsense: Fast DDS says what is put together here.

Usage: fleet_hostile.py SEQLOOP FAST_END
"""
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds import ros  # noqa: E402
from dds.fleet import SIZE, Robot, drive, expect, loops, way  # noqa: E402

FRAMES = 1200
SECOND = 1_000_000_000


def about(robot: str, describer: str = "descriptors", place_bytes: int = SIZE) -> tuple:
    return robot, "today", "int8 euclidean raw", describer, SIZE, place_bytes


def place(session: int, frame: int, time_ns: int, who: tuple | None = None, content: bytes = bytes(SIZE),
          visit: tuple | None = None) -> bytes:
    """As platform/dds/idl/fleet.idl."""
    cdr = ros.Cdr().put("q", session).put("Q", frame).put("q", time_ns).put("I", 0 if who is None else 1)
    if who is not None:
        for text in who[:4]:
            cdr.text(text)
        cdr.put("I", who[4]).put("I", who[5])
    cdr.octets(content).put("I", 0 if visit is None else 1)
    if visit is not None:
        cdr.put("q", visit[0]).put("Q", visit[1])
    return cdr.put("I", 0).message()


def attacks() -> list[bytes]:
    names = [about(name) for name in ("liar", "flood", "back", "alien", "far", "\x1b[2Jevil")]
    said = [place(1000 + i, 0, 10 * SECOND, who) for i, who in enumerate(names) if who[0] != "alien"]
    said += [place(1000, 1, 11 * SECOND, content=bytes(100_000))]
    said += [place(1002, 1, 5 * SECOND)]
    said += [place(1003, 0, 0, about("alien", "another model")), place(1003, 1, 1)]
    said += [place(1004, 2**40, 11 * SECOND), place(1004, 2**64 - 1, 12 * SECOND)]
    said += [place(1005, 0, 0, content=b"", visit=visit) for visit in ((1005, 0), (77, 5), (1001, 2**63))]
    # What is no message of this type: cut off, and lengths that are not there.
    whole = place(1006, 0, 0, about("cut"))
    said += [whole[:end] for end in (12, 20, 28, 33, 60, len(whole) - 4)]
    said += [whole[:28] + struct.pack("<I", 2**32 - 1) + whole[32:], whole[:28] + struct.pack("<I", 2) + whole[32:]]
    # Twice as many as it takes to be called a flood: a busy machine loses some.
    said += [place(1001, frame, 10 * SECOND) for frame in range(1, 4100)]
    return said


def say(fast_end: str, messages: list[bytes]) -> int:
    """Two thousand a second."""
    evil = subprocess.Popen([fast_end, "publish", "seqloop_fleet/places", "seqloop_fleet::Place", "reliable", "test"],
                            stdin=subprocess.PIPE, env=ros.environment())
    evil.communicate(b"".join(struct.pack("<II", len(message), 500 * i) + message
                              for i, message in enumerate(messages)), timeout=100)
    return evil.returncode


def fresh_keeper(seqloop: str, fast_end: str, work: pathlib.Path) -> None:
    """A keeper without a file hears first of places that no map can have."""
    said = work / "keeper.said"
    with said.open("w") as words:
        keeper = subprocess.Popen([seqloop, "keep", "--map", work / "kept.seqloop", "--fleet", "test"], stderr=words,
                                  env=ros.environment())
    names = [about("nothing", place_bytes=0), about("huge", place_bytes=2**26 + 1), about("huge", place_bytes=2**32 - 1),
             about("good")]
    expect(say(fast_end, [place(1000 + i, frame, 10 * SECOND, who, b"" if who[5] == 0 else bytes(SIZE))
                          for i, who in enumerate(names) for frame in range(3)]) == 0, "all of it was said")
    time.sleep(1.0)
    expect(keeper.poll() is None, f"the keeper goes on: {said.read_text()}")
    keeper.send_signal(signal.SIGTERM)
    words = said.read_text() if keeper.wait(timeout=60) == 0 else "it failed"
    expect(words.count("robot 'nothing', session 'today': it says 0 bytes a place, and a map has 1 to 67108864: none") == 1
           and words.count(" bytes a place") == 1, f"it says once that such places cannot be: {words}")
    expect("3 places of 1 session are kept" in words, "and keeps those that can")


def main(seqloop: str, fast_end: str, work: pathlib.Path) -> None:
    fresh_keeper(seqloop, fast_end, work)
    seen = way(FRAMES)
    anna = Robot(seqloop, work, "anna", drive(work, "anna", seen, 1), "anna.seqloop")
    time.sleep(1.0)
    bert = Robot(seqloop, work, "bert", drive(work, "bert", seen, 2), "bert.seqloop")
    time.sleep(1.0)  # both hear it from the first
    expect(say(fast_end, attacks()) == 0, "all of it was said")
    lines = {robot.name: robot.end() for robot in (anna, bert)}
    found = len(loops(lines["bert"], "anna"))
    expect(found > FRAMES / 4, f"bert finds loops with anna, who is a second ahead: {found}")
    for robot, other in ((anna, bert), (bert, anna)):
        words = robot.said.read_text()
        for name, why in (("liar", f"it says {SIZE} bytes a place, and sends 100000"), ("back", "its time goes back"),
                          ("flood", "it has more than 1000 places a second of its drive"),
                          ("alien", "none is taken in")):
            said = [line for line in words.splitlines() if f"robot '{name}'" in line]
            expect(len(said) == 1 and why in said[0], f"{robot.name} says once of {name}: {why}")
        expect("\x1b" not in words, "and prints no escapes")
        places, sessions = robot.counted()
        expect(sessions == 6 and other.told() <= places <= other.told() + 2100,
               f"what it takes in of them is bounded: {places} places of {sessions} sessions")
        frames = sum(1 + line["dropped"] for line in lines[robot.name] if line["newest"] is not None)
        expect(frames > 0.95 * FRAMES, f"it drives on: {frames} frames")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], sys.argv[2], pathlib.Path(folder))
