"""The page of `trawl view --web` in a real browser, by its state and by its picture."""

import signal
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from browser import MISSING, PROGRAM, SIZE, Browser

pytestmark = [
    # The page draws by the processor, and compiles its shaders before.
    pytest.mark.slow,
    pytest.mark.timeout(900),
    pytest.mark.skipif(PROGRAM is None, reason=MISSING),
]

PATIENCE_S = 300.0
TRAWL = Path(sys.executable).with_name('trawl')
WIDTH, HEIGHT = SIZE
LEFT, RIGHT = slice(0, round(0.46 * WIDTH)), slice(round(0.47 * WIDTH), WIDTH)
TOP = slice(round(0.08 * HEIGHT), round(0.45 * HEIGHT))
MIDDLE = slice(round(0.5 * HEIGHT), round(0.8 * HEIGHT))
SEA, PORT, STARBOARD, READ_OFF = (14, 24, 38), (214, 39, 40), (44, 160, 44), (77, 210, 255)
WARPS = (220, 160, 36)

STATISTICS = """new Promise((held_back) => {
    document.addEventListener('securitypolicyviolation', (event) =>
        held_back(`${event.effectiveDirective} ${event.blockedURI}`));
    fetch('https://tel.rerun.io/api/pog').then(() => held_back('sent'), () => {});
})"""

STATE = 'new TextDecoder().decode(window._handle.viewer_state())'


@pytest.fixture(scope='module')
def command(tow, estimates):
    """The command with two bags, its first line, and what it says at the end."""
    with subprocess.Popen(
        [TRAWL, 'view', tow, estimates, '--web'], stdout=subprocess.PIPE, text=True
    ) as running:
        running.page = running.stdout.readline().strip()
        yield running
        if running.poll() is None:
            running.kill()


@pytest.fixture(scope='module')
def page(command, tmp_path_factory):
    """The page once it has drawn what it has been sent."""
    with Browser(tmp_path_factory.mktemp('browser')) as browser:
        browser.open(command.page)
        browser.seen = until_drawn(browser)
        yield browser


def until_drawn(browser):
    """Wait until readings, which come last, are drawn; return the picture."""
    end = time.monotonic() + PATIENCE_S
    while True:
        picture = browser.picture()
        if near(picture[:, RIGHT], PORT, 20) > 300 or time.monotonic() > end:
            return picture
        time.sleep(2.0)


def near(pixels, colour, away):
    """Number of pixels whose colour is no further away than that, in each channel."""
    return int((np.abs(pixels - colour).max(axis=2) <= away).sum())


def test_the_page_shows_gear_sea_sonar_and_readings(page):
    picture = page.seen
    assert picture.shape == (HEIGHT, WIDTH, 3)
    assert near(picture[TOP, LEFT], SEA, 3) > 50_000
    assert near(picture[TOP, LEFT], WARPS, 40) > 100
    assert near(picture[MIDDLE, LEFT], READ_OFF, 12) > 50
    assert near(picture[:, RIGHT], PORT, 20) > 300
    assert near(picture[:, RIGHT], STARBOARD, 20) > 300


def test_the_page_has_the_views_and_the_tow(page, known):
    assert page.ask('document.title') == 'Rerun Viewer'
    assert page.ask('window._handle.has_panicked()') is False
    if not page.ask("'viewer_state' in window._handle"):
        pytest.skip('the page of this Rerun tells no state; that of 0.41 does')
    state = page.ask(STATE)
    for name in (
        'Gear, coloured by tension',
        'From above, north up',
        'Trawl sonar, looking ahead',
        'Findings and notes',
        'warp tension / kN',
        'trawl_ros',
    ):
        assert name in state


def test_the_page_gets_the_tow_and_reaches_nobody_else(page, command):
    own = urlsplit(command.page).hostname
    reached = {urlsplit(address).hostname for address in page.asked - page.refused}
    assert reached == {own}
    # The usage statistics of its makers are held back by the page's policy.
    assert page.ask(STATISTICS) == 'connect-src https://tel.rerun.io/api/pog'


def test_the_command_ends_with_ctrl_c_and_the_page_with_it(page, command):
    command.send_signal(signal.SIGINT)
    assert command.wait(30.0) in (0, 130)
    assert command.stdout.read() == ''
