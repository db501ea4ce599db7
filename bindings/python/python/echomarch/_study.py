"""Studies: sweeps and maps of many points."""

from __future__ import annotations

import csv
import os
import tempfile
from typing import Any, List, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arguments, _echomarch, _progress, _workers
from ._errors import SettingsError

AnyPath = Union[str, "os.PathLike[str]"]


class Study:
    """A study file (docs/clusters.md): scenes, named values, positions and settings, and the results to keep.

    Parameters
    ----------
    file : path
        The study file (``.ron``).

    Raises
    ------
    StudyError
        The file, or a scene that it names, cannot be used.
    """

    def __init__(self, file: AnyPath) -> None:
        self._file = _arguments.path("file", file)
        self._raw = _echomarch.Study(self._file)

    @property
    def name(self) -> str:
        """Name of the study."""
        return self._raw.name

    @property
    def points(self) -> int:
        """Number of points."""
        return self._raw.points

    def run(
        self,
        folder: Optional[AnyPath] = None,
        workers: int = 1,
        *,
        progress: _progress.AnyProgress = None,
    ) -> npt.NDArray[Any]:
        """Compute all points.

        Parameters
        ----------
        folder : path, optional
            The folder for shards and tables, as of ``echomarch study -o``. Points that it already contains are not
            computed again. Without it, the results are kept in memory only.
        workers : int
            Number of processes. The results do not depend on the number.
        progress : callable, bool or None
            A function that receives the number of completed points (with several workers, of completed shards); True,
            False and None as in :func:`response`.

        Returns
        -------
        numpy.ndarray, shape (points,), structured
            The columns of the table. Missing numbers are NaN.
        """
        if _arguments.whole("workers", "a whole number of processes", workers) < 1:
            raise SettingsError(f"workers must be 1 or more, not {workers}")
        if folder is not None:
            return self._computed(_arguments.path("folder", folder), workers, progress)
        with tempfile.TemporaryDirectory() as temporary:
            return self._computed(temporary, workers, progress)

    def _computed(self, folder: str, workers: int, progress: _progress.AnyProgress) -> npt.NDArray[Any]:
        begun = self._raw.begun(folder)
        shards = begun if begun is not None else workers
        bar = None if callable(progress) else _progress.of_counts(progress, self.name)
        if workers > 1 and shards > 1:
            tasks = [("study", self._file, shard, shards, folder) for shard in range(1, shards + 1)]
            show_shards = self._shown(progress, bar, shards, 0)
            _workers.run(tasks, workers, lambda number, _: show_shards(number))
        else:
            done = 0
            for shard in range(1, shards + 1):
                seen = [0]
                show = self._shown(progress, bar, self.points, done, seen)
                self._raw.compute(shard, shards, folder, show)
                done += seen[0]
        self._raw.join(folder)
        return table(os.path.join(folder, "study.csv"))

    @staticmethod
    def _shown(progress: Any, bar: Any, whole: int, before: int, seen: Optional[List[int]] = None) -> Any:
        def show(done: int) -> None:
            if seen is not None:
                seen[0] = done
            if callable(progress):
                progress(before + done)
            elif bar is not None:
                bar.show((before + done) / whole, f"{before + done} of {whole}")

        return show


def table(file: AnyPath) -> npt.NDArray[Any]:
    """Read a table with a heading, for example ``study.csv``, as a structured array.

    Columns of numbers are floats, with NaN for empty cells. All other columns are texts.
    """
    with open(file, newline="", encoding="utf-8") as lines:
        names, *rows = list(csv.reader(lines))
    columns = [_column([row[index] for row in rows]) for index in range(len(names))]
    result = np.empty(len(rows), [(name, column.dtype) for name, column in zip(names, columns)])
    for name, column in zip(names, columns):
        result[name] = column
    return result


def _column(cells: List[str]) -> npt.NDArray[Any]:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells)
