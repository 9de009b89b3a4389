#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Two robots on network namespaces whose network falls apart and heals: both go on, then each gets what it missed.

Usage: fleet_partition.py SEQLOOP SECONDS (of the partition). Needs root and `ip netns`; exit code 77 without.
"""
import pathlib
import re
import sys
import tempfile
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds.fleet import expect, way  # noqa: E402
from dds.fleet_net import RATE, Network, Robot, ask_for_namespaces  # noqa: E402

BEFORE, AFTER = 2.5, 4.0  # seconds
LEASE, REDISCOVERY = 10.0, 15.0  # who is not heard for so long has gone, until it announces itself again
AHEAD = 100  # frames that one robot is ahead of the other


def known(robot: Robot) -> int:
    return robot.lines[-1][1]["fleet_places"]


def main(seqloop: str, apart: float, work: pathlib.Path) -> None:
    frames = int((BEFORE + apart + (AFTER if apart < LEASE - 1 else REDISCOVERY)) * RATE)
    seen = way(frames + AHEAD)
    for robot, first in enumerate((AHEAD, 0)):
        noisy = seen[first:first + frames]
        noisy = noisy + numpy.random.default_rng(robot).normal(size=noisy.shape) * 0.1
        noisy /= numpy.linalg.norm(noisy, axis=1, keepdims=True)
        numpy.save(work / f"{robot}.npy", noisy.astype(numpy.float32))
    network = Network(2)
    try:
        robots = [Robot(seqloop, work, robot, network.names[robot], True) for robot in range(2)]
        while any(len(robot.lines) < BEFORE * RATE for robot in robots):
            time.sleep(0.02)
        network.cut_off(1, True)
        time.sleep(min(apart / 2, 1.0))  # what was on its way has come
        there = [known(robot) for robot in robots]
        time.sleep(apart - min(apart / 2, 1.0))
        still = [known(robot) for robot in robots]
        went_on = [len(robot.lines) for robot in robots]
        network.cut_off(1, False)
        expect(all(count > 0 for count in there) and there == still,
               f"both know places of the other, and no more while they are apart: {there}, {still}")
        expect(all(count > BEFORE * RATE for count in went_on), f"both go on meanwhile: {went_on} frames")
        for robot in robots:
            robot.end()
        said = [pathlib.Path(robot.said.name).read_text() for robot in robots]
        told = [int(re.search(r"(\d+) places? (?:was|were) told", words)[1]) for words in said]
        heard = [int(re.search(r"of others (\d+) place", words)[1]) for words in said]
        # What was saved in the last second may not have come.
        expect(all(abs(heard[one] - told[1 - one]) <= 2 * RATE and heard[one] > still[one] + apart * RATE
                   for one in range(2)), f"whole again, each gets what it has missed: {heard} of {told[::-1]}")
        found = [sum(answer["status"] == "match" for _, line in robot.lines for answer in line["fleet"])
                 for robot in robots]
        expect(found[1] > 50, f"and finds loops with it: {found}")
    finally:
        network.remove()


if __name__ == "__main__":
    ask_for_namespaces()
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], float(sys.argv[2]), pathlib.Path(folder))
