"""Graphs of `trawl_ros.testing` for the project's own nodes, and a short trial for them to run."""

import os
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np
import pytest
import yaml

from trawl_ros.gear.records import GearRecord

if TYPE_CHECKING:
    from trawl_ros.testing import Graph

# Before rclpy is loaded: nobody outside of this machine is to hear these nodes.
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'

SCENARIO = """\
description: A short tow with a change of everything
gear: gear.yaml
seed: 5
heading_deg: 30.0
effects:
  - {name: tension_cell, values: {scale: 0.1}}
  - {name: warp_strumming, values: {factor: 1.3}}
sea:
  heave: {height_m: 1.0, period_s: 8.0, growth_minutes: 0.25}
  seabed: {profile: [{distance_m: 0.0, depth_m: 250.0}, {distance_m: 1000.0, depth_m: 260.0}]}
  schools:
    - {east_m: 20.0, north_m: 10.0, depth_m: 60.0, size_east_m: 60.0, size_north_m: 60.0,
       size_up_m: 20.0, density_per_m3: 1.0}
    - {east_m: 700.0, north_m: 350.0, depth_m: 60.0, size_east_m: 90.0, size_north_m: 60.0,
       size_up_m: 20.0, density_per_m3: 2.0}
start: {warp_length_m: 300.0, speed_m_s: 2.1}
steps:
  - {name: hold, minutes: 0.1}
  - {name: veer, minutes: 0.3, warp_length_m: 305.0, speed_m_s: 2.15, steer: {heading_deg: 33.0},
     autotrawl: {mode: lengths}}
"""


@pytest.fixture(scope='session', autouse=True)
def no_viewer() -> Iterator[None]:
    """Leave `view_node` without a viewer, which needs an extra and a display."""
    try:
        from trawl_ros.nodes import view_node
    except ImportError:  # without ROS 2
        yield
        return
    nothing = SimpleNamespace(
        page='', shown=0, lost=0, waiting=0, trouble='', closed=False,
        put=lambda record: None, close=lambda: None,
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(view_node, 'open_view', lambda parameters, output: nothing)
        yield


@pytest.fixture(scope='module', autouse=True)
def pictures(rough_pictures_of_all: None) -> None:
    """Draw reports of nodes roughly: what is in them has tests of its own."""


@pytest.fixture(scope='session')
def open_graph():
    """Give the context manager that makes a graph in a domain of its own."""
    from trawl_ros.testing import open_graph

    return open_graph


@pytest.fixture
def graph(open_graph) -> Iterator['Graph']:
    with open_graph() as graph:
        yield graph


@pytest.fixture(scope='session')
def gear_path(gear: GearRecord, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The default gear with its netting as coarse as it may be, for speed."""
    coarse = gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})
    path = tmp_path_factory.mktemp('gear') / 'gear.yaml'
    path.write_text(yaml.safe_dump(coarse.model_dump(mode='json')))
    return path


@pytest.fixture(scope='session')
def scenario_path(gear_path: Path) -> Path:
    """A trial of 24 s, long enough for every instrument to speak more than once."""
    path = gear_path.parent / 'short.yaml'
    path.write_text(SCENARIO)
    return path


@pytest.fixture(scope='session')
def estimate_listener():
    """Give the class of a node that looks at what the identification says."""
    from trawl_ros.messages.diagnostics import read_statuses
    from trawl_ros.messages.estimates import read_covariance, read_estimate, read_innovations
    from trawl_ros.nodes.graph.source import with_history
    from trawl_ros.nodes.runtime.node import TrawlNode
    from trawl_ros.nodes.runtime.qos import CONSUMER

    # Latched, and all that comes: two windows may be dealt with before it is its turn.
    latched = with_history(CONSUMER)

    class EstimateListener(TrawlNode):
        def __init__(self, name='listener', **kwargs):
            super().__init__(name, **kwargs)
            self.estimates = []
            self.covariances = []
            self.summaries = []
            self.innovations = []
            self.reports = {}
            for topic, read, found, profile in (
                ('estimate', read_estimate, self.estimates, latched),
                ('covariance', read_covariance, self.covariances, latched),
                ('status', read_statuses, self.summaries, latched),
                ('innovation', read_innovations, self.innovations, CONSUMER),
            ):
                self.listen(f'identification/{topic}', self._keeper(read, found), profile)
            self.listen('/diagnostics', self._hear, CONSUMER)

        @staticmethod
        def _keeper(read, found):
            return lambda message: found.append(read(message))

        def _hear(self, message):
            self.reports.update({status.name: status for status in read_statuses(message)})

        def report(self, subsystem='estimate'):
            return self.reports.get(f'/trawl/identification_node: {subsystem}')

        @property
        def status(self):
            """The newest statuses by the last word of their names."""
            newest = self.summaries[-1] if self.summaries else ()
            return {status.name.split(': ')[1]: status for status in newest}

    return EstimateListener


@pytest.fixture(scope='session')
def steady_samples(steady_tow):
    """Give a function that makes the samples of steady legs, in which every channel speaks.

    A channel that never does is waited for, and windows then come in bunches.
    """
    from dataclasses import replace

    from trawl_ros.records.samples import (
        HeadingSample,
        RangeSample,
        VelocitySample,
        WarpAngleSample,
    )
    from trawl_ros.records.truth import SIDES

    second = 1_000_000_000

    def samples(start: int, leg_s: int, **kwargs: int) -> list:
        found = []
        angles = np.random.default_rng(7)
        for sample in steady_tow.samples(start=start, leg_s=leg_s, **kwargs):
            if isinstance(sample, VelocitySample):
                found.append(replace(sample, yaw_rate=0.0))
                found.append(HeadingSample(sample.stamp, 0.5, 0.01))
                # A current from ahead, by which a log and GPS are told apart.
                ahead = np.array([np.cos(0.5), np.sin(0.5), 0.0])
                over_ground = (sample.velocity[0] - 0.3) * ahead
                nan = float('nan')
                found.append(VelocitySample(sample.stamp, 'ground', over_ground, nan))
                if (sample.stamp - start) % (10 * second) == 5 * second:
                    height = RangeSample(sample.stamp, 'opening_height', 40.0, 1.0, 1.0, 300.0)
                    found.append(height)
                seen = steady_tow.states[(sample.stamp - start) // second // leg_s][2]
                found += [
                    WarpAngleSample(
                        sample.stamp,
                        side,
                        getattr(seen, f'{side}_divergence') + 0.005 * angles.standard_normal(),
                        getattr(seen, f'{side}_declination') + 0.005 * angles.standard_normal(),
                    )
                    for side in SIDES
                ]
            else:
                found.append(sample)
        return found

    return samples


@pytest.fixture(scope='session')
def tight_tows(steady_tow, model, tmp_path_factory) -> SimpleNamespace:
    """Three tows in one bag over a level ground; from the second on cells show an eighth too much.

    `path` of the bag, how many `tows`, how many seconds lie between their starts, `apart_s`, and
    the depth (m) of the `seabed`.
    """
    from dataclasses import replace

    from trawl_ros.core.time import SECOND
    from trawl_ros.records.samples import RangeSample, WinchSample
    from trawl_ros.solver.equilibrium import steady_state

    legs = ((300.0, 2.4), (450.0, 2.1), (600.0, 2.4), (600.0, 2.1))
    tows, leg_s, apart_s, too_much, seabed = 3, 60, 3000, 1.12, 850.0

    def tight(sample):
        if isinstance(sample, WinchSample):
            port, starboard = sample.tensions
            return replace(sample, tensions=(too_much * port, too_much * starboard))
        return sample

    states = [
        (length, speed, steady_state(model, length, speed).observables) for length, speed in legs
    ]
    tow = replace(steady_tow, states=tuple(states))
    samples = []
    for number in range(tows):
        start = (1000 + number * apart_s) * SECOND
        own = tow.samples(start=start, seed=number, leg_s=leg_s)
        samples += own if number == 0 else map(tight, own)
        samples += [
            RangeSample(stamp, 'depth', seabed, 0.5, 1.0, 2000.0)
            for stamp in range(start, start + len(legs) * leg_s * SECOND, 10 * SECOND)
        ]
    samples.sort(key=lambda sample: sample.stamp)
    path = tow.write(tmp_path_factory.mktemp('tows') / 'bag', samples)
    return SimpleNamespace(path=path, tows=tows, apart_s=apart_s, seabed=seabed)
