# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Check of a gear file without a solution: main quantities, findings and drawings."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.core.files import made_folder, write_figure
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import load_yaml
from trawl_ros.gear.drag_bands import BANDS, KNOT
from trawl_ros.gear.findings import GearFinding, findings
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.rigging import ropes_of

if TYPE_CHECKING:
    from trawl_ros.model.state import State, Tow

BRIDLE_SUFFIXES = '_bridle', '_sweep', '_backstrop'
"""Ends of the names of ropes between boards and net."""

DRAG_SPEEDS_KN = (2.0, 3.0, 4.0)
"""Speeds at which the drag is compared."""

DRAG_MARGINS = (0.6, 1.0)
"""Factors on the least and largest drag of the formulas; a drag between them is plausible."""


@dataclass(frozen=True)
class GearCheck:
    """Check of a gear file.

    Attributes
    ----------
    gear, model
        Record of the file, and its model, without a solution.
    twine_area
        Twine area of all netting, length times diameter, m².
    weights
        Weight in water (N) by part of the gear, without warps; negative for floats.
    drag
        Drag of the net (N) by speed (knots) and empirical formula.
    findings
        Findings, in the order of the file.
    derived
        Values of keys that the file does not give.

    Examples
    --------
    >>> import trawl_ros
    >>> check = trawl_ros.check_gear('krill_800')
    >>> check.derived['headrope.length_m']
    '58.85'
    """

    gear: GearRecord
    model: GearModel
    twine_area: float
    weights: Mapping[str, float]
    drag: Mapping[float, Mapping[str, float]]
    findings: tuple[GearFinding, ...]
    derived: Mapping[str, str]


def check_gear(path: str | Path) -> GearCheck:
    """Check a gear file without solving anything.

    Parameters
    ----------
    path
        A file, or the name of a gear that comes with the package.

    Returns
    -------
    GearCheck
        Figures and findings.

    Raises
    ------
    GearError
        If the file cannot be loaded, or no model can be built of it.

    Examples
    --------
    >>> import trawl_ros
    >>> check = trawl_ros.check_gear('kaifuha')
    >>> print(f'{check.twine_area:.0f} m² of twine')
    678 m² of twine
    >>> check.findings
    ()
    """
    raw = load_yaml(packaged(path, 'gear', GearError), GearError)
    gear = load_gear(path)
    model = build_model(gear)
    area = sum(bar.area * bar.rest for bar in model.net_mesh.bars)
    drag = {
        knots: {name: band(area, knots) for name, band in BANDS.items()} for knots in DRAG_SPEEDS_KN
    }
    return GearCheck(
        gear=gear,
        model=model,
        twine_area=float(area),
        weights=weights_of(model),
        drag=drag,
        findings=(*findings(gear), *_drag_findings(model, drag)),
        derived=dict(_derived(raw, gear)),
    )


def weights_of(model: GearModel) -> dict[str, float]:
    """Weight in water (N) by part of the gear, warps left out."""
    water, bars, gear = model.water, model.bars, model.gear
    heavy = water.gravity * (bars.mass - water.density * bars.volume) * model.rest
    found = {
        'boards' if gear.pair is None else 'plates': 2
        * water.gravity
        * (gear.board.mass_kg - water.density * gear.board.volume_m3),
    }
    for name, _, numbers in model.layout.lines:
        if name.endswith('_warp'):
            continue
        part = 'bridles' if name.endswith(BRIDLE_SUFFIXES) else name
        part = {'port_wing_end': 'side ropes', 'starboard_wing_end': 'side ropes'}.get(part, part)
        found[part] = found.get(part, 0.0) + float(heavy[numbers].sum())
    mesh = model.net_mesh
    if mesh.knot_volume.any():
        sunk = mesh.knot_density - water.density
        found['knots'] = float(water.gravity * sunk * mesh.knot_volume.sum())
    for name, force in (
        ('clump', gear.clump.weight_in_water_n),
        ('floats', -gear.floats.buoyancy_n),
    ):
        if force:
            found[name] = 2 * force
    for item in gear.hung:
        for rope in ropes_of(item):
            own = next(numbers for name, _, numbers in model.layout.lines if name == rope)
            force = item.force_on(float(model.rest[own].sum()))
            if force:  # a kite may have none
                found[item.name] = found.get(item.name, 0.0) + force
    if gear.catch is not None:
        fish = gear.catch.mass_kg / gear.catch.density_kg_m3
        found['catch'] = water.gravity * (gear.catch.mass_kg - water.density * fish)
    if gear.kite is not None:
        sunk = gear.kite.mass_kg - water.density * gear.kite.volume_m3
        found['kite'] = water.gravity * sunk
    return found


def drag_of_model(model: GearModel, knots: float) -> float:
    """Return the drag (N) of the net in its built shape at a speed (knots).

    It includes netting, ropes and hung items, but no boards, bridles and warps.
    """
    from trawl_ros.solver.first_guess import first_guess
    from trawl_ros.solver.operating_point import OperatingPoint, steady_tow

    warp = max(500.0, model.gear.block_distance)
    tow = steady_tow(model, OperatingPoint(warp, warp, knots * KNOT))
    return drag_of_net(model, first_guess(model, tow, 0.0), tow)


def _drag_findings(
    model: GearModel, drag: Mapping[float, Mapping[str, float]]
) -> Iterator[GearFinding]:
    """Find a drag far from all formulas."""
    knots = DRAG_SPEEDS_KN[1]
    found, others = drag_of_model(model, knots), drag[knots].values()
    if not DRAG_MARGINS[0] * min(others) <= found <= DRAG_MARGINS[1] * max(others):
        yield GearFinding(
            'netting',
            f'found a drag of {1e-3 * found:.3g} kN at {knots:g} knots, expected the '
            f'{1e-3 * min(others):.3g} to {1e-3 * max(others):.3g} kN of the formulas, or near '
            'them; look at twine diameters, meshes and circumferences',
        )


def drag_of_net(model: GearModel, state: 'State', tow: 'Tow') -> float:
    """Return the same drag (N) in a state of a gear towed along x."""
    from trawl_ros.model.assembly import lump_forces, motion_of, points_of
    from trawl_ros.model.line import drag, tension

    motion = motion_of(model, points_of(model, state, tow), tow)
    loads = drag(model.bars, motion, tension(model.bars, motion)[1], model.water)
    of_net = np.isin(model.ends, model.layout.net).all(axis=1)
    lumps = lump_forces(model, state)[model.layout.net]
    return float(-loads[of_net, 0].sum() - lumps[:, 0].sum())


def draw_gear(check: GearCheck, folder: Path) -> list[Path]:
    """Draw the net plan, if the file has one, and the rigged gear as built.

    Raises
    ------
    OSError
        If the pictures cannot be written.
    """
    from trawl_ros.plots.net_plan import net_plan_figure
    from trawl_ros.plots.rigged_gear import rigged_gear_figure
    from trawl_ros.report.style import DPI

    folder, drawn = made_folder(folder), []
    figures = {'gear.png': rigged_gear_figure(check.model)}
    if check.gear.netting.plan is not None:
        figures['net_plan.png'] = net_plan_figure(check.gear.name, check.gear.netting.plan)
    for name, figure in figures.items():
        write_figure(folder / name, figure, DPI)
        drawn.append(folder / name)
    return drawn


def _derived(raw: dict[str, object], gear: GearRecord) -> Iterator[tuple[str, str]]:
    """Yield values of the record that the file does not give, including ropes of the frame."""
    # The plates of a pair replace boards and are described by their mass.
    hidden = {'board', 'identification'} if gear.pair is not None else set()
    yield from _missing('', raw, gear.model_dump(mode='json', exclude=hidden))
    plan = gear.netting.plan
    if plan is None:
        return
    for key in ('headrope', 'footrope', 'side_rope'):
        record = getattr(gear, key)
        if record is None or record.length_m is None:
            yield f'{key}.length_m', f'{plan.rope_length(key):.4g}'
    twines = {
        (p.material, p.rtex, p.twine.diameter) for p in plan.pieces if not p.twine_diameter_mm
    }
    for material, rtex, diameter in sorted(twines, key=lambda twine: -twine[2]):
        yield f'twine of {material} R{rtex:g}', f'{1e3 * diameter:.3g} mm'


def _missing(key: str, raw: object, taken: object) -> Iterator[tuple[str, str]]:
    if isinstance(raw, dict) and isinstance(taken, dict):
        for name, value in taken.items():
            place = f'{key}.{name}' if key else name
            if name in raw:
                yield from _missing(place, raw[name], value)
            elif value not in (None, [], {}, '') and name not in ('pieces', 'plan'):
                yield place, _shown(value)


def _shown(value: object) -> str:
    if isinstance(value, dict):
        inner = {k: v for k, v in value.items() if v not in (None, [], '')}
        return ', '.join(f'{k} {_shown(v)}' for k, v in inner.items())
    if isinstance(value, list):
        return '[' + ', '.join(map(_shown, value)) + ']'
    return f'{value:.4g}' if isinstance(value, float) else str(value)
