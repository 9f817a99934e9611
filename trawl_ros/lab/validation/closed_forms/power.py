# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Power balance of a gear in motion: sources, sinks, and the energy it holds.

With v the velocities, v · (M a) = v · F at every instant: F is the sum of the model's own
forces and M its mass matrix. Each term of either side is taken from the functions that the solvers
use; none is found as what is left of the others.

A warp that is hauled keeps its number of segments: their unstretched lengths shrink all along it.
With strain energy E(s, l0) of a bar at its length s, E changes by T ds from its ends and by
∂E/∂l0 dl0 from the winch; the mass of the wire that goes takes its own energy of motion and
place along, from where it was.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model import line
from trawl_ros.model.assembly import (
    Points,
    bar_tensions,
    block_forces,
    board_loads,
    kite_load,
    lump_forces,
    mass,
    motion_of,
    points_of,
)
from trawl_ros.model.bar import SLACK_WIDTH
from trawl_ros.model.board import world_inertia
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.numerics import dot, length
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.stepper import Motion

Quantity = float | FloatArray

WORKS: Mapping[str, str] = MappingProxyType(
    {
        'ship': 'ship, at the blocks',
        'winches': 'winches, on the wire’s tension',
        'wire_moving': 'wire hauled in: its energy of motion',
        'wire_placed': 'wire hauled in: its weight in water at its depth',
        'ropes_drag': 'water, on ropes and netting',
        'lumps_drag': 'water, on knots, floats and clumps',
        'boards_drag': 'water, on the boards',
        'kite_drag': 'water, on the kite',
        'added_mass': 'water, by its inertia (added mass)',
        'damping': 'inner damping of the ropes',
    }
)
"""Terms of work on the gear, key → words."""

STORES: Mapping[str, str] = MappingProxyType(
    {
        'elastic': 'springs: elastic energy',
        'weight': 'weight and buoyancy: energy of place',
        'motion': 'motion: kinetic energy',
    }
)
"""Terms of energy in the gear, key → words."""


def strain_energy(strain: FloatArray) -> FloatArray:
    """Strain energy: integral of `line.taut`, per EA and unstretched length (eq. 20)."""
    w = SLACK_WIDTH
    corner = (np.clip(strain, -w, w) + w) ** 3 / (12.0 * w)
    above = np.maximum(strain, w)
    return corner + 0.5 * (above**2 - w**2)


@dataclass(frozen=True)
class Ledger:
    """Ledger of powers (W) and energies (J) of a moving gear.

    ``weightless`` is the same gear without gravity and ``massless`` without mass of its own, so
    that the model's own functions give drag alone and added mass alone.
    """

    model: GearModel
    weightless: GearModel
    massless: GearModel

    @classmethod
    def of(cls, model: GearModel) -> 'Ledger':
        """The ledger of a gear."""
        nothing = np.zeros_like
        return cls(
            model=model,
            weightless=replace(
                model,
                water=replace(model.water, gravity=0.0),
                board=replace(model.board, inertia=nothing(model.board.inertia)),
            ),
            massless=replace(
                model,
                bars=replace(model.bars, mass=nothing(model.bars.mass)),
                lump_mass=nothing(model.lump_mass),
                board=replace(model.board, mass=0.0, inertia=nothing(model.board.inertia)),
                kite=replace(model.kite, mass=0.0),
            ),
        )

    def powers(self, now: Motion, tow: Tow) -> FloatArray:
        """Powers of all terms in `WORKS`, W, positive where they add to the gear's energy."""
        model, state = self.model, now.state
        points = points_of(model, state, tow)
        bars = motion_of(model, points, tow)
        span = length(bars.vector)
        along = bars.vector / span[:, None]
        stretch = span / bars.rest
        tension = bar_tensions(model, state, tow)
        viscous = tension - model.bars.stiffness * line.taut(stretch - 1.0)[0]
        strain_rate = (dot(along, bars.stretching) - bars.rest_rate * stretch) / bars.rest
        strained = model.bars.stiffness * strain_energy(stretch - 1.0)
        body = np.concatenate([state.board_velocities, state.board_rates], axis=1)
        held = model.layout.kite
        kite_velocity = held.shares @ state.node_velocities[held.nodes]
        inertia = self.massless.pattern.matrix(mass(self.massless, state, tow))
        works = {
            'ship': -np.sum(block_forces(model, state, tow) * tow.block_velocities),
            'winches': np.sum((strained - tension * stretch) * bars.rest_rate),
            'wire_moving': np.sum(self._motion_per_metre(points) * bars.rest_rate),
            'wire_placed': np.sum(self._place_per_metre(bars.height) * bars.rest_rate),
            'ropes_drag': np.sum(line.drag(model.bars, bars, along, model.water) * bars.velocity),
            'lumps_drag': np.sum(lump_forces(self.weightless, state) * state.node_velocities),
            'boards_drag': np.sum(board_loads(self.weightless, state) * body),
            'kite_drag': kite_load(self.weightless, state) @ kite_velocity,
            'added_mass': -state.velocity @ (inertia @ now.acceleration),
            'damping': -np.sum(viscous * strain_rate * bars.rest),
        }
        return np.array([works[key] for key in WORKS])

    def energies(self, state: State, tow: Tow) -> FloatArray:
        """Energies of all terms in `STORES`, J."""
        model = self.model
        points = points_of(model, state, tow)
        bars = motion_of(model, points, tow)
        strain = length(bars.vector) / bars.rest - 1.0
        strained = model.bars.stiffness * bars.rest * strain_energy(strain)
        board, kite, lumps = model.board, model.kite, state.nodes[:, 2]
        held = model.layout.kite
        place = np.sum(self._place_per_metre(bars.height) * bars.rest)
        place += np.sum(self._place(model.lump_mass, model.lump_volume, lumps))
        place += np.sum(self._place(board.mass, board.volume, state.board_positions[:, 2]))
        place += np.sum(self._place(kite.mass, kite.volume, held.shares @ lumps[held.nodes]))
        node_mass = model.lump_mass.copy()
        np.add.at(node_mass, held.nodes, held.shares * kite.mass)
        moving = np.sum(self._motion_per_metre(points) * bars.rest)
        moving += 0.5 * np.sum(node_mass * dot(state.node_velocities, state.node_velocities))
        moving += 0.5 * board.mass * np.sum(state.board_velocities**2)
        inertia = world_inertia(board, OUTWARD, state.board_rotations)
        moving += 0.5 * np.einsum('si,sij,sj->', state.board_rates, inertia, state.board_rates)
        stores = {'elastic': np.sum(strained), 'weight': place, 'motion': moving}
        return np.array([stores[key] for key in STORES])

    def drum_power(self, state: State, tow: Tow) -> float:
        """Power of winches that take the wire in at the block: tension there times rate, W."""
        pull = length(block_forces(self.model, state, tow))
        return -float(np.sum(pull * tow.length_rates))

    def _place(self, own: Quantity, volume: Quantity, height: FloatArray) -> FloatArray:
        """Potential energy of weight and buoyancy of masses (kg) at heights (m), J."""
        water = self.model.water
        heavy = own - water.density * volume
        return water.gravity * (heavy * height + 0.5 * water.density_gradient * volume * height**2)

    def _place_per_metre(self, height: FloatArray) -> FloatArray:
        """Potential energy of bars (m,) per metre, at heights of their middle, J/m."""
        return self._place(self.model.bars.mass, self.model.bars.volume, height)

    def _motion_per_metre(self, points: Points) -> FloatArray:
        """Kinetic energy of bars (m,), half their mass at either end, J/m.

        The half at a block moves with the ship and is no part of the gear.
        """
        square = dot(points.velocities, points.velocities)
        square[self.model.nodes + 6 :] = 0.0
        energies: FloatArray = 0.25 * self.model.bars.mass * square[self.model.ends].sum(1)
        return energies
