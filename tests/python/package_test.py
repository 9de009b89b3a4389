# SPDX-License-Identifier: MIT
"""`import seqloop`: what it loads, what it refuses, and that it answers as the program does.

Wants PYTHONPATH, and in SEQLOOP_BINARY and SEQLOOP_STREET_BINARY the programs.
"""
import ast
import copy
import csv
import dataclasses
import inspect
import json
import os
import pathlib
import pickle
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import typing
import unittest
import warnings

import numpy

import seqloop

SEED = 7


def program(*arguments: object, check: bool = True) -> subprocess.CompletedProcess:
    return subprocess.run([os.environ["SEQLOOP_BINARY"], *map(str, arguments)], check=check, capture_output=True,
                          text=True)


def unit(rows: numpy.ndarray) -> numpy.ndarray:
    return (rows / numpy.linalg.norm(rows, axis=1, keepdims=True)).astype(numpy.float32)


def drives(places: int = 200, size: int = 48) -> tuple[numpy.ndarray, numpy.ndarray]:
    """A drive, and the same again with noise."""
    random = numpy.random.default_rng(SEED)
    first = random.standard_normal((places, size))
    return unit(first), unit(first + .2 * random.standard_normal(first.shape))


def as_csv(matches: seqloop.Matches) -> str:
    """As the program writes it."""
    def text(value: object) -> str:
        return str(value) if isinstance(value, (numpy.integer, int)) else f"{value:.9g}"
    names = ["query", "match", "score", "uniqueness", "velocity", "head", "candidates", "k", "distances",
             "probability", "accepted"]
    lines = [",".join(names)]
    for row in zip(*(getattr(matches, name) for name in names)):
        lines.append(",".join(text(int(value) if isinstance(value, numpy.bool_) else value) for value in row))
    return "\n".join(lines) + "\n"


def written(frame: int, answer: seqloop.Answer) -> tuple:
    match = answer.match
    return (frame, match.place, numpy.float32(match.score), answer.gate == "match") if match else (frame, None)


class Imports(unittest.TestCase):
    def test_opencv_is_loaded_when_a_describer_is_asked_for(self) -> None:
        code = ("import seqloop, numpy\n"
                "loaded = lambda: 'libopencv' in open('/proc/self/maps').read()\n"
                "seqloop.PlaceMap(9, 4), seqloop.settings(), dir(seqloop)\n"
                "assert not loaded(), 'too early'\n"
                "seqloop.Describer()\n"
                "assert loaded(), 'never'\n")
        subprocess.run([sys.executable, "-B", "-c", code], check=True)

    def test_the_core_needs_few_libraries(self) -> None:
        needed = subprocess.run(["readelf", "-d", seqloop._core.__file__], check=True, capture_output=True, text=True)
        libraries = [line.split("[")[1].split("]")[0] for line in needed.stdout.splitlines() if "NEEDED" in line]
        for library in libraries:
            self.assertRegex(library, r"^(libfmt|libsqlite3|libz|libstdc\+\+|libm|libgcc_s|libc|ld-linux.*)\.so")

    def test_a_numpy_that_it_cannot_read_is_refused(self) -> None:
        code = "import numpy; numpy.__version__ = '2.1.0'; import seqloop"
        done = subprocess.run([sys.executable, "-B", "-c", code], check=False, capture_output=True, text=True)
        knows = tuple(map(int, os.environ["SEQLOOP_PYBIND11_VERSION"].split(".")[:2])) >= (2, 12)
        self.assertEqual(done.returncode == 0, knows, done.stderr)
        if not knows:
            self.assertRegex(done.stderr, "ImportError: this is NumPy 2.1.0, .*: use NumPy 1, or build")

    def test_another_python_is_refused(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            copied = pathlib.Path(folder, "seqloop")
            shutil.copytree(pathlib.Path(seqloop.__file__).parent, copied)
            built = pathlib.Path(seqloop._core.__file__).name
            version = "{}.{}".format(*sys.version_info)
            for name, words in (("_core.cpython-35m-x86_64-linux-gnu.so",
                                 f"seqloop is built for Python 3.5, and this is Python {version}: use that one, or"),
                                (None, "seqloop is not built in .*: build the target seqloop_python")):
                copied.joinpath(built).rename(copied / name) if name else copied.joinpath(built).unlink()
                built = name or built
                done = subprocess.run([sys.executable, "-B", "-c", "import seqloop"], capture_output=True, text=True,
                                      env={**os.environ, "PYTHONPATH": folder})
                self.assertRegex(done.stderr, "ImportError: " + words)

    def test_help_is_enough_to_begin(self) -> None:
        shown = subprocess.run([sys.executable, "-B", "-c", "import seqloop; help(seqloop)"], check=True,
                               capture_output=True, text=True).stdout
        for word in ("PlaceMap", "Describer", "describe_drive", "float32 [D]", "unit length", "match(reference",
                     "SetupError", "settings()"):
            self.assertIn(word, shown)

    def test_all_that_is_public_is_explained(self) -> None:
        unexplained = []
        for name in seqloop.__all__:
            owner = getattr(seqloop, name)
            named = [(name, owner)] if inspect.isfunction(owner) or inspect.isclass(owner) else []
            if inspect.isclass(owner):  # words beside fields of data classes are for who reads the source
                fields = [field.name for field in dataclasses.fields(owner)] if dataclasses.is_dataclass(owner) else []
                named += [(f"{name}.{member}", vars(owner)[member]) for member in vars(owner)
                          if not member.startswith("_") and member not in fields
                          or member in ("__enter__", "__exit__", "__len__")]
            for what, value in named:
                words = str(value.__doc__ or "").strip().splitlines()
                called = not inspect.isclass(value) and not isinstance(value, property) and "->" in words[0]
                if not words[1 if called else 0:]:  # pybind11 begins with what is taken
                    unexplained.append(what)
        self.assertEqual(unexplained, [])
        for gate in typing.get_args(seqloop.Gate):
            self.assertRegex(seqloop.Answer.__doc__, rf"(?m)^{gate}: ")

    def test_the_describer_is_seen_before_it_is_there(self) -> None:
        code = ("import seqloop\n"
                "assert 'Describer' in dir(seqloop) and set(seqloop.__all__) <= set(dir(seqloop))\n"
                "assert 'libopencv' not in open('/proc/self/maps').read()\n"
                "help(seqloop)\n")
        done = subprocess.run([sys.executable, "-B", "-c", code], check=True, capture_output=True, text=True)
        self.assertIn("class Describer(", done.stdout)

    def test_arguments_can_be_asked_for(self) -> None:
        for call, parameters in ((seqloop.PlaceMap, ["max_places", "descriptor_size", "close_loops", "kwargs"]),
                                 (seqloop.PlaceMap.open,
                                  ["map", "descriptor_size", "max_places", "describer", "kwargs"]),
                                 (seqloop.Detector, ["map"]),
                                 (seqloop.Detector.step, ["self", "descriptor", "time_s"]),
                                 (seqloop.Describer.describe, ["self", "picture"])):
            self.assertEqual(list(inspect.signature(call).parameters), parameters)

    def test_help_shows_the_arguments_that_the_types_have(self) -> None:
        from seqloop import _vision
        calls = []
        for module in (seqloop._core, _vision):
            stub = module.__name__.split(".")[1] + ".pyi"
            for node in ast.parse(pathlib.Path(module.__file__).with_name(stub).read_text()).body:
                calls += [(module, node)]
                if isinstance(node, ast.ClassDef):
                    calls += [(getattr(module, node.name), member) for member in node.body]
        checked = 0
        for owner, typed in calls:
            name = getattr(typed, "name", "")
            if not isinstance(typed, ast.FunctionDef) or isinstance(getattr(owner, name), property):
                continue
            first = getattr(owner, name).__doc__.splitlines()[0]
            shown, known = ast.parse(f"def {first}: ...").body[0].args, typed.args
            if shown.vararg:  # takes anything: __exit__
                continue
            with self.subTest(first):
                self.assertEqual([each.arg for each in shown.args], [each.arg for each in known.args])
                self.assertLessEqual({each.arg for each in shown.kwonlyargs}, {each.arg for each in known.kwonlyargs})
                self.assertEqual(shown.kwarg is None, known.kwarg is None)
            checked += 1
        self.assertGreater(checked, 20)
        shown = subprocess.run([sys.executable, "-B", "-c", "import seqloop; help(seqloop.Detector)"], check=True,
                               capture_output=True, text=True).stdout
        self.assertIn("step(self: seqloop._core.Detector, descriptor: Optional[numpy.ndarray], time_s: Opt", shown)

    def test_the_version_is_the_programs(self) -> None:
        self.assertRegex(program("--version").stdout, rf"^seqloop {re.escape(seqloop.__version__)} \(")

    def test_no_other_name_is_known(self) -> None:
        with self.assertRaisesRegex(AttributeError, "nothing"):
            seqloop.nothing


class Settings(unittest.TestCase):
    def test_they_are_the_flags_of_the_program(self) -> None:
        shown = program("match", "--help-all").stdout
        flags = {line.split()[0][2:].replace("-", "_") for line in shown.splitlines() if line.strip().startswith("--")}
        others = {"reference", "query", "out", "config", "help_all", "version"}
        others |= {"map", "read_only", "session", "save_every_s", "grow"}  # of PlaceMap.open alone
        self.assertEqual(set(seqloop.settings()), flags - others)
        shown = program("describe", "--help-all").stdout
        for name in seqloop.Describer.settings():
            self.assertIn("--" + name.replace("_", "-"), shown)

    def test_a_name_is_no_array(self) -> None:
        with self.assertRaises(seqloop.SetupError) as raised:
            seqloop.match("day.npy")  # type: ignore[arg-type]
        for word in ("reference: 'day.npy' is a name, not an array", "numpy.load", "query: not given"):
            self.assertIn(word, str(raised.exception))
        self.assertEqual([fault[0] for fault in raised.exception.faults], ["reference", "query"])
        with self.assertRaisesRegex(ValueError, "query: 'b.npy' is a name"):
            seqloop.match(None, pathlib.Path("b.npy"))  # type: ignore[arg-type]

    def test_every_fault_is_told_at_once(self) -> None:
        reference, query = drives()
        with self.assertRaises(ValueError) as raised:
            seqloop.match(reference[:, :5], query, dss=3, ds=-1, method="foo", max_uniqueness=.3, patience=4,
                          standardise="maybe", paper=3, vmin=True)
        told = str(raised.exception)
        for word in ("'dss': is no setting; did you mean 'ds'?", "ds: '-1' is no whole number", "method: 'foo'",
                     "max_uniqueness: the probability decides; min_probability, or decide_by uniqueness",
                     "standardise: 'maybe'", "paper: 3 is not of its type", "vmin: True", "reference, query: 5 values"):
            self.assertIn(word, told)
        self.assertEqual(len(raised.exception.faults), len(told.splitlines()))
        self.assertIn(("'dss'", "is no setting", "did you mean 'ds'?"), raised.exception.faults)

    def test_values_of_many_types(self) -> None:
        reference, query = drives()
        usual = as_csv(seqloop.match(reference, query, ds=10, vmin=.9, standardise=False))
        for same in ({"ds": "10", "vmin": "0.9", "standardise": "off"},
                     {"ds": numpy.int64(10), "vmin": numpy.float32(.9), "standardise": False, "k": None},
                     {"ds": 10, "vmin": .9, "standardise": numpy.bool_(False)},
                     {"ds": 10.0, "vmin": .9, "standardise": False},
                     {"ds": numpy.float32(10), "vmin": .9, "standardise": False}):
            self.assertEqual(as_csv(seqloop.match(reference, query, **same)), usual)
        for settings, words in (({"ds": [[10]]}, r"ds: \[\[10\]\] is not of its type"),
                                ({"ds": 10.5}, "ds: '10.5' is no whole number"),
                                ({"ds": numpy.inf}, "ds: 'inf' is no whole number"),
                                ({"standardise": 0}, "standardise: 0 is neither True nor False$"),
                                ({"standardise": "yes"}, "standardise: 'yes' is neither True nor False$")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                seqloop.match(reference, query, **settings)

    def test_where_settings_are_listed(self) -> None:
        reference, query = drives()
        for call, where in ((seqloop.Describer, "seqloop.Describer.settings()"),
                            (lambda **given: seqloop.PlaceMap(9, 9, **given), "seqloop.settings()"),
                            (lambda **given: seqloop.PlaceMap.open("m", 9, **given), "help(seqloop.PlaceMap.open)"),
                            (lambda **given: seqloop.match(reference, query, **given), "seqloop.settings()"),
                            (lambda **given: seqloop.evaluate(seqloop.match(reference, query), **given),
                             "help(seqloop.evaluate)")):
            with self.assertRaisesRegex(seqloop.SetupError, "'quite_another': is no setting; see .*" + re.escape(where)):
                call(quite_another=3)

    def test_names_that_are_no_utf8(self) -> None:
        reference, query = drives()
        file = os.fsdecode(b"/nowhere/\xff.onnx")
        for call in (lambda: seqloop.Describer(model=file), lambda: seqloop.Describer(model=pathlib.Path(file)),
                     lambda: seqloop.evaluate(seqloop.match(reference, query), file),
                     lambda: seqloop.map_info(file), lambda: seqloop.PlaceMap.open(file, 9)):
            with self.assertRaises(seqloop.SetupError) as raised:
                call()
            self.assertIn("/nowhere/\ufffd.onnx", str(raised.exception))
            self.assertIn("/nowhere/\ufffd.onnx", raised.exception.faults[0][0])
        for wrong in ({"method": "\udcff"}, {"\udcff": 3}):
            with self.assertRaisesRegex(seqloop.SetupError, "\ufffd"):
                seqloop.match(reference, query, **wrong)

    def test_commands_in_messages_are_the_programs(self) -> None:
        with self.assertRaisesRegex(seqloop.SetupError, "`seqloop run --map`"):
            seqloop.map_info("/nowhere")
        with self.assertRaisesRegex(seqloop.SetupError, "memory: .*; lower max_places; `seqloop plan` shows"):
            seqloop.PlaceMap(2**32 - 2, 100_000)

    def test_a_model_that_is_not_there(self) -> None:
        with self.assertRaises(seqloop.SetupError) as raised:
            seqloop.Describer(model=pathlib.Path("/nowhere.onnx"), lay="x")
        self.assertEqual(len(raised.exception.faults), 2)


class Pillow:
    """As far as anybody looks, an image of PIL."""
    __array_interface__: dict = {}


class Arrays(unittest.TestCase):
    def setUp(self) -> None:
        self.reference, self.query = drives()
        self.places = seqloop.PlaceMap(200, 48, ds=10)
        self.places.add_drive(self.reference)
        self.detector = seqloop.Detector(self.places)

    def test_step_takes_one_form_and_says_how_to_make_it(self) -> None:
        wide = numpy.zeros((48, 2), numpy.float32)
        wide[:, 0] = self.query[0]
        masked = numpy.ma.array(self.query[0], mask=numpy.arange(48) == 3)
        for descriptor, words in ((self.query[0].astype(numpy.float64), "float64.*ascontiguousarray"),
                                  (masked, "descriptor: some of it is masked"),
                                  (self.query[0].astype(">f4"), "ascontiguousarray"),
                                  (wide[:, 0], "side by side"),
                                  (numpy.frombuffer(b"x" + self.query[0].tobytes(), numpy.float32, offset=1),
                                   "address for floats.*numpy.require"),
                                  (self.query[0][:9], r"\(9,\)"),
                                  (self.query[:1], r"\(1, 48\)"),
                                  (numpy.zeros((), numpy.float32), r"\(\)"),
                                  (self.query[0] * 2, "length is 2")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                self.detector.step(descriptor)
        odd = numpy.frombuffer(b"x" + self.query[0].tobytes(), numpy.float32, offset=1)
        report = self.detector.step(numpy.require(odd, numpy.float32, "CA"))
        self.assertEqual(report.newest, 0, "what was refused is no frame")
        with self.assertRaisesRegex(seqloop.SetupError, "(?s)descriptor: its shape.*time_s: it is not finite"):
            self.detector.step(self.query, time_s=numpy.nan)
        self.assertEqual(self.detector.step(numpy.ma.array(self.query[1])).newest, 1, "nothing is masked")

    def test_what_is_no_array_is_told_in_a_sentence(self) -> None:
        describer = seqloop.Describer()
        rows = self.query.tolist()
        for call, words in (
                (lambda: seqloop.match(rows, "q.npy", dss=3),
                 "(?s)reference: its type is list, not numpy.ndarray; numpy.asarray.reference, numpy.float32.*"
                 "query: 'q.npy' is a name, not an array; numpy.load.*'dss'"),
                (lambda: self.detector.step(rows[0]), r"descriptor: .* list.*asarray\(descriptor, numpy.float32\)$"),
                (lambda: self.detector.step("row.npy"), "descriptor: 'row.npy' is a name, not an array; numpy.load"),
                (lambda: seqloop.PlaceMap(200, 48).add_drive(rows), "descriptors: its type is list"),
                (lambda: seqloop.differences(rows, None),
                 "(?s)reference: its type is list.*query: its type is NoneType"),
                (lambda: seqloop.match(None, rows[0][0]), "query: its type is float"),
                (lambda: describer.describe(rows), r"picture: .* list.*asarray\(picture, numpy.uint8\)$"),
                (lambda: describer.describe(None), "picture: it is None, .* not be read; step.None. tells"),
                (lambda: describer.describe(pathlib.Path("a.jpg")), "picture: 'a.jpg' is a name.*cv2.imread")):
            with self.assertRaisesRegex(seqloop.SetupError, words) as raised:
                call()
            self.assertLess(len(str(raised.exception)), 300)
        self.assertEqual(self.detector.step(None).newest, 0, "what was refused is no frame")

    def test_arguments_of_another_type_are_told_in_a_sentence(self) -> None:
        describer = seqloop.Describer()
        rows = self.query.tolist()
        whole = "it must be a whole number"
        for call, words in (
                (lambda: seqloop.PlaceMap("many", 48), f"max_places: {whole}, not 'many'"),
                (lambda: seqloop.PlaceMap(200, 48.5), f"descriptor_size: {whole}, not 48.5"),
                (lambda: seqloop.PlaceMap(200, 2**64), f"descriptor_size: {whole}, not as much as {2**64}"),
                (lambda: seqloop.PlaceMap.open("m", 48, 2**63), f"max_places: {whole}, or None, not as much as"),
                (lambda: self.detector.skip(2**64), f"frames: {whole} of 0 or more, not as much as {2**64}"),
                (lambda: self.detector.skip(2**62), f"frames: {2**62} more are too many to be counted"),
                (lambda: (self.detector.skip(92 * 10**9), self.detector.skip(1)), "frames: 1 more are too many to be"),
                (lambda: seqloop.PlaceMap(200, 48, "yes"), "close_loops: it must be True or False, not 'yes'"),
                (lambda: seqloop.PlaceMap(200, 48, 3), "close_loops: it must be True or False, not 3"),
                (lambda: seqloop.PlaceMap(200, 48, ds=rows[0]), "ds: a value of type list is not of its type"),
                (lambda: seqloop.PlaceMap(200, 48, ds=self.query), "ds: a value of type ndarray is not of its type"),
                (lambda: seqloop.PlaceMap.open(3, 48), "map: it must be the name of a file or folder, not 3"),
                (lambda: seqloop.PlaceMap.open("m", rows), f"descriptor_size: {whole}, not a value of type list"),
                (lambda: seqloop.PlaceMap.open("m", 48, "9"), f"max_places: {whole}, or None, not '9'"),
                (lambda: seqloop.PlaceMap.open("m", 48, describer=3), "describer: it must be text, not 3"),
                (lambda: self.places.where(-1), f"place: {whole} of 0 or more, not -1"),
                (lambda: seqloop.Detector(rows), "map: it must be a seqloop.PlaceMap, not a value of type list"),
                (lambda: seqloop.Detector(None), "map: it must be a seqloop.PlaceMap, not None"),
                (lambda: self.detector.step(None, "now"), "time_s: it must be a number, or None, not 'now'"),
                (lambda: self.detector.skip(-1), f"frames: {whole} of 0 or more, not -1"),
                (lambda: describer.describe_drive(rows), "source: it must be the name of a file or folder, not a v"),
                (lambda: describer.describe_drive("day", 1.5), f"frames: {whole} of 0 or more, not 1.5"),
                (lambda: seqloop.map_info(None), "file: it must be the name of a file or folder, not None"),
                (lambda: seqloop.check_map(rows), "file: it must be the name of a file or folder, not a value"),
                (lambda: seqloop.merge_maps("a", "b"), "maps: it must be a list of names of files, not 'a'"),
                (lambda: seqloop.merge_maps(["a", 3], "b"), r"maps: it must be a list of names of files, not \['a', 3\]"),
                (lambda: seqloop.merge_maps(["a"], 3), "out: it must be the name of a file or folder, not 3")):
            with self.assertRaisesRegex((TypeError, seqloop.SetupError), "^" + words) as raised:
                call()  # type: ignore[no-untyped-call]
            self.assertLess(len(str(raised.exception)), 200)

    def test_a_wrong_number_of_arguments_is_told_as_python_tells_it(self) -> None:
        describer = seqloop.Describer()
        for call, words in (
                (lambda: seqloop.PlaceMap(), r"PlaceMap.*missing 2 .*: 'max_places' and 'descriptor_size'"),
                (lambda: seqloop.PlaceMap(9, 48, False, 3), "PlaceMap.* takes from 3 to 4 positional arguments but 5"),
                (lambda: seqloop.PlaceMap(9, 48, max_places=3), "PlaceMap.* multiple values .* 'max_places'"),
                (lambda: seqloop.PlaceMap.open("m", 48, 9, "d"), "PlaceMap.open.* takes from 2 to 3 .* but 4"),
                (lambda: self.places.where(frame=3), "PlaceMap.where.* unexpected keyword argument 'frame'"),
                (lambda: self.places.close(3), "PlaceMap.close.* takes 1 positional argument but 2"),
                (lambda: seqloop.Detector(), "Detector.* missing 1 .*: 'map'"),
                (lambda: self.detector.step(self.query[0], times=3), "Detector.step.* keyword argument 'times'"),
                (lambda: self.detector.step(self.query, 0.5, 1), "Detector.step.* takes from 2 to 3 .* but 4"),
                (lambda: seqloop.Detector.finish(), "Detector.finish.* missing 1 .*: 'self'"),
                (lambda: seqloop.Describer("net.onnx"), "Describer.* takes 1 positional argument but 2"),
                (lambda: seqloop.Describer.settings(1), "Describer.settings.* takes 0 .* but 1"),
                (lambda: describer.describe(), "Describer.describe.* missing 1 .*: 'picture'"),
                (lambda: describer.describe_drive("day", frame=2), "Describer.describe_drive.* argument 'frame'")):
            with self.assertRaisesRegex(TypeError, "^" + words) as raised:
                call()  # type: ignore[call-arg,no-untyped-call]
            self.assertLess(len(str(raised.exception)), 110)
        self.assertIn("Detector.step", repr(self.detector.step))
        self.assertEqual(self.detector.step(None).newest, 0, "what was refused is no frame")

    def test_read_only_arrays_are_read_where_they_lie(self) -> None:
        frozen = self.query.copy()
        frozen.flags.writeable = False
        self.assertEqual(self.detector.step(frozen[3]).gate, "warming_up")

    def test_frames_that_never_came_are_counted(self) -> None:
        laps = numpy.concatenate([self.reference, self.query])
        for close_loops in (False, True):
            for lost in (3, 11, 60):  # the window is of ten frames
                with self.subTest(close_loops=close_loops, lost=lost):
                    places = seqloop.PlaceMap(400, 48, close_loops=close_loops, ds=10)
                    if not close_loops:
                        places.add_drive(laps)
                    detector = seqloop.Detector(places)
                    detector.skip(5)
                    answers = []
                    for frame in [*range(5, 50), *range(50 + lost, 400)]:
                        if frame == 50 + lost:
                            detector.skip(lost - 1)
                            detector.skip(1)
                        report = detector.step(laps[frame])
                        self.assertEqual(report.newest, frame)
                        answers += report.answers
                    answers += detector.finish()
                    self.assertEqual(answers[-1].frame, 399)
                    # But for places that are missing where loops are closed.
                    off = [answer.match.place - answer.frame + 200 * close_loops for answer in answers
                           if answer.gate == "match" and not 240 <= answer.frame < 260 + lost]
                    self.assertGreater(len(off), 100)
                    self.assertLessEqual(max(map(abs, off)), 1)

    def test_frames_that_say_nothing(self) -> None:
        broken = self.query[0].copy()
        broken[3] = numpy.nan
        for frame, descriptor in enumerate((None, broken, numpy.full(48, numpy.inf, numpy.float32),
                                            numpy.zeros(48, numpy.float32))):
            report = self.detector.step(descriptor)
            self.assertEqual((report.newest, report.gate), (frame, "frame_error"))

    def test_whole_drives(self) -> None:
        usual = as_csv(seqloop.match(self.reference, self.query, ds=10))
        strided = numpy.repeat(self.query, 2, axis=1)[:, ::2]
        self.assertFalse(strided.flags.c_contiguous)
        self.assertEqual(as_csv(seqloop.match(numpy.asfortranarray(self.reference), strided, ds=10)), usual)
        self.assertEqual(as_csv(seqloop.match(self.reference, self.query.astype(numpy.float64), ds=10)), usual)
        broken = self.query.copy()
        broken[4, 2] = numpy.nan
        for query, words in ((broken, "query: holds NaN in row 4, column 2"), (self.query[0], r"\(48,\)"),
                             (self.query.astype(numpy.int32), "int32"), (self.query[:0], r"\(0, 48\)"),
                             (self.query[:5], "shorten ds"),
                             (-1e200 * self.query.astype(numpy.float64), r"query: it holds .*e\+199, which is beyond flo"),
                             (numpy.full((200, 48), numpy.inf), "query: holds infinity in row 0")):
            with self.assertRaisesRegex(seqloop.SetupError, words), warnings.catch_warnings():
                warnings.simplefilter("error")
                seqloop.match(self.reference, query, ds=10)

    def test_pictures(self) -> None:
        describer = seqloop.Describer()
        random = numpy.random.default_rng(SEED)
        picture = random.integers(0, 255, (90, 160, 3), numpy.uint8)
        descriptor = describer.describe(picture)
        self.assertEqual((descriptor.dtype, descriptor.shape), (numpy.float32, (describer.size,)))
        self.assertAlmostEqual(float(numpy.linalg.norm(descriptor)), 1.0, places=5)
        padded = numpy.zeros((90, 200, 3), numpy.uint8)
        padded[:, :160] = picture
        self.assertTrue((describer.describe(padded[:, :160]) == descriptor).all())
        self.assertFalse((describer.describe(numpy.zeros((90, 160), numpy.uint8))).any(), "blank")
        for bad, words in ((picture.astype(numpy.float32), "float32"), (picture[..., ::-1], "side by side"),
                           (picture[::-1], "side by side"), (picture[:, ::2], "side by side"),
                           (picture[:0], r"empty, of shape \(0, 160, 3\); step\(None\) tells"),
                           (picture[..., :2], r"\(90, 160, 2\)"),
                           (numpy.ma.array(picture, mask=picture > 9), r"masked.*; fill it first, picture.filled\(0\)"),
                           (Pillow(), r"its type is Pillow, .*red comes first.*'RGB'\)\)\[..., ::-1\]\)$")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                describer.describe(bad)


class Lives(unittest.TestCase):
    def test_a_detector_keeps_its_map(self) -> None:
        reference, query = drives()
        detectors = []
        for _ in range(3):
            places = seqloop.PlaceMap(200, 48)
            places.add_drive(reference)
            detectors.append(seqloop.Detector(places))
            del places
        found = [[written(answer.frame, answer) for row in query for answer in detector.step(row).answers]
                 for detector in detectors]
        self.assertEqual(found[0], found[1])
        self.assertGreater(len(found[0]), 150)

    def test_answers_outlive_the_step(self) -> None:
        reference, query = drives()
        places = seqloop.PlaceMap(200, 48, ds=10)
        places.add_drive(reference)
        detector = seqloop.Detector(places)
        reports = [detector.step(row) for row in query]
        late = detector.finish()
        frames = [answer.frame for report in reports for answer in report.answers] + [answer.frame for answer in late]
        self.assertEqual(sorted(frames), list(range(200)))
        self.assertEqual(reports[50].newest, 50)
        self.assertIn("Match(place=", repr([report.answers for report in reports]))

    def test_reports_are_plain_values(self) -> None:
        reference, query = drives()
        for settings in ({"ds": 10}, {"ds": 10, "paper": True}):
            places = seqloop.PlaceMap(200, 48, **settings)
            places.add_drive(reference)
            detector = seqloop.Detector(places)
            reports = [detector.step(row) for row in [*query[:60], numpy.zeros(48, numpy.float32), None]]
            values = [*reports, *(answer for report in reports for answer in report.answers),
                      *(report.now for report in reports if report.now), reports[40].match, reports[40].work]
            for value in values:
                pickled = [pickle.loads(pickle.dumps(value, protocol))
                           for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]
                for other in (*pickled, copy.copy(value), copy.deepcopy(value)):
                    self.assertIsNot(other, value)
                    self.assertEqual((other, hash(other), repr(other)), (value, hash(value), repr(value)))
            self.assertEqual(len(set(reports)), len(reports))
            self.assertNotEqual(reports[0], None)
            self.assertRegex(repr(reports[40]), r"^Report\(answers=\[.*gate='match'.*work=Work\(candidates=\d")
        self.assertTrue(any(numpy.isnan(answer.probability) for report in reports for answer in report.answers))
        self.assertEqual(repr(detector), "Detector(PlaceMap(max_places=200, descriptor_size=48, close_loops=False))")
        for kind in (seqloop.Report, seqloop.Answer, seqloop.Match, seqloop.Belief, seqloop.Work):
            with self.assertRaisesRegex(TypeError, "No constructor"):
                kind()
        for kind, use in ((seqloop.PlaceMap, len), (seqloop.Detector, repr), (seqloop.Describer, lambda one: one.size)):
            with self.assertRaises(RuntimeError):
                use(kind.__new__(kind))

    def test_a_drive_that_is_refused_leaves_the_map_empty(self) -> None:
        # Of the built-in descriptor's size, whose statistics are known, and without any: each place is kept as it comes.
        for size, settings in ((735, {}), (48, {"standardise": False}), (48, {})):
            first, again = drives(60, size)
            places = seqloop.PlaceMap(50, size, ds=10, **settings)
            with self.assertRaisesRegex(seqloop.SetupError, "raise max_places"):
                places.add_drive(first)
            self.assertEqual((len(places), places.capacity), (0, 50))
            places.add_drive(first[:50])
            detector = seqloop.Detector(places)
            answers = [answer for row in again[:50] for answer in detector.step(row).answers] + detector.finish()
            matches = seqloop.match(first[:50], again[:50], ds=10, **settings)
            self.assertEqual(sum(answer.gate == "match" for answer in answers), matches.accepted.sum())
            self.assertGreater(matches.accepted.sum(), 30)

    def test_control_c_ends_what_takes_long(self) -> None:
        first, _ = drives(12_000, 735)
        places = seqloop.PlaceMap(len(first), 735)
        called: list[bool] = []

        def interrupt() -> None:
            begun.wait()
            os.kill(os.getpid(), signal.SIGINT)

        for call in (lambda: places.add_drive(first), lambda: seqloop.match(first, first[:30]) and called.append(True)):
            begun = threading.Event()
            thread = threading.Thread(target=interrupt)
            thread.start()
            try:
                with self.assertRaises(KeyboardInterrupt):
                    begun.set()
                    call()
                    called.append(True)
            finally:
                thread.join()
        # Where the interruption came in time, the map is as it was, and can be filled.
        self.assertEqual((len(places), called), (0, []))
        places.add_drive(first[:200])

    def test_what_a_map_refuses(self) -> None:
        reference, _ = drives()
        empty = seqloop.PlaceMap(200, 48)
        with self.assertRaisesRegex(seqloop.SetupError, "no places"):
            seqloop.Detector(empty)
        with self.assertRaisesRegex(seqloop.SetupError, "the map's have 48"):
            empty.add_drive(reference[:, :9])
        with self.assertRaisesRegex(seqloop.SetupError, "max_places"):
            seqloop.PlaceMap(20, 48).add_drive(reference)
        short = seqloop.PlaceMap(200, 48)
        short.add_drive(reference[:5])
        with self.assertRaises(seqloop.SetupError) as raised:
            seqloop.Detector(short)
        self.assertEqual(str(raised.exception), "ds: the shortest line spans 17 places, the map has 5; shorten ds")
        stood = seqloop.PlaceMap(200, 48)
        stood.add_drive(numpy.repeat(reference[:1], 17, axis=0))
        self.assertEqual(len(stood), 1)
        seqloop.Detector(stood).step(reference[0])
        with self.assertRaisesRegex(seqloop.SetupError, re.escape(str(raised.exception))):
            seqloop.match(reference[:5], reference)
        empty.add_drive(reference)
        with self.assertRaisesRegex(seqloop.SetupError, "holds a drive"):
            empty.add_drive(reference)
        closing = seqloop.PlaceMap(200, 48, True)
        with self.assertRaisesRegex(seqloop.SetupError, "closing loops"):
            closing.add_drive(reference)
        seqloop.Detector(closing)
        with self.assertRaisesRegex(seqloop.SetupError, "a detector has begun"):
            seqloop.Detector(closing)
        with self.assertRaises(seqloop.SetupError) as raised:
            seqloop.PlaceMap(-1, 0, ds=-1)
        self.assertEqual(len(raised.exception.faults), 3)
        self.assertRegex(str(raised.exception), "(?s)max_places: -1 is not between 1 and .*descriptor_size: 0 is not")
        with self.assertRaisesRegex(seqloop.SetupError, "(?s)descriptor_size: 0 .*max_places: 10 leave no candidates .*"
                                    "take 58 or more with this exclude and ds$"):
            seqloop.PlaceMap(10, 0, close_loops=True, full_map="thin")
        self.assertEqual((len(empty), empty.capacity, empty.descriptor_size), (200, 200, 48))

    def test_daemon_threads_end_with_the_program(self) -> None:
        code = ("import threading, time, numpy, seqloop\n"
                "begun = threading.Barrier(4)\n"
                "def drive():\n"
                "    detector = seqloop.Detector(seqloop.PlaceMap(3000, 48, True))\n"
                "    rows = numpy.eye(48, dtype=numpy.float32)\n"
                "    begun.wait()\n"
                "    while True: [detector.step(row) for row in rows]\n"
                "def match():\n"
                "    rows = numpy.tile(numpy.eye(48, dtype=numpy.float32), (20, 1))\n"
                "    begun.wait()\n"
                "    while True: seqloop.match(None, rows)\n"
                "for work in (drive, drive, match): threading.Thread(target=work, daemon=True).start()\n"
                "begun.wait()\n"
                "time.sleep(.2)\n"
                "print('over')\n")
        done = subprocess.run([sys.executable, "-B", "-c", code], check=False, capture_output=True, text=True,
                              timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "over\n", ""))

    def test_threads_share_a_map_and_wait_for_each_other_at_a_detector(self) -> None:
        reference, query = drives()
        places = seqloop.PlaceMap(200, 48)
        places.add_drive(reference)
        alone = [seqloop.Detector(places).step(row).newest for row in query[:1]]
        self.assertEqual(alone, [0])
        detectors = [seqloop.Detector(places) for _ in range(2)]
        shared = seqloop.Detector(places)
        found: list[list[tuple]] = [[], []]
        newest: list[int] = []

        def drive(which: int) -> None:
            for row in query:
                found[which] += [written(answer.frame, answer) for answer in detectors[which].step(row).answers]
                newest.append(shared.step(row).newest)

        threads = [threading.Thread(target=drive, args=(which,)) for which in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found[0], found[1])
        self.assertEqual(sorted(newest), list(range(2 * len(query))))


class SameAsTheProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        subprocess.run([os.environ["SEQLOOP_STREET_BINARY"], "--out", cls.work / "street", "--frames", "120", "--size",
                        "160x90"], check=True, capture_output=True)
        cls.drives = [cls.work / "street" / name for name in ("reference", "query")]
        for drive in cls.drives:
            program("describe", "--source", drive, "--out", drive.with_suffix(".npy"))
        cls.reference, cls.query = (numpy.load(drive.with_suffix(".npy")) for drive in cls.drives)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_descriptors(self) -> None:
        describer = seqloop.Describer()
        for drive, described in zip(self.drives, (self.reference, self.query)):
            self.assertEqual(describer.describe_drive(drive).tobytes(), described.tobytes())
        self.assertEqual(describer.describe_drive(str(self.drives[0]), frames=3).tobytes(),
                         self.reference[:3].tobytes())
        program("describe", "--source", self.drives[0], "--descriptor", "patches", "--out", self.work / "patches.npy")
        patches = seqloop.Describer(descriptor="patches").describe_drive(self.drives[0])
        self.assertEqual(patches.tobytes(), numpy.load(self.work / "patches.npy").tobytes())
        with self.assertRaisesRegex(seqloop.SetupError, "numpy.load"):
            describer.describe_drive(self.work / "patches.npy")

    def test_answers(self) -> None:
        names = [drive.with_suffix(".npy") for drive in self.drives]
        for settings in ({}, {"method": "seqcnnslam", "ds": 10}, {"paper": True}, {"method": "single"}):
            flags = []
            for name, value in settings.items():
                flags += ["--" + name] + ([] if value is True else [str(value)])
            out = self.work / "matches.csv"
            program("match", "--reference", names[0], "--query", names[1], "--out", out, *flags)
            self.assertEqual(as_csv(seqloop.match(self.reference, self.query, **settings)), out.read_text())
        program("match", "--query", names[0], "--out", out, "--exclude", 20)
        self.assertEqual(as_csv(seqloop.match(None, self.reference, exclude=20)), out.read_text())

    def test_a_setting_that_goes_by_the_size_of_the_map(self) -> None:
        first, again = drives(6000, 16)
        query = again[5000:5060]
        for name, rows in (("large", first), ("short", query)):
            numpy.save(self.work / f"{name}.npy", rows)
        out = self.work / "matches.csv"
        said = []
        for seconds in (20, .04):
            program("match", "--reference", self.work / "large.npy", "--query", self.work / "short.npy", "--out", out,
                    "--relocalise-s", seconds)
            said.append(out.read_text())
            self.assertEqual(as_csv(seqloop.match(first, query, relocalise_s=seconds)), said[-1])
        self.assertNotEqual(said[0], said[1])

    def test_answers_frame_by_frame(self) -> None:
        # With a stop, of which frames are told, not places.
        reference, query = (numpy.insert(drive, [60] * 30, drive[60], axis=0) for drive in (self.reference, self.query))
        matches = seqloop.match(reference, query)
        places = seqloop.PlaceMap(len(reference), reference.shape[1])
        places.add_drive(reference)
        detector = seqloop.Detector(places)
        answers = [answer for row in query for answer in detector.step(row).answers] + detector.finish()
        stepped = [(answer.frame, answer.match.frame, numpy.float32(answer.probability), answer.gate == "match")
                   for answer in sorted(answers, key=lambda answer: answer.frame) if answer.match]
        self.assertEqual(stepped, list(zip(matches.query, matches.match, matches.probability, matches.accepted)))
        self.assertGreater(matches.accepted.sum(), 20)
        self.assertTrue(any(answer.match.stood for answer in answers if answer.match))

    def test_measures(self) -> None:
        out = self.work / "matches.csv"
        out.write_text(as_csv(matches := seqloop.match(self.reference, self.query)))
        truth = self.work / "truth.csv"
        rows = numpy.array([[query, query] for query in range(20, 110)])
        truth.write_text("query,reference\n" + "".join(f"{a},{b}\n" for a, b in rows))
        for given, flags in ((rows, ["--truth", truth]), (str(truth), ["--truth", truth]), (truth, ["--truth", truth]),
                             ("identity", []), (None, []), ("no-revisit", ["--truth", "no-revisit"])):
            flags += ["--threshold-on", "probability", "--tolerance", 3]
            measures = seqloop.evaluate(matches, given, threshold_on="probability", tolerance=3)
            said = json.loads(program("eval", "--matches", out, "--json", *flags).stdout)
            for name in said.keys() - {"reliability"}:
                ours = getattr(measures, name)
                # The program read probabilities of nine digits.
                same = numpy.isnan(ours) if said[name] is None else abs(ours - said[name]) < 1e-8
                self.assertTrue(same, f"{name}: {ours}, {said[name]}")
        self.assertEqual(measures.curve.shape[1], 2)

    def test_measures_by_positions(self) -> None:
        out, places, driven = (self.work / name for name in ("matches.csv", "places.csv", "driven.csv"))
        out.write_text(as_csv(matches := seqloop.match(self.reference, self.query)))
        for file, drive in ((places, "reference"), (driven, "query")):
            with open(self.work / "street" / f"{drive}.csv", newline="") as rows:
                way = [row["street_m"] for row in csv.DictReader(rows)]
            file.write_text("frame,x,y\n" + "".join(f"{frame},{metres},0\n" for frame, metres in enumerate(way)))
        measures = seqloop.evaluate(matches, reference_positions=places, query_positions=str(driven), radius=5)
        said = json.loads(program("eval", "--matches", out, "--json", "--reference-positions", places,
                                  "--query-positions", driven, "--radius", 5).stdout)
        self.assertEqual((measures.frames, measures.correct), (said["frames"], said["correct"]))
        self.assertGreater(measures.correct, 100)
        for truth in ("identity", [[1, 1]]):
            with self.assertRaisesRegex(seqloop.SetupError, "truth: positions are given too"):
                seqloop.evaluate(matches, truth, reference_positions=places, query_positions=driven)
            with self.assertRaisesRegex(seqloop.SetupError, "radius: it goes with positions"):
                seqloop.evaluate(matches, truth, radius=5)
        with self.assertRaisesRegex(seqloop.SetupError, "reference_positions, query_positions: they are one file"):
            seqloop.evaluate(matches, reference_positions=places, query_positions=places)

    def test_measures_refuse(self) -> None:
        matches = seqloop.match(self.reference, self.query)
        for truth, settings, words in ((numpy.zeros((3, 4), int), {}, r"\(3, 4\)"),
                                       (numpy.zeros((3, 2)), {}, "float64"),
                                       (-numpy.ones((3, 2), int), {}, "0 or more"),
                                       (numpy.full((3, 2), 2**63, numpy.uint64), {}, "numbers of 2.63 or more"),
                                       ("/nowhere.csv", {"threshold_on": "speed", "toll": 3}, "(?s)toll.*speed.*/nowh"),
                                       (numpy.zeros((0, 2), int), {}, "truth")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                seqloop.evaluate(matches, truth, **settings)

    def test_measures_refuse_all_at_once(self) -> None:
        with self.assertRaises(seqloop.SetupError) as raised:
            seqloop.evaluate("m.csv", [[1, 2, 3, 4]], frames=-1, threshold_on="speed", toll=3)
        for word in ("matches: its type is str, not seqloop.Matches; give what match", "`seqloop eval --matches`",
                     "frames: '-1' is no whole number of 0 or more", "truth: it is int64 of shape (1, 4)",
                     "threshold_on: 'speed' is none", "'toll': is no setting"):
            self.assertIn(word, str(raised.exception))
        self.assertEqual(len(raised.exception.faults), 5)
        matches = seqloop.match(self.reference, self.query)
        for settings, words in (({"frames": 1.5}, "frames: '1.5' is no whole number"),
                                ({"frames": True}, "frames: True is not of its type"),
                                ({"threshold_on": 3}, "threshold_on: '3' is none"),
                                ({"truth": self.folder}, "truth: it is object"), ({"matches": None}, "NoneType")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                seqloop.evaluate(**{"matches": matches, "truth": "identity", **settings})
        self.assertEqual(seqloop.evaluate(matches, "identity", frames=numpy.int64(7)).frames, 7)

    def test_measures_refuse_what_is_no_match_list(self) -> None:
        matches = seqloop.match(self.reference, self.query)
        queries, ones = matches.query, numpy.ones(len(matches))
        for columns, words in (
                ({"query": 0 * queries}, "row 1: query 0 is answered twice; keep its best answer.*and .* more like"),
                ({"query": queries - 1}, "row 0: a frame or a place is below 0, or above 2.62; count them from 0"),
                ({"match": -queries}, "row 1: a frame or a place is below 0"),
                ({"query": queries + 2**62}, "row 1: a frame or a place is below 0, or above 2.62"),
                ({"score": numpy.ma.array(ones, mask=ones > 0)}, "matches.score: it is .*, and partly masked"),
                ({"probability": 2 * ones}, "row 0: its probability is 2; give 0 to 1, or NaN"),
                ({"query": queries + .5}, r"matches.query: it is float64 of shape \(.*,\); give whole numbers"),
                ({"score": None, "accepted": queries}, "score: it is NoneType.*accepted: it is int64"),
                ({"match": queries[:3], "accepted": matches.accepted[:2]},
                 "matches.match: it has 3 values and query has .*matches.accepted: it has 2 values"),
                ({"probability": ones[:, None], "score": ones[:, None]}, "score: .* of shape.*probability: .* of")):
            with self.assertRaisesRegex(seqloop.SetupError, "(?s)" + words):
                seqloop.evaluate(dataclasses.replace(matches, **columns), "identity", threshold_on="score")
        with self.assertRaises(seqloop.SetupError) as raised:
            seqloop.evaluate(dataclasses.replace(matches, probability=None), "identity", threshold_on="probability")
        self.assertEqual(len(raised.exception.faults), 1)
        for silent in (None, numpy.nan * ones):
            silent = dataclasses.replace(matches, accepted=None, probability=silent)
            measures = seqloop.evaluate(silent, "identity")
            self.assertIsNone(measures.accepted)
            self.assertTrue(numpy.isnan(measures.expected_calibration_error))
        none = seqloop.Matches(**{field.name: [] for field in dataclasses.fields(seqloop.Matches)})
        self.assertEqual(seqloop.evaluate(none, numpy.array([[3, 3]])).answered, 0)

    def test_matches_and_measures_equal_themselves(self) -> None:
        matches = seqloop.match(self.reference, self.query)
        for one in (matches, seqloop.evaluate(matches, "identity")):
            other = copy.deepcopy(one)
            self.assertTrue(one == one)
            self.assertFalse(one == other)
            self.assertEqual(len({one, other}), 2)
            self.assertIn("equal only themselves", type(one).__doc__ or "")

    def test_the_difference_matrix(self) -> None:
        matrix = seqloop.differences(self.reference, self.query, standardise=False, arithmetic="float")
        naive = numpy.linalg.norm(self.reference[:, None] - self.query[None], axis=2)
        self.assertLess(numpy.abs(matrix - naive).max(), 1e-4)
        self.assertEqual(matrix.dtype, numpy.float32)
        large = seqloop.differences(self.reference, self.query * numpy.float32(1e30), standardise=False)
        self.assertTrue((large == seqloop.differences(self.reference, self.query, standardise=False)).all())

    def test_the_difference_matrix_of_frames_that_say_nothing(self) -> None:
        query = self.query[:6].copy()
        query[0, 3], query[1], query[4, 0] = numpy.nan, 0, numpy.inf
        matrix = seqloop.differences(self.reference, query)
        self.assertTrue(numpy.isnan(matrix[:, :2]).all(), "nothing was seen so far")
        self.assertTrue((matrix[:, 4] == matrix[:, 3]).all())
        self.assertTrue(numpy.isfinite(matrix[:, 2:]).all())

    def test_what_the_difference_matrix_refuses(self) -> None:
        ones = numpy.ones((3, 4))
        for reference, query, settings, words in (
                ("a.npy", pathlib.Path("b.npy"), {}, "(?s)reference: 'a.npy' is a name.*query: 'b.npy' is a name"),
                (ones[0].astype(int), ones[:0], {}, r"(?s)reference: .*\(4,\).*reference: .*int64.*query: .*\(0, 4\)"),
                (ones[0], ones.astype(int), {"method": "seqslam"}, r"(?s)reference: .*\(4,\).*query: .*int64.*method"),
                (numpy.array(3.0), ones, {}, r"reference: its shape is \(\)"),
                (numpy.float32(3), ones, {}, "reference: its type is float32, not numpy.ndarray"),
                ([1], ones, {"quite_another": 1, "vmin": -1},
                 "(?s)reference: its type is list.*'quite_another'.*vmin"),
                (ones * [1, 2, numpy.nan, 4], ones[:, :3], {},
                 "(?s)^reference: holds NaN in row 0, column 2.*4 values in a row of one"),
                (ones, ones * 1e300, {}, "^query: it holds 1e.300, which is beyond float32"),
                (ones, ones[:, :3], {}, "4 values in a row of one, 3 in a row of the other")):
            with self.assertRaisesRegex(seqloop.SetupError, words):
                seqloop.differences(reference, query, **settings)


if __name__ == "__main__":
    unittest.main()
