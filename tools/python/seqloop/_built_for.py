# SPDX-License-Identifier: MIT
"""A build fits one version of Python."""
from __future__ import annotations

import importlib.machinery
import os
import re
import sys


def refuse_others(folder: str) -> None:
    """Where no extension in the folder is for this Python, that would say that the package imports itself in a circle.

    Errors: ImportError.
    """
    built = [name for name in os.listdir(folder) if re.fullmatch(r"_core\..*\.(so|pyd)", name)]
    if any("_core" + suffix in built for suffix in importlib.machinery.EXTENSION_SUFFIXES):
        return
    this = f"this is Python {sys.version_info.major}.{sys.version_info.minor}"
    if not built:
        raise ImportError(f"seqloop is not built in {folder}: build the target seqloop_python, and name its folder")
    known = re.search(r"cpython-(\d)(\d+)", built[0])
    fits = f"Python {known[1]}.{known[2]}" if known else built[0]
    raise ImportError(f"seqloop is built for {fits}, and {this}: use that one, or build it with "
                      f"-DPython_EXECUTABLE={sys.executable}")
