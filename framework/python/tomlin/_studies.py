"""Results of studies, as objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tomlin._record import Record, table_html

if TYPE_CHECKING:
    from tomlin._scene import Scene


class Explanation(Record):
    """The answer of ``tomlin explain --json``: ``bodies``, ``forces``, ``left_out``, ``scales``,
    ``sliding``, ``misfits``, ``integrator``, ``cost``, ``output``, ``warnings``."""

    def _repr_html_(self) -> str:
        rows = {key: self[key] for key in ("integrator", "cost", "scales") if key in self}
        return table_html(rows, self.scene.get("name") or "")


class Check(Record):
    """The answer of ``tomlin check --json``: ``checks``, each with ``subject``, ``check``, ``ok``,
    ``error`` and ``allowed``, and ``warnings``."""

    @property
    def holds(self) -> bool:
        """Whether all checks hold."""
        return bool(self["valid"])

    @property
    def failed(self) -> list[Record]:
        """The checks that do not."""
        return [one for one in self["checks"] if not one.ok]

    def __bool__(self) -> bool:
        return self.holds

    def _repr_html_(self) -> str:
        return table_html({f"{one.subject} {one.check}": one.text for one in self.failed},
                          "all checks hold" if self.holds else "FAILED")


class Tradeoff(Record):
    """The findings of ``tomlin tradeoff``: ``reference``, ``points`` (a run each, with its method,
    step or tolerance, value, error and cost), ``recommendation``."""

    _scene: "Scene | None" = None

    def recommended(self) -> "Scene":
        """The scene with the recommended setting. Raises ValueError where there is none."""
        recommendation = self.get("recommendation")
        if not recommendation or self._scene is None:
            raise ValueError("nothing is recommended")
        return self._scene.set(dict(recommendation["settings"]))

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """The work-precision diagram by matplotlib, error against cost; returns the axes."""
        from tomlin._plots import plot_tradeoff

        return plot_tradeoff(self, ax, **options)

    def to_pandas(self) -> Any:
        """The points as a DataFrame. Needs pandas."""
        import pandas

        return pandas.DataFrame([dict(one) for one in self["points"]])


class Comparison(Record):
    """The findings of ``tomlin compare``: ``models``, each with ``value``, ``error``,
    ``difference`` and ``verdict``; ``simplest``; ``notes``."""

    _curves: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
    _axes: dict[str, str] = {}

    @property
    def curves(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """For each model the displacement of its driver and its force along the pull, two arrays of
        the same length in the units of the scenes; empty where it has no
        driver."""
        return self._curves

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """The forces of the drivers over their displacement, by matplotlib; returns the axes."""
        from tomlin._plots import plot_comparison

        return plot_comparison(self, ax, **options)

    def _repr_html_(self) -> str:
        return table_html({one.get("name") or one.get("file"): f"{one.value} {one.verdict}"
                           for one in self["models"]}, str(self.get("observable", "")))
