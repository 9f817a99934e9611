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

COUNTS = 36, 48, 72, 96
"""Numerical meshes around the net."""

ALLOWED = 0.5
"""Difference of an angle (°) from that of the finest net that is asked for."""

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
        angles = np.abs(by_count[own] - by_count[finest])[-len(ANGLES) :]
        worst = int(angles.argmax())
        column = len(SHOWN) - len(ANGLES) + worst
        series = ', '.join(f'{values[column]:.2f}°' for values in by_count.values())
        yield MeasuredValue(
            f'largest difference of α, δ or roll from the net of {finest} meshes around, twine '
            f'{kind}, {LENGTH:g} m of warp',
            float(angles[worst]),
            '°',
            at_most(ALLOWED),
            'the grouping of the netting has not settled for it: '
            f'{ANGLES[worst]} with {", ".join(map(str, by_count))} numerical meshes around is '
            f'{series}.',
            key=f'angles_{kind}',
        )


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
