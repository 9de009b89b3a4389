# SPDX-License-Identifier: MIT
"""Visual loop closure in fixed memory and bounded time.

Has this robot been here before? To match two drives that are there whole:

    import seqloop
    describer = seqloop.Describer()                        # built in; loads OpenCV
    yesterday = describer.describe_drive("yesterday/")     # float32 [N, D]
    today = describer.describe_drive("today.mp4")
    matches = seqloop.match(yesterday, today)              # None, today: close loops within it
    print(matches.query[matches.accepted], matches.match[matches.accepted])

Frame by frame, as a robot does:

    places = seqloop.PlaceMap(max_places=20_000, descriptor_size=describer.size, close_loops=True)
    detector = seqloop.Detector(places)

    def tell(answers: list[seqloop.Answer]) -> None:
        for answer in answers:
            if answer.gate == "match" and answer.match is not None:
                print(f"frame {answer.frame} shows what {answer.match.frame} did")

    for picture in camera:                                 # uint8 [H, W, 3], blue first
        tell(detector.step(describer.describe(picture)).answers)
    tell(detector.finish())                                # of the frames that still wait

A map that lasts, in the same files as `seqloop run --map`, of many sessions:

    with seqloop.PlaceMap.open("garage.seqloop", describer.size, describer=describer.fingerprint) as places:
        detector = seqloop.Detector(places)                # step as above; places.where(a place)
        tell(detector.finish())                            # the last answers, and all is saved

`map_info`, `check_map` and `merge_maps` are for such files as a whole.

Settings are keyword arguments with the names of the program's flags: `seqloop.settings()` lists
them. What goes wrong is a SetupError, a ValueError that tells every fault at once. So is what is
given in place of a NumPy array, such as a list or a file's name. Other arguments of a wrong Python
type, such as a string for a number of places, are TypeErrors, as are too few, too many, and those of
a name that is none.

`Describer` needs OpenCV, which is loaded when it is asked for, as `help(seqloop)` does; importing
the package loads none. What forks may not do, PlaceMap.open says.

Frames and places are counted from 0, frames that never came too. Differences and scores are 0 to 2
between unit vectors, lower is better; probabilities 0 to 1.
"""
from __future__ import annotations

import dataclasses
import os
import typing

from . import _built_for

_built_for.refuse_others(os.path.dirname(__file__))  # before another Python's NumPy is missed

import numpy  # noqa: E402
import numpy.typing  # noqa: E402

from . import _calls, _core  # noqa: E402
from ._core import Answer, Belief, Detector, Match, PlaceMap, Report, Work, __version__  # noqa: E402
from ._errors import SetupError  # noqa: E402
from ._types import Gate, Setting  # noqa: E402

if typing.TYPE_CHECKING:
    from ._vision import Describer

Floats = numpy.typing.NDArray[numpy.floating[typing.Any]]
Integers = numpy.typing.NDArray[numpy.int64]

MapPath = typing.Union[str, "os.PathLike[str]"]

_calls.told_in_a_sentence(PlaceMap)
_calls.told_in_a_sentence(Detector)

__all__ = ["Answer", "Belief", "Describer", "Detector", "Gate", "MapInfo", "Match", "Matches", "Measures",
           "PlaceMap", "Report", "Session", "Setting", "SetupError", "Work", "__version__", "check_map", "differences",
           "evaluate", "map_info", "match", "merge_maps", "settings"]


# Of arrays there is no one answer to whether they are equal, and no hash.
@dataclasses.dataclass(frozen=True, eq=False)
class Matches:
    """The answers to a drive, in the order of its frames: the columns of `seqloop match`, [M] each.

    A frame about which nothing is known has no row. Matches equal only themselves: compare their columns, with
    numpy.array_equal(a.match, b.match).
    """

    query: Integers
    """Frame of the query."""
    match: Integers
    """The place: a row of the reference or, closing loops, of the query itself."""
    score: numpy.typing.NDArray[numpy.float32]
    """Mean difference along the sequence, 0 to 2 between unit vectors; lower is better. NaN: no line was found."""
    uniqueness: numpy.typing.NDArray[numpy.float32]
    """Score by the runner-up's; lower is better. NaN: not defined."""
    velocity: numpy.typing.NDArray[numpy.float64]
    """Rows a frame."""
    head: Integers
    """The place at the newest end of the sequence."""
    candidates: Integers
    """Rows that got a score in this frame's search."""
    k: Integers
    """Candidate ranges in force; 0 where all rows are candidates."""
    distances: Integers
    """Descriptor distances that the search cost."""
    probability: numpy.typing.NDArray[numpy.float32]
    """That the robot was at this place. NaN: the uniqueness decides."""
    accepted: numpy.typing.NDArray[numpy.bool_]
    """Whether it is a match, or only the best there is. Act on this."""

    def __len__(self) -> int:
        """How many frames have a row."""
        return len(self.query)


@dataclasses.dataclass(frozen=True, eq=False)
class Measures:
    """How good answers are. Shares are 0 to 1, NaN where not defined.

    They have the names of `seqloop eval --json`, which has `reliability`, the answers by their probability, in place
    of `curve`. Measures equal only themselves, because NaN and a curve's array equal nothing: compare what they hold.
    """

    frames: int
    """Queries that have a truth."""
    answered: int
    """Answers that the truth can judge, accepted or not."""
    correct: int
    """Answers that are right by the tolerance or the radius."""
    unknown: int
    """Answers that the truth cannot judge; nothing else counts them."""
    precision: float
    """Of all answers; 0 without any."""
    recall: float
    """Of all answers; 0 without frames."""
    recall_at_100_precision: float
    """The highest recall at which nothing is wrong."""
    area_under_curve: float
    """Area under precision over recall."""
    accepted: int | None
    """Answers that were accepted; None where one does not say."""
    accepted_precision: float
    """NaN: none is accepted."""
    accepted_recall: float
    """NaN: no query has a truth."""
    expected_calibration_error: float
    """How far probabilities are from the shares that are right. NaN: no answer has a probability."""
    curve: numpy.typing.NDArray[numpy.float64]
    """[P, 2]: recall, precision."""


@dataclasses.dataclass(frozen=True)
class Session:
    """A drive in a map's file."""

    name: str
    """Of no other session of the map."""
    places: int
    """Without those that were forgotten."""
    frames: int
    """So many, from its first on, are saved for good."""
    began_ns: int
    """Nanoseconds since 1970."""
    settings: str
    """What the drive was matched with, as text."""


@dataclasses.dataclass(frozen=True)
class MapInfo:
    """What a map's file holds: `seqloop map info`."""

    descriptor_size: int
    """D, values in a descriptor."""
    form: str
    """How places are kept; `arithmetic`, `difference` and `standardise` must say the same."""
    describer: str
    """What described them, as it was given to `PlaceMap.open`."""
    sessions: list[Session]
    """Oldest first."""

    @property
    def places(self) -> int:
        """Places of all sessions."""
        return sum(session.places for session in self.sessions)


def _setup_error(faults: list[tuple[str, str, str]]) -> SetupError:
    error = SetupError("\n".join(f"{what}: {why}" + f"; {remedy}" * bool(remedy) for what, why, remedy in faults))
    error.faults = faults
    return error


def match(reference: Floats | None, query: Floats | None = None, **settings: Setting) -> Matches:
    """Matches a drive with an earlier one, or with itself, as `seqloop match` does.

    reference: [N, D], a row a place; None closes loops within the query.
    query: [M, D], a row a frame. Both are copied, as float32, and rows brought to unit length.
    settings: see seqloop.settings().
    Errors: SetupError.
    """
    return Matches(**_core.match(reference, query, **settings))


def evaluate(matches: Matches, truth: MapPath | Integers | None = None, *, threshold_on: str = "uniqueness",
             frames: int | None = None, **settings: Setting) -> Measures:
    """Compares answers with the truth, as `seqloop eval` does.

    truth: "identity", "no-revisit", the name of a CSV file, or integers [T, 2]: query, reference.
        None: by positions where these are given, and identity elsewhere.
        Several rows of one query are several right answers; a third column is a row's own tolerance, in
        frames. Of a matrix `seen` [references, queries] that is True where both show one place, it is
        numpy.argwhere(seen.T).
    threshold_on: what the curve sweeps: "uniqueness", "score" or "probability".
    frames: queries that have a truth; None or 0: as many as the truth says, or for identity as far as the
        answers reach.
    settings: tolerance=2 frames; reference_positions=, query_positions= (CSV files), radius=25 metres;
        unlisted="wrong": so are answers to frames that the truth does not list, or "unknown": not counted.
    Errors: SetupError.
    """
    pairs: Integers | None = None
    if truth is None or isinstance(truth, (str, os.PathLike)):
        settings["truth"] = truth
    else:
        pairs = numpy.asarray(truth)
    return Measures(**_core.evaluate(matches, pairs, threshold_on=threshold_on, frames=frames, **settings))


def differences(reference: Floats, query: Floats, **settings: Setting) -> numpy.typing.NDArray[numpy.float32]:
    """The difference matrix, [N, M]: how far each place (row) is from each frame (column), 0 to 2
    between unit vectors.

    By the same arithmetic as the matcher's, with standardised features unless standardise=False. A frame
    of the query that could not be read (NaN, infinity, zeros) repeats the column before it; before the first
    that could, columns are NaN. For looking at it, and for code that wants a similarity matrix (its
    negative): the matcher itself never keeps it whole.
    Errors: SetupError.
    """
    faults = _core.drive_faults(reference, "reference", True) + _core.drive_faults(query, "query", False)
    matrices = all(isinstance(drive, numpy.ndarray) and drive.ndim == 2 for drive in (reference, query))
    if matrices and reference.shape[1] != query.shape[1]:
        faults.append(("reference, query", f"{reference.shape[1]} values in a row of one, "
                       f"{query.shape[1]} in a row of the other", "describe both with the same model and layer"))
    if settings.get("method") not in (None, "single"):
        faults.append(("method", "differences are of single frames", "leave method out"))
    settings["method"] = "single"
    rows, size = (1, 1) if faults else reference.shape  # settings are looked at all the same
    try:
        places = PlaceMap(rows, size, False, **settings)
    except SetupError as error:
        faults += error.faults
    if faults:
        raise _setup_error(faults)
    places.add_drive(reference)
    detector = Detector(places)
    matrix = numpy.full((len(reference), len(query)), numpy.nan, numpy.float32)
    by_length = settings.get("difference") != "mean-absolute"
    seen = False
    for frame, given in enumerate(query):
        descriptor = numpy.asarray(given, numpy.float32, "C")
        length = float(numpy.linalg.norm(numpy.asarray(descriptor, numpy.float64)))
        if by_length and 0 < length < numpy.inf:
            descriptor = (descriptor / length).astype(numpy.float32)
        detector.step(descriptor)
        seen = seen or (numpy.isfinite(length) and not (by_length and length == 0))
        if seen:
            matrix[:, frame] = detector.newest_column()
    return matrix


def map_info(file: MapPath) -> MapInfo:
    """What a map's file holds. Another process may write it meanwhile. Errors: SetupError."""
    info = _core.map_info(file)
    sessions = [Session(**session) for session in info.pop("sessions")]
    return MapInfo(sessions=sessions, **info)


def check_map(file: MapPath) -> list[str]:
    """Everything that is wrong with a map's file, a line each; empty: it is whole. Reads it twice.

    `seqloop map recover` copies what is whole into a new file. Errors: SetupError: it is no map.
    """
    return _core.check_map(file)


def merge_maps(maps: typing.Sequence[MapPath], out: MapPath) -> list[int]:
    """Copies all sessions of maps into a new file, which has its name only when it is complete.

    Returns, for each map, what is added to the numbers of its places.
    Errors: SetupError: `out` exists, the maps are of other forms, damaged. OSError: the disk is full.
    """
    return _core.merge_maps(maps, out)


def settings() -> dict[str, str]:
    """Every setting of the matcher, and what it does: of `PlaceMap`, `match` and `differences`.

    They are those of the program: on and off are True and False. Those of `Describer` are listed by
    `seqloop.Describer.settings()`.
    """
    return _core.settings()


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> typing.Any:
    # Describers need OpenCV, which takes longer to load than all the rest: only when asked for.
    if name == "Describer":
        from ._vision import Describer
        return globals().setdefault(name, _calls.told_in_a_sentence(Describer))
    raise AttributeError(f"module 'seqloop' has no attribute '{name}'")
