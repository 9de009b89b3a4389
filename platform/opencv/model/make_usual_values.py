#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write what values of the built-in descriptor usually are, as a C++ header.

Why: a drive that closes loops subtracts from each value its mean so far (src/README.md, section 5.1). Its first frames
cannot tell the mean, and were standardised by another than those that come back to them later.

  make_usual_values.py DRIVE.npy... | clang-format > ../detail/usual_values.hpp

DRIVE.npy are descriptors of drives, [frames, 735], of `seqloop describe`; each drive counts the same. A picture and its
mirror image are as likely, so the mean of an orientation in a cell is that of the mirrored ones, too. Variances follow
the means: the deviation is as many means everywhere as it is on average over the drives.

What is built in was made of Gardens Point (day_left, night_right), 2,400 frames of Nordland (summer, winter), and
garage_laps.
"""
import argparse
import textwrap

import numpy as np

ORIENTATIONS, ROWS, COLUMNS = 15, 7, 7
UNIT = 10_000  # what is written are whole numbers of 1 / UNIT


def mirrored(means: np.ndarray) -> np.ndarray:
    """Of [orientation, row, column]: an edge at the angle a is one at -a there."""
    return means[-np.arange(ORIENTATIONS) % ORIENTATIONS, :, ::-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("drives", nargs="+", metavar="DRIVE.npy")
    drives = [np.load(path).astype(float) for path in parser.parse_args().drives]
    means = np.mean([rows.mean(0) for rows in drives], 0)
    deviation = np.mean([rows.var(0) for rows in drives], 0) ** 0.5
    means = means.reshape(ORIENTATIONS, ROWS, COLUMNS)
    means = (means + mirrored(means)) / 2.0
    numbers = ", ".join(str(round(mean * UNIT)) for mean in means.ravel())
    print(f"""// SPDX-License-Identifier: MIT
// Made by model/make_usual_values.py; not to be edited.
#pragma once

#include <array>
#include <cstdint>

namespace seqloop::opencv {{

/// The deviation of a value, in means.
inline constexpr double usual_deviation = {deviation.mean() / means.mean():.2f};

/// What the means below are counted in.
inline constexpr double usual_unit = {1 / UNIT:g};

/// The mean of each value of the built-in descriptor, orientation x row x column.
inline constexpr std::array<std::uint16_t, {means.size}> usual_means{{
{textwrap.indent(textwrap.fill(numbers, 96), "    ")}}};

}}  // namespace seqloop::opencv""")


if __name__ == "__main__":
    main()
