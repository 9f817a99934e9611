"""What happened on a trial, drawn from its bag."""

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.bags.reader import Bag, RawMessage
from trawl_ros.messages.cdr import deserialize
from trawl_ros.messages.stamps import SECOND, stamp_of
from trawl_ros.messages.topics import NAMESPACE, absolute

TRUTH, MEASURED, COMMANDED = '#2ca02c', '#000000', '#1f77b4'
TRUTH_EVERY = 20
"""Every so many truths are drawn: two seconds apart at ten per second."""

PRESSURES = ('door/port/pressure', 'door/starboard/pressure', 'sonar/pressure')
TOPICS = (
    'truth/winch',
    'truth/door/port/odom',
    'truth/door/starboard/odom',
    'truth/net/opening',
    'winch/joint_states',
    'door/spread',
    'vessel/velocity_water',
    *PRESSURES,
)


@dataclass(frozen=True)
class History:
    """Series by name: times (n,) in s since the trial's start, and values (n,) in SI."""

    series: Mapping[str, tuple[np.ndarray, np.ndarray]]
    gear: Any | None

    def draw(self, axes: Axes, name: str, scale: float = 1.0, **style: Any) -> None:
        """Draw one series over minutes, where there is one."""
        if name in self.series:
            times, values = self.series[name]
            axes.plot(times / 60.0, scale * values, **style)


def read_history(
    path: Path, depth: Callable[[float], float], namespace: str = NAMESPACE
) -> History:
    """Read what the figures need from a bag.

    Parameters
    ----------
    path
        The bag.
    depth
        Depth (m) at an absolute pressure (Pa).
    namespace
        Where the topics live.
    """
    points: dict[str, list[tuple[int, float]]] = defaultdict(list)
    doors: dict[tuple[str, int], np.ndarray] = {}
    gear: RawMessage | None = None
    wanted = {absolute(name, namespace): name for name in (*TOPICS, 'truth/gear')}
    seen: dict[str, int] = defaultdict(int)
    for raw in Bag(path, namespace=namespace).raw(wanted):
        topic = wanted[raw.topic]
        if topic == 'truth/gear':
            gear = raw
            continue
        seen[topic] += 1
        if topic.startswith('truth/') and (seen[topic] - 1) % TRUTH_EVERY:
            continue
        message = deserialize(raw.data, raw.type)
        stamp = stamp_of(message)
        if topic in PRESSURES:
            points[topic].append((stamp, depth(message.fluid_pressure)))
        elif topic == 'door/spread':
            points[topic].append((stamp, message.range))
        elif topic == 'vessel/velocity_water':
            points[topic].append((stamp, message.twist.linear.x))
        elif topic == 'truth/net/opening':
            points[topic].append((stamp, message.vector.z))
        elif topic in ('truth/winch', 'winch/joint_states'):
            points[f'{topic} tension'].append((stamp, float(np.mean(message.effort))))
            points[f'{topic} length'].append((stamp, float(np.mean(message.position))))
        else:
            place = message.pose.pose.position
            doors[topic, stamp] = np.array([place.x, place.y, place.z])
    port, starboard = 'truth/door/port/odom', 'truth/door/starboard/odom'
    for (topic, stamp), place in doors.items():
        if topic == port and (starboard, stamp) in doors:
            other = doors[starboard, stamp]
            points['truth spread'].append((stamp, float(np.linalg.norm(place - other))))
            points['truth door depth'].append((stamp, -0.5 * float(place[2] + other[2])))
    start = min((stamp for series in points.values() for stamp, _ in series), default=0)
    series = {
        name: (
            np.array([(stamp - start) / SECOND for stamp, _ in pairs]),
            np.array([value for _, value in pairs]),
        )
        for name, pairs in points.items()
    }
    return History(series, gear and deserialize(gear.data, gear.type))


def history_figure(history: History) -> Figure:
    """What ship and winches did, and how doors and net followed: truth and measured."""
    figure = Figure(figsize=(10.0, 11.0), layout='constrained')
    panels = figure.subplots(5, 1, sharex=True)
    truth: dict[str, Any] = {'color': TRUTH, 'lw': 1.8, 'zorder': 3}
    measured: dict[str, Any] = {
        'color': MEASURED,
        'ls': '',
        'marker': '.',
        'ms': 2.0,
        'alpha': 0.35,
    }
    driven = panels[0]
    history.draw(driven, 'truth/winch length', color=COMMANDED)
    driven.set_ylabel('warp length / m', color=COMMANDED)
    speed = driven.twinx()
    history.draw(speed, 'vessel/velocity_water', **measured)
    speed.set_ylabel('speed log / (m/s)')
    for axes, label, true_name, names, scale in (
        (panels[1], 'door spread / m', 'truth spread', ('door/spread',), 1.0),
        (panels[2], 'door depth / m', 'truth door depth', PRESSURES[:2], 1.0),
        (panels[3], 'net depth / m', 'truth/net/opening', PRESSURES[2:], 1.0),
        (
            panels[4], 'warp tension / kN', 'truth/winch tension',
            ('winch/joint_states tension',), 1e-3,
        ),
    ):  # fmt: skip
        for number, name in enumerate(names):
            history.draw(
                axes, name, scale, **measured, label='_' if number else 'measured'
            )  # fmt: skip
        history.draw(axes, true_name, scale, **truth, label='truth')
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
        if 'depth' in label:
            axes.invert_yaxis()
    panels[1].legend(fontsize='small', markerscale=4)
    panels[-1].set_xlabel('time / min')
    return figure
