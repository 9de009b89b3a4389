# SPDX-License-Identifier: MIT
"""Maps in files: what the program wrote is read here, and the other way round, with the same answers.

Wants PYTHONPATH, and in SEQLOOP_BINARY and SEQLOOP_STREET_BINARY the programs.
"""
import json
import os
import pathlib
import resource
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import traceback
import typing
import unittest
import zlib

import numpy

import seqloop
from package_test import drives, program, unit

SIZE = 48


def stepped(places: seqloop.PlaceMap, drive: numpy.ndarray) -> list[tuple]:
    """The rows of a match list, as far as a detector that goes frame by frame knows them."""
    detector = seqloop.Detector(places)
    answers = [answer for row in drive for answer in detector.step(row).answers] + detector.finish()
    answers.sort(key=lambda answer: answer.frame)
    return [(str(answer.frame), str(answer.match.place), f"{answer.match.score:.9g}", f"{answer.probability:.9g}",
             str(int(answer.gate == "match"))) for answer in answers if answer.match]


def listed(path: pathlib.Path) -> list[tuple]:
    lines = [line.split(",") for line in path.read_text().splitlines()[1:]]
    return [(line[0], line[1], line[2], line[9], line[10]) for line in lines]


def content(path: pathlib.Path) -> list:
    """All that a map holds, but when its sessions began and the checksums over that."""
    with sqlite3.connect(path) as map:
        return [map.execute("SELECT id, name, frames, places FROM session").fetchall(),
                map.execute("SELECT * FROM block").fetchall(), map.execute("SELECT * FROM link").fetchall(),
                map.execute("SELECT * FROM statistics").fetchall()]


class Maps(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.work = pathlib.Path(self.folder.name)
        self.drive, self.again = drives(200, SIZE)
        numpy.save(self.work / "drive.npy", self.drive)
        numpy.save(self.work / "again.npy", self.again)

    def match(self, map: pathlib.Path, drive: str, *flags: object) -> list[tuple]:
        out = self.work / "out.csv"
        program("match", "--map", map, "--query", self.work / f"{drive}.npy", "--out", out, *flags)
        return listed(out)

    def open(self, map: pathlib.Path, **settings: seqloop.Setting) -> seqloop.PlaceMap:
        return seqloop.PlaceMap.open(map, SIZE, **settings)

    def test_python_and_the_program_go_on_with_each_others_maps(self) -> None:
        theirs, ours = self.work / "theirs.seqloop", self.work / "ours.seqloop"
        # save_every_s: one batch each, so that the files' blocks are cut alike.
        flags = {"save_every_s": 3600.0}
        for session, name in enumerate(("drive", "again")):
            rows = self.drive if name == "drive" else self.again
            said = self.match(theirs, name, "--session", name, "--save-every-s", 3600)
            with self.open(ours, session=name, **flags) as places:
                self.assertEqual(len(places), 200 * session)
                self.assertEqual(stepped(places, rows), said)
                self.assertEqual(places.saved, 200)
            self.assertEqual(content(ours), content(theirs))
        self.assertGreater(sum(row[-1] == "1" for row in said), 100)
        # Each goes on with the other's.
        crossed = self.work / "crossed.seqloop"
        shutil.copy(theirs, crossed)
        said = self.match(ours, "again", "--session", "third")
        with self.open(crossed, session="third") as places:
            self.assertEqual(stepped(places, self.again), said)
        self.assertEqual(content(crossed)[1:3], content(ours)[1:3])
        for file in (theirs, ours, crossed):
            program("map", "check", file)
            self.assertEqual(seqloop.check_map(file), [])

    def test_with_the_same_room_answers_are_the_same(self) -> None:
        # More than 20,480 places, from where on a frame looks at more of the map the more room there is.
        random = numpy.random.default_rng(3)
        places = random.standard_normal((21_000, SIZE))
        again = numpy.concatenate([places[first:first + 60] for first in (300, 15_000, 20_000, 4_000)])
        again += .35 * random.standard_normal(again.shape)
        for name, rows in (("drive", places), ("again", again)):
            numpy.save(self.work / f"{name}.npy", unit(rows))
        theirs, ours = self.work / "theirs.seqloop", self.work / "ours.seqloop"
        self.match(theirs, "drive", "--session", "drive")
        shutil.copy(theirs, ours)
        said = self.match(theirs, "again")
        with self.open(ours, max_places=len(places) + len(again)) as room:
            self.assertEqual(stepped(room, unit(again)), said)
        self.assertGreater(sum(row[-1] == "1" for row in said), 100)

    def test_a_map_that_is_only_read_stays_as_it_is_and_is_shared(self) -> None:
        file = self.work / "map.seqloop"
        self.match(file, "drive", "--session", "monday")
        before = file.read_bytes()
        said = self.match(file, "again", "--read-only")
        with self.open(file, read_only=True) as places:
            for _ in range(2):
                self.assertEqual(stepped(places, self.again), said)
            self.assertEqual(places.where(7), ("monday", 7))
            self.assertEqual((places.saved, len(places), places.capacity), (0, 200, 200))
            detector = seqloop.Detector(places)
        detector.step(self.again[0])  # its places are in memory
        self.assertEqual(file.read_bytes(), before)

    def test_frames_that_never_came_are_counted(self) -> None:
        with self.open(self.work / "map.seqloop", session="monday") as places:
            detector = seqloop.Detector(places)
            for row in self.drive[:100]:
                detector.step(row)
            detector.skip(300)
            for row in self.drive[100:]:
                newest = detector.step(row).newest
            self.assertEqual(newest, 499)
            self.assertEqual(detector.finish()[-1].frame, 499)
            self.assertEqual([places.where(place) for place in (99, 100, 199)],
                             [("monday", 99), ("monday", 400), ("monday", 499)])

    def test_where_places_are(self) -> None:
        file = self.work / "map.seqloop"
        for name in ("monday", "tuesday"):
            with self.open(file, session=name, max_places=500) as places:
                detector = seqloop.Detector(places)
                for row in self.drive if name == "monday" else self.again:
                    detector.step(row, time_s=1000.0)
                found = [answer.match.place for answer in detector.finish() if answer.gate == "match"]
                self.assertEqual(places.where(len(places) - 1), (name, 199))
                with self.assertRaisesRegex(seqloop.SetupError, "place: 400 is none"):
                    places.where(400)
        self.assertTrue(found)
        info = seqloop.map_info(file)
        self.assertEqual([(session.name, session.places, session.frames) for session in info.sessions],
                         [("monday", 200, 200), ("tuesday", 200, 200)])
        self.assertEqual((info.places, info.descriptor_size, info.describer), (400, SIZE, "descriptors"))
        said = json.loads(program("map", "info", file, "--json").stdout)
        self.assertEqual([session["began_ns"] for session in said["sessions"]],
                         [session.began_ns for session in info.sessions])
        folder = self.work / "exported"
        program("map", "export", file, "--out", folder)
        times = {line.split(",")[3] for line in (folder / "places.csv").read_text().splitlines()[1:]}
        self.assertEqual(times, {"1000000000000"})

    def test_merging(self) -> None:
        files = [self.work / f"{name}.seqloop" for name in ("drive", "again")]
        for file in files:
            self.match(file, file.stem, "--session", file.stem)
        program("map", "merge", *files, "--out", self.work / "theirs.seqloop")
        merged = self.work / "merged.seqloop"
        self.assertEqual(seqloop.merge_maps(files, merged), [0, 200])
        self.assertEqual(content(merged), content(self.work / "theirs.seqloop"))
        for files, out, words in ((files, merged, "such a file already"), ([], merged, "none to merge"),
                                  (files, "", "out: its name is empty")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                seqloop.merge_maps(files, out)
        numpy.save(self.work / "drive.npy", self.drive[:, :9] / numpy.linalg.norm(self.drive[:, :9], axis=1)[:, None])
        self.match(self.work / "small.seqloop", "drive")
        with self.assertRaisesRegex(seqloop.SetupError, "cannot be compared"):
            seqloop.merge_maps([merged, self.work / "small.seqloop"], self.work / "none.seqloop")
        self.assertFalse((self.work / "none.seqloop").exists())

    def test_pictures_are_described_alike(self) -> None:
        file, street = self.work / "map.seqloop", self.work / "street"
        subprocess.run([os.environ["SEQLOOP_STREET_BINARY"], "--out", street, "--frames", "60", "--size", "160x90"],
                       check=True, capture_output=True)
        program("run", "--source", street / "reference", "--map", file, "--out", self.work / "run.jsonl")
        describer = seqloop.Describer()
        rows = describer.describe_drive(street / "query")
        with seqloop.PlaceMap.open(file, describer.size, describer=describer.fingerprint, read_only=True) as places:
            ours = stepped(places, rows)
        program("run", "--source", street / "query", "--map", file, "--read-only", "--out", self.work / "run.jsonl")
        lines = [json.loads(line) for line in (self.work / "run.jsonl").read_text().splitlines()]
        theirs = sorted((answer["frame"], answer["match"]) for line in lines for answer in line["answers"]
                        if answer["match"] is not None)
        self.assertEqual([(int(row[0]), int(row[1])) for row in ours], theirs)
        with self.assertRaisesRegex(seqloop.SetupError, "described by 'gradients of 256x128'"):
            seqloop.PlaceMap.open(file, describer.size, read_only=True)

    def test_what_is_refused(self) -> None:
        file = self.work / "map.seqloop"
        with self.assertRaises(seqloop.SetupError) as raised:
            self.open(file, ds=-1, dss=3, session="a", read_only=True)
        for word in ("ds: '-1'", "'dss': is no setting", "session: nothing is added to a map that is only read"):
            self.assertIn(word, str(raised.exception))
        self.assertFalse(file.exists(), "nothing is made where something is wrong")
        with self.assertRaisesRegex(seqloop.SetupError, "(?s)max_places: -1 is not.*descriptor_size: -735 is not"):
            seqloop.PlaceMap.open(file, -735, -1)
        with self.assertRaisesRegex(seqloop.SetupError, "map"):
            self.open(file, read_only=True)
        with self.assertRaisesRegex(seqloop.SetupError, "memory"):
            self.open(file, max_places=4 * 10**9)
        self.assertFalse(file.exists(), "nor where there is no room")
        self.match(file, "drive", "--session", "monday")
        with self.assertRaisesRegex(seqloop.SetupError, "has 200 places already"):
            self.open(file, max_places=100)
        with self.assertRaisesRegex(seqloop.SetupError, "monday"):
            self.open(file, session="monday")
        with self.open(file) as places:
            with self.assertRaisesRegex(seqloop.SetupError, "kept in a file"):
                places.add_drive(self.drive)
            detector = seqloop.Detector(places)
            with self.assertRaisesRegex(seqloop.SetupError, "a detector has begun"):
                seqloop.Detector(places)
            told = program("match", "--map", file, "--query", self.work / "again.npy", "--out", self.work / "o.csv",
                           check=False)
            self.assertIn(str(os.getpid()), told.stderr, "who holds it")
            for row in self.again[:30]:
                detector.step(row)
            for time_s in (numpy.nan, 1e18, -1e300):
                with self.assertRaisesRegex(seqloop.SetupError, "time_s"):
                    detector.step(self.again[30], time_s=time_s)
            detector.finish()
            for call in (lambda: detector.step(self.again[30]), lambda: detector.skip(3)):
                with self.assertRaisesRegex(seqloop.SetupError, "its drive is over"):
                    call()
            self.assertEqual(len(places), 230)
        for call in (lambda: detector.step(self.again[30]), lambda: detector.skip(3), lambda: places.where(0),
                     lambda: places.saved, lambda: seqloop.Detector(places)):
            with self.assertRaisesRegex(seqloop.SetupError, "it is closed"):
                call()
        self.assertEqual(seqloop.map_info(file).sessions[1].frames, 30)
        memory = seqloop.PlaceMap(9, SIZE)
        for call in (lambda: memory.where(0), lambda: memory.saved):
            with self.assertRaisesRegex(seqloop.SetupError, "no file"):
                call()
        with memory as same:
            self.assertIs(memory, same)
        for call in (seqloop.map_info, seqloop.check_map):
            with self.assertRaisesRegex(seqloop.SetupError, "drive.npy"):
                call(self.work / "drive.npy")

    def in_a_fork(self, look: typing.Callable[[], None]) -> None:
        """A look that raises, or does not come back, fails. Only so much as a fork may use is used there."""
        child = os.fork()
        if child == 0:
            signal.alarm(60)
            try:
                look()
            except BaseException:
                traceback.print_exc()
                os._exit(1)
            os._exit(0)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_a_fork_leaves_the_file_to_who_opened_it(self) -> None:
        file = self.work / "map.seqloop"
        held = [self.open(file, session="monday")]
        held.append(seqloop.Detector(held[0]))
        for row in self.drive[:100]:
            held[1].step(row)

        def look() -> None:
            places, detector = held
            for call in (lambda: detector.step(self.drive[100]), lambda: detector.step(None), lambda: detector.skip(3),
                         detector.finish, detector.newest_column, lambda: len(places), lambda: places.where(0),
                         lambda: places.saved, lambda: seqloop.Detector(places)):
                with self.assertRaisesRegex(seqloop.SetupError, f"map: process {os.getppid()} opened it"):
                    call()
            with places:
                self.assertIn("PlaceMap(", repr(detector))
            del places, detector
            held.clear()

        self.in_a_fork(look)
        places, detector = held
        for row in self.drive[100:]:
            detector.step(row)
        detector.finish()
        self.assertEqual(places.saved, 200)
        places.close()
        self.assertEqual(seqloop.check_map(file), [])
        self.assertEqual(seqloop.map_info(file).sessions[0].frames, 200)
        # What is only read is in memory.
        with self.open(file, read_only=True) as places:
            detector = seqloop.Detector(places)
            said = stepped(places, self.again)
            self.in_a_fork(lambda: (self.assertEqual(stepped(places, self.again), said), detector.step(self.again[0]),
                                    self.assertEqual(places.where(7), ("monday", 7)), places.close()))
        with self.open(file) as places:
            self.assertEqual(len(places), 200)

    def test_who_has_it_open_is_told(self) -> None:
        file = self.work / "map.seqloop"
        self.match(file, "drive", "--session", "monday")
        (self.work / "link.seqloop").symlink_to(file)
        for settings in ({"read_only": True}, {}):
            with self.open(file, **settings):
                self.open(file, read_only=True).close()
                for name in (file, self.work / "link.seqloop"):
                    with self.assertRaisesRegex(seqloop.SetupError, r"open already; close\(\) that PlaceMap"):
                        self.open(name)
        self.open(file).close()

    def test_a_describer_that_was_forgotten_is_told(self) -> None:
        file = self.work / "map.seqloop"
        with self.open(file, describer="gradients") as places:
            stepped(places, self.drive)
        for read_only in (False, True):
            with self.assertRaisesRegex(seqloop.SetupError, "gradients.*; describer=describer.fingerprint"):
                self.open(file, read_only=read_only)
            with self.assertRaises(seqloop.SetupError) as raised:
                self.open(file, read_only=read_only, describer="others")
            self.assertNotIn("describer=", str(raised.exception))

    def test_names_that_are_no_utf8_are_read(self) -> None:
        file = self.work / "map.seqloop"
        self.match(file, "drive", "--session", "cafe")
        # As a keeper may have it of a robot.
        with sqlite3.connect(file) as map:
            *values, _ = map.execute("SELECT * FROM session").fetchone()
            values[1] = b"caf\xe9"
            row = b"session"
            for value in values:
                text = value.encode() if isinstance(value, str) else value
                row += struct.pack("<q", value) if isinstance(value, int) else struct.pack("<q", len(text)) + text
            map.execute("UPDATE session SET name = CAST(? AS TEXT), checksum = ?", (values[1], zlib.crc32(row)))
        self.assertEqual(seqloop.check_map(file), [])
        self.assertEqual(seqloop.map_info(file).sessions[0].name, "caf\ufffd")
        with self.open(file, read_only=True) as places:
            self.assertEqual(places.where(7), ("caf\ufffd", 7))

    def test_a_full_disk_is_told_and_tried_again(self) -> None:
        file = self.work / os.fsdecode(b"map\xff.seqloop")
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        with self.open(file, session="monday", save_every_s=3600.0) as places:
            detector = seqloop.Detector(places)
            for row in self.drive:
                detector.step(row)
            _, most = resource.getrlimit(resource.RLIMIT_FSIZE)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, most))
            try:
                with self.assertRaisesRegex(OSError, "not all of the drive is saved: .*map\ufffd.seqloop: "):
                    detector.finish()
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
            self.assertLess(places.saved, 200)
            answers = detector.finish()
            self.assertEqual(places.saved, 200)
            self.assertEqual([answer.frame for answer in answers], [answer.frame for answer in detector.finish()])
            self.assertTrue(answers)
        self.assertEqual(seqloop.check_map(file), [])


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    unittest.main()
