"""The autotrawl against the simulated gear, with counters and load cells that err."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.control.autotrawl import Autotrawl
from trawl_ros.control.autotrawl_records import AutotrawlSettings
from trawl_ros.records.samples import WinchSample
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.heave import regular_heave
from trawl_ros.simulation.sea import Sea
from trawl_ros.simulation.simulation import Simulation

SECOND = 1_000_000_000
NOISE_M, NOISE_N = 0.05, 1600.0


class Tow:
    """A gear under tow whose winches an autotrawl works.

    ``scales`` and ``cells`` are those of counters and load cells, port first.
    """

    def __init__(
        self,
        model,
        lengths,
        speed,
        settings,
        *,
        interval=0.5,
        sea=None,
        scales=(1.0, 1.0),
        cells=(1.0, 1.0),
        works=True,
    ):
        self.simulation = Simulation(
            model,
            Command(*lengths, speed),
            period=min(0.25, 0.5 * interval),
            sea=sea or Sea(),
        )
        self.autotrawl = Autotrawl(settings, lengths)
        self.scales, self.cells, self.works = scales, cells, works
        self.interval = round(interval * SECOND)
        self.speed = speed
        self.draw = np.random.default_rng(7)
        self.frozen = {}
        self.times, self.lengths, self.tensions, self.states = [], [], [], []

    def go(self, minutes):
        end = self.simulation.now.stamp + round(60 * minutes * SECOND)
        while self.simulation.now.stamp < end:
            if self.simulation.now.stamp % self.interval == 0:
                self._sample()
            self.simulation.advance()
        return self

    def _sample(self):
        truth = self.simulation.truth()
        lengths = np.array([winch.length for winch in truth.winches])
        tensions = np.array([winch.tension for winch in truth.winches])
        counted = (
            np.round((lengths * self.scales + NOISE_M * self.draw.standard_normal(2)) / 0.1) * 0.1
        )
        felt = np.round(tensions * self.cells + NOISE_N * self.draw.standard_normal(2), -2)
        for name, readings in (('counter', counted), ('cell', felt)):
            for side in (0, 1):
                readings[side] = self.frozen.get((name, side), readings[side])
        sample = WinchSample(truth.stamp, tuple(counted), (0.0, 0.0), tuple(felt))
        wanted = self.autotrawl.update(sample)
        if self.works:
            self.simulation.command = Command(*wanted, self.speed)
        self.times.append(truth.stamp / SECOND)
        self.lengths.append(lengths)
        self.tensions.append(tensions)
        self.states.append(self.autotrawl.state())

    def difference(self):
        """(T1 − T2) / (T1 + T2), by sample."""
        port, starboard = np.array(self.tensions).T
        return (port - starboard) / (port + starboard)


BALANCE = AutotrawlSettings(give_gain=0.0, haul_gain=0.0)


@pytest.mark.parametrize(('length', 'speed', 'apart'), [(500.0, 2.3, 5.0), (200.0, 1.9, 3.0)])
def test_unequal_warps_come_to_equal_tension(model, length, speed, apart):
    start = (length + 0.5 * apart, length - 0.5 * apart)
    tow = Tow(model, start, speed, AutotrawlSettings()).go(5)
    off = np.abs(tow.difference())
    assert off[0] > 0.03
    assert off[-60:].max() < 0.01
    # Never worse than at the start, and at rest at the end.
    assert off.max() < 1.1 * off[0]
    assert np.ptp(np.array(tow.lengths)[-60:], axis=0).max() < 0.3
    assert np.mean(tow.lengths[-1]) == pytest.approx(length, abs=0.5)


def test_two_per_cent_of_a_counter_make_unequal_lengths_and_equal_tension_undoes_it(model):
    tow = Tow(model, (500.0, 500.0), 2.3, AutotrawlSettings(mode='lengths'), scales=(1.02, 1.0)).go(
        8
    )
    port, starboard = tow.lengths[-1]
    assert port == pytest.approx(500.0 / 1.02, abs=0.5)
    assert starboard == pytest.approx(500.0, abs=0.5)
    assert tow.difference()[-1] > 0.07
    tow.autotrawl.change(BALANCE)
    tow.go(7)
    assert np.abs(tow.difference()[-60:]).max() < 0.01
    lengths = np.array(tow.lengths[-1])
    assert lengths[0] == pytest.approx(lengths[1], abs=1.0)


def test_a_change_of_mode_moves_no_winch_at_once(model):
    tow = Tow(model, (500.0, 494.0), 2.3, AutotrawlSettings()).go(1)
    before = tow.autotrawl.wanted
    tow.autotrawl.change(AutotrawlSettings(mode='lengths'))
    tow.go(0.01)
    assert tow.autotrawl.wanted == pytest.approx(before, abs=0.41)


def test_the_peaks_of_a_swell_are_lower_than_with_standing_winches(model):
    sea = Sea(regular_heave(4.0, 9.0, begin=0.0, growth=15.0))
    swings = {}
    for works in (False, True):
        tow = Tow(
            model, (500.0, 500.0), 2.3, AutotrawlSettings(), interval=0.2, sea=sea, works=works
        ).go(2)
        late = np.array(tow.tensions)[375:]
        swings[works] = late.std(), late.max() - late.mean()
        lengths = np.array(tow.lengths)[375:]
    assert swings[True][0] < 0.85 * swings[False][0]
    assert swings[True][1] < 0.95 * swings[False][1]
    assert lengths.mean() == pytest.approx(500.0, abs=1.0)


def test_a_short_warp_in_a_swell_at_a_slow_rate_is_not_shaken_up(model):
    sea = Sea(regular_heave(4.0, 9.0, begin=0.0, growth=15.0))
    swings = []
    for works in (False, True):
        tow = Tow(
            model, (200.0, 200.0), 1.9, AutotrawlSettings(), interval=0.4, sea=sea, works=works
        ).go(2)
        swings.append(np.array(tow.tensions)[187:].std())
    assert swings[1] < 1.02 * swings[0]


def test_a_load_cell_that_lies_moves_no_more_warp_than_allowed(model):
    settings = replace(BALANCE, max_difference=0.01)
    tow = Tow(model, (500.0, 500.0), 2.3, settings, cells=(1.3, 1.0)).go(3)
    port, starboard = tow.lengths[-1]
    assert port - starboard == pytest.approx(5.0, abs=0.1)
    assert 'balance' in tow.states[-1].saturated


@pytest.mark.parametrize('reading', [math.nan, None], ids=['lost', 'frozen'])
def test_without_a_load_cell_the_lengths_are_held_and_it_is_said(model, reading):
    tow = Tow(model, (503.0, 497.0), 2.3, BALANCE).go(1)
    tow.frozen['cell', 0] = tow.tensions[-1][0] if reading is None else reading
    tow.go(0.5)
    word = 'frozen' if reading is None else 'lost'
    assert tow.states[-1].problems == (f'port load cell {word}',)
    held = tow.autotrawl.wanted
    tow.go(1)
    assert tow.autotrawl.wanted == pytest.approx(held, abs=0.05)
    tow.frozen.clear()
    tow.go(3)
    assert tow.states[-1].problems == ()
    assert abs(tow.difference()[-1]) < abs(tow.difference()[0]) / 2


def test_a_frozen_counter_is_found_when_its_winch_moves_and_the_other_goes_on(model):
    tow = Tow(model, (500.0, 500.0), 2.3, AutotrawlSettings(mode='lengths')).go(0.5)
    tow.frozen['counter', 0] = 500.0
    tow.autotrawl.set_lengths(506.0, 506.0)
    tow.go(1)
    assert tow.states[-1].problems == ('port counter frozen',)
    assert tow.lengths[-1] == pytest.approx([506.0, 506.0], abs=0.5)


def test_a_counter_far_from_what_can_be_is_not_followed(model):
    tow = Tow(model, (500.0, 500.0), 2.3, AutotrawlSettings(mode='lengths')).go(0.5)
    tow.frozen['counter', 0] = 50.0
    tow.go(1)
    assert tow.states[-1].problems == ('port counter lost',)
    assert tow.lengths[-1] == pytest.approx([500.0, 500.0], abs=0.5)


def test_a_single_outlier_and_a_gap_move_nothing(model):
    tow = Tow(model, (500.0, 500.0), 2.3, AutotrawlSettings()).go(1)
    stamp = tow.simulation.now.stamp
    before = tow.autotrawl.wanted
    tow.autotrawl.update(WinchSample(stamp, (530.0, 500.0), (0.0, 0.0), (900e3, 180e3)))
    assert tow.autotrawl.wanted == pytest.approx(before, abs=0.05)
    late = WinchSample(stamp + 600 * SECOND, (500.0, 500.0), (0.0, 0.0), (181e3, 180e3))
    assert tow.autotrawl.update(late) == pytest.approx(before, abs=0.1)


def test_hauling_is_no_peak_to_give_way_to(model):
    tow = Tow(model, (500.0, 500.0), 2.3, AutotrawlSettings())
    tow.autotrawl.set_lengths(480.0, 480.0)
    tow.go(2.5)
    assert np.max(tow.tensions) > 1.2 * np.max(tow.tensions[0])
    assert np.abs([state.given for state in tow.states]).max() < 0.5
    assert tow.lengths[-1] == pytest.approx([480.0, 480.0], abs=0.5)


def test_winches_that_move_warp_across_as_well_are_hauled_to_the_end_together(model):
    tow = Tow(model, (333.0, 327.0), 2.3, AutotrawlSettings())
    tow.autotrawl.set_lengths(303.0, 297.0)
    tow.go(4)
    hauled = -np.diff(tow.lengths, axis=0)
    last = [np.flatnonzero(side > 0.5 * hauled.max())[-1] for side in hauled.T]
    assert abs(last[0] - last[1]) <= 1
    # Doors that slow down one after the other fall.
    doors = [door.position for door in tow.simulation.truth().doors]
    assert np.linalg.norm(doors[0] - doors[1]) > 110.0
    assert min(door[2] for door in doors) > -75.0


def test_a_slow_winch_arrives_while_it_moves_warp_across(model):
    settings = replace(BALANCE, max_speed=0.05)
    tow = Tow(model, (503.0, 497.0), 2.3, settings)
    tow.autotrawl.set_lengths(502.0, 496.0)
    tow.go(1.5)
    assert tow.states[-1].set_lengths == (502.0, 496.0)
    assert abs(np.diff([state.wanted for state in tow.states], axis=0)).max() <= 0.0251


def test_a_set_tension_below_the_present_one_pays_out_to_the_bound_and_says_so(model):
    settings = AutotrawlSettings(tension=150e3, max_give_m=3.0)
    tow = Tow(model, (500.0, 500.0), 2.3, settings).go(3)
    assert set(tow.states[-1].saturated) == {'port give', 'starboard give'}
    assert max(map(max, tow.lengths)) < 503.5
