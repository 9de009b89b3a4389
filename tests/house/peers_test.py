# SPDX-License-Identifier: MIT
"""What tools/peers compares with: the guesses of `seqloop-peers loops`, and what is accepted of them.

Usage: peers_test.py SOURCE PEERS STREET
"""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SOURCE, PEERS, STREET = map(pathlib.Path, sys.argv[1:4])
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "tools"))

import peer_loops  # noqa: E402

SEED = 3


def guesses_of(place: list[int], value: list[float]) -> peer_loops.Guesses:
    nothing = np.zeros(len(place))
    return peer_loops.Guesses(np.array(place), {"value": np.array(value)}, np.ones(len(place), bool), nothing, nothing, 0)


class Judging(unittest.TestCase):
    def test_steady_frames_are_those_that_follow_each_other(self) -> None:
        place = np.array([3, 4, 5, -1, 6, 90, 91, 97, 98])
        self.assertEqual(peer_loops.steady(place, 1).tolist(), [True] * 3 + [False] + [True] * 5)
        self.assertEqual(peer_loops.steady(place, 2).tolist(),
                         [False, True, True, False, False, False, True, False, True])
        self.assertEqual(peer_loops.steady(place, 3).tolist(), [False, False, True] + [False] * 6)

    def test_the_best_threshold_has_no_false_answer(self) -> None:
        # Frames 10 to 15 see places 0 to 5; frame 16 sees nothing known, frame 17 nobody knows.
        truth = {frame: [frame - 10] for frame in range(10, 16)} | {16: []}
        place = [-1] * 10 + [0, 1, 2, 50, 4, 5, 7, 70]
        value = [9.0] * 10 + [.1, .2, .3, .25, .9, .15, .35, .0]
        judge = peer_loops.Judge(guesses_of(place, value), truth, 0)
        usual = judge.usual()
        self.assertEqual((usual.accepted, usual.precision, usual.recall), (7, 5 / 7, 5 / 6))
        best = judge.best()
        # Below .25 there are three right ones; steady ones alone: frames 11 and 12 (and 15, after a gap of one).
        self.assertEqual((best.precision, best.recall), (1.0, 3 / 6))
        self.assertEqual(best.by, "value")
        self.assertEqual(peer_loops.Judge(guesses_of([7], [.1]), {0: []}, 0).best().recall, 0)

    def test_any_earlier_visit_is_right(self) -> None:
        judge = peer_loops.Judge(guesses_of([4, 41, 60], [.1] * 3), {0: [5, 40], 1: [5, 40], 2: [5, 40]}, 1)
        self.assertEqual(judge.usual().recall, 2 / 3)


class Guessing(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)

    def loops(self, by: str, source: pathlib.Path, *flags: object) -> list[dict[str, str]]:
        out = self.work / "out.csv"
        subprocess.run([PEERS, "loops", "--by", by, "--source", source, "--out", out, *map(str, flags)], check=True,
                       capture_output=True)
        with out.open(encoding="ascii") as stream:
            return list(csv.DictReader(stream))

    def test_the_nearest_neighbour_is_the_nearest(self) -> None:
        random = np.random.default_rng(SEED)
        lap = random.standard_normal((80, 16))
        rows = np.vstack([lap, lap + .3 * random.standard_normal(lap.shape)])
        rows = (rows / np.linalg.norm(rows, axis=1, keepdims=True)).astype(np.float32)
        np.save(self.work / "drive.npy", rows)
        found = self.loops("flat", self.work / "drive.npy", "--exclude", 20)
        for frame, row in enumerate(found):
            known = rows[:max(0, frame - 20)]
            if len(known) == 0:
                self.assertEqual(row["place"], "")
                continue
            far = np.linalg.norm(known - rows[frame], axis=1)
            self.assertEqual(int(row["place"]), int(far.argmin()), frame)
            self.assertAlmostEqual(float(row["distance"]), float(far.min()), places=4)
            others = far[abs(np.arange(len(far)) - far.argmin()) > 10]
            if len(known) > 42:  # 32 are looked at, 21 of them may be its neighbours
                self.assertAlmostEqual(float(row["ratio"]), float(far.min() / others.min()), places=4)
        for by, flags in (("hnsw", []), ("flat", ["--standardise"])):
            found = self.loops(by, self.work / "drive.npy", "--exclude", 20, *flags)
            right = sum(int(row["place"]) == frame - 80 for frame, row in enumerate(found) if frame >= 80)
            self.assertGreater(right, 70, by)

    def test_words_find_a_street_again(self) -> None:
        subprocess.run([STREET, "--out", self.work / "street", "--frames", "60", "--size", "320x180", "--second-light",
                        "summer"], check=True, capture_output=True)
        found = self.loops("words", self.work / "street/query", "--reference", self.work / "street/reference")
        with (self.work / "street/truth.csv").open(encoding="ascii") as stream:
            truth = {int(row["query"]): int(row["reference"]) for row in csv.DictReader(stream)}
        near = [abs(int(found[frame]["place"]) - place) <= 3 for frame, place in truth.items() if found[frame]["place"]]
        self.assertGreater(sum(near), len(truth) / 2)
        self.assertGreater(np.median([int(row["inliers"]) for row in found]), 12)

    def test_what_is_refused(self) -> None:
        for flags, words in ((["--by", "magic"], "magic"), (["--source", "none.npy"], "none.npy")):
            done = subprocess.run([PEERS, "loops", "--out", self.work / "o.csv", *flags], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_the_comparison_knows_its_drives_before_it_works(self) -> None:
        done = subprocess.run([sys.executable, "-B", SOURCE / "tools/peers", self.work / "out", "--data", self.work,
                               "--street", "-1", "--only", "gardens,streets"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        for words in ("--street -1: 0 or more", "--only streets: no such drive; there are gardens, gardens-loop",
                      "day_left: is not there"):
            self.assertIn(words, done.stderr)
        self.assertNotIn("--only gardens", done.stderr)
        self.assertFalse((self.work / "out").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
