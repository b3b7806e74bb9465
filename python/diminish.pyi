"""Removes real objects from a camera's picture and shows what is behind them."""

from os import PathLike
from typing import Any, Callable, Iterator, Mapping, TypeVar

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
"""height x width x 3, BGR"""
Mask = NDArray[np.uint8]
"""height x width"""
Depth = NDArray[np.uint16]
"""height x width, in the rig's unit; 0: no measurement"""
Transform = NDArray[np.float64]
"""3 x 4 or 4 x 4, metres; a_from_b takes coordinates in frame b to frame a"""

__version__: str
_Method = TypeVar("_Method", bound=Callable[..., Any])

class Error(ValueError): ...

class Options:
    """Everything that can be chosen; see docs/command-line.md."""

    def __init__(self, **options: Any) -> None: ...
    def __getattr__(self, name: str) -> Any: ...

def detector(name: str) -> Callable[[_Method], _Method]: ...
def inpainter(name: str) -> Callable[[_Method], _Method]: ...
def pose_source(name: str) -> Callable[[_Method], _Method]: ...
def methods(option: str) -> list[str]: ...

class Frame:
    name: str
    index: int
    stamp_s: float
    picture: Picture
    mask: Mask
    provenance: NDArray[np.uint8]
    input: Picture
    rgbd: list[tuple[Picture, Depth] | None]
    report: dict[str, Any]
    def _repr_png_(self) -> bytes: ...

class Frames(Iterator[Frame]):
    def __next__(self) -> Frame: ...

class Pipeline:
    cameras: list[str]
    def __init__(
        self,
        folder: str | PathLike[str],
        options: Options | None = None,
        detector: str = "",
        pose_source: str = "",
        **single_options: Any,
    ) -> None: ...
    def __iter__(self) -> Frames: ...
    def process(
        self,
        color: Picture,
        rgbd: Mapping[str, tuple[Picture, Depth]] = {},
        stamp_s: float = 0.0,
    ) -> Frame: ...
    def forget(self) -> None: ...

class Live(Iterator[Frame]):
    status: dict[str, Any]
    def __init__(
        self,
        folder: str | PathLike[str],
        cameras: Mapping[str, str] = {},
        options: Options | None = None,
        detector: str = "",
        budget_ms: float = 0.0,
        pose_source: str = "",
        **single_options: Any,
    ) -> None: ...
    def __next__(self) -> Frame: ...
    def stop(self) -> None: ...

def inpaint(src: Picture, inpaintMask: Mask, inpaintRadius: float = 3, flags: int = 0) -> Picture: ...
def seamless_clone(
    src: Picture, dst: Picture, mask: Mask, p: tuple[int, int], flags: int = 1
) -> Picture: ...
