# SPDX-License-Identifier: MIT
"""On Gardens Point, `import seqloop` describes and answers as the program does, to the byte.

Wants PYTHONPATH, and in SEQLOOP_BINARY the program. Exit code 77 without SEQLOOP_SHARED.
"""
import os
import pathlib
import sys
import tempfile
import unittest

import numpy

import seqloop
from package_test import as_csv, program

SHARED = pathlib.Path(os.environ.get("SEQLOOP_SHARED", "/nowhere"))
DRIVES = [SHARED / "data/gardens_point" / name for name in ("day_left", "night_right")]


class GardensPoint(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.files = [pathlib.Path(cls.folder.name, drive.name + ".npy") for drive in DRIVES]
        for drive, file in zip(DRIVES, cls.files):
            program("describe", "--source", drive, "--out", file)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_descriptors_and_answers(self) -> None:
        describer = seqloop.Describer()
        described = [describer.describe_drive(drive) for drive in DRIVES]
        for ours, file in zip(described, self.files):
            self.assertEqual(ours.tobytes(), numpy.load(file).tobytes())
        out = pathlib.Path(self.folder.name, "matches.csv")
        for settings in ({}, {"method": "seqcnnslam", "ds": 40}, {"paper": True, "ds": 20}):
            flags = [word for name, value in settings.items()
                     for word in (["--" + name] if value is True else ["--" + name, value])]
            program("match", "--reference", self.files[0], "--query", self.files[1], "--out", out, *flags)
            self.assertEqual(as_csv(seqloop.match(*described, **settings)), out.read_text())

    def test_a_model(self) -> None:
        out = pathlib.Path(self.folder.name, "pool5.npy")
        model = SHARED / "models/squeezenet11_places365.onnx"
        mean, scale = (104.05, 112.51, 116.67), 1 / 255
        program("describe", "--source", DRIVES[0], "--frames", 4, "--model", model, "--layer", "pool5", "--mean",
                ",".join(map(str, mean)), "--scale", scale, "--out", out)
        describer = seqloop.Describer(model=model, layer="pool5", mean=mean, scale=scale)
        self.assertEqual(describer.describe_drive(DRIVES[0], frames=4).tobytes(), numpy.load(out).tobytes())


if __name__ == "__main__":
    if not SHARED.is_dir():
        print("SEQLOOP_SHARED names no folder of real data")
        sys.exit(1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77)
    unittest.main()
