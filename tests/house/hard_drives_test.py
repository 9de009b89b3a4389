# SPDX-License-Identifier: MIT
"""The truth of the changed drives of tools/confidence.

Usage: hard_drives_test.py SOURCE
"""
import functools
import pathlib
import sys
import unittest

import numpy as np

SOURCE = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "tools"))

import hard_drives  # noqa: E402

SEED, FRAMES, STAND = 5, 400, range(200, 220)


class Drives:
    """In place of a Maker: drives of one road, on which all stand at the frames of STAND. Every
    drive has its own first value, the second one counts the frames."""

    def __init__(self, count: int = FRAMES):
        self.count = count

    @functools.cache
    def real(self, source: str) -> np.ndarray:
        rows = np.random.default_rng(SEED).normal(size=(self.count, 8))
        rows[STAND.start:STAND.stop] = rows[STAND.start]
        rows[:, 0], rows[:, 1] = sum(map(ord, source)), np.arange(self.count) * 1e-3
        return rows


def frames_of(rows: np.ndarray) -> list[int]:
    return np.rint(rows[:, 1] * 1e3).astype(int).tolist()


class HardDrives(unittest.TestCase):
    def setUp(self) -> None:
        self.drives = Drives()
        self.way = hard_drives.way_of(self.drives, "one", "other")

    def test_a_stand_is_one_place(self) -> None:
        self.assertEqual(len(self.way), FRAMES)
        self.assertEqual(len(set(self.way[STAND.start:STAND.stop])), 1)
        self.assertEqual(self.way[-1], FRAMES - 1 - (len(STAND) - 1))
        self.assertTrue((np.diff(self.way[:STAND.start]) == 1).all())

    def test_all_rows_are_right_that_are_near_on_the_way(self) -> None:
        at = np.array([50, STAND.start - 3])
        truth = hard_drives.truth_of(self.way, at, np.arange(FRAMES))
        self.assertEqual(truth[0], list(range(40, 61)))
        self.assertEqual(truth[1], list(range(STAND.start - 13, STAND.stop + 7)))

    def test_edits_are_what_they_are_called(self) -> None:
        dice = hard_drives.dice_of(0)
        kept = hard_drives.lost(0.2, 6, 6000, dice)
        gaps = np.diff(kept)[np.diff(kept) > 1] - 1
        self.assertTrue((gaps % 6 == 0).all())
        self.assertAlmostEqual(len(kept) / 6000, 0.8, delta=0.04)
        self.assertEqual(hard_drives.repeated(3, 2, dice).tolist(), [0, 0, 0, 1, 1, 1])
        seen = hard_drives.hidden(20, FRAMES, dice)
        self.assertEqual((seen != np.arange(FRAMES)).sum(), 19)
        turned = hard_drives.turning_back(70, FRAMES, dice)
        steps = np.diff(turned)
        self.assertEqual(set(np.abs(steps)), {1})
        self.assertEqual((steps[1:] < steps[:-1]).sum(), (FRAMES - 1) // 70)
        self.assertEqual(set(turned), set(range(FRAMES)))

    def test_of_a_loop_only_what_is_new_has_no_place(self) -> None:
        edit = functools.partial(hard_drives.turning_back, 70)
        rows, known, truth = hard_drives.edited_loop("one", "other", edit, 1)(self.drives)
        self.assertIsNone(known)
        seen, at = frames_of(rows), {}
        half = next(i for i in range(1, len(rows)) if rows[i, 0] != rows[0, 0])
        for i, frame in enumerate(seen):
            for place in truth.get(i, []):
                self.assertLess(place, i)
                self.assertLessEqual(abs(self.way[seen[place]] - self.way[frame]), hard_drives.NEAR)
            self.assertTrue(i < half or truth[i], i)
            if i < half and i in truth:
                self.assertEqual(truth[i], [])
                earlier = [at[f] for f in at if abs(self.way[f] - self.way[frame]) <= hard_drives.NEAR]
                self.assertTrue(all(e > i - hard_drives.NEWEST for e in earlier), i)
            at.setdefault(frame, i)
        self.assertGreater(sum(i in truth for i in range(half)), 200)

    def test_rows_and_truth_agree_where_it_localises(self) -> None:
        one = ("one", "other")
        for make in (hard_drives.edited(*one, functools.partial(hard_drives.lost, 0.3, 1), 2),
                     hard_drives.thinned_out(*one, 3, 1),
                     hard_drives.thinned_out(*one, 2, 0),
                     hard_drives.hole_in_the_map(*one, 30, 3),
                     hard_drives.out_of_the_map(*one, 0.3, True),
                     hard_drives.another_way(*one, 20, 1),
                     hard_drives.switched_on(*one, 45, 2)):
            rows, known, truth = make(self.drives)
            seen, places = frames_of(rows), frames_of(known)
            self.assertEqual(sorted(truth), list(range(len(rows))))
            found = 0
            for i, frame in enumerate(seen):
                nearest = int(np.abs(self.way[places] - self.way[frame]).argmin())
                if truth[i] and abs(self.way[places[nearest]] - self.way[frame]) <= 1:
                    self.assertIn(nearest, truth[i])
                    found += 1
            self.assertGreater(found, len(rows) / 4)

    def test_a_hole_is_right_on_either_side_and_what_is_elsewhere_nowhere(self) -> None:
        rows, known, truth = hard_drives.hole_in_the_map("one", "other", 30, 3)(self.drives)
        self.assertEqual(len(known), FRAMES - 30)
        missing = sorted(set(range(FRAMES)) - set(frames_of(known)))
        self.assertEqual(truth[missing[15]], list(range(missing[0] - 10, missing[0] + 10)))
        _, known, truth = hard_drives.out_of_the_map("one", "other", 0.5, False)(self.drives)
        self.assertEqual({i for i in truth if not truth[i]}, set(range(FRAMES // 2, FRAMES)))
        _, _, truth = hard_drives.in_another_part("one", "other", 2, 0, 1)(self.drives)
        self.assertFalse(any(truth.values()))
        _, _, truth = hard_drives.into_another_world("one", "other", "third", 0)(self.drives)
        self.assertEqual([bool(truth[i]) for i in (0, 119, 120, 319)], [True, True, False, False])
        _, _, truth = hard_drives.behind_a_detour("one", "other", "third", 100, 0)(self.drives)
        self.assertEqual([bool(truth[i]) for i in (0, 499, 500, 899)], [False, False, True, True])

    def test_drives_of_one_name_differ_in_their_draw(self) -> None:
        drives = hard_drives.hard_drives()
        self.assertTrue(all(drive.name.startswith("hard-") for drive in drives))
        again = [drive for drive in drives if drive.name == "hard-lost-0.3-nordland"]
        self.assertEqual(len(again), hard_drives.DRAWS)
        lengths = {len(drive.make(self.drives)[0]) for drive in again}
        self.assertGreater(len(lengths), 1)


print("seed", SEED)
unittest.main(argv=sys.argv[:1])
