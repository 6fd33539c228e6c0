"""Runs members (of a study, or cells to fit) on an executor of the user: submits batches and collects rows."""

from __future__ import annotations

import hashlib
import os
import threading
import time
from collections import OrderedDict, deque
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Callable, Iterator, Protocol

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._progress import Heard

# Result of a batch of a study: numbers of members, metrics (n, M), why one has none, curves (n, L), seconds.
Rows = tuple[NDArray[np.uint64], NDArray[np.float64], list[str | None], NDArray[np.float32], float]
# Result of any batch: numbers of members first, seconds of work last.
Answer = tuple[Any, ...]

# Size of the first batches, before the time of a member is known.
FIRST = {"cell": 128, "beat": 4, "fit": 1}
# What a person calls them.
STAGES = {"cell": "members", "beat": "members", "fit": "cells"}
# Cells are integrated together in lanes, which should be filled.
LANES = {"cell": 16, "beat": 1, "fit": 1}
# Largest batch, however fast its members are.
LARGEST = 1_000_000
# Interval at which signals, workers and the clock are checked, s.
SOON = 0.1
WORKERS_EVERY = 5.0
# After this many consecutive batches whose workers died, the cause is not the members.
HOPELESS = 3

_made: OrderedDict[str, _native.Members] = OrderedDict()
_making = threading.Lock()


def work(key: str, head: bytes, numbers: NDArray[np.uint64], values: NDArray[np.float64], threads: int, _try: int) -> Rows:
    """Returns the rows of a batch, in a worker; what its members share is created once per process."""
    with _making:
        members = _made.pop(key, None) or _native.Members(head)
        _made[key] = members
        while len(_made) > 4:
            _made.popitem(last=False)
    return members.rows(_aligned(numbers), _aligned(values), threads)


def _aligned(array: NDArray[Any]) -> NDArray[Any]:
    """Returns an aligned array from any position in a message, copied if necessary."""
    return np.require(array, requirements=["C_CONTIGUOUS", "ALIGNED"])


class Tasks(Protocol):
    """Members and the work on them."""

    @property
    def kind(self) -> str:
        """Kind of the members: a key of `FIRST`."""

    @property
    def size(self) -> int:
        """Number of members, including finished ones."""

    def left(self) -> NDArray[np.uint64]:
        """Numbers of the members that are not finished."""

    def work(self, numbers: NDArray[np.uint64]) -> Answer:
        """Computes some members on this thread."""

    def stop(self) -> None:
        """Asks that work to stop soon."""

    def call(self, numbers: NDArray[np.uint64], threads: int, tries: int) -> tuple[Any, ...]:
        """Returns the function, with arguments, by which a worker computes some members."""

    def take(self, answer: Answer) -> None:
        """Records a result."""

    def lose(self, numbers: NDArray[np.uint64], reason: str) -> None:
        """Records members without a result."""


class StudyTasks:
    """The members of a study."""

    def __init__(self, study: _native.Study) -> None:
        self.kind, self.size = study.kind, study.size
        self.left, self.work, self.stop, self.lose = study.left, study.work, study.stop, study.lose
        self._study = study

    @cached_property
    def _head(self) -> tuple[str, bytes]:
        head = self._study.head()
        return hashlib.sha256(head).hexdigest(), head

    def call(self, numbers: NDArray[np.uint64], threads: int, tries: int) -> tuple[Any, ...]:
        return (work, *self._head, numbers, self._study.values_of(numbers), threads, tries)

    def take(self, answer: Answer) -> None:
        numbers, metrics, reasons, curves, _ = answer
        self._study.note(_aligned(numbers), _aligned(metrics), reasons, _aligned(curves))


@dataclass(eq=False)
class Batch:
    """Members that are computed together."""

    numbers: NDArray[np.uint64]
    # Number of times its worker died, and whether it may be the cause of other losses.
    deaths: int = 0
    alone: bool = False
    # Makes each task unique, since some executors reuse the results of equal tasks.
    tries: int = 0


class Pace:
    """Chooses the size of batches by the time that members take."""

    def __init__(self, kind: str, seconds: float) -> None:
        self._kind = kind
        self._seconds = seconds
        self._members, self._took = 0, 0.0

    def seen(self, members: int, seconds: float) -> None:
        """Records the time that some members took."""
        self._members += members
        self._took += seconds

    def size(self, left: int, workers: int) -> int:
        """Returns how many of the remaining members form the next batch."""
        lanes = LANES[self._kind]
        if self._took > 0:
            size = min(LARGEST, int(self._seconds * self._members / self._took))
        else:
            size = FIRST[self._kind]
        # The last members are divided, so that all workers end at about the same time.
        size = min(size, -(-left // (2 * workers)))
        return min(left, max(lanes, size - size % lanes))


def died(error: BaseException) -> bool:
    """Whether an error means that a worker died, independent of its task."""
    names = {kind.__name__ for kind in type(error).__mro__}
    gone = {"KilledWorker", "CommClosedError", "FutureCancelledError"}
    return isinstance(error, (BrokenExecutor, CancelledError, ConnectionError)) or bool(names & gone)


class Pool:
    """An executor, replaced by another of its kind if it breaks."""

    def __init__(self, executor: Executor | Callable[[], Executor]) -> None:
        self._make = None if isinstance(executor, Executor) else executor
        self.executor: Executor = executor if isinstance(executor, Executor) else executor()
        if not hasattr(self.executor, "submit"):
            kind = type(self.executor).__name__
            raise TypeError(f"executor is of type {kind}; give a concurrent.futures.Executor or a function that makes one")
        self._own = self._make is not None
        self._workers, self._looked = 1, -np.inf

    def workers(self) -> int:
        """Number of batches computed at a time; for an executor that grows, the current number."""
        if time.monotonic() - self._looked < WORKERS_EVERY:
            return self._workers
        self._looked = time.monotonic()
        client: Any = getattr(self.executor, "_client", None)
        if client is not None and hasattr(client, "nthreads"):
            count = sum(client.nthreads().values())
        else:
            counts = (getattr(self.executor, name, None) for name in ("num_workers", "_max_workers"))
            count = next((count for count in counts if isinstance(count, int)), os.cpu_count() or 1)
        self._workers = max(1, count)
        return self._workers

    def renew(self, error: BaseException) -> None:
        """Replaces an executor that broke."""
        broken = self.executor
        if self._make is not None:
            self.executor = self._make()
        elif type(broken) is ProcessPoolExecutor:
            # Every Python from 3.10 on keeps the arguments of an executor under these names.
            made: Any = broken
            self.executor = ProcessPoolExecutor(
                made._max_workers, made._mp_context, made._initializer, made._initargs
            )
        else:
            raise RuntimeError(
                f"the executor broke ({error}) and takes no more work; what is done is kept where there is an output "
                "folder. Give a function that makes an executor instead, so that another can take its place"
            ) from error
        if self._own:
            broken.shutdown(wait=False)
        self._own = True

    def close(self, cancel: bool) -> None:
        """Shuts down an executor that this object created."""
        if self._own:
            self.executor.shutdown(wait=not cancel, cancel_futures=cancel)


class Run:
    """A run of all members."""

    def __init__(
        self,
        tasks: Tasks,
        threads: int,
        seconds: float,
        tries: int,
        watch: Heard | None,
    ) -> None:
        self._tasks = tasks
        self._threads = threads
        self._tries = tries
        self._watch = watch
        self._pace = Pace(tasks.kind, seconds)
        self._left = tasks.left()
        self._next = 0
        self._again: deque[Batch] = deque()
        self._pending: dict[Future[Answer], Batch] = {}
        self._given_up = 0
        self._done = 0
        self._shown = -np.inf

    def here(self, threads: int) -> None:
        """Computes all members on threads of this process."""
        executor = ThreadPoolExecutor(threads, thread_name_prefix="myospring")
        pool = Pool(executor)

        def submit(batch: Batch) -> Future[Answer]:
            return executor.submit(self._tasks.work, batch.numbers)

        try:
            self._loop(pool, submit)
        except BaseException:
            # Running members end at once, and finished ones are kept.
            self._tasks.stop()
            executor.shutdown(wait=True, cancel_futures=True)
            self._keep()
            raise
        executor.shutdown()

    def on(self, executor: Executor | Callable[[], Executor]) -> None:
        """Computes all members on an executor."""
        pool = Pool(executor)

        def submit(batch: Batch) -> Future[Answer]:
            return pool.executor.submit(*self._tasks.call(batch.numbers, self._threads, batch.tries))

        try:
            self._loop(pool, submit)
        except BaseException:
            for future in self._pending:
                future.cancel()
            self._keep()
            pool.close(cancel=True)
            raise
        pool.close(cancel=False)

    def _loop(self, pool: Pool, submit: Callable[[Batch], Future[Answer]]) -> None:
        self._show(pool)
        while True:
            try:
                # Never more than a window: executors stall if they are given millions of tasks at once.
                for batch in self._batches(pool):
                    batch.tries += 1
                    self._pending[submit(batch)] = batch
            except BrokenExecutor as error:
                self._again.appendleft(batch)
                self._broke(pool, error)
                continue
            if not self._pending:
                break
            done, _ = wait(self._pending, timeout=SOON, return_when=FIRST_COMPLETED)
            for future in done:
                if future not in self._pending:
                    continue
                failure = CancelledError() if future.cancelled() else future.exception()
                if failure is None:
                    self._take(self._pending.pop(future), future.result())
                elif isinstance(failure, BrokenExecutor):
                    self._broke(pool, failure)
                elif died(failure):
                    self._blame(self._pending.pop(future), failure)
                else:
                    raise failure
            self._show(pool)
        self._show(pool, last=True)

    def _batches(self, pool: Pool) -> Iterator[Batch]:
        """Returns the batches to submit now."""
        while len(self._pending) < 2 * pool.workers():
            if any(batch.alone for batch in self._pending.values()):
                return
            if self._again:
                if self._again[0].alone and self._pending:
                    return
                yield self._again.popleft()
            elif self._next < len(self._left):
                size = self._pace.size(len(self._left) - self._next, pool.workers())
                numbers = self._left[self._next : self._next + size]
                self._next += size
                yield Batch(numbers)
            else:
                return

    def _take(self, batch: Batch, answer: Answer) -> None:
        numbers, seconds = answer[0], answer[-1]
        self._tasks.take(answer)
        self._pace.seen(len(numbers), seconds)
        self._done += len(numbers)
        self._given_up = 0
        if len(numbers) < len(batch.numbers):
            # Its worker was asked to stop.
            rest = np.setdiff1d(batch.numbers, numbers)
            self._again.append(Batch(rest, batch.deaths))

    def _broke(self, pool: Pool, error: BaseException) -> None:
        """Handles a broken executor: all its batches are lost; the cause is known only if it had a single one."""
        wait(self._pending, timeout=10)
        self._keep()
        lost = list(self._pending.values())
        self._pending.clear()
        pool.renew(error)
        if len(lost) == 1:
            self._blame(lost[0], error)
        else:
            for batch in lost:
                batch.alone = True
            self._again.extendleft(lost)

    def _blame(self, batch: Batch, error: BaseException) -> None:
        batch.deaths += 1
        if batch.deaths < self._tries:
            self._again.appendleft(batch)
            return
        self._given_up += 1
        reason = f"its worker died {batch.deaths} times ({type(error).__name__}: {error})"
        if self._given_up >= HOPELESS:
            raise RuntimeError(
                f"{self._given_up} batches in a row were lost with their workers, of the last one {reason}; "
                "what is done is kept where there is an output folder"
            ) from error
        self._tasks.lose(batch.numbers, reason)
        self._done += len(batch.numbers)

    def _keep(self) -> None:
        """Records all finished batches."""
        for future in [future for future in self._pending if future.done()]:
            if not future.cancelled() and future.exception() is None:
                self._take(self._pending.pop(future), future.result())

    def _show(self, pool: Pool, last: bool = False) -> None:
        now = time.monotonic()
        if self._watch is None or (not last and now - self._shown < 0.25):
            return
        self._shown = now
        left = len(self._left) - self._done
        members = self._tasks.size
        self._watch(STAGES[self._tasks.kind], members - left, members)
