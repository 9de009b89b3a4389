# SPDX-License-Identifier: MIT
"""A drive's pictures as a bad camera would have taken them. Used by tools/confidence."""
import dataclasses
import functools
import pathlib
import re
import zlib
from typing import Callable

import numpy as np
from PIL import Image, ImageOps

Picture = np.ndarray  # rows x columns x 3, grey levels from 0 to 255


def slowly(frames: int, dice: np.random.Generator, within: int) -> np.ndarray:
    """A value for each frame, with a deviation of 1, that forgets itself within so many frames."""
    weights = np.exp(-np.arange(8 * within) / within)
    values = np.convolve(dice.normal(size=frames + len(weights) - 1), weights, "valid")
    return values / np.sqrt((weights**2).sum())


@dataclasses.dataclass(frozen=True)
class Shot:
    """A frame's picture, and what chance has in store for it."""
    picture: Picture
    frame: int
    dice: np.random.Generator  # the frame's own
    of_drive: int  # where a generator that is the drive's begins
    frames: int  # of the drive

    def drive_dice(self) -> np.random.Generator:
        return np.random.default_rng(self.of_drive)

    def spot(self, row: float, column: float, radius: float) -> np.ndarray:
        """1 in its centre, falling off as a Gaussian; in shares of height, width, and width."""
        height, width, _ = self.picture.shape
        down, across = np.mgrid[:height, :width]
        squared = (down - row * height)**2 + (across - column * width)**2
        return np.exp(-squared / (2 * (radius * width)**2))[..., None]


def tiles(levels: np.ndarray, height: int, width: int) -> Picture:
    """A picture of tiles that have these grey levels."""
    down, across = levels.shape
    grey = levels[np.arange(height) * down // height][:, np.arange(width) * across // width]
    return np.repeat(grey[..., None].astype(np.float32), 3, axis=2)


@functools.cache
def sways(of_drive: int, frames: int) -> np.ndarray:
    """Down and across, for each frame of a drive, as `slowly` has it."""
    dice = np.random.default_rng(of_drive)
    return np.stack([slowly(frames, dice, 60) for _ in range(2)])


def bumper(shot: Shot) -> Picture:
    """The robot's own parts fill the lowest three tenths, the same on every drive."""
    height, width, _ = shot.picture.shape
    first = int(0.7 * height)
    levels = np.random.default_rng(7).integers(20, 200, (2, 12))
    return np.concatenate([shot.picture[:first], tiles(levels, height - first, width)])


def crowd(shot: Shot) -> Picture:
    """Half of the time, for 10 to 39 frames on end, somebody hides a quarter of the view."""
    dice, begins = shot.drive_dice(), 0
    height, width, _ = shot.picture.shape
    while begins <= shot.frame:
        begins += int(dice.integers(10, 40))
        goes = begins + int(dice.integers(10, 40))
        first = int(dice.uniform(0.0, 0.75) * width)
        clothes = dice.integers(20, 200, (4, 1))
        if begins <= shot.frame < goes:
            picture = shot.picture.copy()
            picture[:, first:first + width // 4] = tiles(clothes, height, width // 4)
            return picture
        begins = goes
    return shot.picture


def dirt(shot: Shot) -> Picture:
    """Eight blurred spots on the lens, others on each drive."""
    dice, covered = shot.drive_dice(), np.zeros((*shot.picture.shape[:2], 1))
    for _ in range(8):
        spot = shot.spot(dice.uniform(), dice.uniform(), dice.uniform(0.04, 0.12))
        covered = np.maximum(covered, dice.uniform(0.6, 1.0) * spot)
    return shot.picture * (1 - covered) + 90 * covered


def flicker(shot: Shot) -> Picture:
    """Exposure changes from frame to frame, with a deviation of a third."""
    return shot.picture * np.exp(shot.dice.normal(0.0, 0.36))


def haze(shot: Shot) -> Picture:
    """A quarter of the contrast, and bright."""
    return 140 + shot.picture / 4


def lamp(shot: Shot) -> Picture:
    """The robot's own lamp: a bright spot that sways, the rest darker."""
    down, across = sways(shot.of_drive, shot.frames)[:, shot.frame]
    return 0.6 * shot.picture + 200 * shot.spot(0.6 + 0.05 * down, 0.5 + 0.1 * across, 0.15)


def coarse(shot: Shot) -> Picture:
    """24 x 12 pixels."""
    height, width, _ = shot.picture.shape
    image = Image.fromarray(shot.picture.astype(np.uint8))
    small = image.resize((24, 12), Image.Resampling.BOX)
    return np.asarray(small.resize((width, height), Image.Resampling.BILINEAR), np.float32)


def noise(shot: Shot) -> Picture:
    """Each pixel's deviation is 20 grey levels. Little is left of it where pictures are large."""
    return shot.picture + shot.dice.normal(0.0, 20.0, shot.picture.shape)


def shake(shot: Shot) -> Picture:
    """Turned and moved from frame to frame, with deviations of 2 degrees and of 3 hundredths of
    width and height. What comes into view is black."""
    height, width, _ = shot.picture.shape
    turn, across, down = shot.dice.normal(size=3)
    image = Image.fromarray(shot.picture.astype(np.uint8))
    moved = image.rotate(2 * turn, Image.Resampling.BILINEAR,
                         translate=(round(0.03 * width * across), round(0.03 * height * down)))
    return np.asarray(moved, np.float32)


def aside(shot: Shot) -> Picture:
    """Slowly looks to either side, by up to an eighth of its width; the border's column goes on."""
    width = shot.picture.shape[1]
    by = sways(shot.of_drive, shot.frames)[0, shot.frame]
    columns = np.arange(width) + int(np.clip(0.05 * by, -0.125, 0.125) * width)
    return shot.picture[:, np.clip(columns, 0, width - 1)]


def lanes(shot: Shot) -> Picture:
    """Looks to one side for 100 frames, then to the other, by six hundredths of its width."""
    width = shot.picture.shape[1]
    begins = int(shot.drive_dice().integers(0, 200))
    side = 1 if (begins + shot.frame) // 100 % 2 else -1
    columns = np.arange(width) + side * int(0.06 * width)
    return shot.picture[:, np.clip(columns, 0, width - 1)]


KINDS: dict[str, Callable[[Shot], Picture]] = {
    kind.__name__: kind
    for kind in (aside, bumper, coarse, crowd, dirt, flicker, haze, lamp, lanes, noise, shake)}


def by_numbers(file: pathlib.Path) -> list:
    """What names are sorted by: f2 comes before f10."""
    return [(int(part), "") if part.isdecimal() else (-1, part)
            for part in re.split(r"(\d+)", file.name)]


def take_again(kind: str, drive: pathlib.Path, out: pathlib.Path) -> None:
    """Makes a folder with the pictures of another, in the order of their names."""
    out.mkdir(parents=True)
    files = sorted((file for file in drive.iterdir()
                    if file.is_file() and not file.name.startswith(".")), key=by_numbers)
    of_drive = zlib.crc32(f"{drive.parent.name}/{drive.name}".encode())
    for frame, file in enumerate(files):
        with Image.open(file) as image:
            picture = np.asarray(ImageOps.exif_transpose(image).convert("RGB"), np.float32)
        dice = np.random.default_rng([of_drive, frame])
        bad = KINDS[kind](Shot(picture, frame, dice, of_drive, len(files)))
        Image.fromarray(np.clip(bad, 0, 255).astype(np.uint8)).save(
            out / f"{frame:06}.png", compress_level=1)
