# SPDX-License-Identifier: MIT
"""Types of arguments and answers."""
from __future__ import annotations

import os
from typing import Literal, Sequence, Union

Setting = Union[bool, float, str, "os.PathLike[str]", Sequence[float], None]
"""A setting's value; None leaves it as it is."""

Gate = Literal["no_frame", "frame_error", "warming_up", "waiting", "no_candidate", "not_unique",
               "new_place", "unsure", "match"]
"""How far a frame came, in the order of the pipeline; only `match` means that the robot was here before. `Answer` says
what each means."""
