# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Catch on the codend's line: its place, and its lumps at the nodes there."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.gear.catch import CatchBody, CatchRecord, catch_body
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.model.net.planned_cloth import sections_of
from trawl_ros.model.net.rows import Profile
from trawl_ros.model.net.weave import NetMesh

MAX_ITERATIONS = 20
"""Iterations after which the catch and the circumference in its middle agree."""


@dataclass(frozen=True)
class CodendCatch:
    """Catch in the codend of a net.

    Attributes
    ----------
    body
        Its radius, length and volume.
    covered : (n,) array
        Part of the codend before each node of the net that is full, 0 for all other nodes.
    shares : (n,) array
        Parts of the catch at the nodes; their sum is 1.
    """

    body: CatchBody
    covered: FloatArray
    shares: FloatArray

    def lumps(self, catch: CatchRecord, density: float) -> FloatArray:
        """Mass (kg), volume, drag area C_D S (m²) and added mass over density (m³) at the nodes.

        Rows of an array (4, n), in water of a density (kg/m³).

        The water between the fish moves with them. The added mass is that of a sphere, half of
        the volume.
        """
        fish = catch.mass_kg / catch.density_kg_m3
        volume = self.body.volume
        whole = (
            catch.mass_kg + density * (volume - fish),
            volume,
            catch.drag_coefficient * self.body.cross_section,
            0.5 * volume,
        )
        return np.outer(whole, self.shares)


def place_catch(catch: CatchRecord, net: NettingRecord, mesh: NetMesh) -> CodendCatch:
    """Place a catch at the end of a net's codend.

    Raises
    ------
    GearError
        If it is longer than the codend.
    """
    profile = Profile(net.codend, net)
    if net.plan is not None:
        profile = sections_of(net, net.plan, 'codend', 'upper')
    behind = 0.0
    for _ in range(MAX_ITERATIONS):
        section, circumference = profile.at(profile.length - behind)
        body = catch_body(catch, float(circumference), square=section.square)
        behind = min(0.5 * body.length, profile.length)
    if body.length > profile.length:
        raise GearError(
            f'catch.mass_kg: found {catch.mass_kg:g} kg, which fill {body.length:.3g} m, expected '
            f'no more than the {profile.length:.3g} m of the codend hold'
        )
    count, nodes = net.codend_segments, len(mesh.positions)
    steps = np.array([bar.rest for bar in mesh.bars[-count + 1 :]])
    # The line is as long as the netting behind the last whole row; its bars are alike.
    ends = steps[0] * np.arange(count + 1)
    start = ends[-1] - body.length
    full = np.clip((ends[1:] - start) / steps[0], 0.0, 1.0)
    covered = np.zeros(nodes)
    covered[-count:] = full
    return CodendCatch(body, covered, covered / covered.sum())
