"""The viewer as a process: bound to this machine, without usage statistics, and ended cleanly."""

import json
import os
import socket
from pathlib import Path

import pytest

pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from trawl_ros.view.viewer import Viewer, ViewerFailed, address_of

NO_DISPLAY = {name: os.environ[name] for name in ('PATH', 'HOME') if name in os.environ}


def listening(process: int) -> set[str]:
    """Addresses (hexadecimal, with port) on which the sockets of a process listen."""
    inodes = set()
    for entry in Path(f'/proc/{process}/fd').iterdir():
        try:
            target = str(entry.readlink())
        except FileNotFoundError:  # closed meanwhile
            continue
        if target.startswith('socket:['):
            inodes.add(target[8:-1])
    found = set()
    for table in ('tcp', 'tcp6'):
        for line in Path(f'/proc/{process}/net/{table}').read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == '0A' and fields[9] in inodes:
                found.add(fields[1])
    return found


def test_a_page_listens_on_this_machine_alone_and_ends_with_the_command():
    with Viewer('web', environment=NO_DISPLAY) as viewer:
        sockets = listening(viewer._process.pid)
        assert {address.partition(':')[0] for address in sockets} == {'0100007F'}
        assert len(sockets) == 2
        folder = Path(viewer._folder.name)
        settings = json.loads((folder / 'rerun' / 'analytics.json').read_text())
        assert settings['analytics_enabled'] is False
    assert not viewer.running
    assert not folder.exists()


def test_statistics_stay_off_though_the_user_has_them_on(tmp_path):
    forced = {**NO_DISPLAY, 'HOME': str(tmp_path), 'FORCE_RERUN_ANALYTICS': '1'}
    with Viewer('web', environment=forced) as viewer:
        own = Path(f'/proc/{viewer._process.pid}/environ').read_bytes()
        assert b'FORCE_RERUN_ANALYTICS' not in own
    assert not list(tmp_path.rglob('*.json'))


def test_a_window_needs_a_display():
    with pytest.raises(ViewerFailed, match=r'no display .* --web .* --out'):
        Viewer('window', environment=NO_DISPLAY)


def test_an_address_is_checked_and_a_taken_port_told():
    with pytest.raises(ViewerFailed, match='--bind everywhere: expected an IP address'):
        address_of('everywhere')
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(ViewerFailed, match=f'port {port}: cannot be listened on'):
            Viewer('web', port=port)


def test_a_viewer_without_graphics_is_told_with_its_last_words():
    names = ('VK_DRIVER_FILES', 'VK_ICD_FILENAMES', 'LIBGL_DRIVERS_PATH')
    nothing = {**NO_DISPLAY, **dict.fromkeys(names, '/nowhere')}
    with pytest.raises(ViewerFailed, match=r'the viewer (has ended|does not start): \S+'):
        look_at(nothing)


def look_at(environment):
    with Viewer('headless', environment=environment) as viewer:
        viewer.wait(30.0)
        viewer.check()
