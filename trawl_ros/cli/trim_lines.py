"""Lines that ``trawl trim`` prints."""

from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray

if TYPE_CHECKING:
    from trawl_ros.records.observables import Observables
    from trawl_ros.solver.equilibrium import SteadyState
    from trawl_ros.solver.trimming.over_range import RangeTrim


def points_lines(points: FloatArray) -> tuple[str, ...]:
    """Fastening points as a gear file has them."""
    names = 'warp_m', 'upper_bridle_m', 'lower_bridle_m'
    return (
        '  fastening:',
        *(
            f'    {name}: [{", ".join(f"{x:.3f}" for x in point)}]'
            for name, point in zip(names, points, strict=True)
        ),
    )


def state_line(warp: float, speed: float, steady: 'SteadyState') -> str:
    """A steady state at a warp length (m) and speed (m/s)."""
    observables: Observables = steady.observables
    # δ has no sign: which way the port board leans its roll tells.
    inward = ' inward' if observables.port_roll < 0.0 else ''
    return (
        f'at {warp:g} m and {speed:g} m/s: α {np.degrees(observables.port_attack):.1f}°, '
        f'δ {np.degrees(observables.port_inclination):.1f}°{inward}, '
        f'β {np.degrees(observables.port_slip):.1f}°, '
        f'spread {observables.door_spread:.1f} m, door depth {observables.door_depth:.1f} m, '
        f'tension {observables.warp_tension / 1e3:.1f} kN; the slowest motion settles in '
        f'{steady.stability.settling_time:.0f} s'
    )


def range_lines(found: 'RangeTrim') -> list[str]:
    """Every operating point of a range."""
    lines = []
    for point in found.found:
        if point.steady is None:
            lines.append(
                f'not at {point.warp_length:g} m and {point.speed:.3g} m/s: {point.reason}'
            )
        else:
            lines.append(state_line(point.warp_length, round(point.speed, 3), point.steady))
    return lines


def wish_lines(found: 'RangeTrim', attack: float, inclination: float) -> list[str]:
    """Wanted angles beside those that the range has, where a state is usable."""
    seen = [point.steady.observables for point in found.found if point.steady is not None]
    if not seen:
        return []
    # δ is told without a sign: boards that lean inward are wanted and found with it alike.
    angles = np.degrees([[o.port_attack, o.port_inclination] for o in seen])
    (alpha, delta), (most_alpha, most_delta) = angles.min(axis=0), angles.max(axis=0)
    return [
        f'wanted α {np.degrees(attack):.1f}° and δ {np.degrees(abs(inclination)):.1f}°; nearest '
        f'over the range: α {alpha:.1f}° to {most_alpha:.1f}°, δ {delta:.1f}° to {most_delta:.1f}°'
    ]


def closing_line(found: 'RangeTrim') -> str:
    """Usable states of a range, and the change of attitude over it."""
    speeds = sorted({point.speed for point in found.found})
    percent = 100.0 * np.log(speeds[-1] / speeds[0])
    attack, lean = np.degrees(found.by_speed)
    closing = f'{found.usable} of {len(found.found)} are usable'
    if percent > 0.0 and found.usable > 1:
        closing += (
            f'; with speed α changes by {attack:.1f}° and δ by {lean:.1f}°, '
            f'{attack / percent:.2f}° and {lean / percent:.2f}° per % of speed'
        )
    if len({point.warp_length for point in found.found}) > 1 and found.usable > 1:
        attack, lean = np.degrees(found.by_warp)
        closing += f'; with warp length by {attack:.1f}° and {lean:.1f}°'
    return closing
