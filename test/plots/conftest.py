"""A tow of which everything is known, recorded without towing.

The ship turns to port through west in a current to the east; the doors sink by 0.1 m/s.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.geodesy import Datum, to_latitude_longitude
from trawl_ros.core.rotations import to_quaternion
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.truth_to_messages import truth_messages
from trawl_ros.model.water import Water
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.records import TowHistory
from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    SonarImageSample,
    SonarScanSample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.topics import absolute
from trawl_ros.records.truth import (
    DoorTruth,
    GearPicture,
    NetTruth,
    Polyline,
    Truth,
    VesselTruth,
    WinchTruth,
)

BEAMS, CELLS, REACH = 180, 160, 120.0
SPECKLE = 40


def sweep(stamp: int, mouth: np.ndarray, seed: int = 0) -> tuple[SonarImageSample, SonarScanSample]:
    """All around, once: echoes on the closed line through ``mouth`` (n, 2), x down, y port, m."""
    increment = 2.0 * np.pi / BEAMS
    start = -np.pi
    image = np.random.default_rng(seed).integers(0, SPECKLE, (BEAMS, CELLS)).astype(np.uint8)
    ends = np.roll(mouth, -1, axis=0)
    points = np.concatenate([mouth + part * (ends - mouth) for part in np.linspace(0.0, 1.0, 200)])
    beams = np.round((np.arctan2(points[:, 1], points[:, 0]) - start) / increment).astype(int)
    cells = (np.hypot(*points.T) / REACH * CELLS).astype(int)
    image[beams % BEAMS, np.minimum(cells, CELLS - 1)] = 230
    first = np.where((image > SPECKLE).any(axis=1), (image > SPECKLE).argmax(axis=1), np.inf)
    scan = SonarScanSample(
        stamp=stamp,
        ranges=(first + 0.5) * REACH / CELLS,
        intensities=image.max(axis=1).astype(float),
        angle_min=start,
        angle_increment=increment,
        min_range=1.0,
        max_range=REACH,
        sweep_s=4.0,
    )
    return SonarImageSample(stamp, image), scan


SECOND = 1_000_000_000
DURATION_S = 120
START = 5 * SECOND
CURRENT = np.array([0.4, 0.0, 0.0])
SPEED, TURN = 2.0, np.radians(0.25)
HEADING = np.radians(165.0)
ASTERN, HALF_SPREAD, DEPTH, SINKING = 300.0, 40.0, 60.0, 0.1
ROLLS, PITCH = (0.2, -0.1), 0.05
LENGTH = 320.0
NET_DEPTH, HEIGHT, WIDTH = 55.0, 50.0, 44.0
SILENT = (40.0, 80.0)
"""The starboard door's pressure sensor says nothing in between (s)."""

MOUTH = np.array([[0.0, 0.0], [4.0, 22.0], [34.0, 20.0], [50.0, 0.0], [34.0, -20.0], [4.0, -22.0]])
"""Corners in the sonar's plane, x down and y port, m: headrope's centre, then around by port."""


def truth_at(time: float) -> Truth:
    """Everything at a time (s)."""
    heading = HEADING + TURN * time
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    port = np.array([-ahead[1], ahead[0], 0.0])
    up = np.array([0.0, 0.0, 1.0])
    turned = np.array([np.sin(heading) - np.sin(HEADING), np.cos(HEADING) - np.cos(heading), 0.0])
    ship = SPEED / TURN * turned + CURRENT * time
    depth = DEPTH + SINKING * time
    sonar = ship - (ASTERN + 150.0) * ahead - NET_DEPTH * up
    ring = sonar - MOUTH[:, :1] * up + MOUTH[:, 1:] * port
    doors = tuple(
        DoorTruth(
            position=ship - ASTERN * ahead + side * HALF_SPREAD * port - depth * up,
            orientation=np.array(to_quaternion(roll, PITCH, heading)),
            velocity=np.zeros(3),
            angular_velocity=np.zeros(3),
            attack=0.4,
            slip=0.0,
            inclination=0.2,
            force=np.zeros(3),
            moment=np.zeros(3),
        )
        for side, roll in zip((1.0, -1.0), ROLLS, strict=True)
    )
    return Truth(
        stamp=START + round(time * SECOND),
        doors=(doors[0], doors[1]),
        winches=(WinchTruth(LENGTH, 0.0, 150e3), WinchTruth(LENGTH, 0.0, 140e3)),
        net=NetTruth(
            # Headrope from port over the centre to starboard, footrope back.
            mouth=ring[[1, 0, 5, 4, 3, 2]],
            horizontal_opening=WIDTH,
            vertical_opening=HEIGHT,
            headrope_depth=NET_DEPTH,
            sonar_position=sonar,
            sonar_orientation=Rotation.from_matrix(np.column_stack([-up, port, ahead])).as_quat(),
            section=np.column_stack([MOUTH, np.full(len(MOUTH), 0.03)]),
        ),
        vessel=VesselTruth(
            position=ship,
            heading=float(np.arctan2(np.sin(heading), np.cos(heading))),
            yaw_rate=TURN,
            velocity_ground=SPEED * ahead + CURRENT,
            velocity_water=np.array([SPEED, 0.0, 0.0]),
        ),
    )


def picture_of(truth: Truth) -> GearPicture:
    """The warps as lines; the doors."""
    ship, heading = truth.vessel.position, truth.vessel.heading
    port = np.array([-np.sin(heading), np.cos(heading), 0.0])
    warps = tuple(
        Polyline(name, np.array([ship + side * 6.0 * port, door.position]), winch.tension)
        for name, side, door, winch in zip(
            ('port_warp', 'starboard_warp'), (1.0, -1.0), truth.doors, truth.winches, strict=True
        )
    )
    return GearPicture(truth.stamp, warps, truth.doors, (2.0, 4.0))


def samples_of(truth: Truth) -> Iterator[Sample]:
    """What flawless instruments say, but for the one that is silent for a while."""
    stamp, time = truth.stamp, (truth.stamp - START) / SECOND
    lengths, tensions = zip(*((w.length, w.tension) for w in truth.winches), strict=True)
    yield WinchSample(stamp, lengths, (0.0, 0.0), tensions)
    for side, door, roll in zip(('port', 'starboard'), truth.doors, ROLLS, strict=True):
        if side == 'port' or not SILENT[0] < time < SILENT[1]:
            yield PressureSample(stamp, side, Water().pressure(-door.position[2]), 1e3)
        yield AttitudeSample(stamp, side, PITCH, roll, 0.01)
    yield PressureSample(stamp, 'sonar', Water().pressure(NET_DEPTH), 1e3)
    yield RangeSample(stamp, 'spread', 2.0 * HALF_SPREAD, 1.0, 1.0, 400.0)
    yield VelocitySample(stamp, 'water', truth.vessel.velocity_water, truth.vessel.yaw_rate)
    yield VelocitySample(stamp, 'ground', truth.vessel.velocity_ground, 0.0)
    yield HeadingSample(stamp, truth.vessel.heading, 0.01)
    place = to_latitude_longitude(truth.vessel.position, Datum(60.0, 5.0))
    yield FixSample(stamp, *place, 1.0)


def sweep_of(truth: Truth) -> Iterator[Sample]:
    """The sonar's sweep, and what was read off it."""
    yield from sweep(truth.stamp, MOUTH)
    yield RangeSample(truth.stamp, 'opening_height', HEIGHT, 1.0, 1.0, 200.0)
    yield RangeSample(truth.stamp, 'opening_width', WIDTH, 1.0, 1.0, 200.0)


def write_tow(
    path: Path,
    parts: Collection[str] = ('truth', 'markers', 'instruments', 'sonar'),
    *,
    log_lag_s: float = 0.0,
    section: bool = True,
    growing: float = 0.0,
) -> Path:
    """Record it: everything once a second, a sweep every ten.

    Without ``section`` it has no points; with ``growing`` they go down by so much (m/s).
    """
    with BagWriter(path) as bag:
        for second in range(DURATION_S + 1):
            truth = truth_at(second)
            through = truth.net.section[: None if section else 0] + [growing * second, 0.0, 0.0]
            truth = replace(truth, net=replace(truth.net, section=through))
            messages = truth_messages(truth) if 'truth' in parts else []
            if 'markers' in parts:
                messages.append(gear_markers(picture_of(truth)))
            if 'instruments' in parts:
                messages += [sample_message(sample) for sample in samples_of(truth)]
            if second % 10 == 0 and 'sonar' in parts:
                messages += [sample_message(sample) for sample in sweep_of(truth)]
            for topic, message in messages:
                logged = truth.stamp + round(log_lag_s * SECOND)
                bag.write(absolute(topic), message.__msgtype__, serialize(message), logged)
    return path


@pytest.fixture(scope='session')
def known() -> SimpleNamespace:
    """What is known of the tow, and what makes bags and sweeps of it."""
    return SimpleNamespace(
        DURATION_S=DURATION_S,
        START=START,
        CURRENT=CURRENT,
        ASTERN=ASTERN,
        HALF_SPREAD=HALF_SPREAD,
        DEPTH=DEPTH,
        SINKING=SINKING,
        LENGTH=LENGTH,
        NET_DEPTH=NET_DEPTH,
        HEIGHT=HEIGHT,
        WIDTH=WIDTH,
        ROLLS=ROLLS,
        PITCH=PITCH,
        SILENT=SILENT,
        MOUTH=MOUTH,
        truth_at=truth_at,
        picture_of=picture_of,
        sweep=sweep,
        write=write_tow,
    )


@pytest.fixture(scope='session')
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The whole tow."""
    return write_tow(tmp_path_factory.mktemp('known') / 'whole')


@pytest.fixture(scope='session')
def tow(bag: Path) -> TowHistory:
    """The whole tow as it is read."""
    return read_history(bag, Water().depth, 'trawl')


@pytest.fixture(scope='session')
def readings_only(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The tow without truth and sonar."""
    return write_tow(tmp_path_factory.mktemp('known') / 'readings', ['instruments'])
