"""Faults of instruments that need no effect to be seen."""

import re
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.diagnosis.instruments import frozen, over_ground, possible, standing, without
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.diagnosis.report.what_to_do import what_to_do
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.windows.over_ground import GroundTrack


@pytest.fixture(scope='module')
def in_kilonewtons(coarse, hide):
    def divided(values):
        return {
            name: value / 1000.0 if name.endswith('_tension') else value
            for name, value in values.items()
        }

    return [
        replace(window, means=divided(window.means), noise=divided(window.noise))
        for window in hide.trial(coarse, hide.nothing, 6, tows=2)
    ]


@pytest.mark.slow
def test_a_wrong_unit_is_called_so(coarse, hide, in_kilonewtons):
    found = diagnose_windows(coarse, in_kilonewtons, hide.names[:2])
    assert found.verdict == 'NOT_TESTABLE'
    assert 'look like kilonewtons' in found.reason
    assert 'tension' in found.reason


def test_a_log_over_ground_is_told_tow_by_tow(coarse, hide):
    windows = hide.trial(coarse, hide.nothing, 7, tows=2)
    copied = [
        replace(window, track=GroundTrack(0.0, 0.0, 0.1, True)) if window.tow == 1 else window
        for window in windows
    ]
    (said,) = over_ground(copied, ['first', 'second'])
    assert said.startswith('second: speed (vessel/velocity_water) ')
    assert over_ground(windows, ['first', 'second']) == ()
    found = diagnose_windows(coarse, copied[:2], ['first', 'second'])
    assert found.verdict == 'NOT_TESTABLE'
    assert said not in sentences(found)
    assert sentences(replace(found, remarks=(said,)))[0] == said


def test_a_state_in_which_a_board_lies_over_is_left_out_and_told(coarse, hide):
    windows = hide.trial(coarse, hide.nothing, 7, tows=2)
    assert standing(windows, hide.names[:2]) == (tuple(windows), ())
    closed = {**windows[0].means, 'door_spread': 6.0}
    folded = [replace(windows[0], means=closed), *windows[1:]]
    kept, (said,) = standing(folded, ['first', 'second'])
    assert kept == tuple(windows[1:])
    assert re.match(r'first: .* 6 m ', said)
    (remark,) = diagnose_windows(coarse, folded[:2], ['first', 'second']).remarks
    assert 'fallen over' in remark
    # Without a sensor of the spread nothing is known.
    blind = [
        replace(window, means={k: v for k, v in window.means.items() if k != 'door_spread'})
        for window in windows
    ]
    assert standing(blind, ['first', 'second']) == (tuple(blind), ())


def test_a_sensor_that_is_frozen_at_a_plausible_value_is_told(coarse, hide):
    windows = hide.trial(coarse, hide.nothing, 7, tows=2)
    assert frozen(windows, ['first', 'second']) == ()
    noise = np.random.default_rng(1)
    stuck = [
        replace(
            window,
            means={
                **window.means,
                'net_depth': 120.0 + window.noise['net_depth'] * noise.standard_normal(),
            },
        )
        if window.tow == 1
        else window
        for window in windows
    ]
    (found,) = frozen(stuck, ['first', 'second'])
    assert re.match(r'second: .*\(sonar/pressure\).* 120 m .*300 to 803', found.sentence)
    left = without(stuck, [found])
    assert [window.tow for window in left if 'net_depth' in window.means] == [0] * 5
    assert without(stuck, []) == tuple(stuck)
    said = diagnose_windows(coarse, stuck, ['first', 'second'], frozenset({0}))
    assert said.verdict == 'NAMED'
    assert said.repair is None
    (effect,) = result(said, ())['effects']
    assert (effect['name'], effect['tow'], effect['channel']) == (
        'frozen_sensor', 'second', 'net_depth',
    )  # fmt: skip
    value = effect['parameters']['value']
    assert value['low'] < 120.0 < value['high']
    assert '(net depth in tow 2, 120 m' in headline(said)
    assert 'the other readings' in headline(said)
    assert what_to_do(said).startswith('Frozen sensor: ')
    assert said.remarks == (found.sentence,)
    assert frozen(stuck[:6], ['first', 'second']) == ()


def test_what_the_echo_sounder_rules_out_is_not_looked_for(coarse, hide):
    windows = hide.trial(coarse, hide.nothing, 7, tows=1)
    assert possible(catalogue(), windows) == (catalogue(), ())
    over = [replace(window, seabed=400.0) for window in windows]
    there, (said,) = possible(catalogue(), over)
    assert set(catalogue()) - set(there) == {'bottom_contact'}
    assert re.match(r'Bottom contact .* 400 m', said)
    # One tow in which she was near the bottom is enough for it to be asked.
    lowest = max(window.means['net_depth'] for window in windows)
    near = [replace(window, seabed=lowest + 50.0) for window in windows]
    assert possible(catalogue(), near)[1] == ()
