"""The viewer as a process: bound to this machine, without usage statistics, and ended cleanly."""

import json
import os
import socket
from pathlib import Path
from urllib.error import HTTPError
from urllib.parse import urljoin
from urllib.request import Request, urlopen

import pytest

pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from trawl_ros.view.viewer.page import Page
from trawl_ros.view.viewer.ports import address_of
from trawl_ros.view.viewer.process import ViewerFailed
from trawl_ros.view.viewer.viewer import Viewer

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
    before = listening(os.getpid())
    with Viewer('web', environment=NO_DISPLAY) as viewer:
        # The page is served by this process, the data by the viewer's.
        sockets = listening(viewer.pid) | (listening(os.getpid()) - before)
        assert {address.partition(':')[0] for address in sockets} == {'0100007F'}
        assert len(sockets) == 2
        folder = viewer._process._log.parent
        settings = json.loads((folder / 'rerun' / 'analytics.json').read_text())
        assert settings['analytics_enabled'] is False
    assert not viewer.running
    assert not folder.exists()


def test_the_page_comes_with_a_policy_that_lets_it_speak_to_its_data_alone():
    with Viewer('web', environment=NO_DISPLAY) as viewer:
        with urlopen(viewer.page) as given:
            policy, page = given.headers['Content-Security-Policy'], given.read()
        port = int(viewer.url.rpartition(':')[2].partition('/')[0])
        assert f"connect-src 'self' data: blob: http://*:{port};" in policy
        assert "default-src 'none';" in policy
        assert b're_viewer.js' in page
        with urlopen(urljoin(viewer.page, '/re_viewer_bg.wasm')) as given:
            assert given.headers['Content-Type'] == 'application/wasm'
            assert given.headers['Content-Security-Policy'] == policy
            assert given.read(4) == b'\0asm'
        for path in ('/log', '/../log', '/%2e%2e/log', '/rerun/analytics.json'):
            with pytest.raises(HTTPError, match='404'):
                urlopen(urljoin(viewer.page, path))


def test_a_port_of_the_page_that_is_taken_meanwhile_is_told(tmp_path):
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(ViewerFailed, match=f'127.0.0.1 port {port}: '):
            Page(('127.0.0.1', port), port + 1, tmp_path, NO_DISPLAY)


def admitted(viewer, host):
    """Whether the data may be read by a page that a browser has from this host."""
    page = viewer.page.partition('/?')[0].rpartition(':')[2]
    asked = {'Origin': f'http://{host}:{page}', 'Access-Control-Request-Method': 'POST'}
    data = viewer.url.removeprefix('rerun+')
    request = Request(data, method='OPTIONS', headers=asked)
    with urlopen(request) as given:
        return given.headers.get('Access-Control-Allow-Origin') == asked['Origin']


def test_a_page_open_to_all_has_its_data_by_each_name_of_the_machine():
    with Viewer('web', bind='0.0.0.0', environment=NO_DISPLAY) as viewer:
        assert viewer.page.startswith('http://127.0.0.1:')
        assert admitted(viewer, 'ship')
    with Viewer('web', environment=NO_DISPLAY) as viewer:
        assert admitted(viewer, '127.0.0.1')
        assert not admitted(viewer, 'ship')


def test_statistics_stay_off_though_the_user_has_them_on(tmp_path):
    forced = {**NO_DISPLAY, 'HOME': str(tmp_path), 'FORCE_RERUN_ANALYTICS': '1'}
    with Viewer('web', environment=forced) as viewer:
        own = Path(f'/proc/{viewer.pid}/environ').read_bytes()
        assert b'FORCE_RERUN_ANALYTICS' not in own
    assert not list(tmp_path.rglob('*.json'))


def test_a_window_needs_a_display():
    with pytest.raises(ViewerFailed, match=r'no display .* --web .* --out'):
        Viewer('window', environment=NO_DISPLAY)


def test_an_address_is_checked_and_a_taken_port_told():
    with pytest.raises(ViewerFailed, match='--bind everywhere: '):
        address_of('everywhere')
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(ViewerFailed, match=f'port {port}: '):
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
