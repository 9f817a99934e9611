"""The longest way of data, from bags to a verdict, goes through the rooms in their order."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import trawl_ros
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state

PACKAGE = f'{Path(trawl_ros.__file__).parent}/'
WAY = ('api', 'bags', 'estimation/windows', 'estimation/fit', 'diagnosis', 'diagnosis/report')
BELOW = {
    'api': set(WAY),
    'bags': set(),
    'estimation/windows': set(),
    'estimation/fit': {'estimation/windows'},
    'diagnosis': {'estimation/fit', 'estimation/windows'},
    'diagnosis/report': {'diagnosis', 'estimation/fit', 'estimation/windows'},
}
"""Rooms that a room may call, beside itself."""

STAGES = (
    ('api/trials.py', 'diagnose'),
    ('bags/reader.py', 'messages'),
    ('estimation/windows/finder.py', 'feed'),
    ('diagnosis/procedure.py', 'diagnose_windows'),
    ('estimation/fit/window_search.py', 'linearised'),
    ('diagnosis/inference/screen.py', 'screen'),
    ('diagnosis/report/writing.py', 'write_diagnosis'),
)
"""Functions that are called one after another; the diagnosis asks for the fit."""

LEGS = ((200.0, 2.3), (220.0, 2.3), (240.0, 2.4), (260.0, 2.2))


class Way:
    """Calls between rooms, and the stages in the order in which they were called."""

    def __init__(self) -> None:
        self.stages: list[tuple[str, str]] = []
        self.calls: set[tuple[str, str]] = set()
        self._room_of: dict[str, str] = {}

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        if event != 'call' or not (room := self._room(frame)):
            return
        stage = frame.f_code.co_filename.removeprefix(PACKAGE), frame.f_code.co_name
        if stage in STAGES:
            self.stages.append(stage)
        caller = frame.f_back
        while caller is not None and not self._room(caller):
            caller = caller.f_back
        if caller is not None:
            self.calls.add((self._room(caller), room))

    def _room(self, frame: FrameType) -> str:
        file = frame.f_code.co_filename
        if file not in self._room_of:
            inside = file.removeprefix(PACKAGE) if file.startswith(PACKAGE) else ''
            rooms = [room for room in WAY if inside.startswith(f'{room}/')]
            self._room_of[file] = max(rooms, key=len, default='')
        return self._room_of[file]

    @contextmanager
    def followed(self) -> Iterator[None]:
        """Watch all calls of this thread."""
        sys.setprofile(self)
        try:
            yield
        finally:
            sys.setprofile(None)


def test_bags_become_a_verdict_without_a_step_back(steady_tow, coarse_gear, tmp_path):
    model, start, states = build_model(load_gear(coarse_gear)), None, []
    for length, speed in LEGS:
        steady = steady_state(model, length, speed, start=start)
        start = steady.equilibrium
        states.append((length, speed, steady.observables))
    bag = type(steady_tow)(tuple(states), steady_tow.pressure).bag(tmp_path / 'bag')
    # What is imported runs, too, whoever needs it first.
    diagnose, way = trawl_ros.diagnose, Way()
    # What earlier tests left unread ends wherever it is collected, and would count as a call there.
    gc.collect()
    with way.followed():
        diagnosis = diagnose([bag], gear=coarse_gear, out=tmp_path / 'out')
    assert diagnosis.screen is not None
    assert tuple(dict.fromkeys(way.stages)) == STAGES
    reading, rest = STAGES[1:3], way.stages[way.stages.index(STAGES[3]) :]
    assert not set(reading) & set(rest), 'a bag is read after its windows were handed on'
    for caller, called in way.calls:
        assert called == caller or called in BELOW[caller], f'{caller} calls {called}'
