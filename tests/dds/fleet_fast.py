#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a robot tells its fleet, as another maker's DDS hears it: Fast DDS listens to the real program.

Usage: fleet_fast.py SEQLOOP FAST_END
"""
import pathlib
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds import ros  # noqa: E402
from dds.fleet import Robot, drive, expect, way  # noqa: E402
from dds.fleet_keeper import places  # noqa: E402


class Reader:
    """Plain CDR of little-endian numbers, behind its header of four bytes."""

    def __init__(self, message: bytes) -> None:
        self.body, self.at = message[4:], 0

    def number(self, kind: str) -> int:
        size = struct.calcsize("<" + kind)
        self.at += -self.at % size
        value = struct.unpack_from("<" + kind, self.body, self.at)[0]
        self.at += size
        return value

    def octets(self) -> bytes:
        size = self.number("I")
        self.at += size
        return self.body[self.at - size:self.at]


def place(message: bytes) -> tuple:
    """@return session, frame, time, names and form or nothing, bytes, visit or nothing, frames and doubles of
    statistics or nothing, as platform/dds/idl/fleet.idl"""
    cdr = Reader(message)
    session, frame, time_ns = cdr.number("q"), cdr.number("Q"), cdr.number("q")
    about, visit, statistics = None, None, None
    if cdr.number("I") == 1:
        about = [cdr.octets().rstrip(b"\0").decode() for _ in range(4)] + [cdr.number("I"), cdr.number("I")]
    content = cdr.octets()
    if cdr.number("I") == 1:
        visit = (cdr.number("q"), cdr.number("Q"))
    if cdr.number("I") == 1:
        statistics = (cdr.number("Q"), *([cdr.number("d") for _ in range(cdr.number("I"))] for _ in range(2)))
    return session, frame, time_ns, about, content, visit, statistics


def statistics_of(path: pathlib.Path) -> tuple:
    """@return frames, means, variances of the newest session"""
    frames, *values = sqlite3.connect(f"file:{path}?mode=ro", uri=True).execute(
        "SELECT frames, mean, variance FROM statistics ORDER BY session DESC").fetchone()
    return (frames, *([number for number, in struct.iter_unpack("<d", value)] for value in values))


def main(seqloop: str, fast_end: str, work: pathlib.Path) -> None:
    robot = Robot(seqloop, work, "anna", drive(work, "anna", way(700), 1), "anna.seqloop",
                  standardise="on")
    time.sleep(1.5)  # it has told some before anybody listens
    listener = subprocess.Popen([fast_end, "listen", "seqloop_fleet/places", "seqloop_fleet::Place", "reliable", "test"],
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=ros.environment())
    robot.end()
    data = listener.communicate()[0]
    heard = []
    while len(data) >= 8:
        size = struct.unpack_from("<I", data)[0]
        heard.append(place(data[8:8 + size]))
        data = data[8 + size:]
    saved = places(work / "anna.seqloop")
    told = {(session, frame): struct.pack("<q", time_ns) + content
            for session, frame, time_ns, _, content, visit, statistics in heard if visit is None and statistics is None}
    expect(told == saved, f"Fast DDS hears every place that is saved, to the byte: {len(told)} of {len(saved)}")
    first = heard[0]
    # Its drive's first frame, or the next that a busy machine leaves.
    expect(first[:2] == min(saved) and first[3] is not None and first[3][0] == "anna" and first[3][2].startswith("int8")
           and first[3][4] == 64, f"the first says whose it is and what it is like: {first[:2]}, {first[3]}")
    expect(all(about is None or about == first[3] for _, _, _, about, *_ in heard), "and all that say so say the same")
    newest = [message[6] for message in heard if message[6] is not None][-1]
    expect(newest == statistics_of(work / "anna.seqloop"), f"and by what it is standardised, of {newest[0]} frames")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], sys.argv[2], pathlib.Path(folder))
