"""Pieces of a sweep on threads of this process, or on the workers of a Dask cluster."""

from __future__ import annotations

import os
import queue
import threading
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

from liepoisson.errors import LiePoissonError
from liepoisson.sweeps.tasks import Piece, PieceResult, Stopped, run_piece

RETRIES = 2
"""How often a piece that fails is tried again."""
PATIENCE = 60.0
"""Seconds to wait for a scheduler that is gone, or for a worker while there is none."""
GRACE = 2.0
"""Seconds in which threads shall have ended; the integration of exponents looks ten times a second whether to stop."""


class SweepError(LiePoissonError):
    """A sweep that cannot go on: no scheduler, or no worker that may compute its pieces."""


@dataclass(frozen=True)
class Event:
    """What became of a piece."""

    index: int  # which piece
    result: PieceResult | None = None  # what it gave, or None
    error: str | None = None  # why it failed, or None
    is_lost: bool = False  # whether it must be handed out again through no fault of its own
    remark: str | None = None  # what to report, or None


class Threads:
    """Threads of this process, one piece on each; the core has no threads of its own then.

    They do not keep the process from ending: a function of the user that runs on when a sweep is given up cannot be
    ended, and is not waited for.
    """

    def __init__(self, threads: int | None, n_pieces: int) -> None:
        available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        wanted = threads or available
        self.workers = max(1, min(wanted, n_pieces))
        # Fewer pieces than threads: the core shares out the trajectories of each.
        self._inner = max(1, wanted // self.workers)
        self._pieces: queue.SimpleQueue[Piece | None] = queue.SimpleQueue()
        self._events: queue.SimpleQueue[Event] = queue.SimpleQueue()
        self._given_up = threading.Event()
        self._threads = [
            threading.Thread(target=self._work, name=f"sweep-{k}", daemon=True) for k in range(self.workers)
        ]
        for thread in self._threads:
            thread.start()

    def submit(self, piece: Piece) -> None:
        """Hand out a piece."""
        self._pieces.put(replace(piece, threads=self._inner))

    def _work(self) -> None:
        while (piece := self._pieces.get()) is not None and not self._given_up.is_set():
            try:
                event = Event(piece.index, result=run_piece(piece, self._listen))
            except BaseException as error:  # one that is not told of would be waited for without end
                event = Event(piece.index, error=_words(error))
            self._events.put(event)

    def _listen(self, _: float) -> None:
        if self._given_up.is_set():
            raise Stopped

    def next(self) -> Event:
        """Wait for a piece; in short waits, so that Ctrl-C comes through."""
        while True:
            try:
                return self._events.get(timeout=0.5)
            except queue.Empty:
                continue

    def close(self) -> None:
        """Give up what is not done, at once; threads that do not end in time are left alone."""
        self._given_up.set()
        for _ in self._threads:
            self._pieces.put(None)
        end = time.monotonic() + GRACE
        for thread in self._threads:
            thread.join(max(0.0, end - time.monotonic()))


def _words(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"


class Cluster:
    """The workers of a scheduler of `dask.distributed`; without an address, of processes on this machine.

    A worker with another version of liepoisson refuses; it is reported and not asked again.  When the connection to the
    scheduler is lost, this waits for one at the same address and hands out again what is not done.  When all workers
    are gone, it waits for a new one; for neither longer than `patience` seconds.
    """

    def __init__(self, address: str | None, processes: int | None, patience: float = PATIENCE) -> None:
        from liepoisson.sweeps.remote import packed, portable

        self._pack, self._function = packed, portable()
        self._patience = patience
        self._local: Any = None
        self._pending: dict[int, tuple[Piece, Any, list[str] | None]] = {}
        self._deserted: float | None = None
        self._events: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        self.refused: dict[str, str] = {}
        if address is None:
            self._folder = TemporaryDirectory(prefix="liepoisson-sweep-")
            self._local = _processes(processes or 1, self._folder.name)
            address = self._local.scheduler_address
        self._address = address
        self._client: Any = self._connect(processes or 1)

    def _connect(self, n_workers: int = 1) -> Any:
        from distributed import Client

        end = time.monotonic() + self._patience
        while True:
            try:
                client = Client(self._address, timeout=min(5.0, self._patience), set_as_default=False)
            except (OSError, ValueError) as error:
                if time.monotonic() > end or isinstance(error, ValueError):
                    raise SweepError(
                        f"no scheduler answers at {self._address} ({error}). Start one (dask scheduler), or check the "
                        "address; what is finished is kept."
                    ) from error
                time.sleep(0.5)
                continue
            try:
                client.wait_for_workers(n_workers, timeout=max(1.0, end - time.monotonic()))
            except TimeoutError as error:
                client.close()
                raise SweepError(
                    f"the scheduler at {self._address} has no workers. Start some: dask worker {self._address}; what "
                    "is finished is kept."
                ) from error
            return client

    @property
    def workers(self) -> int:
        """Threads of the workers that may be asked."""
        known = self._client.scheduler_info(n_workers=-1)["workers"]
        return max(1, sum(w["nthreads"] for address, w in known.items() if address not in self.refused))

    def submit(self, piece: Piece) -> None:
        """Hand out a piece, to workers that have not refused."""
        where = self._willing(piece.version) if self.refused else None
        future = self._client.submit(
            self._function, self._pack(piece), piece.version, pure=False, workers=where, allow_other_workers=False
        )
        self._pending[piece.index] = piece, future, where
        future.add_done_callback(lambda done: self._events.put((piece.index, done)))

    def _willing(self, version: str) -> list[str]:
        """The workers that have not refused; waits for one where there is none."""
        end = time.monotonic() + self._patience
        while True:
            willing = [w for w in self._client.scheduler_info(n_workers=-1)["workers"] if w not in self.refused]
            if willing:
                return willing
            if time.monotonic() > end:
                raise SweepError(
                    f"no worker may compute this sweep: {next(iter(self.refused.values()))}. Install liepoisson "
                    f"{version} on the workers."
                )
            time.sleep(0.2)

    def next(self) -> Event:
        """Wait for what becomes of a piece."""
        while True:
            try:
                index, future = self._events.get(timeout=1.0)
            except queue.Empty:
                if self._client.status in ("closed", "closing"):
                    self._start_again()
                else:
                    self._look_after_workers()
                continue
            if index not in self._pending or self._pending[index][1] is not future:
                continue  # of a connection that is gone
            if future.status in ("cancelled", "lost"):
                self._start_again()
                continue
            self._deserted = None
            piece = self._pending.pop(index)[0]
            if future.status == "error":
                return Event(index, error=_words(cast("BaseException", future.exception())))
            kind, content, worker = future.result()
            if kind == "done":
                return Event(index, result=content)
            remark = None if worker in self.refused else f"worker {worker} is not asked: {content}"
            self.refused[worker] = content
            return Event(piece.index, is_lost=True, remark=remark)

    def _look_after_workers(self) -> None:
        """Hand out again what only workers that are gone may compute; give up when there has been none for too long."""
        try:
            known = self._client.scheduler_info(n_workers=-1)["workers"]
        except OSError:  # the connection is breaking; the client will say so
            return
        if any(worker not in self.refused for worker in known):
            self._deserted = None
            for piece, future, where in list(self._pending.values()):
                if where is not None and not any(worker in known for worker in where):
                    self.submit(piece)
                    self._client.cancel([future], force=True)
            return
        now = time.monotonic()
        self._deserted = now if self._deserted is None else self._deserted
        if now - self._deserted > self._patience:
            raise SweepError(
                f"the scheduler at {self._address} has had no worker for {self._patience:g} s; what is finished is "
                f"kept. Start some (dask worker {self._address}), or give workers of a queue more time (patience, "
                "--patience)."
            )

    def _start_again(self) -> None:
        """Connect anew and hand out all that is not done."""
        self._client.close(timeout=1)
        self._client = self._connect()
        self.refused.clear()
        self._deserted = None
        for piece, _, _ in list(self._pending.values()):
            self.submit(piece)

    def close(self) -> None:
        """Drop what is not done, and leave the scheduler, or end it where it is ours."""
        if self._client.status == "running":
            self._client.cancel([future for _, future, _ in self._pending.values()], force=True)
        self._client.close(timeout=5)
        if self._local is not None:
            self._local.close()
            self._folder.cleanup()


_END_WITH_PARENT = """
import os, threading, time

def watch():
    while os.getppid() == {pid}:
        time.sleep(0.5)
    os._exit(1)

threading.Thread(target=watch, name="parent", daemon=True).start()
"""
"""Run by the scheduler and the nannies, whose workers end with them: a process that is killed cannot end its children,
and they would compute on and hold its output open."""


def _processes(count: int, folder: str) -> Any:
    """A scheduler and workers in processes of their own, which do not run the user's script again as forks would.

    They end when this process has ended, however it did.
    """
    from distributed.deploy.subprocess import SubprocessCluster

    watch = [_END_WITH_PARENT.format(pid=os.getpid())]
    with _quiet_children():
        return SubprocessCluster(
            n_workers=count,
            threads_per_worker=1,
            dashboard_address=cast("Any", None),
            scheduler_kwargs={"scheduler_file": str(Path(folder) / "scheduler.json"), "preload": watch},
            worker_kwargs={"local_directory": folder, "memory_limit": 0, "dashboard": False, "preload_nanny": watch},
        )


@contextmanager
def _quiet_children() -> Generator[None]:
    """Processes that begin here log warnings alone, unless the user's environment has set what they log."""
    level = "DASK_DISTRIBUTED__LOGGING__DISTRIBUTED"
    if level in os.environ:
        yield
        return
    os.environ[level] = "warning"  # Dask starts them, and takes no other environment for them
    try:
        yield
    finally:
        del os.environ[level]


@dataclass
class Report:
    """How the pieces of a level went."""

    failed: dict[int, str] = field(default_factory=dict[int, str])  # pieces that failed for good, with the reason
    # points that failed, likewise, by their number in the level
    points: dict[int, str] = field(default_factory=dict[int, str])
    retried: int = 0  # how many tries failed and were repeated
    remarks: list[str] = field(default_factory=list[str])  # workers that refused, and the like
    wall_seconds: float = 0.0  # from the first piece handed out to the last one back
    task_seconds: float = 0.0  # sum of the times of the pieces
    workers: int = 1  # how many pieces were computed at once
    n_pieces: int = 0  # how many were computed

    @property
    def overhead_per_piece(self) -> float:
        """Seconds of a worker that are not spent in a piece, for each piece; at the end some workers idle, too."""
        return max(0.0, self.wall_seconds * self.workers - self.task_seconds) / max(1, self.n_pieces)


def run_pieces(executor: Threads | Cluster, pieces: Sequence[Piece], *, keep: Callable[[PieceResult], None]) -> Report:
    """Compute pieces; each result goes to `keep` at once, in this thread."""
    began, report = time.perf_counter(), Report(workers=executor.workers)
    waiting = {piece.index: piece for piece in pieces}
    tries = dict.fromkeys(waiting, 0)
    for piece in pieces:
        executor.submit(piece)
    while waiting:
        event = executor.next()
        if event.remark is not None:
            report.remarks.append(event.remark)
        if event.result is not None:
            report.task_seconds += event.result.seconds
            report.n_pieces += 1
            report.retried += event.result.retried
            keep(event.result)
            del waiting[event.index]
        elif event.is_lost:
            executor.submit(waiting[event.index])
        elif tries[event.index] < RETRIES:
            tries[event.index] += 1
            report.retried += 1
            executor.submit(waiting[event.index])
        else:
            report.failed[event.index] = event.error or "unknown"
            del waiting[event.index]
    report.wall_seconds = time.perf_counter() - began
    return report
