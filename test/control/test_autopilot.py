"""The autopilot against a ship of the simulation's kind, her own sensors, and a current."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from trawl_ros.control.autopilot import (
    Autopilot,
    AutopilotSettings,
    FollowTrack,
    HoldCourse,
    HoldHeading,
    ToSchool,
)
from trawl_ros.core.errors import ScenarioError
from trawl_ros.core.geodesy import Datum
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.instruments.vessel import GpsFix, GpsVelocity, Heading, SpeedLog
from trawl_ros.records.samples import FixSample, HeadingSample, SchoolsSample, VelocitySample
from trawl_ros.simulation.ship import Ship

SECOND = 1_000_000_000
DT = 0.5
SPEED = 2.2
STILL = np.zeros(3)
SETTINGS = AutopilotSettings(max_turn=math.radians(0.3))
DATUM = Datum(60.0, 2.0)


@dataclass
class Voyage:
    """A ship at sea with the default instruments, steered by an autopilot."""

    gear: GearRecord
    current: np.ndarray = field(default_factory=lambda: STILL)
    settings: AutopilotSettings = SETTINGS
    heading: float = 0.0
    lost: tuple[str, ...] = ()
    school: np.ndarray | None = None

    def __post_init__(self):
        self.pilot = Autopilot(self.settings, DATUM)
        self.ship = Ship(np.zeros(3), self.heading, SPEED, 0.0)
        made, draws = load_instruments('default').vessel, SeedPlan(3)
        self.log = SpeedLog(made.velocity_water, draws)
        self.gps = GpsVelocity(made.velocity_ground, draws)
        self.fix = GpsFix(made.fix, DATUM, draws)
        self.compass = Heading(made.heading, draws)
        self.stamp = 0
        self.times, self.places, self.headings, self.states = [], [], [], []

    def go(self, minutes):
        for _ in range(round(60 * minutes / DT)):
            for sample in self._samples():
                if not any(isinstance(sample, kind) for kind in self.lost):
                    self.pilot.take(sample)
            rate = self.pilot.turn_rate(self.stamp)
            self.times.append(self.stamp / SECOND)
            self.places.append(self.ship.position[:2])
            self.headings.append(self.ship.heading)
            self.states.append(self.pilot.state)
            self.ship = self.ship.advanced(self.gear.ship, SPEED, rate, self.current, DT)
            self.stamp += round(DT * SECOND)
        return np.array(self.places), np.degrees(self.headings)

    def _samples(self):
        ahead = self.ship.ahead
        stamp, turn = self.stamp, self.ship.yaw_rate
        yield from self.log.observe((np.array([self.ship.speed, 0.0, 0.0]), turn), stamp)
        yield from self.gps.observe((self.ship.speed * ahead + self.current, turn), stamp)
        yield from self.fix.observe(self.ship.position, stamp)
        yield from self.compass.observe(self.ship.heading, stamp)
        if self.school is not None and self.stamp % (5 * SECOND) == 0:
            away = self.school - self.ship.position
            port = np.array([-ahead[1], ahead[0], 0.0])
            yield SchoolsSample(self.stamp, np.array([[away @ ahead, away @ port, away[2]]]))


@pytest.mark.parametrize('wanted', [30.0, -75.0, 170.0])
@pytest.mark.parametrize('max_turn', [0.1, 0.3, 1.0])
def test_a_heading_is_reached_and_not_overshot_by_two_degrees(gear, wanted, max_turn):
    settings = AutopilotSettings(max_turn=math.radians(max_turn))
    voyage = Voyage(gear, settings=settings)
    voyage.pilot.steer(HoldHeading(math.radians(wanted)))
    _, headings = voyage.go(abs(wanted) / max_turn / 60 + 3)
    turned = np.sign(wanted) * headings
    assert turned.max() < abs(wanted) + 0.5
    assert turned[-120:] == pytest.approx(abs(wanted), abs=0.3)
    assert np.abs(np.diff(headings)).max() / DT <= 1.001 * max_turn


def test_the_shorter_way_is_taken(gear):
    voyage = Voyage(gear, heading=math.radians(170))
    voyage.pilot.steer(HoldHeading(math.radians(-160)))
    _, headings = voyage.go(5)
    assert headings[-1] == pytest.approx(200, abs=0.3)


def test_a_course_over_ground_is_made_good_in_a_cross_current(gear):
    voyage = Voyage(gear, current=np.array([0.0, 0.6, 0.0]))
    voyage.pilot.steer(HoldCourse(math.radians(20)))
    places, headings = voyage.go(12)
    east, north = places[-1] - places[-600]
    assert math.degrees(math.atan2(north, east)) == pytest.approx(20, abs=0.5)
    assert headings[-1] < 8


def track_errors(places, legs):
    """How far off (m) the nearest of the legs each place is."""
    off = []
    for start, end in legs:
        along = (end - start) / np.hypot(*(end - start))
        away = places - start
        reach = away @ along
        across = away[:, 1] * along[0] - away[:, 0] * along[1]
        inside = (reach >= 0) & (reach <= np.hypot(*(end - start)))
        off.append(np.where(inside, np.abs(across), np.inf))
    return np.min(off, axis=0)


def test_a_track_of_two_legs_is_followed_in_a_cross_current(gear):
    corner, end = np.array([2500.0, 0.0]), np.array([2500.0, 2500.0])
    voyage = Voyage(gear, current=np.array([0.3, 0.3, 0.0]))
    voyage.pilot.steer(FollowTrack(np.array([corner, end])))
    places, _ = voyage.go(34)
    to_corner = np.hypot(*(places - corner).T)
    steady = (to_corner > 800) & (places[:, 1] < end[1]) & (np.array(voyage.times) > 300)
    off = track_errors(places[steady], [(np.zeros(2), corner), (corner, end)])
    assert off.max() < 10.0
    assert np.hypot(*(places - end).T).min() < 10.0
    overshoot = (places[:, 0] - corner[0])[places[:, 1] > 100].max()
    assert overshoot < 25.0
    assert [state.leg for state in voyage.states][-1] == 1
    assert voyage.states[-1].ended


@pytest.mark.parametrize('max_turn', [0.12, 0.3])
def test_a_ship_that_turns_slowly_begins_in_time(gear, max_turn):
    corner = np.array([3500.0, 0.0])
    settings = AutopilotSettings(max_turn=math.radians(max_turn))
    voyage = Voyage(gear, current=np.array([0.05, 0.35, 0.0]), settings=settings)
    voyage.pilot.steer(FollowTrack(np.array([corner, [3500.0, 4000.0]])))
    places, _ = voyage.go(40)
    assert (places[:, 0] - corner[0]).max() < 25.0


def test_after_the_end_of_a_track_the_course_is_held(gear):
    voyage = Voyage(gear)
    voyage.pilot.steer(FollowTrack(np.array([[400.0, 0.0]])))
    places, _ = voyage.go(10)
    assert voyage.states[-1].ended
    assert not voyage.states[10].ended
    assert places[-1][0] > 1200
    assert abs(places[-1][1]) < 10


def problem(voyage):
    (sentence,) = voyage.states[-1].problems
    return sentence


def test_a_fix_that_fails_for_a_while_is_made_up_for(gear):
    voyage = Voyage(gear, current=np.array([0.0, 0.3, 0.0]))
    voyage.pilot.steer(FollowTrack(np.array([[5000.0, 0.0]])))
    voyage.go(6)
    voyage.lost = (FixSample,)
    places, _ = voyage.go(1.5)
    assert problem(voyage).startswith('fix lost')
    assert np.abs(places[-180:, 1]).max() < 10
    voyage.go(2)
    assert problem(voyage).startswith('fix lost')
    _, headings = voyage.go(1)
    assert headings[-120:] == pytest.approx(headings[-1], abs=1.0)


def test_without_a_compass_she_goes_straight_on_and_says_so(gear):
    voyage = Voyage(gear)
    voyage.pilot.steer(HoldHeading(math.radians(90)))
    voyage.go(1)
    voyage.lost = (HeadingSample,)
    voyage.go(1)
    assert problem(voyage).startswith('heading lost')
    assert voyage.ship.yaw_rate == 0.0


def test_a_current_is_taken_as_it_was_when_the_log_fails(gear):
    voyage = Voyage(gear, current=np.array([0.0, 0.5, 0.0]))
    voyage.pilot.steer(HoldCourse(0.0))
    voyage.go(8)
    voyage.lost = (VelocitySample,)
    places, _ = voyage.go(3)
    assert len(voyage.states[-1].problems) == 2
    assert abs(places[-1][1] - places[-360][1]) < 8


def test_a_school_that_drifts_is_met_and_passed(gear):
    school = np.array([1500.0, 500.0, -60.0])
    voyage = Voyage(gear, current=np.array([0.0, 0.2, 0.0]), school=school)
    voyage.pilot.steer(ToSchool())
    places, headings = voyage.go(16)
    assert np.hypot(*(places - school[:2]).T).min() < 10
    assert voyage.states[-1].ended
    assert headings[-1] == pytest.approx(headings[-300], abs=1.0)


def test_without_a_school_the_course_is_held_and_that_is_said(gear):
    voyage = Voyage(gear)
    voyage.pilot.steer(ToSchool())
    places, _ = voyage.go(2)
    assert problem(voyage).startswith('no school')
    assert abs(places[-1][1]) < 2


def test_readings_that_are_no_numbers_change_nothing(gear):
    voyage = Voyage(gear)
    voyage.pilot.steer(HoldHeading(0.5))
    voyage.go(0.5)
    rate = voyage.pilot.turn_rate(voyage.stamp)
    for sample in (
        HeadingSample(voyage.stamp, math.nan, 0.1),
        FixSample(voyage.stamp, math.nan, 2.0, 1.0),
        VelocitySample(voyage.stamp, 'water', np.full(3, math.nan), 0.0),
    ):
        voyage.pilot.take(sample)
    assert voyage.pilot.turn_rate(voyage.stamp) == pytest.approx(rate)


@pytest.mark.parametrize(
    ('waypoints', 'sentence'),
    [(np.zeros((0, 2)), '1 waypoints'), (np.array([[9.0, 9.0], [9.0, 9.0]]), '0.0 m')],
)
def test_what_is_no_track_is_refused(gear, waypoints, sentence):
    voyage = Voyage(gear)
    voyage.pilot.steer(FollowTrack(waypoints))
    with pytest.raises(ScenarioError, match=sentence):
        voyage.go(0.1)
