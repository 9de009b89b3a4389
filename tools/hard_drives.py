# SPDX-License-Identifier: MIT
"""Real drives, changed in ways that robots and recordings change them: frames lost, repeated, in
between, in reverse; places that the map lacks; roads that are left. Used by tools/confidence."""
import functools
import itertools
from typing import Callable

import numpy as np

from confidence_drives import GARAGE, Drive, Maker, Truth
from loop_drives import GARDENS, NORDLAND

DRAWS, NEAR, NEWEST = 4, 10, 20  # frames on the way that are right, and that are no places yet
Dice = np.random.Generator
# Which frames of a drive of so many come, in order.
Edit = Callable[[int, Dice], np.ndarray]


def dice_of(draw: int) -> Dice:
    return np.random.default_rng([13, draw])


def lost(share: float, together: int, count: int, dice: Dice) -> np.ndarray:
    """All but a share of the frames, so many on end."""
    runs = dice.random(-(-count // together)) < share
    return np.flatnonzero(~np.repeat(runs, together)[:count])


def every(step: int, count: int, _: Dice) -> np.ndarray:
    return np.arange(0, count, step)


def repeated(times: int, count: int, _: Dice) -> np.ndarray:
    return np.repeat(np.arange(count), times)


def hidden(length: int, count: int, dice: Dice) -> np.ndarray:
    """One picture in place of so many, somewhere."""
    frames = np.arange(count)
    at = int(dice.integers(60, count - 60 - length))
    frames[at:at + length] = at
    return frames


def turning_back(forwards: int, count: int, dice: Dice) -> np.ndarray:
    """Backwards for 10 to 30 frames each so many, and on."""
    frames: list[int] = []
    for start in range(0, count, forwards):
        stop = min(start + forwards, count)
        frames += range(start, stop)
        if stop < count:
            back = stop - int(dice.integers(10, 31))
            frames += [*range(stop - 2, back, -1), *range(back, stop)]
    return np.array(frames)


@functools.lru_cache
def way_of(maker: Maker, one: str, other: str) -> np.ndarray:
    """How far a robot is at a frame, in frames in which it moves: where both drives hardly change
    for some frames it stands, and is at one place."""
    changes = [np.linalg.norm(np.diff(maker.real(drive), axis=0), axis=1)
               for drive in (one, other)]
    still = np.all([change < 0.5 * np.median(change) for change in changes], axis=0)
    stands = np.convolve(np.convolve(still, np.ones(5), "full") == 5, np.ones(5), "valid") > 0
    return np.append(0, np.cumsum(~stands))


def truth_of(way: np.ndarray, frames: np.ndarray, known: np.ndarray, near: int = NEAR) -> Truth:
    """Of each frame the rows that are right: all that are near on the way."""
    apart = np.abs(way[frames][:, None] - way[known])
    return {i: np.flatnonzero(some <= near).tolist() for i, some in enumerate(apart)}


def after_new(new: int, truth: Truth) -> Truth:
    """Of a drive that begins with so many new frames."""
    return {i: [] for i in range(new)} | {new + i: places for i, places in truth.items()}


def near_of(step: int) -> int:
    """Of drives of every so many-th frame: five of these."""
    return max(NEAR, NEAR * step // 2)


def edited(query: str, reference: str, edit: Edit, draw: int):
    """Localising in the whole reference."""
    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        frames, way = edit(len(rows), dice_of(draw)), way_of(maker, query, reference)
        return rows[frames], known, truth_of(way, frames, np.arange(len(known)))
    return make


def edited_loop(first: str, second: str, edit: Edit, draw: int, near: int = NEAR):
    """As one drive, either half by a draw of its own. What a robot comes back to at once is right,
    too, in the first half it is not asked for."""
    def make(maker: Maker):
        dice, way = dice_of(draw), way_of(maker, first, second)
        before, after = maker.real(first), maker.real(second)
        known, frames = edit(len(before), dice), edit(len(after), dice)
        whole = np.concatenate([known, frames])
        right = truth_of(way, whole, whole, near)
        truth: Truth = {i: [] for i in range(len(known)) if min(right[i]) > i - NEWEST}
        truth |= {i: [place for place in right[i] if place < i]
                  for i in range(len(known), len(whole))}
        return np.vstack([before[known], after[frames]]), None, truth
    return make


def thinned_out(query: str, reference: str, step: int, first: int):
    """Every so many-th frame from the first on, in a map of every so many-th from 0 on."""
    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        frames, places = np.arange(first, len(rows), step), np.arange(0, len(known), step)
        truth = truth_of(way_of(maker, query, reference), frames, places, near_of(step))
        return rows[frames], known[places], truth
    return make


def start_of(count: int, length: int, dice: Dice) -> int:
    return int(dice.integers(0, count - length + 1))


def another_way(query: str, reference: str, length: int, draw: int):
    """Two corridors of 100 frames are the map's, what lies between is not."""
    def make(maker: Maker):
        rows, known, dice = maker.real(query), maker.real(reference), dice_of(draw)
        quarter = len(rows) // 4
        one, mine, robots, two = (k * quarter + start_of(quarter, 100, dice) for k in range(4))
        places, frames = (
            np.concatenate([np.arange(at, at + n)
                            for at, n in ((one, 100), (between, length), (two, 100))])
            for between in (mine, robots))
        truth = truth_of(way_of(maker, query, reference), frames, places)
        return rows[frames], known[places], truth | {100 + i: [] for i in range(length)}
    return make


def hole_in_the_map(query: str, reference: str, length: int, draw: int):
    """So many places are missing: their frames are right beside the hole."""
    def make(maker: Maker):
        rows, known, dice = maker.real(query), maker.real(reference), dice_of(draw)
        at = 40 + start_of(len(known) - 80, length, dice)
        kept = np.delete(np.arange(len(known)), np.arange(at, at + length))
        truth = truth_of(way_of(maker, query, reference), np.arange(len(rows)), kept)
        beside = list(range(at - NEAR, at + NEAR))
        return rows, known[kept], truth | {at + i: beside for i in range(length)}
    return make


def out_of_the_map(query: str, reference: str, share: float, end: bool):
    """The map is a drive's first part, or its last; the robot drives all of it."""
    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        count = int(len(known) * share)
        first = len(known) - count if end else 0
        kept = range(first, first + count)
        truth = truth_of(way_of(maker, query, reference), np.arange(len(rows)), np.array(kept))
        return (rows, known[first:first + count],
                truth | {frame: [] for frame in range(len(rows)) if frame not in kept})
    return make


def in_another_part(query: str, reference: str, parts: int, part: int, of: int):
    """In the map of another part of the road, ten frames or more away."""
    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        cuts = np.linspace(0, len(rows), parts + 1).astype(int)
        seen = rows[cuts[part] + 5:cuts[part + 1] - 5]
        return seen, known[cuts[of] + 5:cuts[of + 1] - 5], {i: [] for i in range(len(seen))}
    return make


def switched_on(query: str, reference: str, length: int, draw: int):
    """So many frames somewhere on the map, and no more."""
    def make(maker: Maker):
        rows, known = maker.real(query), maker.real(reference)
        frames = start_of(len(rows), length, dice_of(draw)) + np.arange(length)
        truth = truth_of(way_of(maker, query, reference), frames, np.arange(len(known)))
        return rows[frames], known, truth
    return make


def in_another_world(query: str, reference: str):
    def make(maker: Maker):
        rows = maker.real(query)
        return rows, maker.real(reference), {i: [] for i in range(len(rows))}
    return make


def into_another_world(query: str, reference: str, beyond: str, draw: int):
    """120 frames of the map's road, and on, by a hard cut, for 200 frames of another."""
    def make(maker: Maker):
        rows, known, far = maker.real(query), maker.real(reference), maker.real(beyond)
        dice = dice_of(draw)
        at, there = start_of(len(rows), 120, dice), start_of(len(far), 200, dice)
        frames = np.arange(at, at + 120)
        truth = truth_of(way_of(maker, query, reference), frames, np.arange(len(known)))
        return (np.vstack([rows[frames], far[there:there + 200]]), known,
                truth | {120 + i: [] for i in range(200)})
    return make


def short_loop(first: str, second: str, length: int, draw: int):
    """So many frames somewhere, and once more, as one drive."""
    def make(maker: Maker):
        before, after = maker.real(first), maker.real(second)
        frames = start_of(len(before), length, dice_of(draw)) + np.arange(length)
        truth = truth_of(way_of(maker, first, second), frames, frames)
        return np.vstack([before[frames], after[frames]]), None, after_new(length, truth)
    return make


def behind_a_detour(first: str, second: str, detour: str, length: int, draw: int):
    """As one drive, with so many frames of another road between."""
    def make(maker: Maker):
        before, after, far = maker.real(first), maker.real(second), maker.real(detour)
        there = start_of(len(far), length, dice_of(draw))
        frames = np.arange(len(after))
        truth = truth_of(way_of(maker, first, second), frames, frames)
        return (np.vstack([before, far[there:there + length], after]), None,
                after_new(len(before) + length, truth))
    return make


def hard_drives() -> list[Drive]:
    """Those of one name differ by their draw, and are one row."""
    (day, night), (summer, winter) = GARDENS, NORDLAND
    pairs = {"gardens": (night, day), "nordland": (winter, summer)}
    drives: list[Drive] = []

    def add(name: str, make, needs: tuple[str, ...]) -> None:
        drives.append(Drive(f"hard-{name}", make, (0, 0), needs))

    certain: dict[str, Edit] = {
        "twice": functools.partial(repeated, 2),
        "three-times": functools.partial(repeated, 3)}
    by_chance: dict[str, Edit] = {
        **{f"lost-{share}": functools.partial(lost, share, 1) for share in (0.1, 0.3, 0.5)},
        "lost-0.2-by-6": functools.partial(lost, 0.2, 6),
        "hidden-20": functools.partial(hidden, 20),
        "turning-back": functools.partial(turning_back, 70)}
    for base, (query, reference) in pairs.items():
        for draws, edits in ((1, certain), (DRAWS, by_chance)):
            for (name, edit), draw in itertools.product(edits.items(), range(draws)):
                add(f"{name}-{base}", edited(query, reference, edit, draw), (query, reference))
                add(f"{name}-{base}-loop", edited_loop(reference, query, edit, draw),
                    (query, reference))
        for seen, known in ((query, reference), (reference, query)):
            needs = (seen, known)
            for step in (2, 3, 4):
                add(f"between-{step}-{base}", thinned_out(seen, known, step, step // 2), needs)
            for step in (2, 3, 5, 8):
                add(f"every-{step}-{base}", thinned_out(seen, known, step, 0), needs)
                edit = functools.partial(every, step)
                add(f"every-{step}-{base}-loop",
                    edited_loop(known, seen, edit, 0, near_of(step)), needs)
            for share in (0.3, 0.5, 0.7):
                for end in (False, True):
                    add(f"out-of-the-map-{base}", out_of_the_map(seen, known, share, end), needs)
            for parts in (2, 3):
                for part, of in np.argwhere(~np.eye(parts, dtype=bool)).tolist():
                    add(f"in-another-part-{base}",
                        in_another_part(seen, known, parts, part, of), needs)
            for draw in range(3 * DRAWS):
                for length in (30, 45, 60):
                    add(f"switched-on-{length}-{base}", switched_on(seen, known, length, draw),
                        needs)
            for draw in range(2 * DRAWS):
                for length in (50, 75, 100, 150):
                    add(f"short-{length}-{base}-loop", short_loop(known, seen, length, draw),
                        needs)
            for draw in range(DRAWS):
                for length in (15, 30, 60):
                    add(f"hole-{length}-{base}", hole_in_the_map(seen, known, length, draw),
                        needs)
    for seen, known in ((winter, summer), (summer, winter)):
        for draw in range(DRAWS):
            for length in (20, 60, 100):
                add(f"another-way-{length}-nordland", another_way(seen, known, length, draw),
                    (seen, known))
            for beyond in (GARAGE, day):
                add(f"into-{beyond.split('/')[0]}-nordland",
                    into_another_world(seen, known, beyond, draw), (seen, known, beyond))
    for first, second in ((day, night), (night, day)):
        for length in (100, 200, 600):
            for draw in range(DRAWS):
                add(f"detour-{length}-gardens",
                    behind_a_detour(first, second, summer, length, draw), (first, second, summer))
    worlds = ((day, night), (summer, winter), (GARAGE,))
    for mine, others in itertools.permutations(worlds, 2):
        for seen, known in itertools.product(mine, others):
            add("in-another-world", in_another_world(seen, known), (seen, known))
    return drives
