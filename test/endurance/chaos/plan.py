"""Plan of the faults in a graph: a random order from a seed."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import yaml

from trawl_ros.lab.running.chain import INSTRUMENTS

RECORDER, SIMULATION, IDENTIFICATION = 'bag_recorder', 'sim_node', 'identification_node'
WORKERS = (*INSTRUMENTS, RECORDER, IDENTIFICATION)

Kind = Literal[
    'stopped', 'killed', 'disk full', 'second publisher', 'flood', 'clock', 'stamp', 'progress'
]

STOPPED_S = (0.5, 4.0)
RUN_S = (1.0, 3.0)
"""Wall time for which a node is stopped, and a stranger speaks; least and most."""

QUIET_SHARE = 0.05
"""Of the tow, at its beginning and at its end, in which nothing happens."""

REPERTOIRE: tuple[tuple[Kind, str], ...] = (
    *(('stopped', node) for node in (SIMULATION, *WORKERS)),
    *(('stopped', node) for node in (SIMULATION, *WORKERS)),
    *(('killed', node) for node in WORKERS),
    *(('killed', node) for node in WORKERS),
    ('disk full', RECORDER),
    ('disk full', RECORDER),
    ('second publisher', 'winch/joint_states'),
    ('second publisher', 'door/spread'),
    ('second publisher', 'door/port/pressure'),
    ('flood', 'winch/joint_states'),
    ('flood', 'door/spread'),
    ('flood', 'vessel/heading'),
    ('flood', 'truth/winch'),
    ('clock', '-30'),
    ('clock', '3600'),
    ('clock', '-100000'),
    ('stamp', 'winch/joint_states'),
    ('stamp', 'vessel/heading'),
    ('progress', 'sync/progress'),
)
"""Faults of each hour, with their node or topic; a clock is off by so many seconds.

The simulation is not killed: it is the sea, and with it the tow would begin anew.
"""

STATES = ((300.0, 2.3), (250.0, 2.1), (200.0, 1.9), (250.0, 2.3), (300.0, 2.0))
"""Warp (m) and speed (m/s) of the steady states of the tow, short, so that a state of 12 minutes
has several windows."""


@dataclass(frozen=True)
class Plan:
    """Plan: hours of towing, number of kills of the recorder at full load, the seed."""

    hours: float = 1.0
    kills: int = 50
    seed: int = 16
    gear: str = 'kaifuha'

    @property
    def end_s(self) -> float:
        """Length of the tow, s."""
        return 3600.0 * self.hours


@dataclass(frozen=True)
class InjectedFault:
    """Fault that happens ``at_s`` of the tow to a node or topic, for some wall time (s)."""

    at_s: float
    kind: Kind
    target: str
    for_s: float

    def __str__(self) -> str:
        return f'{self.kind}, {self.target}'


def faults_of(plan: Plan) -> list[InjectedFault]:
    """Return the faults on a tow, in order."""
    rng = np.random.default_rng(plan.seed)
    number = max(1, round(plan.hours * len(REPERTOIRE)))
    order: list[int] = []
    while len(order) < number:
        order += rng.permutation(len(REPERTOIRE)).tolist()
    ends = plan.end_s * QUIET_SHARE, plan.end_s * (1.0 - QUIET_SHARE)
    times = np.sort(rng.uniform(*ends, number)).tolist()
    faults = []
    for at_s, index in zip(times, order, strict=False):
        kind, target = REPERTOIRE[index]
        span = STOPPED_S if kind == 'stopped' else RUN_S
        faults.append(InjectedFault(at_s, kind, target, float(rng.uniform(*span))))
    return faults


def write_tow(folder: Path, gear: str, hours: float, truth_rate_hz: float) -> Path:
    """Write the scenario of a tow of steady states, and return its path."""
    warp, speed = STATES[0]
    minutes = 60.0 * hours / len(STATES)
    record = {
        'description': f'{hours:g} hours of steady states',
        'gear': gear,
        'seed': 4,
        'start': {'warp_length_m': warp, 'speed_m_s': speed},
        'steps': [
            {'name': f'{warp:g} m', 'minutes': minutes, 'warp_length_m': warp, 'speed_m_s': speed}
            for warp, speed in STATES
        ],
        'truth_rate_hz': truth_rate_hz,
    }
    path = folder / 'tow.yaml'
    path.write_text(yaml.safe_dump(record, sort_keys=False), encoding='utf-8')
    return path
