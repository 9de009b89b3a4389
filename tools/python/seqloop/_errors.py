# SPDX-License-Identifier: MIT
"""What goes wrong."""
from __future__ import annotations


class SetupError(ValueError):
    """Everything that keeps something from working, a line each; `faults` takes them apart.

    faults: (what, why, remedy) of each; the remedy is empty where none can be given.
    """

    faults: list[tuple[str, str, str]]
