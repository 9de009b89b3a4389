#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Looks at how a drive was matched with an earlier one. To be read from top to bottom, as a notebook.

Usage: look.py REFERENCE QUERY PICTURE.jpg    two image folders; needs python3-matplotlib
"""
import pathlib
import sys

import matplotlib
import numpy

import seqloop

matplotlib.use("Agg")  # into a file, not onto a screen
from matplotlib import pyplot  # noqa: E402

if len(sys.argv) != 4:
    sys.exit(__doc__)
reference, query = map(pathlib.Path, sys.argv[1:3])

# 1. Describe: a row of 735 numbers for each picture.
describer = seqloop.Describer()
yesterday = describer.describe_drive(reference)
today = describer.describe_drive(query)

# 2. Match: what place does each frame show, and how sure is that?
matches = seqloop.match(yesterday, today)
accepted = matches.accepted
print(f"{accepted.sum()} of {len(today)} frames are places that are known")

# 3. The difference matrix, which the matcher itself never has whole: dark where frame and place are alike.
differences = seqloop.differences(yesterday, today)

# 4. Pairs: an accepted frame from each third of the drive, and its place.
pictures = [sorted(drive.iterdir()) for drive in (reference, query)]
known = numpy.flatnonzero(accepted)
shown = known[[len(known) // 6, len(known) // 2, len(known) * 5 // 6]]

figure = pyplot.figure(figsize=(9, 5.4), dpi=80, layout="constrained")
pictures_side, matrix_side = figure.subfigures(1, 2, width_ratios=(1, 1.6))
for row, (at, axes) in enumerate(zip(shown, pictures_side.subplots(3, 2))):
    for place, files, name, ax in ((matches.query[at], pictures[1], "frame", axes[0]),
                                   (matches.match[at], pictures[0], "place", axes[1])):
        ax.imshow(pyplot.imread(files[place]))
        ax.set_title(f"{name} {place}", fontsize=8)
        ax.axis("off")

above, below = matrix_side.subplots(2, 1, height_ratios=(2.2, 1))
low, high = numpy.nanpercentile(differences, (1, 99))
above.imshow(differences, cmap="gray", vmin=low, vmax=high, aspect="auto", interpolation="nearest")
above.scatter(matches.query[~accepted], matches.match[~accepted], s=2, color="tab:orange", label="not accepted")
above.scatter(matches.query[accepted], matches.match[accepted], s=2, color="tab:red", label="accepted")
above.legend(fontsize=7, loc="lower left", markerscale=3)
above.set(title="differences of frames and places", ylabel="place", xlim=(0, len(today)))

# 5. The probability over time: it rises with what is seen, and falls where evidence is missing.
below.plot(matches.query, matches.probability, color="tab:blue", linewidth=1)
below.axhline(.99, color="tab:red", linewidth=.8, linestyle="--")
below.set(xlabel="frame", ylabel="probability", ylim=(0, 1.03), xlim=(0, len(today)))

figure.savefig(sys.argv[3], pil_kwargs={"quality": 80})
