# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Linearisation, at one place, of tows that grow."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.nuisances import TowLayout, point_of
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.lineariser import TowLineariser
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear


@dataclass(frozen=True)
class InputsPlace:
    """Errors of a tow's inputs, however long it is.

    ``errors`` (e,) stay, in std; ``drifts`` are those at the knots of each input, SI.
    """

    errors: FloatArray
    drifts: tuple[FloatArray, ...]

    def along(self, tow: MovingTow) -> FloatArray:
        """Drifts (knots,) at all knots of a tow, nought at those that are new."""
        every = np.zeros(tow.inputs.number_of_knots)
        for (_, own, _), drifts in zip(tow.inputs.knot_places, self.drifts, strict=False):
            known = min(own.stop - own.start, len(drifts))
            every[own.start : own.start + known] = drifts[:known]
        return every


NO_ERRORS = InputsPlace(np.zeros(len(INPUT_ERRORS)), ())


class GrowingLinearisation:
    """Linearisation of tows, by the stamps of their beginnings, which grow.

    Parameters
    ----------
    gear, prior
        The gear that is towed, and the prior of its coefficients.
    tows, layouts
        Tows as they are.
    place
        Parameters (p,) of each, in prior std, at which they are linearised.
    """

    def __init__(
        self,
        gear: TowedGear,
        prior: ParameterVector,
        tows: Sequence[MovingTow],
        layouts: Sequence[TowLayout],
        place: Sequence[FloatArray],
    ) -> None:
        self._gear = gear
        self._shared = place[0][: layouts[0].shared].copy()
        self._inputs: dict[int, InputsPlace] = {}
        for tow, layout, z in zip(tows, layouts, place, strict=True):
            point = point_of(tow, layout, z, prior.start, prior.std)
            self._point = point
            drifts = tuple(point.drifts[own] for _, own, _ in tow.inputs.knot_places)
            self._inputs[tow.start_ns] = InputsPlace(point.errors, drifts)
        self._towed: dict[int, TowLineariser] = {}

    def extend(self, tows: Sequence[MovingTow], most: int | None = None) -> bool:
        """Tow on along what is new of the tows.

        Parameters
        ----------
        tows
            As they are now.
        most
            Number of stretches that are towed along at most.

        Returns
        -------
        bool
            True if nothing is left to tow along.
        """
        left = most
        for tow in tows:
            known = self._towed.get(tow.start_ns)
            if known is None or known.channels != tow.channels:
                known = self._begin(tow)
            done = known.extend(tow, self._of(tow).along(tow), left)
            left = None if left is None else left - done
        return all(len(self._towed[tow.start_ns]) >= len(tow) for tow in tows)

    def _begin(self, tow: MovingTow) -> TowLineariser:
        inputs = self._of(tow)
        point = replace(self._point, errors=inputs.errors, drifts=inputs.along(tow))
        begun = TowLineariser(self._gear, tow.channels, point)
        self._towed[tow.start_ns] = begun
        return begun

    def _of(self, tow: MovingTow) -> InputsPlace:
        return self._inputs.get(tow.start_ns, NO_ERRORS)

    def linearised(self, tows: Sequence[MovingTow]) -> tuple[LinearisedTow, ...]:
        """Tows as they are linearised, nothing of which is left to tow along."""
        return tuple(self._towed[tow.start_ns].linearised(tow) for tow in tows)

    def place(self, tows: Sequence[MovingTow], layouts: Sequence[TowLayout]) -> list[FloatArray]:
        """Parameters (p,) of each tow, in prior std, at which it is linearised."""
        found = []
        for tow, layout in zip(tows, layouts, strict=True):
            z, inputs = np.zeros(len(layout)), self._of(tow)
            z[: layout.shared], z[layout.slices['errors']] = self._shared, inputs.errors
            drifts = inputs.along(tow)
            if drifts.any():
                # Roots change with the log's scatter as a tow grows, and drifts stay.
                for knots, own, _ in tow.inputs.knot_places:
                    z[layout.slices[knots.channel]] = np.linalg.solve(knots.root, drifts[own])
            found.append(z)
        return found
