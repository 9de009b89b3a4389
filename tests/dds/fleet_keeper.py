#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A keeper that is killed again and again loses nothing, and serves who comes late: the real program.

Usage: fleet_keeper.py SEQLOOP TIMES
"""
import bisect
import json
import pathlib
import random
import re
import resource
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds import fleet, ros  # noqa: E402
from dds.fleet import Robot, drive, expect, loops, way  # noqa: E402

SEED = 11
FRAMES = 700  # of a drive: three and a half seconds


class Keeper:
    def __init__(self, seqloop: str, work: pathlib.Path) -> None:
        self.said = work / "keeper.said"
        with self.said.open("a") as said:
            self.process = subprocess.Popen([seqloop, "keep", "--map", work / "kept.seqloop", "--fleet", "test",
                                             "--save-every-s", "0.05"], stderr=said, env=ros.environment())

    def let_write(self, file_bytes: int) -> None:
        """How large it may make a file: what it writes beyond that fails as on a full disk."""
        resource.prlimit(self.process.pid, resource.RLIMIT_FSIZE, (file_bytes, resource.RLIM_INFINITY))

    def kill(self) -> None:
        if self.process.poll() is not None:
            sys.exit("the keeper ended by itself: " + self.said.read_text()[-300:])
        self.process.kill()
        self.process.wait()

    def end(self, code: int = 0) -> None:
        self.process.send_signal(signal.SIGTERM)
        ended = self.process.wait(timeout=60)
        expect(ended == code, f"the keeper ends when it is asked to, with {code}: {ended}")


def places(path: pathlib.Path) -> dict[tuple[int, int], bytes]:
    """@return of each session, by when it began, and frame: time and bytes"""
    found = {}
    base = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    size = base.execute("SELECT place_bytes FROM map").fetchone()[0]
    for began, count, records, content in base.execute(
            "SELECT began_ns, count, records, block.places FROM block JOIN session ON session = session.id"):
        for i in range(count):
            _, frame, time_ns = struct.unpack_from("<QQq", records, 24 * i)
            if (began, frame) in found:
                sys.exit(f"{path} has frame {frame} of {began} twice")
            found[began, frame] = struct.pack("<q", time_ns) + content[size * i:size * (i + 1)]
    return found


def frames_of(path: pathlib.Path) -> dict[str, list[int]]:
    """@return of each session, by name, the frames that are places, in order: a busy machine loses some"""
    names = sqlite3.connect(f"file:{path}?mode=ro", uri=True).execute("SELECT began_ns, name FROM session")
    of = dict(names.fetchall())
    found: dict[str, list[int]] = {name: [] for name in of.values()}
    for began, frame in sorted(places(path)):
        found[of[began]].append(frame)
    return found


def localises(seqloop: str, work: pathlib.Path) -> None:
    """What two robots tell a keeper is a map for a third that never was in their fleet; places are standardised."""
    work.mkdir()
    seen = way(600)
    keeper = Keeper(seqloop, work)
    robots = [Robot(seqloop, work, name, drive(work, name, seen[first:first + 400], seed), f"{name}.seqloop",
                    standardise="on") for name, first, seed in (("anna", 0, 1), ("bert", 200, 2))]
    for robot in robots:
        robot.end()
    time.sleep(1.0)
    keeper.end()
    late = drive(work, "late", seen, 3)
    kept = frames_of(work / "kept.seqloop")
    for flags in (("--out", work / "read.jsonl", "--read-only"), ("--out", work / "added.jsonl")):
        subprocess.run([seqloop, "run", "--source", late, "--map", work / "kept.seqloop", *flags], check=True,
                       capture_output=True)
        lines = [json.loads(line) for line in flags[1].read_text().splitlines()]
        found = [answer for line in lines for answer in line["answers"] if answer["status"] == "match"]
        off = []
        for answer in found:
            frames = kept[answer["session"]]
            truth = answer["frame"] - (200 if answer["session"].startswith("bert") else 0)
            off.append(abs(bisect.bisect(frames, truth) - bisect.bisect(frames, answer["session_frame"])))
        expect(len(found) > 400 and max(off) <= 3,
               f"a drive is localised in a keeper's map: {len(found)}, {max(off, default=0)} places off at most")
    subprocess.run([seqloop, "match", "--query", late, "--map", work / "kept.seqloop", "--read-only", "--out",
                    work / "m.csv"], check=True, capture_output=True)


def power_cut(seqloop: str, work: pathlib.Path) -> None:
    """A robot tells places before the disk has them, and is cut from its power: others know some that its own map has
    lost, and each once."""
    work.mkdir()
    seen = way(600)
    keeper = Keeper(seqloop, work)
    runs = 3
    for run in range(runs):
        anna = Robot(seqloop, work, "anna", drive(work, "anna", seen, run), "anna.seqloop", save_every_s=1.0)
        if run == runs - 1:
            anna.end()
            break
        time.sleep(2.0)
        anna.process.kill()
        anna.process.wait()
    time.sleep(1.0)
    keeper.end()
    kept, saved = places(work / "kept.seqloop"), places(work / "anna.seqloop")
    expect(saved.items() <= kept.items(), f"all that its map has is known, to the byte: {len(saved)} places")
    newest: dict[int, int] = {}
    for began, frame in saved:
        newest[began] = max(frame, newest.get(began, 0))
    ahead = [(began, frame) for began, frame in kept if (began, frame) not in saved]
    expect(all(frame > newest.get(began, -1) for began, frame in ahead),
           f"and of what it has lost, only ends of drives: {len(ahead)}")
    expect(len({began for began, _ in kept}) == runs, "a session for each time that it was switched on")


def refuses(seqloop: str, folder: pathlib.Path) -> None:
    """What is told would wait for a file that can never be made."""
    refused = subprocess.run([seqloop, "keep", "--map", folder / "none" / "kept.seqloop", "--fleet", "none"],
                             capture_output=True, text=True)
    expect(refused.returncode == 2 and "none is no folder" in refused.stderr,
           f"a map in no folder is refused: {refused.returncode}, {refused.stderr}")


def full_disk(seqloop: str, work: pathlib.Path) -> None:
    """Where there is no room for a file, and later none for a session, the keeper waits, and then has all."""
    work.mkdir()
    seen = way(200)
    keeper = Keeper(seqloop, work)
    robots = []
    for name in ("anna", "bert"):
        keeper.let_write(4096)
        robots.append(Robot(seqloop, work, name, drive(work, name, seen, len(robots)), f"{name}.seqloop"))
        time.sleep(2.0)
        expect(keeper.process.poll() is None, "the keeper waits for room: " + keeper.said.read_text()[-300:])
        keeper.let_write(resource.RLIM_INFINITY)
        robots[-1].end()
        time.sleep(1.0)
    keeper.end()
    told = places(work / "anna.seqloop") | places(work / "bert.seqloop")
    expect(places(work / "kept.seqloop") == told, f"and keeps all, to the byte: {len(told)} places")
    words = keeper.said.read_text()
    expect(words.count("what was told is saved again") == 2, "each time it says that it goes on: " + words)


def ends_on_a_full_disk(seqloop: str, work: pathlib.Path) -> None:
    """What still waits when a keeper ends is lost, whether there is a file or none: it says so, and fails."""
    work.mkdir()
    seen = way(400)
    for name, room_for_s in (("anna", 0.0), ("bert", 1.0)):
        keeper = Keeper(seqloop, work)
        if room_for_s == 0:
            keeper.let_write(4096)
        robot = Robot(seqloop, work, name, drive(work, name, seen, 1), f"{name}.seqloop")
        time.sleep(room_for_s)
        keeper.let_write(4096)
        robot.end()
        time.sleep(1.0)
        keeper.end(1)
        last = keeper.said.read_text().splitlines()[-1]
        expect(re.search(r"not saved of what was told: [1-9]\d* places? or more: .*kept.seqloop: .*; ", last), last)


def main(seqloop: str, times: int, work: pathlib.Path) -> None:
    print(f"seed {SEED}")
    chance = random.Random(SEED)
    seen = way(1200)
    keeper = Keeper(seqloop, work)
    kills, rounds = 0, 0
    while kills < times:
        robots = [Robot(seqloop, work, f"{name}{rounds}",
                        drive(work, f"{name}{rounds}", seen[:FRAMES], 2 * rounds + i), f"{name}{rounds}.seqloop")
                  for i, name in enumerate(("anna", "bert"))]
        # The last third of their drive they have to tell it what it has missed.
        end = time.monotonic() + FRAMES / fleet.RATE * 2 / 3
        while kills < times and time.monotonic() < end:
            time.sleep(chance.uniform(0.02, 0.4))
            keeper.kill()
            keeper = Keeper(seqloop, work)
            kills += 1
        for robot in robots:
            robot.end()
        rounds += 1
    time.sleep(1.0)
    keeper.end()
    kept = places(work / "kept.seqloop")
    told = {}
    for path in work.glob("*[0-9].seqloop"):
        told |= places(path)
    missing = [key for key in told if key not in kept]
    expect(len(told) > 1000 and not missing, f"of {len(told)} places none is missing after {kills} kills: "
           f"{len(missing)}, {missing[:3]}")
    expect(kept == told, "each is kept once, to the byte")
    base = sqlite3.connect(f"file:{work / 'kept.seqloop'}?mode=ro", uri=True)
    expect(base.execute("SELECT count(*) FROM session").fetchone()[0] == 2 * rounds, "no session was begun twice")
    base.close()
    checked = subprocess.run([seqloop, "map", "check", work / "kept.seqloop"], capture_output=True, text=True)
    expect(checked.returncode == 0, "the map's check finds nothing: " + checked.stdout + checked.stderr)

    # All robots have gone.
    keeper = Keeper(seqloop, work)
    late = Robot(seqloop, work, "late", drive(work, "late", seen[:FRAMES], 99), "late.seqloop", "--fleet-places", "100000")
    lines = late.end()
    sessions = len({began for began, _ in kept})
    expect(late.counted() == (len(kept), sessions), f"who comes late gets all from the keeper: {late.counted()}")
    found = [answer for line in lines for answer in line["fleet"] if answer["status"] == "match"]
    expect(len(found) > 100 and all(answer["robot"][:4] in ("anna", "bert") for answer in found),
           f"and finds loops with them: {len(found)}")
    time.sleep(1.0)
    keeper.end()
    expect(places(work / "late.seqloop").items() <= places(work / "kept.seqloop").items(),
           "its drive is kept, too")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        localises(sys.argv[1], pathlib.Path(folder) / "whole")
        power_cut(sys.argv[1], pathlib.Path(folder) / "cut")
        refuses(sys.argv[1], pathlib.Path(folder))
        full_disk(sys.argv[1], pathlib.Path(folder) / "full")
        ends_on_a_full_disk(sys.argv[1], pathlib.Path(folder) / "end")
        main(sys.argv[1], int(sys.argv[2]), pathlib.Path(folder))
