"""Points of a sweep that the workers of an executor run."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from dataclasses import dataclass, replace
from typing import Any

from tomlin import _core
from tomlin._errors import Error, RunError

# A worker gets points in chunks. Each has at most a quarter of its share of those that are left, so
# that none is busy long after the others, unless lanes would have less than a vector of them.
_CHUNKS_OF_A_SHARE = 4
_FEWEST_POINTS = 8
_MOST_POINTS = 512  # rows that are lost with a worker

_SECONDS_BETWEEN_REPORTS = 0.5
_SECONDS_AFTER_AN_END = 1.0  # for workers that Ctrl-C has reached as well


@dataclass(frozen=True)
class Job:
    """A worker makes the plan of a sweep from these plain values, which can be sent."""

    text: str
    file: bytes
    plugins: list[bytes]
    settings: list[tuple[str, str]]
    request: dict[str, Any]
    folder: bytes | None
    threads: int
    identity: int = 0

    def plan(self) -> _core.WorkerPlan:
        scene = _core.read_text(self.text, self.file, self.plugins).with_settings(self.settings)
        plan = _core.WorkerPlan(scene, request_of(self.request))
        if plan.identity != self.identity:
            raise RunError("a worker has other files, other plugins or another version of tomlin "
                           "than the process that has started the sweep")
        return plan


def request_of(values: dict[str, Any]) -> _core.SweepRequest:
    """Describes a sweep, but for where and how it is run."""
    request = _core.SweepRequest()
    for name, value in values.items():
        setattr(request, name, value)
    return request


class _Plans(threading.local):
    """The plan of the last sweep of a thread, which gets many chunks of it."""

    of: tuple[Job, _core.WorkerPlan] | None = None


_plans = _Plans()


def run_chunk(job: Job, points: list[int], values: list[float]) -> list[_core.SentRow]:
    """Runs points in a worker and returns their rows."""
    if _plans.of is None or _plans.of[0] != job:
        _plans.of = None  # the memory of the one before
        _plans.of = (job, job.plan())
    return _plans.of[1].run(points, values, job.folder, job.threads)


class _Lost(Exception):
    """The executor gives no rows any more."""


class Dispatch:
    """Hands out the points of a sweep, in each round of a refinement anew, and keeps their rows.
    What ends it early is its `error`."""

    def __init__(self, executor: Executor, job: Job, chunk: int | None,
                 progress: Callable[..., Any] | None):
        self.error: BaseException | None = None
        self._executor = executor
        self._job = job
        self._chunk = chunk
        self._progress = progress

    def __call__(self, points: _core.SweepRound) -> None:
        if self.error is not None:
            return
        pending: set[Future[Any]] = set()
        try:
            self._submit(points, pending)
            while pending:
                ended, _ = wait(pending, _SECONDS_BETWEEN_REPORTS, FIRST_COMPLETED)
                pending -= ended
                _keep(points, ended)
                if self._progress:
                    self._progress(*points.progress())
        except BaseException as error:
            self.error = error
            self._end(points, pending)

    def _submit(self, points: _core.SweepRound, pending: set[Future[Any]]) -> None:
        job = replace(self._job, identity=points.identity)
        size = self._chunk or _fair_chunk(points.missing, self._executor)
        while (chunk := points.take(size))[0]:
            try:
                pending.add(self._executor.submit(run_chunk, job, *chunk))
            except Exception as error:
                raise _Lost from error

    def _end(self, points: _core.SweepRound, pending: set[Future[Any]]) -> None:
        running = [future for future in pending if not future.cancel()]
        try:
            _keep(points, wait(running, _SECONDS_AFTER_AN_END)[0])
        except Exception:
            pass  # the first error is the one that is reported

    def raise_error(self, result: Any) -> None:
        """Raises what has ended the sweep early, with the sweep so far as its ``result``."""
        if not isinstance(self.error, _Lost):
            if self.error is not None and not isinstance(self.error, KeyboardInterrupt):
                raise self.error
            return
        kept = int((result.status != "missing").sum())
        where = ("are in the result of this exception" if result.folder is None else
                 f"are kept in {result.folder}, and the same call continues with the others")
        cause = self.error.__cause__
        error = RunError(f"the executor has lost a worker: {type(cause).__name__}: {cause}; "
                         f"{kept} of {result.status.size} rows {where}")
        error.result = result  # type: ignore[attr-defined]
        raise error from cause


def _keep(points: _core.SweepRound, ended: Iterable[Future[Any]]) -> None:
    """Keeps all rows that have come, then raises what came instead of others."""
    failure: BaseException | None = None
    for future in ended:
        try:
            error = future.exception()
        except CancelledError as cancelled:  # by the executor
            error = cancelled
        if error is None:
            points.keep(future.result())
        else:
            failure = failure or error
    if isinstance(failure, (Error, KeyboardInterrupt)):
        raise failure
    if failure is not None:
        raise _Lost from failure


def _fair_chunk(missing: int, executor: Executor) -> int:
    # Executors of the standard library and of mpi4py have this attribute.
    workers = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    share = -(-missing // workers)
    return min(share, max(_FEWEST_POINTS, min(_MOST_POINTS, share // _CHUNKS_OF_A_SHARE)))
