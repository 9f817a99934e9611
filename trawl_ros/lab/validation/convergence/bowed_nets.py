"""Boards beside finer and finer nets, with straight twine and with twine that bows."""

from collections.abc import Iterator, Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import TextTable
from trawl_ros.lab.validation.convergence.gears import SPEED
from trawl_ros.lab.validation.convergence.time_step import BOWING
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

LENGTH = 500.0
"""Warp length, m."""

COUNTS = 36, 48, 60, 72, 96
"""Numerical meshes around the net."""

ALLOWED = 0.5
"""Difference of an angle (°) from that of the finest net that is asked for."""

ALLOWED_SHARE = 2.0
"""The same of a length or tension, %."""

ANGLES = 'port_attack', 'port_inclination', 'port_roll'
SHOWN = 'door_spread', 'port_door_depth', 'vertical_opening', 'warp_tension', *ANGLES
KINDS = {'straight': 0.0, 'bowed': BOWING}


def bowed_nets(
    gear: GearRecord, counts: Sequence[int] = COUNTS
) -> tuple[list[MeasuredValue], TextTable]:
    """Solve the gear with all nets, cold, and compare the default's boards with the finest's."""
    seen = {
        kind: {count: _observed(_netted(gear, count, pressure)) for count in counts}
        for kind, pressure in KINDS.items()
    }
    return list(_checks(seen, gear.netting.around)), _table(seen)


def _netted(gear: GearRecord, around: int, pressure: float) -> GearRecord:
    update = {'around': around, 'bowing_pressure_pa': pressure}
    return gear.model_copy(update={'netting': gear.netting.model_copy(update=update)})


def _observed(gear: GearRecord) -> FloatArray:
    """Observables of `SHOWN`; angles in degrees, tension in kN."""
    seen = find_equilibrium(build_model(gear), OperatingPoint(LENGTH, LENGTH, SPEED)).observables
    values = np.array([getattr(seen, name) for name in SHOWN])
    values[-len(ANGLES) :] = np.degrees(values[-len(ANGLES) :])
    values[SHOWN.index('warp_tension')] /= 1000.0
    return values


def _checks(seen: dict[str, dict[int, FloatArray]], own: int) -> Iterator[MeasuredValue]:
    for kind, by_count in seen.items():
        finest = max(by_count)
        others = f'from the net of {finest} meshes around, twine {kind}, {LENGTH:g} m of warp'
        off = {count: np.abs(values - by_count[finest]) for count, values in by_count.items()}
        shares = 100.0 * off[own][: -len(ANGLES)] / by_count[finest][: -len(ANGLES)]
        yield MeasuredValue(
            f'largest difference of spread, depth, opening or tension {others}',
            float(shares.max()),
            '%',
            at_most(ALLOWED_SHARE),
            _series(by_count, int(shares.argmax())),
            key=f'sizes_{kind}',
        )
        worst = len(SHOWN) - len(ANGLES) + int(off[own][-len(ANGLES) :].argmax())
        enough = min(count for count in off if off[count][-len(ANGLES) :].max() <= ALLOWED)
        yield MeasuredValue(
            f'largest difference of α, δ or roll {others}',
            float(off[own][worst]),
            '°',
            at_most(ALLOWED),
            f'{_series(by_count, worst)} The fewest of these with all three within {ALLOWED:g}°: '
            f'{enough}.',
            key=f'angles_{kind}',
        )


def _series(by_count: dict[int, FloatArray], column: int) -> str:
    """Sentence with one observable over the meshes around."""
    values = ', '.join(f'{observed[column]:.2f}' for observed in by_count.values())
    counts = ', '.join(map(str, by_count))
    return f'{SHOWN[column]} with {counts} numerical meshes around is {values}.'


def _table(seen: dict[str, dict[int, FloatArray]]) -> TextTable:
    rows = [
        (kind, str(count), *(f'{value:.2f}' for value in values))
        for kind, by_count in seen.items()
        for count, values in by_count.items()
    ]
    head = ('twine', 'around', 'spread (m)', 'door depth (m)', 'opening (m)', 'tension (kN)')
    return TextTable(
        f'{LENGTH:g} m of warp, {SPEED:g} m/s, over meshes around the net; bowed: under '
        f'{BOWING:g} Pa',
        (*head, 'α (°)', 'δ (°)', 'roll (°)'),
        tuple(rows),
    )
