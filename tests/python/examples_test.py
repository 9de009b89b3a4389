# SPDX-License-Identifier: MIT
"""The examples: what they print, and that they draw the picture on the page of the room.

Usage: examples_test.py SOURCE [DRIVES]    wants PYTHONPATH, SEQLOOP_BINARY and SEQLOOP_STREET_BINARY; with DRIVES, a folder with
Gardens Point, the protocol is run there. Exit code 77 where matplotlib or DRIVES is missing.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy

SOURCE = pathlib.Path(sys.argv[1])
EXAMPLES = SOURCE / "tools/python/examples"
DRIVES = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
sys.path.insert(0, str(EXAMPLES))
sys.dont_write_bytecode = True


def run(script: str, *arguments: object) -> str:
    command = [sys.executable, "-B", EXAMPLES / script, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Protocol(unittest.TestCase):
    def test_its_measures(self) -> None:
        import vpr_protocol
        S = numpy.array([[.9, .1, .3], [.5, .8, .2], [.1, .2, .1]])
        truth = numpy.array([[True, False, False], [False, False, True], [False, True, False]])
        predictions = vpr_protocol.ranked(S, 3)
        self.assertEqual(predictions.tolist(), [[0, 1, 2], [1, 2, 0], [0, 1, 2]])
        self.assertEqual([vpr_protocol.recall_at(predictions, truth, k) for k in (1, 2, 3)], [1 / 3, 1, 1])
        predictions[0] = -1  # no prediction is none of the last row
        self.assertEqual(vpr_protocol.recall_at(predictions, truth, 1), 0)
        # Right at .9, wrong at .8 and .3: a third of the queries at a precision of 1.
        self.assertAlmostEqual(vpr_protocol.area_under_curve(S, truth), 1 / 3)
        S[0, 0] = -numpy.inf
        S[1, 0] = -numpy.inf
        self.assertEqual(vpr_protocol.area_under_curve(S, truth), 0)

    def test_on_gardens_point(self) -> None:
        if DRIVES is None:
            self.skipTest("no DRIVES")
        said = run("vpr_protocol.py", DRIVES / "day_left", DRIVES / "night_right")
        print(said)
        recall = {name: float(value) for name, value in re.findall(r"^(.*?)  +([01]\.\d+)", said, re.MULTILINE)}
        self.assertGreater(recall["our descriptor, our matcher"], .95)
        self.assertGreater(recall["another descriptor, our matcher"], .9)
        self.assertLess(recall["our descriptor, dot product"], .5)
        # The page has the same numbers; another machine's sums may end a little otherwise.
        printed = [[float(value) for value in row] for row in re.findall(r"  +([01]\.\d+)  +([.\d]+)  +([.\d]+)$", said,
                                                                         re.MULTILINE)]
        table = (SOURCE / "tools/python/README.md").read_text().split("| recall@1 |")[1]
        page = [[float(value) for value in row] for row in re.findall(r"^\|.*\| ([.\d]+) \| ([.\d]+) \| ([.\d]+) \|$", table,
                                                                      re.MULTILINE)]
        self.assertEqual(len(page), 4)
        self.assertLess(numpy.abs(numpy.array(printed) - numpy.array(page)).max(), .005, page)
        self.assertRegex(said, r"accepted: (19\d|200) of 200 frames, precision 1.000")


class StepCost(unittest.TestCase):
    def test_python_and_the_program_do_the_same(self) -> None:
        if DRIVES is not None:
            self.skipTest("elsewhere")
        said = run("step_cost.py", os.environ["SEQLOOP_BINARY"], 60).splitlines()
        self.assertEqual(len(said), 5, said)
        for line in said[1:]:
            *_, program, python = line.split()
            self.assertEqual(program, python)
            self.assertGreater(int(program), 30)


class Look(unittest.TestCase):
    def test_the_picture_is_what_the_script_draws(self) -> None:
        if DRIVES is not None:
            self.skipTest("elsewhere")
        from matplotlib import pyplot
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            subprocess.run([os.environ["SEQLOOP_STREET_BINARY"], "--out", work, "--frames", "200", "--size", "160x90"],
                           check=True, capture_output=True)
            said = run("look.py", work / "reference", work / "query", work / "look.jpg")
            drawn = pyplot.imread(work / "look.jpg").astype(int)
        kept = pyplot.imread(SOURCE / "tools/pictures/python.jpg").astype(int)
        self.assertEqual(drawn.shape, kept.shape)
        # Fonts and JPEG may differ a little from machine to machine; nothing else may.
        self.assertLess(numpy.abs(drawn - kept).mean(), 2.0)
        self.assertGreater(numpy.abs(drawn - 255).mean(), 20.0, "hardly anything is drawn")
        self.assertGreater(int(said.split()[0]), 50)


if __name__ == "__main__":
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        print("not installed: python3-matplotlib")
        sys.exit(1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77)
    if DRIVES is not None and not DRIVES.is_dir():
        print(f"{DRIVES} is no folder")
        sys.exit(1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77)
    unittest.main(argv=sys.argv[:1])
