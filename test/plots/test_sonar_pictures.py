"""A sweep is laid out as its message says, and what was read off is drawn on it."""

import numpy as np
import pytest

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.model.water import Water
from trawl_ros.plots.moments import IMAGE, MOST_AWAY_S, SCAN, Moment, read_sweeps, sweep_of
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.sonar import seen, sonar_figure
from trawl_ros.records.samples import SonarImageSample, SonarScanSample

REACH = 100.0
PIXELS = 200


def lay_out(echo, *, beams=8, start=-np.pi, increment=np.pi / 4):
    """One echo, at (beam, cell of 50)."""
    image = np.zeros((beams, 50), np.uint8)
    image[echo] = 255
    scan = SonarScanSample(0, np.zeros(beams), np.zeros(beams), start, increment, 1.0, REACH, 1.0)
    picture = seen(SonarImageSample(0, image), scan, PIXELS)
    rows, columns = np.nonzero(picture.filled(0))
    middle = 0.5 * (PIXELS - 1)
    return picture, (rows.mean() - middle, columns.mean() - middle)


@pytest.mark.parametrize(
    ('beam', 'towards'),
    [(4, (1.0, 0.0)), (6, (0.0, -1.0)), (0, (-1.0, 0.0)), (2, (0.0, 1.0))],
)
def test_angles_turn_from_down_to_port_which_is_on_the_left(beam, towards):
    # Beams of -180°, -135°, ... : the fifth looks down, the seventh to port.
    _, (down, right) = lay_out((beam, 40))
    expected = 40.5 / 50 * PIXELS / 2
    assert np.hypot(down, right) == pytest.approx(expected, rel=0.05)
    np.testing.assert_allclose(np.array([down, right]) / expected, towards, atol=0.05)


def test_cells_lie_at_the_middle_of_their_range():
    picture, _ = lay_out((4, 20))
    column = picture[:, PIXELS // 2]
    rows = np.flatnonzero(column.filled(0))
    below = (rows + 0.5 - PIXELS / 2) / (PIXELS / 2) * REACH
    assert (below.min(), below.max()) == pytest.approx((40.0, 42.0), abs=1.0)


def test_where_no_beam_looks_nothing_is_drawn():
    picture, _ = lay_out((1, 20), beams=3, start=-np.pi / 4)
    middle = PIXELS // 2
    assert not picture.mask[-20, middle]
    assert picture.mask[20, middle]
    assert picture.mask[middle, 5]
    assert picture.mask[5, 5]


@pytest.mark.parametrize('turns', [-1, 1])
def test_a_sweep_may_begin_at_any_turn(turns):
    plain, _ = lay_out((6, 40))
    turned, _ = lay_out((6, 40), start=-np.pi + 2.0 * np.pi * turns)
    np.testing.assert_array_equal(plain.filled(0), turned.filled(0))


def test_beams_may_turn_the_other_way():
    _, (down, right) = lay_out((2, 40), start=np.pi, increment=-np.pi / 4)
    assert right < -60.0
    assert abs(down) < 5.0


def test_echoes_of_the_mouth_lie_on_truth_and_the_reading_between_them(bag, tow, known):
    (picture,), problems = read_sweeps(bag, tow, [33.0], 'trawl')
    assert problems == []
    assert picture.time == 30.0
    assert (picture.height, picture.width) == (known.HEIGHT, known.WIDTH)
    assert not picture.closed
    bright = picture.image.image > 200
    for down, port in picture.mouth[1:]:
        beam = round((np.arctan2(port, down) + np.pi) / picture.scan.angle_increment)
        cell = int(np.hypot(down, port) / picture.scan.max_range * bright.shape[1])
        near = bright.take(range(beam - 1, beam + 2), axis=0, mode='wrap')
        assert near[:, cell - 1 : cell + 2].any()
    figure = sonar_figure(picture, 'tow')
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert [label.split()[0].rstrip(':') for label in labels] == ['truth', 'height', 'width']
    assert [label.split(': ')[1] for label in labels[1:]] == ['50.0 m', '44.0 m']


def test_the_mouths_corners_stand_in_where_no_section_is_known(known, tmp_path):
    path = known.write(tmp_path / 'bag', ['truth', 'sonar'], section=False)
    tow = read_history(path, Water().depth, 'trawl')
    (picture,), _ = read_sweeps(path, tow, [33.0], 'trawl')
    assert picture.closed
    around = known.MOUTH[[1, 0, 5, 4, 3, 2]]
    np.testing.assert_allclose(picture.mouth, around, atol=1e-3)


def test_truth_is_that_of_the_middle_of_the_sweep(known, tmp_path):
    # The mouth grows by 0.1 m/s here, and a sweep takes 4 s.
    path = known.write(tmp_path / 'bag', ['truth', 'sonar'], growing=0.1)
    tow = read_history(path, Water().depth, 'trawl')
    for time, begun in ((31.0, 30.0), (69.0, 70.0)):
        (picture,), _ = read_sweeps(path, tow, [time], 'trawl')
        assert picture.time == begun
        grown = picture.mouth[:, 0].max() - known.MOUTH[:, 0].max()
        assert grown == pytest.approx(0.1 * (begun + 2.0), abs=1e-3)


def test_without_a_scan_nobody_knows_where_the_beams_look(tow, known):
    image, scan = (sample_message(sample)[1] for sample in known.sweep(known.START, known.MOUTH))
    _, other = (sample_message(s)[1] for s in known.sweep(known.START + 1, known.MOUTH))
    assert sweep_of(Moment(0.0, {IMAGE: image, SCAN: scan}), tow) is not None
    for messages in ({IMAGE: image}, {IMAGE: image, SCAN: other}):
        with pytest.raises(MessageError, match=r'0\.0 s .*sonar/scan'):
            sweep_of(Moment(0.0, messages), tow)
    assert sweep_of(Moment(0.0, {SCAN: scan}), tow) is None


def test_sweeps_that_are_far_away_are_not_shown(known, tmp_path, monkeypatch):
    path = known.write(tmp_path / 'bag', ['sonar'])
    tow = read_history(path, Water().depth, 'trawl')
    monkeypatch.setitem(MOST_AWAY_S, IMAGE, 3.0)
    pictures, problems = read_sweeps(path, tow, [20.0, 25.0, 31.0], 'trawl')
    assert [picture and picture.time for picture in pictures] == [20.0, None, 30.0]
    assert problems == []
