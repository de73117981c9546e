"""Spread work over threads of this machine, or over the workers of a Dask cluster.

Results come in the order of the items, and few are held at a time, so that a caller can write them
away as they come.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor, wait
from typing import Any, TypeVar

from hoverproof.errors import InputError, needing

Item = TypeVar("Item")
Result = TypeVar("Result")

CONNECT_SECONDS, IDLE_SECONDS = 10, 0.2
MOST_PROCESSES = 1024
RETRIES = 5
"""How often a piece of work is given to another worker when one fails or is lost."""


def processors() -> int:
    """Return how many processors this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on Linux
        return os.cpu_count() or 1


def spread(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    executor: Executor | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    stop: Callable[[], None] | None = None,
    idle: Callable[[], None] | None = None,
) -> Generator[Result, None, None]:
    """Yield ``function(item)`` for each item, in order.

    Parameters
    ----------
    function : callable
        Must be picklable for a cluster, or for an executor of processes.
    items : iterable
    executor : Executor, optional
        Where to run, and shut down at the end; by default `threads` threads.
    threads : int, optional
        Their number; by default as many as there are processors.
    scheduler : str, optional
        Address of a running Dask scheduler, as ``tcp://host:8786``; needs the extra ``cluster``.
    stop : callable, optional
        Called if the caller does not want the rest: tells work under way to end soon.
    idle : callable, optional
        Called now and then while a result is waited for.

    Raises
    ------
    InputError
        If the scheduler cannot be reached, or its workers cannot do the work.
    """
    if scheduler is not None:
        yield from _on_cluster(function, items, scheduler)
        return
    width = (threads or processors()) if executor is None else processors()
    with executor or ThreadPoolExecutor(width) as pool:
        try:
            yield from _in_order(lambda item: pool.submit(function, item), items, 2 * width, idle)
        except BaseException:  # also if the caller closes this generator
            if stop is not None:
                stop()
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def collected(
    work: Callable[[Item], Result],
    items: Sequence[Item],
    processes: int | None,
    scheduler: str | None,
    report: Callable[[int, int], None],
    parts: int = 1,
) -> list[Result]:
    """Do work in processes or on a cluster; return the results in the order of the items.

    Parameters
    ----------
    work : callable
        See `spread`.
    items : sequence
    processes : int, optional
        Number of those that work at once; by default one for each CPU.
    scheduler : str, optional
        See `spread`, also for what is raised.
    report : callable
        Called with how many are done, of how many.
    parts : int
        What an item counts for, a bare number; work calls `count` when one of them is done.

    Raises
    ------
    InputError
        If there cannot be so many processes.
    """
    if processes is not None and not 1 <= processes <= MOST_PROCESSES:
        raise InputError("--processes", "", f"must be from 1 to {MOST_PROCESSES}, not {processes}")
    total, shared = len(items) * parts, multiprocessing.Value("q", 0)

    def told() -> None:
        report(min(shared.value, total), total)

    if scheduler is None and (processes == 1 or len(items) < 2):
        _count_in(shared, told)
        done: Iterable[Result] = map(work, items)
    else:
        pool = None
        if scheduler is None:
            pool = ProcessPoolExecutor(processes, initializer=_count_in, initargs=(shared,))
        done = spread(work, items, executor=pool, scheduler=scheduler, idle=told)
    results = []
    for result in done:
        results.append(result)
        with shared.get_lock():
            shared.value = max(shared.value, len(results) * parts)
        told()
    return results


_here = threading.local()


def count() -> None:
    """Count a part of an item as done, where `collected` counts parts in this thread."""
    getattr(_here, "counted", lambda: None)()


def _count_in(shared: Any, told: Callable[[], None] = lambda: None) -> None:
    """Let this thread count what is done in a number that it shares with other processes."""

    def counted() -> None:
        with shared.get_lock():
            shared.value += 1
        told()

    _here.counted = counted


def interruptibly(function: Callable[[], Result], stop: Callable[[], None]) -> Result:
    """Return ``function()``, which works in another thread, so that this one hears Ctrl-C.

    Parameters
    ----------
    function : callable
        Work that spends its time outside of Python.
    stop : callable
        Called on an interruption: tells the work to end soon.
    """
    (result,) = spread(lambda _: function(), [None], threads=1, stop=stop)
    return result


def _in_order(
    submit: Callable[[Item], Any],
    items: Iterable[Item],
    ahead: int,
    idle: Callable[[], None] | None = None,
) -> Iterator[Any]:
    under_way: deque[Any] = deque()
    for item in items:
        under_way.append(submit(item))
        if len(under_way) >= ahead:
            yield _result(under_way.popleft(), idle)
    while under_way:
        yield _result(under_way.popleft(), idle)


def _result(future: Any, idle: Callable[[], None] | None) -> Any:
    while idle is not None and not wait([future], IDLE_SECONDS).done:
        idle()
    return future.result()


def _on_cluster(
    function: Callable[[Item], Result], items: Iterable[Item], scheduler: str
) -> Iterator[Result]:
    with needing("cluster", "--scheduler", "needs the extra cluster"):
        from distributed import Client
        from distributed.scheduler import KilledWorker
    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        reason = f"no Dask scheduler answers at {scheduler!r}: {error}"
        raise InputError("--scheduler", "", reason) from None
    with client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise InputError("--scheduler", "", f"the scheduler at {scheduler} has no workers")

        def submit(item: Item) -> Any:
            return client.submit(function, item, pure=False, retries=RETRIES)

        try:
            yield from _in_order(submit, items, 2 * threads + 2)
        except (ImportError, KilledWorker) as error:
            raise InputError(
                "--scheduler", "", f"its workers cannot do this work: {error}"
            ) from None
