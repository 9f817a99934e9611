# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Record of a tow in motion at a point: predicted means of its stretches, and their derivatives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.linearisation import STARTS, Linearisation
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint


@dataclass(frozen=True)
class LinearisedTow:
    """Tow at a point, in n stretches by k channels.

    Attributes
    ----------
    tow, point
        The tow, and where it is linearised.
    values : (n, k) array
        Predicted means; NaN in stretches that are left out.
    by
        Derivatives (n, k, m) by each group of parameters: ``coefficients``, ``added_mass``, ``net``
        (drag and weight, where they are estimated), ``examined`` (values of the effects that are
        examined, of what they do to the gear and its inputs), ``errors`` (a std of each of
        `INPUT_ERRORS`), ``starts`` (amplitudes, m, of the slowest motions with which each part may
        begin), and each input's error at its knots, per SI unit, by the input's name.
    left_out
        Stretches that cannot be predicted, and why.
    """

    tow: MovingTow
    point: TowedPoint
    values: FloatArray
    by: Mapping[str, FloatArray]
    left_out: tuple[LeftOut, ...]

    @classmethod
    def of(
        cls, tow: MovingTow, point: TowedPoint, gear: TowedGear,
        means: Sequence[Linearisation | None], left_out: tuple[LeftOut, ...],
    ) -> 'LinearisedTow':  # fmt: skip
        """Gather predictions of the stretches of a tow, in their order; None where there is none.

        A prediction may have fewer columns of a group than the tow: the others are zero.
        """
        widths = {
            'coefficients': len(point.coefficients),
            'added_mass': 1,
            'net': gear.of_net,
            'examined': sum(len(effect.parameters) for effect in gear.examined),
            'errors': len(INPUT_ERRORS),
            STARTS: tow.starts,
            **{knots.channel: knots.number for knots in tow.inputs.knots},
        }
        values = np.full(tow.means.shape, np.nan)
        by = {name: np.zeros((*tow.means.shape, width)) for name, width in widths.items()}
        for stretch, found in enumerate(means[: len(tow)]):
            if found is None:
                continue
            values[stretch] = found.values
            for name, slopes in found.by.items():
                width = min(slopes.shape[1], widths[name])
                by[name][stretch, :, :width] = slopes[:, :width]
        by['net'] /= point.net[: gear.of_net]
        return cls(tow, point, values, by, left_out)

    @property
    def towed(self) -> BoolArray:
        """Flags (n,) of the stretches that are not left out."""
        return np.asarray(np.isfinite(self.values).any(axis=1), np.bool_)

    @property
    def residual(self) -> FloatArray:
        """Measured minus predicted means (n, k), NaN where either is missing."""
        return self.tow.means - self.values
