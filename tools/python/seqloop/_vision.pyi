# SPDX-License-Identifier: MIT
from os import PathLike
from typing import Union

import numpy
from numpy.typing import NDArray

from ._types import Setting

class Describer:
    def __init__(self, **settings: Setting) -> None: ...
    @staticmethod
    def settings() -> dict[str, str]: ...
    @property
    def size(self) -> int: ...
    def describe(self, picture: NDArray[numpy.uint8]) -> NDArray[numpy.float32]: ...
    def describe_drive(self, source: Union[str, PathLike[str]], frames: int = 0) -> NDArray[numpy.float32]: ...
