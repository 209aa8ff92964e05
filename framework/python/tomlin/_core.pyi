"""The extension module: what the package is made of. Not an interface of its own."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

version: str

class Progress:
    time: float
    duration: float
    steps: int
    elapsed_seconds: float

class Scene:
    file: str
    name: str
    source: str
    dimension: int
    units: str
    axes: dict[str, str]
    duration: float
    parameters: dict[str, float]
    text: str
    effective_toml: str
    settings: list[tuple[str, str]]
    plugins: list[bytes]
    file_bytes: bytes
    def with_settings(self, settings: list[tuple[str, str]], /) -> Scene: ...
    def explain_json(self, seconds: float, /) -> str: ...
    def check_json(self, seed: int, /) -> str: ...
    def tradeoff_json(self, observable: str, tolerance: float, budget: float,
                      progress: Callable[[str], Any] | None, /) -> str: ...

class Run:
    status: str
    failure: dict[str, Any] | None
    scene: Scene
    def summary_json(self) -> str: ...
    def text(self, where: str, /) -> str: ...
    def observable(self, path: str, /) -> float | None: ...
    def quantities(self) -> list[tuple[str, float | None, str, str]]: ...
    def samples(self) -> NDArray[np.float64]: ...
    def layout(self) -> dict[str, Any]: ...
    def events(self) -> list[tuple[float, str, str, float, float, float, float]]: ...

class Simulation:
    time: float
    steps: int
    done: bool
    duration: float
    drivers: list[str]
    bodies: list[tuple[str, int]]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    forces: NDArray[np.float64]
    kinetic_energy: float
    potential_energy: float
    def __init__(self, scene: Scene, /) -> None: ...
    def advance(self, to: float, steps: int, /) -> None: ...
    def driver_force(self, driver: int, /) -> list[float]: ...
    def save(self) -> tuple[bytes, int, int, bool]: ...
    def restore(self, numbers: bytes, samples: int, events: int, is_over: bool, /) -> None: ...
    def result(self) -> Run: ...
    def samples(self) -> NDArray[np.float64]: ...
    def layout(self) -> dict[str, Any]: ...
    def events(self) -> list[tuple[float, str, str, float, float, float, float]]: ...

class SweepRequest:
    over: list[tuple[str, str | list[str]]]
    zips: list[list[str]]
    observables: list[str]
    repeats: str | None
    refine: str | None
    refine_along: str | None
    refine_to: str | None
    continues: bool | None
    threads: int
    folder: bytes | None
    journal: str
    force: bool
    progress: Callable[..., Any] | None
    run_points: Callable[[SweepRound], Any] | None

SentRow = tuple[int, int, list[float], bytes, str]

class SweepRound:
    identity: int
    missing: int
    def take(self, most: int, /) -> tuple[list[int], list[float]]: ...
    def keep(self, rows: list[SentRow], /) -> None: ...
    def progress(self) -> tuple[str, int, int]: ...

class WorkerPlan:
    identity: int
    def __init__(self, scene: Scene, request: SweepRequest, /) -> None: ...
    def run(self, points: list[int], values: list[float], folder: bytes | None, threads: int,
            /) -> list[SentRow]: ...

class Sweep:
    columns: list[list[str]]
    shape: list[int]
    status: list[str]
    reasons: list[str]
    summary_json: str
    complete: bool
    def axes(self) -> list[tuple[str, int, NDArray[np.float64] | list[str]]]: ...
    def column(self, column: int, /) -> NDArray[np.float64]: ...

def read_file(file: bytes, plugins: list[bytes], /) -> Scene: ...
def read_text(text: str, file: bytes, plugins: list[bytes], /) -> Scene: ...
def run(scene: Scene, threads: int, progress: Callable[[Progress], Any] | None, /) -> Run: ...
def run_in_folder(scene: Scene, folder: bytes, resume: bool, force: bool, threads: int,
                  progress: Callable[[Progress], Any] | None, /) -> Run | None: ...
def positions_in(file: bytes, /) -> NDArray[np.float64]: ...
def compare(scenes: list[Scene], observable: str, tolerance: float,
            progress: Callable[[str], Any] | None,
            /) -> tuple[str, list[tuple[NDArray[np.float64], NDArray[np.float64]]]]: ...
def sweep(scene: Scene, request: SweepRequest, /) -> Sweep: ...
