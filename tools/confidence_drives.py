# SPDX-License-Identifier: MIT
"""The drives on which confidence is measured, and how each is made. Used by tools/confidence."""
import csv
import dataclasses
import pathlib
import shutil
from typing import Callable

import numpy as np

import bad_camera
from loop_drives import GARDENS, NORDLAND, Tools, call, say

GARAGE, GARAGE_TRUTH, FIRST_LAP = "garage_laps/images", "garage_laps/truth.csv", 211
Truth = dict[int, list[int]]  # right places of a frame; none: nothing is right; unlisted: unknown
Near = dict[int, list[range]]  # frames that another road passes so near that they are right, too


def same_frames(count: int, after: int = 0) -> Truth:
    """Frame i of the second drive is place i; `after` frames before it are new."""
    return {i: [] for i in range(after)} | {after + i: [i] for i in range(count)}


def read_truth(path: pathlib.Path, new: int) -> Truth:
    """@param new the first so many frames have nothing that is right, unless the file says so"""
    truth: Truth = {i: [] for i in range(new)}
    with path.open(encoding="ascii") as stream:
        for row in csv.DictReader(stream):
            truth.setdefault(int(row["query"]), []).append(int(row["reference"]))
    return truth


def read_near(path: pathlib.Path) -> Near:
    near: Near = {}
    with path.open(encoding="ascii") as stream:
        for row in csv.DictReader(stream):
            frames = range(int(row["first"]), int(row["last"]) + 1)
            near.setdefault(int(row["query"]), []).append(frames)
    return near


@dataclasses.dataclass(frozen=True)
class Maker:
    """Makes what drives consist of, once: what OUT/descriptors has is not made again."""
    tools: Tools
    out: pathlib.Path
    camera: str | None = None  # which bad one has taken the pictures

    def named(self, name: str) -> str:
        return f"{name}-by-{self.camera}" if self.camera else name

    def file(self, name: str) -> pathlib.Path:
        return self.out / f"{self.named(name)}.npy"

    def read(self, source: str, name: str) -> np.ndarray:
        path = self.file(name)
        if not path.exists():
            say(f"{path.stem}: making descriptors")
            if self.camera:
                taken = path.with_suffix(".pictures")
                shutil.rmtree(taken, ignore_errors=True)
                try:
                    bad_camera.take_again(self.camera, self.tools.data / source, taken)
                    self.tools.describe(str(taken), path)
                finally:
                    shutil.rmtree(taken)
            else:
                self.tools.describe(source, path)
        return np.load(path)

    def real(self, source: str) -> np.ndarray:
        return self.read(source, source.replace("/", "-"))

    def street(self, use: str, frames: int, seed: int,
               metres: float) -> tuple[list[np.ndarray], pathlib.Path]:
        """Descriptors of the drives of a synthetic street, and their truth. With what is near by
        another road where the drive closes loops."""
        parts = ["reference", "query"] if use == "localise" else ["drive"]
        name = f"street-{use}-{seed}" + (f"-{metres}" if metres != 1.0 else "")
        names = [f"{name}-{part}" for part in parts]
        folder, truth = self.out / f"{name}.pictures", self.out / f"{name}-truth.csv"
        kept = {"truth.csv": truth}
        if use == "loop":
            kept["near.csv"] = self.out / f"{name}-near.csv"
        if not all(file.exists() for file in [*map(self.file, names), *kept.values()]):
            say(f"{name}: drawing")
            jumps = ["--kidnaps", seed % 3] if use == "loop" else []
            call([self.tools.street, "--keep", "--quiet", "--drives", use, "--frames", frames,
                  "--length", frames * metres, "--seed", seed, "--out", folder, *jumps])
        drives = [self.read(str(folder / part), one) for part, one in zip(parts, names)]
        if folder.exists():
            for drawn, file in kept.items():
                (folder / drawn).replace(file)
            shutil.rmtree(folder)
        return drives, truth


def nothing_near(maker: Maker) -> Near:
    return {}


@dataclasses.dataclass(frozen=True)
class Drive:
    name: str
    make: Callable[[Maker], tuple[np.ndarray, np.ndarray | None, Truth]]  # query, map, truth
    tolerances: tuple[int, int]  # frames
    needs: tuple[str, ...] = ()  # below the data folder; none: a synthetic street
    near: Callable[[Maker], Near] = nothing_near  # once it is made


def localise(query: str, reference: str):
    def make(maker: Maker):
        rows = maker.real(query)
        return rows, maker.real(reference), same_frames(len(rows))
    return make


def at_pace(query: str, reference: str, pace: float):
    """Localising at another pace than the reference: frames left out of the faster of the two."""
    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        if pace > 1.0:
            frames = (np.arange(int(len(rows) / pace)) * pace).astype(int)
            return rows[frames], known, {i: [int(f)] for i, f in enumerate(frames)}
        places = (np.arange(int(len(known) * pace)) / pace).astype(int)
        truth = {i: [int(np.abs(places - i).argmin())] for i in range(len(rows))}
        return rows, known[places], truth
    return make


def first_or_second_half_faster(drive: Drive, pace: float) -> Drive:
    """A drive that closes loops, whose second half goes at so many times the pace of its first."""
    def frames(count: int) -> np.ndarray:
        first, second = max(1.0, 1.0 / pace), max(1.0, pace)
        half = count // 2
        return np.concatenate([np.arange(0.0, half, first),
                               np.arange(half, count, second)]).astype(int)

    def make(maker: Maker):
        rows, _, truth = drive.make(maker)
        kept = frames(len(rows))
        return rows[kept], None, {
            i: [int(np.abs(kept - place).argmin()) for place in truth[int(frame)]]
            for i, frame in enumerate(kept) if int(frame) in truth}

    def near(maker: Maker) -> Near:
        kept, by = frames(len(drive.make(maker)[0])), drive.near(maker)
        return {i: [range(*np.searchsorted(kept, [places.start, places.stop]))
                    for places in by[int(frame)]]
                for i, frame in enumerate(kept) if int(frame) in by}
    return dataclasses.replace(drive, name=f"pace-{drive.name}-{pace}", make=make,
                               tolerances=(10, 5), near=near)


def with_stops(query: str, reference: str, every: int, stop: int, whose: str):
    """Localising where a robot stands so long each so many frames: now, then, or both times, but at
    other places. Drives that stand nowhere of their own."""
    def stopped(rows: np.ndarray, first: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
        frames = np.arange(len(rows))
        stands = (frames >= first) & ((frames - first) % every == 0)
        frames = np.repeat(frames, np.where(stands, stop + 1, 1))
        again = np.append(False, frames[1:] == frames[:-1])[:, None]
        noise = np.random.default_rng(seed).normal(0.0, 0.003, (len(frames), rows.shape[1]))
        noisy = rows[frames] + np.where(again, noise, 0.0)
        return noisy / np.linalg.norm(noisy, axis=1, keepdims=True), frames

    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        seen, frames = stopped(rows, every, 5) if whose != "then" else (rows, np.arange(len(rows)))
        places, of = (stopped(known, every + every // 2, 6) if whose != "now"
                      else (known, np.arange(len(known))))
        truth = {i: [int(place) for place in np.flatnonzero(of == frame)]
                 for i, frame in enumerate(frames)}
        return seen, places, truth
    return make


def one_after_the_other(first: str, second: str, between: int = 0):
    """As one drive, with so many frames of a covered lens between them."""
    def make(maker: Maker):
        before, after = maker.real(first), maker.real(second)
        dark = np.zeros((between, before.shape[1]), before.dtype)
        new = len(before) + between
        return np.vstack([before, dark, after]), None, same_frames(len(after), new)
    return make


def nothing_twice(source: str):
    def make(maker: Maker):
        rows = maker.real(source)
        return rows, None, same_frames(0, len(rows))
    return make


def garage(maker: Maker):
    return maker.real(GARAGE), None, read_truth(maker.tools.data / GARAGE_TRUTH, FIRST_LAP)


def later_laps(maker: Maker):
    """The second half of the garage's laps, in a map of the first."""
    rows = maker.real(GARAGE)
    half = len(rows) // 2
    truth: Truth = {}
    for frame, places in read_truth(maker.tools.data / GARAGE_TRUTH, FIRST_LAP).items():
        if frame >= half:
            truth[frame - half] = [place for place in places if place < half]
    return rows[half:], rows[:half], truth


def standing(source: str, frame: int, going_on: int):
    """To a frame, 5,000 noisy pictures of it, and on."""
    def make(maker: Maker):
        rows = maker.real(source)
        noise = np.random.default_rng(5).normal(0.0, 0.003, (5000, rows.shape[1]))
        still = rows[frame] + noise
        still /= np.linalg.norm(still, axis=1, keepdims=True)
        whole = np.vstack([rows[:frame + 1], still, rows[frame + 1:frame + 1 + going_on]])
        return whole, None, same_frames(0, len(whole))
    return make


def teleports(query: str, reference: str, pieces: int, shortest: int, longest: int):
    """Pieces of the query in any order; the same frame may come again."""
    def make(maker: Maker):
        rows, dice = maker.real(query), np.random.default_rng(5)
        begins = dice.integers(0, len(rows) - longest, pieces)
        frames = np.concatenate([np.arange(at, at + dice.integers(shortest, longest))
                                 for at in begins])
        return rows[frames], maker.real(reference), {i: [int(f)] for i, f in enumerate(frames)}
    return make


def street(seed: int, use: str, alone: int | None = None, metres: float = 1.0):
    """@param alone which of the two drives is matched with itself   @param metres a frame"""
    def make(maker: Maker):
        frames = int((600 if use == "localise" else 1200) / metres)
        drives, truth = maker.street(use, frames, seed, metres)
        if alone is not None:
            return drives[alone], None, same_frames(0, len(drives[alone]))
        known = drives[0] if use == "localise" else None
        return drives[-1], known, read_truth(truth, len(drives[-1]))
    return make


def near_on_street(seed: int):
    return lambda maker: read_near(maker.out / f"street-loop-{seed}-near.csv")


def elsewhere(seed: int, other: int, pieces: int = 0):
    """A street in another season, in the map of another street, on whose own street the robot has
    been carried about before: so many pieces of 40 frames, which are not asked for."""
    def make(maker: Maker):
        (known, same), _ = maker.street("localise", 600, other, 1.0)
        (_, foreign), _ = maker.street("localise", 600, seed, 1.0)
        begins = np.random.default_rng(5).integers(0, len(same) - 40, pieces)
        rows = np.vstack([*(same[at:at + 40] for at in begins), foreign])
        return rows, known, {40 * pieces + i: [] for i in range(len(foreign))}
    return make


def all_drives(seeds: list[int], teleports_by: int = 1) -> list[Drive]:
    """@param teleports_by so many times as many teleports"""
    (day, night), (summer, winter) = GARDENS, NORDLAND
    drives = [
        Drive("gardens-day-night", localise(night, day), (10, 2), GARDENS),
        Drive("gardens-night-day", localise(day, night), (10, 2), GARDENS),
        Drive("gardens-loop", one_after_the_other(day, night), (10, 2), GARDENS),
        Drive("nordland-summer-winter", localise(winter, summer), (10, 1), NORDLAND),
        Drive("nordland-winter-summer", localise(summer, winter), (10, 1), NORDLAND),
        Drive("nordland-loop", one_after_the_other(summer, winter), (10, 1), NORDLAND),
        Drive("garage", garage, (12, 27), (GARAGE, GARAGE_TRUTH)),
        Drive("garage-later-laps", later_laps, (12, 27), (GARAGE, GARAGE_TRUTH)),
        Drive("standing-nordland", standing(summer, 300, 299), (10, 2), (summer,)),
        Drive("standing-garage", standing(GARAGE, 150, 0), (10, 2), (GARAGE,)),
        Drive("covered-lens", one_after_the_other(day, night, 3000), (10, 2), GARDENS)]
    for query, reference, pieces, lengths, exact in (
            (night, day, 40, (15, 80), 2), (day, night, 40, (15, 80), 2),
            (winter, summer, 200, (12, 60), 1), (summer, winter, 200, (12, 60), 1)):
        carried = teleports(query, reference, teleports_by * pieces, *lengths)
        name = f"teleports-{query.split('/')[-1]}"
        drives.append(Drive(name, carried, (10, exact), (query, reference)))
    for name, query, reference in (("gardens", night, day), ("nordland", winter, summer)):
        drives += [Drive(f"pace-{name}-{pace}", at_pace(query, reference, pace), (10, 5),
                         (query, reference)) for pace in (0.5, 0.67, 1.5)]
    for query, reference in ((night, day), (day, night)):
        drives += [Drive(f"stops-{query.split('/')[-1]}-{whose}",
                         with_stops(query, reference, 60, 100, whose), (10, 2), (query, reference))
                   for whose in ("now", "then", "both")]
    drives += [Drive(f"slow-street-{seed}-{metres}", street(seed, "localise", metres=metres),
                     (int(10 / metres), int(3 / metres)))
               for seed in seeds[:4] for metres in (0.5, 0.25)]
    drives += [Drive(f"new-{source.split('/')[-1]}", nothing_twice(source), (10, 2), (source,))
               for source in (*GARDENS, *NORDLAND)]
    for seed, other in zip(seeds, seeds[1:] + seeds[:1]):
        drives += [Drive(f"street-{seed}", street(seed, "localise"), (10, 3)),
                   Drive(f"street-{seed}-loop", street(seed, "loop"), (10, 3),
                         near=near_on_street(seed)),
                   Drive(f"street-{seed}-new-summer", street(seed, "localise", 0), (10, 3)),
                   Drive(f"street-{seed}-new-winter", street(seed, "localise", 1), (10, 3))]
        if other != seed:
            drives += [Drive(f"elsewhere-{seed}-in-{other}", elsewhere(seed, other), (10, 3)),
                       Drive(f"carried-off-{other}-to-{seed}", elsewhere(seed, other, 16), (10, 3))]
    drives += [first_or_second_half_faster(drive, pace) for drive in drives
               if drive.name.endswith("-loop") for pace in (0.5, 0.67, 1.5, 2.0)]
    return drives
