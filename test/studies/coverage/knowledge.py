"""Information in a planned trial, and size of the model error: figures without chance."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import GROUPS, group_of
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.planning.plan import plan_for
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.lab.trials.linearised_plant import MeshResolution, State
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

HOURS = 6.0
LEAST_KNOWN = 6
MOST_SWEEP = 2

LOOKED_AT: tuple[State, ...] = (
    (200.0, 2.3), (300.0, 1.9), (400.0, 2.1), (500.0, 2.3), (700.0, 2.1), (900.0, 2.3),
)  # fmt: skip
"""States in which model and plant are compared."""


def planning_rows(gear: str) -> list[MeasuredValue]:
    """Number of law quantities that a six-hour trial makes well known."""
    plan = plan_for(load_gear(gear), hours=HOURS)
    limits = '; '.join(f'{name}: {what}' for name, what in plan.limits.items())
    rows = [
        MeasuredValue(
            'planned six hours: values and slopes of laws that are well known',
            int(plan.trial.known.well_known.sum()),
            target=at_least(LEAST_KNOWN),
            note=f'of {len(QUANTITIES)}: standard deviation below 20 % of what the law spans over '
            f'15° of its angle; what limits the others: {limits or "nothing"}',
        )
    ]
    rows += [
        MeasuredValue(
            f'the same six hours as a {sweep.name}',
            int(sweep.known.well_known.sum()),
            note=f'{len(sweep.legs)} legs, {sweep.minutes:.0f} min; 0 to {MOST_SWEEP} expected',
        )
        for sweep in plan.sweeps
    ]
    return rows


def model_error_rows(gear: str, mesh: MeshResolution) -> list[MeasuredValue]:
    """Differences of a model and a plant, both with the board of the gear file."""
    model, plant = (_looks(record) for record in (mesh.model(gear), mesh.plant(gear)))
    rows = []
    for group in GROUPS:
        columns = [OBSERVABLES.index(name) for name in MEASURED if group_of(name) == group]
        angle = CHANNELS[next(name for name in MEASURED if group_of(name) == group)].unit == 'rad'
        difference = plant[:, columns] - model[:, columns]
        parts = np.degrees(difference) if angle else 100.0 * difference / model[:, columns]
        rows.append(
            MeasuredValue(
                f'plant less model ({mesh.around} meshes): {group.replace("_", " ")}',
                float(np.sqrt(np.mean(parts**2))),
                'deg' if angle else '%',
                note=f'{mesh}; root mean square over {len(LOOKED_AT)} states, least and most',
                low=float(parts.min()),
                high=float(parts.max()),
            )
        )
    return rows


def _looks(gear: GearRecord) -> FloatArray:
    """Observables (states, 22) of a gear."""
    model = build_model(gear)
    found = []
    near: Equilibrium | None = None
    for length, speed in LOOKED_AT:
        near = find_equilibrium(model, OperatingPoint(length, length, speed), near)
        found.append(near.observables.array())
    return np.array(found)
