"""Parallel tasks on Dask: on the cores of this machine, or on a cluster.

What a task gives depends on the task alone (randomness comes from a seed in it), and results
are handed over by the task's place, so it does not matter where and when each one was run.
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

PATIENCE_S = 5.0
"""Timeout of a scheduler's answer."""

START_S = 300.0
"""Timeout of processes of this machine, which may have much else to do while they start."""

TLS_KEYS = "ca-file, client.cert and client.key of Dask's distributed.comm.tls"

QUIET = {
    # A worker that dies takes its task along; the same task would kill the next one too.
    'distributed.scheduler.allowed-failures': 0,
    'distributed.comm.timeouts.connect': f'{START_S:g}s',
    # Tasks compute for minutes without giving the interpreter back; that is no fault.
    'distributed.admin.tick.limit': '1h',
}


def run_tasks(
    function: Callable[[TaskT], ResultT],
    tasks: Mapping[str, TaskT],
    *,
    scheduler: str | None = None,
    workers: int | None = None,
) -> Iterator[tuple[str, ResultT]]:
    """Run a function on each task, and give results as they come.

    Ending the iteration early, also by Ctrl-C, ends what still runs.

    Parameters
    ----------
    function
        Of a module, so that another process finds it by its name.
    tasks
        By name; tasks and results can be pickled.
    scheduler
        Address of a Dask cluster, such as ``tcp://10.0.0.5:8786``, whose workers have this package
        installed; for ``tls://`` keys are those of Dask's configuration (``distributed.comm.tls``).
        It runs code and sends pickles, so it must be trusted. None runs processes of this
        machine, which listen on it alone.
    workers
        Number of these processes; as many as there are cores, or tasks if these are fewer, if None.

    Yields
    ------
    tuple
        Name of a task and its result, in the order in which they are done.

    Raises
    ------
    TrawlError
        If the cluster does not answer, or a task fails; names the task.
    """
    if not tasks:
        return
    with config.set(QUIET), _client(scheduler, workers or min(cores(), len(tasks))) as client:
        names = {
            # Dask would take two calls with equal arguments for one.
            client.submit(_outcome, function, task, pure=False): name
            for name, task in tasks.items()
        }
        try:
            for future in as_completed(names, loop=client.loop):
                yield names[future], _result(names[future], future)
        finally:
            client.cancel(list(names), force=True)


def cores() -> int:
    """Number of cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1


@dataclass(frozen=True)
class _Fault:
    """Error of a task as a sentence, which can always be sent."""

    sentence: str


def _outcome(function: Callable[[TaskT], ResultT], task: TaskT) -> ResultT | _Fault:
    try:
        return function(task)
    except Exception as reason:
        # Told whole: the traceback would otherwise stay on the worker.
        return _Fault(sentence_of(reason))


def _result(name: str, future: Future[ResultT | _Fault]) -> ResultT:
    try:
        outcome = future.result()
    except KilledWorker as reason:
        raise TrawlError(f'{name}: the process that ran it died') from reason
    except Exception as reason:
        # Not the task but what runs it, such as a worker without this package.
        raise TrawlError(f'{name}: could not be run ({reason})') from reason
    if isinstance(outcome, _Fault):
        raise TrawlError(f'{name}: {outcome.sentence}')
    return outcome


@contextmanager
def _client(scheduler: str | None, workers: int) -> Iterator[Client]:
    with ExitStack() as stack:
        if scheduler is None:
            client = _of_this_machine(workers, stack)
        else:
            client = stack.enter_context(_connected(scheduler))
        yield client


def _of_this_machine(workers: int, stack: ExitStack) -> Client:
    """Client of as many processes, which the stack ends."""
    try:
        with _interrupts_held():
            # Keys made for this cluster alone: who else works on this machine cannot join.
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host=THIS_MACHINE,
                security=True,
                # No dashboard, but what is left of its server would listen to all.
                dashboard_address=f'{THIS_MACHINE}:0',
                worker_dashboard_address=None,
                scheduler_kwargs={'dashboard': False},
                silence_logs=logging.CRITICAL,
                memory_limit=0,
            )
            stack.enter_context(cluster)
        client: Client = stack.enter_context(Client(cluster, set_as_default=False))
    except (OSError, RuntimeError) as reason:
        # Dask tells of its own timeouts by either.
        raise TrawlError(
            f'the {workers} processes for it did not start ({_first_line(reason)}); each has '
            f'{START_S:g} s, so is this machine busy with other work?'
        ) from reason
    return client


def _connected(address: str) -> Client:
    keys = _keys(address)
    log = logging.getLogger('distributed')
    before = log.level
    try:
        log.setLevel(logging.CRITICAL + 1)
        # Dask's client tries for much longer, and waits for ever for one that says nothing.
        asyncio.run(asyncio.wait_for(_shake_hands(address, keys), PATIENCE_S + 1.0))
        return Client(address, timeout=PATIENCE_S, set_as_default=False)
    except Exception as reason:
        # Errors of Dask here are of many kinds; none of them is this program's fault.
        raise TrawlError(
            f'{address}: no Dask scheduler answers there ({_first_line(reason)}), expected an '
            'address such as tcp://10.0.0.5:8786, or tls:// with the keys that Dask is configured '
            'with'
        ) from reason
    finally:
        log.setLevel(before)


def _first_line(reason: Exception) -> str:
    return next(iter(str(reason).splitlines()), type(reason).__name__)


def _keys(address: str) -> dict[str, object]:
    """Arguments of a connection with the keys of Dask's configuration, if there are any."""
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
        raise TrawlError(f'{address}: no keys for tls are configured, expected {TLS_KEYS}')
    return keys


async def _shake_hands(address: str, keys: dict[str, object]) -> None:
    (await connect(address, timeout=PATIENCE_S, **keys)).abort()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back; processes that are started meanwhile never hear of it.

    It is sent to all processes of a terminal at once, but workers are ended by who started them.
    """
    # Whichever thread starts this process of multiprocessing's hears signals again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
