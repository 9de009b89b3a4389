#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Robots on network namespaces with delay, loss and partitions: one recorded drive, cut in overlapping parts.

Usage: fleet_net.py SEQLOOP DESCRIPTORS.npy ROBOTS [--frames N] [--conditions N] [--flags "FLAGS"]

FRAMES are those of a part; FLAGS are given to each robot; of the conditions below the first N are tried. Prints what was found between robots against one process that has all of it, bytes and packets a place, how long
until others know a place, and what the loop pays. Needs root, `ip netns` and `tc`; exit code 77 without.
Delay and loss are netem's, or those of slow_network.py.
"""
import argparse
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds.slow_network import Hub, open_tap  # noqa: E402

RATE = 50       # frames a second
OVERLAP = 0.3   # of a part with the next
MINE = f"seqloop{os.getpid()}"  # namespaces: others may test just now, too
SLOW = (0.05, 0.01, 0.05)  # delay and how far it varies, seconds; share of packets that is lost


def command(*words: object, check: bool = True) -> str:
    return subprocess.run([str(word) for word in words], check=check, capture_output=True, text=True).stdout


def ask_for_namespaces() -> None:
    """Ends with 77 where there are none to be had."""
    if os.geteuid() != 0 or subprocess.run(["ip", "netns", "add", MINE], capture_output=True).returncode != 0:
        print("network namespaces cannot be made here")
        sys.exit(77)
    command("ip", "netns", "del", MINE)


class Network:
    """A switch, and a namespace for each robot."""

    def __init__(self, robots: int) -> None:
        self.names = [f"{MINE}r{robot}" for robot in range(robots)]
        self.hub = f"{MINE}h"
        self.remove()
        command("ip", "netns", "add", self.hub)
        command("ip", "-n", self.hub, "link", "add", "switch", "type", "bridge", "mcast_snooping", "0")
        command("ip", "-n", self.hub, "link", "set", "switch", "up")
        for robot, name in enumerate(self.names):
            command("ip", "netns", "add", name)
            command("ip", "-n", name, "link", "add", "radio", "type", "veth", "peer", "name", f"r{robot}", "netns",
                    self.hub)
            command("ip", "-n", self.hub, "link", "set", f"r{robot}", "master", "switch", "up")
            command("ip", "-n", name, "addr", "add", f"10.9.0.{robot + 1}/24", "dev", "radio")
            command("ip", "-n", name, "link", "set", "radio", "up")
            command("ip", "-n", name, "link", "set", "lo", "up")

    def remove(self) -> None:
        for name in (*self.names, self.hub):
            command("ip", "netns", "del", name, check=False)

    def worsen(self, *netem: str) -> bool:
        """@return whether the kernel can"""
        return all(subprocess.run(["tc", "-n", name, "qdisc", "replace", "dev", "radio", "root", "netem", *netem],
                                  capture_output=True).returncode == 0 for name in self.names)

    def cut_off(self, robot: int, off: bool) -> None:
        command("ip", "-n", self.hub, "link", "set", f"r{robot}", "down" if off else "up")

    def sent(self, robot: int) -> tuple[int, int]:
        """@return bytes, packets"""
        link = json.loads(command("ip", "-n", self.names[robot], "-s", "-j", "link", "show", "radio"))[0]["stats64"]
        return link["tx"]["bytes"], link["tx"]["packets"]


class SlowNetwork(Network):
    """The same, with delay and loss where the kernel has no netem: a process hands packets on, late or not at all."""

    def __init__(self, robots: int, delay_s: float, jitter_s: float, loss: float) -> None:
        self.names = [f"{MINE}r{robot}" for robot in range(robots)]
        self.hub = f"{MINE}h"
        self.remove()
        self.taps = []
        for robot, name in enumerate(self.names):
            command("ip", "netns", "add", name)
            self.taps.append(open_tap(name, "radio"))
            command("ip", "-n", name, "addr", "add", f"10.9.0.{robot + 1}/24", "dev", "radio")
            command("ip", "-n", name, "link", "set", "radio", "up")
            command("ip", "-n", name, "link", "set", "lo", "up")
        self.process = Hub(self.taps, delay_s, jitter_s, loss)

    def remove(self) -> None:
        if hasattr(self, "process"):
            self.process.end()
            for tap in self.taps:
                os.close(tap)
        super().remove()

    def cut_off(self, robot: int, off: bool) -> None:
        self.process.cut[robot] = off


class Robot:
    def __init__(self, seqloop: str, work: pathlib.Path, robot: int, namespace: str | None, fleet: bool,
                 *more: str) -> None:
        words = [] if namespace is None else ["ip", "netns", "exec", namespace]
        words += [seqloop, "run", "--source", work / f"{robot}.npy", "--map", work / f"{robot}.seqloop", "--fps",
                  str(RATE), "--pace", "live", "--summary", work / f"{robot}.json"]
        if fleet:
            words += ["--fleet", "net", "--robot", str(robot), *more]
        self.summary = work / f"{robot}.json"
        self.said = (work / f"{robot}.said").open("w")
        self.process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=self.said,
                                        env={**os.environ, "ROS_DOMAIN_ID": "99"})
        self.lines: list[tuple[float, dict]] = []
        self.memory: list[int] = []
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self) -> None:
        for line in self.process.stdout:
            self.lines.append((time.monotonic(), json.loads(line)))
            if len(self.lines) % 100 == 0:
                status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
                self.memory += [int(row.split()[1]) for row in status.splitlines() if row.startswith("VmRSS")]

    def end(self) -> None:
        self.reader.join()
        if self.process.wait() != 0:
            sys.exit("a robot failed: " + pathlib.Path(self.said.name).read_text())


def cut(drive: numpy.ndarray, robots: int, frames: int, work: pathlib.Path) -> None:
    for robot in range(robots):
        first = int(robot * frames * (1 - OVERLAP))
        numpy.save(work / f"{robot}.npy", drive[first:first + frames])


def alone(seqloop: str, work: pathlib.Path, robots: int) -> list[list[dict]]:
    """Each part in one process that has all the others from the start, and adds it."""
    found = []
    for robot in range(robots):
        others = [str(work / f"{other}.seqloop") for other in range(robots) if other != robot]
        whole = work / f"without{robot}.seqloop"
        if len(others) > 1:
            command(seqloop, "map", "merge", *others, "--out", whole)
        else:
            shutil.copy(others[0], whole)
        lines = command(seqloop, "run", "--source", work / f"{robot}.npy", "--map", whole, "--session", "own", "--fps",
                        str(RATE))
        found.append([answer for line in lines.splitlines() for answer in json.loads(line)["answers"]
                      if answer["status"] == "match" and answer["session"] != "own"])
    return found


def latencies(by: Robot, to: Robot) -> numpy.ndarray:
    """From when a frame was taken by one of two robots until the other knew it, seconds."""
    taken = [when for when, line in by.lines if line["newest"] is not None]
    known, waits = 0, []
    for when, line in to.lines:
        while known < min(line["fleet_places"], len(taken)):
            waits.append(when - taken[known])
            known += 1
    return numpy.array(waits)


def delays(runs: list[Robot]) -> numpy.ndarray:
    """From when two robots had both seen a place until one of them found that, seconds."""
    seen = [{line["newest"]: when for when, line in run.lines if line["newest"] is not None} for run in runs]
    waits = []
    for mine, run in zip(seen, runs):
        for when, line in run.lines:
            waits += [when - max(mine[answer["frame"]], seen[int(answer["robot"])][answer["session_frame"]])
                      for answer in line["fleet"] if answer["status"] == "match" and answer["frame"] in mine
                      and answer["session_frame"] in seen[int(answer["robot"])]]
    return numpy.array(waits)


def misses(runs: list[Robot]) -> str:
    lines = [line for run in runs for _, line in run.lines if line["newest"] is not None]
    match = numpy.percentile([line["latency_ms"]["match"] for line in lines], [50, 99])
    missed = sum(line["deadline_missed"] for line in lines)
    dropped = sum(line["dropped"] for line in lines)
    return f"{missed} of {len(lines)} frames missed, {dropped} dropped, match p50 {match[0]:.2f} p99 {match[1]:.2f} ms"


def told(runs: list[Robot]) -> int:
    return sum(int(re.search(r"(\d+) places? (?:was|were) told", pathlib.Path(run.said.name).read_text())[1]) for run in runs)


def drive_all(seqloop: str, work: pathlib.Path, network: Network, robots: int, fleet: bool, cut_off: bool,
              flags: list[str]) -> list:
    for old in work.glob("?.seqloop*"):
        old.unlink()
    runs = [Robot(seqloop, work, robot, network.names[robot], fleet, *flags) for robot in range(robots)]
    if cut_off:
        time.sleep(6)
        network.cut_off(1, True)
        time.sleep(6)
        network.cut_off(1, False)
    for run in runs:
        run.end()
    return runs


def main(seqloop: str, descriptors: str, robots: int, frames: int, tried: int, flags: list[str],
         work: pathlib.Path) -> None:
    cut(numpy.load(descriptors), robots, frames, work)
    network = Network(robots)
    try:
        conditions = [("alone", False, None, False), ("no delay", True, None, False),
                      ("no delay, one cut off from 6 to 12 s", True, None, True),
                      ("50 ms delay, 5 % lost", True, ("delay", "50ms", "10ms", "loss", "5%"), False),
                      ("the same, one cut off from 6 to 12 s", True, ("delay", "50ms", "10ms", "loss", "5%"), True)]
        whole = None
        for name, fleet, netem, cut_off in conditions[:tried]:
            if netem and not isinstance(network, SlowNetwork) and not network.worsen(*netem):
                network.remove()
                network = SlowNetwork(robots, *SLOW)
            before = [network.sent(robot) for robot in range(robots)]
            runs = drive_all(seqloop, work, network, robots, fleet, cut_off, flags)
            print(f"{name}: {misses(runs)}")
            if not fleet:
                whole = alone(seqloop, work, robots)
                continue
            after = [network.sent(robot) for robot in range(robots)]
            octets = sum(now[0] - then[0] for now, then in zip(after, before))
            packets = sum(now[1] - then[1] for now, then in zip(after, before))
            places = sum(line["newest"] is not None for run in runs for _, line in run.lines)
            print(f"  {octets / places:.0f} bytes, {packets / places:.2f} packets a frame, of {robots} robots; "
                  f"{told(runs)} places of {places} frames were told")
            found, possible, accepted = 0, 0, 0
            for robot, run in enumerate(runs):
                mine = {answer["frame"] for _, line in run.lines for answer in line["fleet"]
                        if answer["status"] == "match"}
                accepted += len(mine)
                # What one process found in what others had seen two seconds before.
                past = {answer["frame"] for answer in whole[robot]
                        if answer["session_frame"] + 2 * RATE <= answer["frame"]}
                possible += len(past)
                found += len(past & mine)
            print(f"  {accepted} loops between robots; of {possible} that one process finds in what was seen before: "
                  f"{found}, {found / max(possible, 1):.3f}")
            print("  resident memory, from the first hundred frames to the last: "
                  + ", ".join(f"{run.memory[0] // 1024} to {run.memory[-1] // 1024} MiB" for run in runs))
            waits = delays(runs)
            print(f"  until a loop was found that both had seen: p50 {numpy.median(waits):.2f} s, p99 "
                  f"{numpy.percentile(waits, 99):.2f} s")
            if robots == 2:
                waits = numpy.concatenate([latencies(runs[0], runs[1]), latencies(runs[1], runs[0])])
                print(f"  until the other knew a place: p50 {numpy.median(waits):.2f} s, p99 "
                      f"{numpy.percentile(waits, 99):.2f} s of {len(waits)}")
            if isinstance(network, SlowNetwork):
                hub = network.process
                print(f"  {hub.lost.value} packets lost, {hub.handed_on.value} handed on, until now")
            sys.stdout.flush()
    finally:
        network.remove()


if __name__ == "__main__":
    words = argparse.ArgumentParser(usage=__doc__)
    words.add_argument("seqloop")
    words.add_argument("descriptors")
    words.add_argument("robots", type=int)
    words.add_argument("--frames", type=int, default=1000)
    words.add_argument("--conditions", type=int, default=5)
    words.add_argument("--flags", default="")
    asked = words.parse_args()
    ask_for_namespaces()
    with tempfile.TemporaryDirectory() as folder:
        main(asked.seqloop, asked.descriptors, asked.robots, asked.frames, asked.conditions, shlex.split(asked.flags),
             pathlib.Path(folder))
