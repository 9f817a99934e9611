# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drag of whole nets by speed, as built and in equilibrium, compared with formulas of trawls."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.api.gear_check import DRAG_SPEEDS_KN, drag_of_model, drag_of_net
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.drag_bands import KNOT, maclennan, reid
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.page import TextTable
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import steady_state

NETS = {'krill_800': 500.0, 'krill_1420': 300.0, 'krill_1600': 300.0, 'harstad_1436': 400.0,
        'four_seam': 150.0, 'pair_368': 150.0}  # fmt: skip
"""Gears with a plan, and the lengths of warp (m) with which they are towed here."""

TOWED = (2.0, 2.5, 3.0, 4.0)
"""Speeds (knots) of the equilibria."""

LEAST_SHARE_OF_REID, MOST_SHARE_OF_MACLENNAN = 0.85, 1.15
"""Shares of Reid's drag and of MacLennan's between which that of a net is asked to lie."""

NET_FINENESS_FACTOR = 0.5
"""Fineness of the nets in equilibrium, as a share of that of the files."""


@dataclass(frozen=True)
class WholeNet:
    """Net with its twine area (m²), and its drag (N) by towing speed (knots).

    ``built`` is the drag of the net as drawn, ``towed`` that in equilibrium. Speeds without a
    steady state are missing in ``towed``.
    """

    name: str
    area: float
    built: dict[float, float]
    towed: dict[float, float]

    @property
    def exponent(self) -> float:
        """Exponent of the drag in the speed, in equilibrium; NaN of a single one."""
        if len(self.towed) < 2:
            return float('nan')
        speeds, drags = np.log(list(self.towed)), np.log(list(self.towed.values()))
        return float(np.polyfit(speeds, drags, 1)[0])

    @property
    def inside(self) -> list[bool]:
        """True for each speed at which the drag as built is within the range asked for."""
        return [
            LEAST_SHARE_OF_REID * reid(self.area, knots)
            <= drag
            <= MOST_SHARE_OF_MACLENNAN * maclennan(self.area, knots)
            for knots, drag in self.built.items()
        ]


def whole_nets(names: Sequence[str]) -> list[WholeNet]:
    """Drag of these nets."""
    nets = []
    for name in names:
        gear = load_gear(name)
        model = build_model(gear)
        area = sum(bar.area * bar.rest for bar in model.net_mesh.bars)
        built = {knots: drag_of_model(model, knots) for knots in DRAG_SPEEDS_KN}
        coarse = build_model(gear.refined(net=NET_FINENESS_FACTOR))
        nets.append(WholeNet(name, float(area), built, _towed(coarse, NETS[name])))
    return nets


def _towed(model: GearModel, warp: float) -> dict[float, float]:
    drags = {}
    for knots in TOWED:
        try:
            found = steady_state(model, warp, knots * KNOT).equilibrium
        except NoSteadyState:
            continue
        drags[knots] = drag_of_net(model, found.state, found.tow)
    return drags


def nets_table(nets: Sequence[WholeNet]) -> TextTable:
    """Drag of nets over that of the formulas."""
    lines = []
    for net in nets:
        for how, drags in (('built', net.built), ('equilibrium', net.towed)):
            for knots, drag in drags.items():
                lines.append(
                    (
                        net.name,
                        how,
                        f'{knots:g}',
                        f'{1e-3 * drag:.1f}',
                        f'{drag / reid(net.area, knots):.2f}',
                        f'{drag / maclennan(net.area, knots):.2f}',
                        f'{net.exponent:.2f}' if how == 'equilibrium' else '',
                    )
                )
    return TextTable(
        'Drag of whole nets, without boards, bridles and warps.',
        ('gear', 'shape', 'speed (kn)', 'drag (kN)', 'over Reid', 'over MacLennan', 'exponent'),
        tuple(lines),
    )
