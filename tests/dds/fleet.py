#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Robots that tell each other their places: the real program, over the loopback interface.

Usage: fleet.py SEQLOOP
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds import ros  # noqa: E402

RATE = 200  # frames a second
SIZE = 64   # values of a descriptor
SEED = 7


def expect(what: bool, told: str) -> None:
    if not what:
        sys.exit("not so: " + told)
    print(told, flush=True)


def way(frames: int) -> numpy.ndarray:
    """What a robot would see without noise: neighbours are alike, others are not."""
    random = numpy.random.default_rng(SEED)
    noise = random.normal(size=(frames + 8, SIZE))
    return numpy.stack([noise[i:i + frames] for i in range(8)]).mean(axis=0)


def drive(work: pathlib.Path, name: str, seen: numpy.ndarray, seed: int) -> pathlib.Path:
    noisy = seen + numpy.random.default_rng(seed).normal(size=seen.shape) * 0.1
    noisy /= numpy.linalg.norm(noisy, axis=1, keepdims=True)
    path = work / f"{name}.npy"
    numpy.save(path, noisy.astype(numpy.float32))
    return path


class Robot:
    """`seqloop run` of one robot, at its drive's own pace. `network` is told to Cyclone DDS, too."""

    def __init__(self, seqloop: str, work: pathlib.Path, name: str, source: pathlib.Path, map_file: str,
                 *more: str, network: str = "", standardise: str = "off", save_every_s: float = 0.1) -> None:
        self.name, self.lines, self.said = name, work / f"{name}.jsonl", work / f"{name}.said"
        environment = ros.environment()
        environment["CYCLONEDDS_URI"] += "," + network if network else ""
        with self.said.open("w") as said:
            self.process = subprocess.Popen(
                [seqloop, "run", "--source", source, "--map", work / map_file, "--fleet", "test", "--robot", name,
                 "--fps", str(RATE), "--pace", "live", "--save-every-s", str(save_every_s), "--standardise", standardise,
                 "--out", self.lines, *more], stderr=said, env=environment)

    def end(self) -> list[dict]:
        """@return its lines"""
        if self.process.wait(timeout=100) != 0:
            sys.exit(f"{self.name} failed: {self.said.read_text()}")
        return [json.loads(line) for line in self.lines.read_text().splitlines()]

    def told(self) -> int:
        """@return places, those of earlier sessions included"""
        return int(re.search(r"(\d+) places? (?:was|were) told", self.said.read_text())[1])

    def counted(self) -> tuple[int, int]:
        """@return places of others, sessions"""
        found = re.search(r"of others (\d+) places? of (\d+) session", self.said.read_text())
        return int(found[1]), int(found[2])


def loops(lines: list[dict], robot: str) -> list[dict]:
    return [answer for line in lines for answer in line["fleet"]
            if answer["status"] == "match" and answer["robot"] == robot]


def main(seqloop: str, work: pathlib.Path) -> None:
    print(f"seed {SEED}")
    seen = way(1600)
    eve = Robot(seqloop, work, "eve", drive(work, "eve", seen, 1), "eve.seqloop")
    dora = Robot(seqloop, work, "dora", drive(work, "dora", seen[:400], 2), "dora.seqloop", "--arithmetic", "sketch")
    anna = Robot(seqloop, work, "anna", drive(work, "anna", seen[:250], 3), "anna.seqloop")
    anna.end()
    # Switched on again with its map, under another name; and one that has not been there before.
    anton = Robot(seqloop, work, "anton", drive(work, "anton", seen[500:650], 4), "anna.seqloop")
    bert = Robot(seqloop, work, "bert", drive(work, "bert", seen[:400], 5), "bert.seqloop")
    robots = {robot.name: robot.end() for robot in (anton, bert, dora, eve)}

    expect(eve.counted() == (anton.told() + bert.told(), 3),
           f"who was there all the time knows each place of others once: {eve.counted()}")
    places, sessions = bert.counted()
    expect(sessions == 3 and places > 250, f"who comes late gets what was before: {bert.counted()}")
    found = loops(robots["bert"], "eve") + loops(robots["bert"], "anton") + loops(robots["bert"], "anna")
    expect(len(found) > 60, f"and finds loops with it: {len(found)}")
    right = [answer for answer in found if abs(answer["frame"] - answer["session_frame"]) <= 3]
    expect(len(right) >= 0.99 * len(found), f"that are right: {len(right)}")
    expect(all(answer["probability"] >= 0.99 for answer in found), "each with its probability")
    for one, other in ((eve, "dora"), (dora, "eve")):
        words = one.said.read_text()
        expect(words.count(f"robot '{other}', session") == 1 and "none is taken in" in words,
               f"{one.name} says once that {other} cannot be understood")
    expect(dora.counted() == (0, 0), "and takes in nothing of it")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], pathlib.Path(folder))
