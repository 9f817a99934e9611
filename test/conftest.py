"""The default gear, whole and cut coarsely, and bags of steady tows made without towing."""

import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import yaml

from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.files import write_figure
from trawl_ros.core.resources import share_path
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.observables import Observables
from trawl_ros.records.samples import (
    AttitudeSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.topics import absolute
from trawl_ros.report import pictures
from trawl_ros.solver.equilibrium import steady_state

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SECOND = 1_000_000_000
LEGS = ((200.0, 2.3), (220.0, 2.3))


# A shell that starts tests in the background has them, and all their children, ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_configure(config: pytest.Config) -> None:
    """Leave slow tests out where nothing is asked for, as by `colcon test`."""
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS and not config.option.markexpr:
        config.option.markexpr = 'not slow'


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with slow tests come first: one that begins last would leave a worker idle."""
    slow = {item.path for item in items if item.get_closest_marker('slow')}
    items.sort(key=lambda item: item.path not in slow)


@pytest.fixture(scope='session', autouse=True)
def own_domain(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Lease a ROS domain for what this process starts: other suites are not to hear it."""
    with own_graph(tmp_path_factory.mktemp('log')) as graph, pytest.MonkeyPatch.context() as patch:
        for name, value in graph.items():
            patch.setenv(name, value)
        yield


@contextmanager
def roughly_drawn() -> Iterator[None]:
    """Draw the pictures of reports small and without a layout, in less than half of the time."""

    def rough(path: Path, figure: 'Figure', dpi: float) -> None:
        figure.set_layout_engine('none')
        write_figure(path, figure, dpi / 4.0)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, 'write_figure', rough)
        yield


@pytest.fixture
def rough_pictures() -> Iterator[None]:
    """A report of whose pictures nothing is claimed but that there are some."""
    with roughly_drawn():
        yield


@pytest.fixture(scope='module')
def rough_pictures_of_all() -> Iterator[None]:
    """The same for all tests of a file."""
    with roughly_drawn():
        yield


@pytest.fixture(scope='session')
def gear() -> GearRecord:
    return load_gear('kaifuha')


@pytest.fixture(scope='session')
def default_model(gear: GearRecord) -> GearModel:
    return build_model(gear)


@pytest.fixture(scope='session')
def model(gear: GearRecord) -> GearModel:
    """The gear with its netting as coarse as it may be, which is quicker and no less general."""
    return build_model(
        gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})
    )


@pytest.fixture(scope='session')
def coarse_gear(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of the default gear, its netting as coarse as it may be, which is quicker."""
    data = yaml.safe_load(share_path('config', 'gear', 'kaifuha.yaml').read_text())
    data['netting']['around'] = 12
    path = tmp_path_factory.mktemp('gear') / 'coarse.yaml'
    path.write_text(yaml.safe_dump(data))
    return path


@pytest.fixture(scope='session')
def pair_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of the planned net, cut coarsely, between two ships 200 m apart."""
    data = yaml.safe_load(share_path('config', 'gear', 'krill_800.yaml').read_text())
    del data['board'], data['ship']['block_spacing_m']
    data['name'], data['pair'] = 'pair', {'distance_m': 200.0}
    data['netting']['around'] = 24
    path = tmp_path_factory.mktemp('pair') / 'pair.yaml'
    path.write_text(yaml.safe_dump(data))
    return path


@pytest.fixture(scope='session')
def pair_gear(pair_file: Path) -> GearRecord:
    return load_gear(pair_file)


@dataclass(frozen=True)
class SteadyTow:
    """Steady states of the coarse gear, and bags of what instruments say in them."""

    states: tuple[tuple[float, float, Observables], ...]
    pressure: Callable[[float], float]

    def samples(self, *, start: int = 0, seed: int = 0, leg_s: int = 400) -> Iterable[Sample]:
        """One leg after the other at one reading per second, with small errors."""
        draw = np.random.default_rng(seed).standard_normal
        for second in range(leg_s * len(self.states)):
            stamp = start + second * SECOND
            length, speed, seen = self.states[second // leg_s]
            tensions = np.array([seen.port_tension, seen.starboard_tension]) + 300.0 * draw(2)
            yield WinchSample(stamp, (length, length), (0.0, 0.0), tuple(tensions))
            for place, depth in (
                ('port', seen.port_door_depth),
                ('starboard', seen.starboard_door_depth),
                ('sonar', seen.net_depth),
            ):
                yield PressureSample(stamp, place, self.pressure(depth + 0.1 * draw()), 1000.0)
            for side, pitch, roll in (
                ('port', seen.port_pitch, seen.port_roll),
                ('starboard', seen.starboard_pitch, seen.starboard_roll),
            ):
                yield AttitudeSample(
                    stamp, side, pitch + 0.003 * draw(), roll + 0.003 * draw(), 0.003
                )
            spread = seen.door_spread + 0.3 * draw()
            yield RangeSample(stamp, 'spread', spread, 0.3, 1.0, 500.0)
            yield VelocitySample(
                stamp, 'water', np.array([speed + 0.01 * draw(), 0.0, 0.0]), float('nan')
            )

    def bag(self, path: Path, **kwargs: int) -> Path:
        """Write these samples as a bag."""
        return self.write(path, self.samples(**kwargs))

    @staticmethod
    def write(path: Path, samples: Iterable[Sample]) -> Path:
        with BagWriter(path) as bag:
            for sample in samples:
                topic, message = sample_message(sample)
                bag.write(absolute(topic), message.__msgtype__, serialize(message), sample.stamp)
        return path


@pytest.fixture(scope='session')
def steady_tow(coarse_gear: Path) -> SteadyTow:
    model = build_model(load_gear(coarse_gear))
    states = []
    start = None
    for length, speed in LEGS:
        found = steady_state(model, length, speed, start=start)
        start = found.equilibrium
        states.append((length, speed, found.observables))
    return SteadyTow(tuple(states), model.water.pressure)


@pytest.fixture(scope='session')
def onset_samples(steady_tow: SteadyTow) -> Callable[..., Iterable[Sample]]:
    """Give samples of minutes in one state, in which cells show a part too much from a time on."""
    still = replace(steady_tow, states=steady_tow.states[:1])

    def samples(minutes: int, begin_s: float = np.inf, part: float = 0.1) -> Iterable[Sample]:
        for sample in still.samples(start=SECOND, leg_s=60 * minutes):
            if isinstance(sample, WinchSample) and sample.stamp >= begin_s * SECOND:
                port, starboard = ((1.0 + part) * tension for tension in sample.tensions)
                yield replace(sample, tensions=(port, starboard))
            else:
                yield sample

    return samples
