"""The viewer, by its state and by its picture, where software or hardware can draw."""

import os
import time

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from rerun.experimental import ViewerClient

from trawl_ros.cli.main import trawl
from trawl_ros.core.progress import ignore
from trawl_ros.sentences.framing import framed
from trawl_ros.view.bags import TowBags
from trawl_ros.view.recording import to_viewer
from trawl_ros.view.rerun_log import RerunLog
from trawl_ros.view.viewer.process import ViewerFailed
from trawl_ros.view.viewer.viewer import Viewer

PATIENCE_S = 60.0
AT_S = 95.0

NO_GRAPHICS = 'no graphics for the viewer: apt-get install mesa-vulkan-drivers draws in software'


@pytest.fixture(scope='module')
def client(tow, estimates, gear):
    """The tow in a viewer without a window."""
    if not hasattr(ViewerClient, 'get_state'):
        pytest.skip('the client of this Rerun tells no state of the viewer; that of 0.41 does')
    try:
        with Viewer('headless', environment=os.environ) as viewer:
            bags = TowBags([tow, estimates])
            with to_viewer(viewer.url) as recording:
                assert bags.show(RerunLog(recording, bags.topics), gear, on_progress=ignore)
            client = ViewerClient(viewer.url)
            until(viewer, lambda: has_arrived(client))
            client.set_time('time', duration=AT_S, play_state='paused')
            yield client
    except ViewerFailed as reason:
        pytest.skip(f'{NO_GRAPHICS} ({reason})')


def until(viewer, condition):
    end = time.monotonic() + PATIENCE_S
    while not condition():
        viewer.check()
        assert time.monotonic() < end
        time.sleep(0.1)


def has_arrived(client):
    recordings = client.get_state().recordings
    ends = [line.end for entry in recordings for line in entry.timelines if line.name == 'time']
    return any(end is not None and end >= 125_000_000_000 for end in ends)


def test_every_view_is_laid_out_and_draws_without_complaint(client):
    state = client.get_state()
    names = {view.name for view in state.views}
    assert {
        'Gear, coloured by tension',
        'From above, north up',
        'Trawl sonar, looking ahead',
        'Findings and notes',
        'warp tension / kN',
        'b3',
    } <= names
    assert [(view.name, view.reports) for view in state.views if view.reports] == []
    (recording,) = (entry for entry in state.recordings if entry.timelines)
    assert recording.current_timeline == 'time'


def test_the_picture_shows_gear_sea_sonar_and_readings(client, tmp_path):
    histories = slice(60, 1040), slice(890, 1920)
    end = time.monotonic() + PATIENCE_S
    while True:
        client.save_screenshot(str(tmp_path / 'view.png'))
        picture = np.asarray(Image.open(tmp_path / 'view.png').convert('RGB')).astype(int)
        # Readings are passed on in batches, and come last.
        if near(picture[histories], (214, 39, 40), 20) > 300 or time.monotonic() > end:
            break
    assert picture.shape == (1080, 1920, 3)
    top, left = slice(50, 510), slice(0, 880)
    sonar = slice(545, 890), slice(450, 880)
    # Warps at 150 and 140 kN, and the sea behind them.
    assert near(picture[top, left], (220, 160, 36), 40) > 100
    assert near(picture[top, left], (14, 24, 38), 3) > 50_000
    # Height and width as read off, over the echoes.
    assert near(picture[sonar], (77, 210, 255), 12) > 50
    # Port and starboard readings.
    assert near(picture[histories], (214, 39, 40), 20) > 300
    assert near(picture[histories], (44, 160, 44), 20) > 300


def test_the_command_draws_a_picture(client, tow, tmp_path):
    out = tmp_path / 'tow.png'
    done = CliRunner().invoke(trawl, ['view', str(tow), '--out', str(out)])
    assert done.exit_code == 0, done.output
    assert f'{out}: ' in done.stdout
    picture = np.asarray(Image.open(out).convert('RGB')).astype(int)
    assert near(picture[50:510, :880], (14, 24, 38), 3) > 50_000
    again = CliRunner().invoke(trawl, ['view', str(tow), '--out', str(out)])
    assert again.exit_code == 1
    assert f'{out}' in again.output.replace('\n', '')
    assert 'exists already' in again.output


def test_a_log_of_a_ship_is_drawn_at_its_time_of_day(client, tmp_path):
    log = tmp_path / 'ship.nmea'
    rest = ',15215.2500,W,3.9,000.0,010826,,,A'
    sentences = [
        framed('$', f'GPRMC,1038{second:02d}.00,A,5730.{10 * second:04d},N{rest}', checksum=True)
        for second in range(60)
    ]
    log.write_text('\n'.join(sentences))
    bag, out = tmp_path / 'bag', tmp_path / 'ship.png'
    imported = CliRunner().invoke(
        trawl, ['import-log', str(log), '--mapping', 'nmea', '--out', str(bag)]
    )
    assert imported.exit_code == 0, imported.output
    done = CliRunner().invoke(trawl, ['view', str(bag), '--out', str(out)])
    assert done.exit_code == 0, done.output
    with Image.open(out) as picture:
        assert picture.size == (1920, 1080)


def near(pixels, colour, away):
    """Number of pixels whose colour is no further away than that, in each channel."""
    return int((np.abs(pixels - colour).max(axis=2) <= away).sum())
