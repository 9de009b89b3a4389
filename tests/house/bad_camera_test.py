# SPDX-License-Identifier: MIT
"""What tools/bad_camera makes of pictures.

Usage: bad_camera_test.py SOURCE
"""
import pathlib
import sys
import tempfile
import unittest

import numpy as np
from PIL import Image

SOURCE = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "tools"))

import bad_camera  # noqa: E402

SEED, FRAMES, HEIGHT, WIDTH = 5, 200, 40, 60


class BadCamera(unittest.TestCase):
    def setUp(self) -> None:
        dice = np.random.default_rng(SEED)
        self.pictures = dice.integers(0, 256, (FRAMES, HEIGHT, WIDTH, 3)).astype(np.float32)

    def taken(self, kind: str, drive: int = 1) -> np.ndarray:
        take = bad_camera.KINDS[kind]
        return np.stack([
            take(bad_camera.Shot(picture, frame, np.random.default_rng([drive, frame]), drive, FRAMES))
            for frame, picture in enumerate(self.pictures)])

    def test_every_kind_keeps_the_size_and_changes_the_picture(self) -> None:
        for kind in bad_camera.KINDS:
            bad = self.taken(kind)
            self.assertEqual(bad.shape, self.pictures.shape, kind)
            self.assertTrue(np.isfinite(bad).all(), kind)
            self.assertGreater(np.abs(bad - self.pictures).mean(), 3, kind)
            self.assertTrue((bad == self.taken(kind)).all(), kind)

    def test_chance_is_another_on_another_drive(self) -> None:
        for kind in ("aside", "crowd", "dirt", "flicker", "lamp", "noise", "shake"):
            self.assertFalse((self.taken(kind) == self.taken(kind, 2)).all(), kind)
        for kind in ("bumper", "coarse", "haze"):
            self.assertTrue((self.taken(kind) == self.taken(kind, 2)).all(), kind)

    def test_a_bumper_is_the_lowest_three_tenths_and_always_the_same(self) -> None:
        bad = self.taken("bumper")
        self.assertTrue((bad[:, :28] == self.pictures[:, :28]).all())
        self.assertTrue((bad[:, 28:] == bad[0, 28:]).all())

    def test_a_crowd_hides_a_quarter_half_of_the_time(self) -> None:
        changed = (self.taken("crowd") != self.pictures).any(axis=3)
        there = changed.any(axis=(1, 2))
        self.assertTrue((changed[there].any(axis=1).sum(axis=1) == WIDTH // 4).all())
        ends = np.flatnonzero(np.diff(there.astype(int)))
        lasts = np.diff(ends)
        self.assertTrue(((10 <= lasts) & (lasts < 40)).all(), lasts)
        flat = np.zeros((4, 6, 3), np.float32)
        dark = [not bad_camera.crowd(bad_camera.Shot(flat, frame, np.random.default_rng(0), drive, 300)).any()
                for drive in range(20) for frame in range(0, 300, 3)]
        self.assertAlmostEqual(np.mean(dark), .5, delta=.06)

    def test_aside_moves_columns_by_an_eighth_at_most(self) -> None:
        moved = set()
        for bad, picture in zip(self.taken("aside"), self.pictures):
            moved |= {by for by in range(-8, 9)
                      if (bad == picture[:, np.clip(np.arange(WIDTH) + by, 0, WIDTH - 1)]).all()}
        self.assertLessEqual({-3, -2, -1, 0, 1, 2, 3}, moved)
        self.assertLessEqual(max(map(abs, moved)), 7)

    def test_numbers_are_those_that_are_said(self) -> None:
        self.assertTrue((self.taken("haze") == 140 + self.pictures / 4).all())
        self.assertAlmostEqual(float((self.taken("noise") - self.pictures).std()), 20, delta=.2)
        gains = np.log(self.taken("flicker").mean(axis=(1, 2, 3)) / self.pictures.mean(axis=(1, 2, 3)))
        self.assertAlmostEqual(float(gains.std()), .36, delta=.06)
        small = self.taken("coarse")[0]
        self.assertLess(small.std(), self.pictures[0].std() / 2)

    def test_dirt_stays_where_it_is_and_a_lamp_sways(self) -> None:
        self.pictures[:] = 200
        dirt, lamp = self.taken("dirt"), self.taken("lamp")
        self.assertTrue((dirt == dirt[0]).all())
        self.assertTrue((90 <= dirt).all() and (dirt <= 200).all() and (dirt < 150).any())
        self.assertGreater(len({int(frame[..., 0].argmax()) for frame in lamp}), 20)

    def test_values_change_slowly_by_1(self) -> None:
        values = bad_camera.slowly(20000, np.random.default_rng(SEED), 60)
        self.assertAlmostEqual(float(values.std()), 1, delta=.2)
        self.assertLess(float(np.abs(np.diff(values)).mean()), .2)

    def test_a_folder_is_taken_again_in_order(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            drive, out = pathlib.Path(name) / "drive", pathlib.Path(name) / "a" / "bad"
            drive.mkdir()
            for level, frame in enumerate((0, 2, 10)):
                Image.new("L", (20, 10), 40 * level).save(drive / f"f{frame}.png")
            (drive / ".hidden").write_text("no picture", encoding="ascii")
            (drive / "folder").mkdir()
            bad_camera.take_again("haze", drive, out)
            levels = [int(np.asarray(Image.open(file)).mean()) for file in sorted(out.iterdir())]
            self.assertEqual(levels, [140, 150, 160])
            with self.assertRaises(FileExistsError):
                bad_camera.take_again("haze", drive, out)


print("seed", SEED)
unittest.main(argv=sys.argv[:1])
