#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A robot that tells novel places alone tells its first lap, and others find loops with it all the same.

Usage: fleet_novel.py SEQLOOP
"""
import pathlib
import re
import sys
import tempfile
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds.fleet import Robot, drive, expect, loops, way  # noqa: E402

LAP = 300


def not_seen(robot: Robot) -> int:
    """Frames that a busy machine dropped or lost: places that are copies of those beside them."""
    return sum(map(int, re.search(r"(\d+) dropped; (\d+) lost", robot.said.read_text()).groups()))


def main(seqloop: str, work: pathlib.Path) -> None:
    seen = way(LAP)
    three = numpy.concatenate([seen, seen, seen])
    anna = Robot(seqloop, work, "anna", drive(work, "anna", three, 1), "anna.seqloop", "--fleet-tell", "novel")
    time.sleep(1.0)
    bert = Robot(seqloop, work, "bert", drive(work, "bert", three, 2), "bert.seqloop")
    of_anna, of_bert = anna.end(), bert.end()
    known = int(re.search(r"(\d+) were not told", anna.said.read_text())[1])
    # Frames that were dropped are places, too: copies of those beside them.
    places = sum(line["newest"] is not None for line in of_anna)
    expect(LAP / 2 < anna.told() < 1.5 * LAP and anna.told() + known >= places,
           f"anna tells little more than one lap of three: {anna.told()}, and not {known}")
    expect(bert.counted()[0] == anna.told(), "which bert knows")
    found = loops(of_bert, "anna")
    off = [(answer["frame"] - answer["session_frame"] + LAP // 2) % LAP - LAP // 2 for answer in found]
    most = 5 + not_seen(anna) + not_seen(bert)
    expect(len(found) > LAP and max(map(abs, off)) <= most,
           f"and finds loops with: {len(found)}, off by {max(map(abs, off))} at most, of {most}")
    expect(len(loops(of_anna, "bert")) > LAP, "anna finds loops with bert, too")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], pathlib.Path(folder))
