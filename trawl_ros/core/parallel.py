# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parallel tasks on Dask: on the cores of this machine, or on a cluster.

A result depends only on its task (random numbers come from a seed in it), and results are assigned
by the name of the task. So it does not matter where and when a task runs.
"""

import asyncio
import logging
import os
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import TypeVar

from dask import config
from distributed import Client, Future, KilledWorker, LocalCluster, as_completed
from distributed.comm.core import connect
from distributed.security import Security

from trawl_ros.core.errors import TrawlError, sentence_of
from trawl_ros.core.network import THIS_MACHINE

TaskT = TypeVar('TaskT')
ResultT = TypeVar('ResultT')

SCHEDULER_TIMEOUT_S = 5.0
"""Timeout of the answer of a scheduler."""

START_TIMEOUT_S = 300.0
"""Timeout of the start of processes of this machine, which may be busy."""

TLS_KEYS = "ca-file, client.cert and client.key of Dask's distributed.comm.tls"

DASK_OPTIONS = {
    # No retry of a task whose worker died: it would kill the next worker too.
    'distributed.scheduler.allowed-failures': 0,
    'distributed.comm.timeouts.connect': f'{START_TIMEOUT_S:g}s',
    # Tasks compute for minutes without releasing the interpreter, which is no fault.
    'distributed.admin.tick.limit': '1h',
}


def run_tasks(
    function: Callable[[TaskT], ResultT],
    tasks: Mapping[str, TaskT],
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    scheduler_timeout_s: float = SCHEDULER_TIMEOUT_S,
) -> Iterator[tuple[str, ResultT]]:
    """Run a function on each task, and yield results as they are done.

    An early end of the iteration, for example by Ctrl-C, stops the running tasks.

    Parameters
    ----------
    function
        Function of a module, so that another process can import it.
    tasks
        Tasks by name; tasks and results must be picklable.
    scheduler
        Address of a Dask cluster, such as ``tcp://10.0.0.5:8786``, whose workers have this package
        installed. ``tls://`` uses the keys of Dask's configuration (``distributed.comm.tls``). The
        cluster runs code and sends pickles, so it must be trusted. None uses processes of this
        machine, which listen only on the loopback address.
    workers
        Number of these processes; None for the smaller of the numbers of cores and tasks.
    scheduler_timeout_s
        Timeout of the answer of ``scheduler``, s.

    Yields
    ------
    tuple
        Name of a task and its result, in the order in which they are done.

    Raises
    ------
    TrawlError
        If the cluster does not answer, or a task fails; the error names the task.
    """
    if not tasks:
        return
    with config.set(DASK_OPTIONS), ExitStack() as stack:
        if scheduler is None:
            client = _of_this_machine(workers or min(cores(), len(tasks)), stack)
        else:
            client = stack.enter_context(_connected(scheduler, scheduler_timeout_s))
        names = {
            # pure=False, because Dask would merge two calls with equal arguments.
            client.submit(_outcome, function, task, pure=False): name
            for name, task in tasks.items()
        }
        try:
            for future in as_completed(names, loop=client.loop):
                yield names[future], _result(names[future], future)
        finally:
            client.cancel(list(names), force=True)


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1


@dataclass(frozen=True)
class _Fault:
    """Error of a task as a sentence, which can always be pickled."""

    sentence: str


def _outcome(function: Callable[[TaskT], ResultT], task: TaskT) -> ResultT | _Fault:
    try:
        return function(task)
    except Exception as reason:
        # As a sentence, because the traceback would otherwise stay on the worker.
        return _Fault(sentence_of(reason))


def _result(name: str, future: Future[ResultT | _Fault]) -> ResultT:
    try:
        outcome = future.result()
    except KilledWorker as reason:
        raise TrawlError(f'{name}: the process that ran it died') from reason
    except Exception as reason:
        # A fault of the cluster, such as a worker without this package.
        raise TrawlError(f'{name}: could not be run ({reason})') from reason
    if isinstance(outcome, _Fault):
        raise TrawlError(f'{name}: {outcome.sentence}')
    return outcome


def _of_this_machine(workers: int, stack: ExitStack) -> Client:
    """Return the client of this many processes, which the stack stops."""
    try:
        with _interrupts_held():
            # security=True makes temporary keys, so other users of this machine cannot join.
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host=THIS_MACHINE,
                security=True,
                # Without a dashboard, the rest of its server would still listen on all addresses.
                dashboard_address=f'{THIS_MACHINE}:0',
                worker_dashboard_address=None,
                scheduler_kwargs={'dashboard': False},
                silence_logs=logging.CRITICAL,
                memory_limit=0,
            )
            stack.enter_context(cluster)
        client: Client = stack.enter_context(Client(cluster, set_as_default=False))
    except (OSError, RuntimeError) as reason:
        # Dask raises either for its own timeouts.
        raise TrawlError(
            f'the {workers} processes for the work did not start ({_first_line(reason)}), '
            f'expected a start within {START_TIMEOUT_S:g} s; check whether this machine is busy'
        ) from reason
    return client


def _connected(address: str, timeout_s: float) -> Client:
    keys = _keys(address)
    log = logging.getLogger('distributed')
    before = log.level
    try:
        log.setLevel(logging.CRITICAL + 1)
        # First a handshake with a timeout: Dask's client would wait forever for a silent server.
        handshake = _shake_hands(address, keys, timeout_s)
        asyncio.run(asyncio.wait_for(handshake, timeout_s + 1.0))
        return Client(address, timeout=timeout_s, set_as_default=False)
    except Exception as reason:
        # Dask raises errors of many types here; none is an error of this program.
        raise TrawlError(
            f'{address}: no Dask scheduler answers ({_first_line(reason)}), expected an address '
            'such as tcp://10.0.0.5:8786, or tls:// with the keys of the configuration of Dask'
        ) from reason
    finally:
        log.setLevel(before)


def _first_line(reason: Exception) -> str:
    return next(iter(str(reason).splitlines()), type(reason).__name__)


def _keys(address: str) -> dict[str, object]:
    """Return arguments of a connection with the keys of Dask's configuration, if any."""
    try:
        keys: dict[str, object] = Security().get_connection_args('client')
    except (OSError, ValueError) as reason:
        names = ('ca-file', 'client.cert', 'client.key')
        files = [config.get(f'distributed.comm.tls.{name}') for name in names]
        raise TrawlError(
            f"{address}: the keys of Dask's configuration cannot be read ({reason}), found "
            f'{", ".join(map(str, files))}, expected PEM files under {TLS_KEYS}'
        ) from reason
    if address.startswith('tls://') and keys.get('ssl_context') is None:
        raise TrawlError(
            f'{address}: found no TLS keys in the configuration of Dask, expected {TLS_KEYS}'
        )
    return keys


async def _shake_hands(address: str, keys: dict[str, object], timeout_s: float) -> None:
    (await connect(address, timeout=timeout_s, **keys)).abort()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Block Ctrl-C; processes that are started meanwhile never receive it.

    A terminal sends it to all processes at once, but workers must be stopped by their parent.
    """
    # Start this helper process first: starting it later would unblock signals.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
