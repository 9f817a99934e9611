"""A bag without truth has the model beside its readings: steady states in the steady windows."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.core.time import SECOND
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.plots.records import Quantities
from trawl_ros.records.samples import VelocitySample, WinchSample
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.view.model_source import ModelFollower
from trawl_ros.view.records import Note

LEG_S = 400


@pytest.fixture(scope='module')
def coarse(coarse_gear):
    return load_gear(coarse_gear)


def said(gear, samples):
    follower = ModelFollower(gear)
    records = [record for sample in samples for record in follower.take(sample)]
    return [*records, *follower.finish()]


def lines(records):
    """Values of each window, by the leg of the tow that it is in."""
    drawn = [record for record in records if isinstance(record, Quantities)]
    assert {record.kind for record in drawn} == {'model'}
    windows = [drawn[k : k + 3] for k in range(0, len(drawn), 3)]
    for first, last, end in windows:
        assert first.values == last.values
        assert last.stamp - first.stamp == pytest.approx(60 * SECOND, abs=1)
        assert np.isnan(list(end.values.values())).all()
        assert end.stamp > last.stamp
    return {first.stamp // SECOND // LEG_S: first.values for first, _, _ in windows}


def test_the_model_says_what_is_measured_where_it_is_right(coarse, steady_tow):
    drawn = lines(said(coarse, steady_tow.samples()))
    assert set(drawn) == {0, 1}
    for leg, (_, _, seen) in enumerate(steady_tow.states):
        values = drawn[leg]
        # The log's mean is a little off, by which the model is asked.
        assert values['door_spread'] == pytest.approx(seen.door_spread, rel=2e-3)
        assert values['port_tension'] == pytest.approx(seen.port_tension, rel=5e-3)
        assert values['starboard_door_depth'] == pytest.approx(seen.starboard_door_depth, rel=5e-3)
        assert values['opening_height'] == pytest.approx(seen.vertical_opening, rel=5e-3)


def test_another_gear_is_drawn_where_it_would_be(coarse, steady_tow):
    board = coarse.board.coefficients
    weaker = board.model_copy(update={'a1': 0.8 * board.a1, 'c1': 0.8 * board.c1})
    other = coarse.model_copy(
        update={'board': coarse.board.model_copy(update={'coefficients': weaker})}
    )
    drawn = lines(said(other, steady_tow.samples()))
    there = build_model(other)
    for leg, (length, speed, seen) in enumerate(steady_tow.states):
        expected = steady_state(there, length, speed).observables
        assert abs(expected.door_spread - seen.door_spread) > 0.5
        assert drawn[leg]['door_spread'] == pytest.approx(expected.door_spread, rel=1e-3)


def test_every_window_of_a_long_steady_state_is_drawn(coarse, steady_tow):
    records = said(coarse, steady_tow.samples(leg_s=900))
    windows = [record.stamp for record in records if isinstance(record, Quantities)][::3]
    assert len(windows) >= 12


def test_a_tow_without_windows_is_told_why(coarse, steady_tow):
    silent = [s for s in steady_tow.samples() if not isinstance(s, VelocitySample)]
    (note,) = said(coarse, silent)
    assert isinstance(note, Note)
    assert note.level == 'WARN'
    assert 'speed (vessel/velocity_water) is silent' in note.text


def test_where_the_gear_has_no_steady_state_that_is_told(coarse, steady_tow):
    """Metres that were taken for feet tell of warps with which the gear surfaces."""
    wrong = (
        replace(s, lengths=(0.3048 * s.lengths[0], 0.3048 * s.lengths[1]))
        if isinstance(s, WinchSample)
        else s
        for s in steady_tow.samples()
    )
    notes = [record.text for record in said(coarse, wrong) if isinstance(record, Note)]
    assert any(t.startswith('kaifuha') and 'surface' in t for t in notes)
    assert 'is not drawn' in notes[-1]


@pytest.fixture(scope='module')
def recording(coarse_gear, steady_tow, read_back, tmp_path_factory):
    pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')
    from trawl_ros.cli.main import trawl

    folder = tmp_path_factory.mktemp('model')
    bag = steady_tow.bag(folder / 'bag')
    words = ['view', bag, '--model', '--gear', coarse_gear, '--out', folder / 'tow.rrd']
    done = CliRunner().invoke(trawl, list(map(str, words)))
    assert done.exit_code == 0, done.output
    return read_back(folder / 'tow.rrd')


def test_the_recording_of_a_real_ship_has_measured_and_model(recording, steady_tow):
    assert not any(path.endswith('/truth') for path in recording.entities)
    for path, scale, name in (
        ('door_spread/door_spread', 1.0, 'door_spread'),
        ('warp_tension/port_tension', 1e-3, 'port_tension'),
        ('height_over_the_surface/net_depth', -1.0, 'net_depth'),
    ):
        _, measured = recording.series(f'/histories/{path}/measured')
        times, model = recording.series(f'/histories/{path}/model')
        assert len(measured) == 2 * LEG_S
        assert np.isnan(model[2::3]).all()
        assert (times[1::3] - times[::3]) / SECOND == pytest.approx([60.0, 60.0])
        expected = [scale * getattr(seen, name) for _, _, seen in steady_tow.states]
        np.testing.assert_allclose(model[::3], expected, rtol=5e-3)
    notes = [row['text'][0] for _, row in recording.rows('/notes/view')]
    assert any('broad ones' in text for text in notes)
