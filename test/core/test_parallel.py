"""Tasks give the same wherever they run, and faults come out as a sentence that names the task."""

import math
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from dask import config
from distributed import LocalCluster
from distributed.security import Security

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.network import THIS_MACHINE
from trawl_ros.core.parallel import DASK_OPTIONS, run_tasks

TASKS = {f'root {number}': float(number) for number in range(6)}
ROOTS = {name: math.sqrt(number) for name, number in TASKS.items()}


@pytest.fixture(scope='module')
def cluster() -> Iterator[str]:
    """The address of a cluster that somebody else has started, as `dask scheduler` would."""
    with LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        host=THIS_MACHINE,
        dashboard_address=f'{THIS_MACHINE}:0',
        silence_logs=50,
    ) as running:
        yield running.scheduler_address


def test_processes_and_a_cluster_give_the_same(cluster: str) -> None:
    assert dict(run_tasks(math.sqrt, TASKS, workers=2)) == ROOTS
    assert dict(run_tasks(math.sqrt, TASKS, scheduler=cluster)) == ROOTS


def test_equal_tasks_are_each_run(cluster: str) -> None:
    assert dict(run_tasks(abs, {'first': -1, 'second': -1}, scheduler=cluster)) == {
        'first': 1,
        'second': 1,
    }


def test_no_tasks_need_no_cluster() -> None:
    assert list(run_tasks(math.sqrt, {}, scheduler='tcp://nowhere:1')) == []


def test_a_fault_names_its_task(cluster: str) -> None:
    with pytest.raises(TrawlError, match=r'(?s)^trial 7: .*ValueError: math domain'):
        list(run_tasks(math.sqrt, {'trial 7': -1.0}, scheduler=cluster))


def test_a_worker_that_dies_names_its_task() -> None:
    with pytest.raises(TrawlError, match=r'^trial 7: '):
        list(run_tasks(os._exit, {'trial 7': 3}, workers=1))


def test_processes_that_do_not_start_in_time_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(DASK_OPTIONS, 'distributed.comm.timeouts.connect', '1ms')
    with pytest.raises(TrawlError, match='the 1 processes'):
        list(run_tasks(abs, {'one': 1}, workers=1))


@pytest.mark.parametrize('address', ['tcp://127.0.0.1:9', 'foo', 'file:///etc/passwd'])
def test_an_address_without_a_scheduler_is_refused(address: str) -> None:
    with pytest.raises(TrawlError, match=f'{address}: no Dask scheduler'):
        list(run_tasks(abs, {'first': 1}, scheduler=address, scheduler_timeout_s=0.2))


def test_tls_without_keys_says_which_are_missing() -> None:
    with pytest.raises(TrawlError, match=r'^tls://127\.0\.0\.1:9: .*ca-file'):
        list(run_tasks(abs, {'first': 1}, scheduler='tls://127.0.0.1:9'))


@pytest.mark.parametrize('content', [None, '', 'no key'])
def test_keys_that_cannot_be_read_are_named(content: str | None, tmp_path: Path) -> None:
    file = tmp_path / 'key.pem'
    if content is not None:
        file.write_text(content)
    names = ('ca-file', 'client.cert', 'client.key')
    with (
        config.set({f'distributed.comm.tls.{name}': str(file) for name in names}),
        pytest.raises(TrawlError, match=r'^tls://127\.0\.0\.1:9: .*key\.pem'),
    ):
        list(run_tasks(abs, {'first': 1}, scheduler='tls://127.0.0.1:9'))


def test_a_cluster_with_keys_is_joined_by_those_who_have_them() -> None:
    security = Security.temporary()
    with LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        host=THIS_MACHINE,
        protocol='tls://',
        security=security,
        dashboard_address=f'{THIS_MACHINE}:0',
        silence_logs=50,
    ) as running:
        keys = {
            'ca-file': security.tls_ca_file,
            'client.cert': security.tls_client_cert,
            'client.key': security.tls_client_key,
        }
        with config.set({f'distributed.comm.tls.{name}': key for name, key in keys.items()}):
            given = dict(run_tasks(math.sqrt, TASKS, scheduler=running.scheduler_address))
        assert given == ROOTS
        plain = running.scheduler_address.replace('tls', 'tcp')
        with pytest.raises(TrawlError, match='no Dask scheduler'):
            list(run_tasks(abs, {'first': 1}, scheduler=plain))


def test_one_that_listens_and_says_nothing_is_refused() -> None:
    with socket.create_server((THIS_MACHINE, 0)) as silent:
        address = f'tcp://{THIS_MACHINE}:{silent.getsockname()[1]}'
        with pytest.raises(TrawlError, match='no Dask scheduler'):
            list(run_tasks(abs, {'first': 1}, scheduler=address, scheduler_timeout_s=0.2))


SLEEPERS = """
import time
from trawl_ros.core.parallel import DASK_OPTIONS, run_tasks

if __name__ == '__main__':
    try:
        for name, _ in run_tasks(time.sleep, {'short': 0.0, 'long': 600.0}, workers=2):
            print(name, flush=True)
    except KeyboardInterrupt:
        print('interrupted', flush=True)
"""


def test_ctrl_c_ends_all_processes_quietly(tmp_path) -> None:
    script = tmp_path / 'sleepers.py'
    script.write_text(SLEEPERS)
    # A terminal sends the signal to every process of the group; so does this test.
    running = subprocess.Popen(
        [sys.executable, str(script)],
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        assert running.stdout is not None
        assert running.stdout.readline() == 'short\n'
        os.killpg(running.pid, signal.SIGINT)
        said, faults = running.communicate(timeout=60)
    finally:
        running.kill()
    assert said == 'interrupted\n'
    assert faults == ''
    assert running.returncode == 0
    deadline = time.monotonic() + 20.0
    while _alive(running.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not _alive(running.pid)


def _alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
