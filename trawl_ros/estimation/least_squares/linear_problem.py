# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bounded linear least-squares problem: blocks of data with shared and own parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.least_squares.information import Information, Joined, joined, own_values

Place = Sequence[FloatArray]
"""Parameters (p,) of each block, in units of their prior std."""


@dataclass(frozen=True)
class LinearProblem:
    """Least-squares problem, linearised at a place, with normal priors about 0.

    Attributes
    ----------
    blocks
        Information of each block of data on its p parameters.
    precisions : sequence of (p,) arrays
        Prior precisions; those of the shared parameters are taken from the first block.
    here : sequence of (p,) arrays
        Place of the linearisation.
    low, high : (s,) arrays
        Bounds of the shared parameters, the first of each block.
    watched
        Number of the parameters, the first, whose steps are measured.
    """

    blocks: Sequence[Information]
    precisions: Sequence[FloatArray]
    here: Place
    low: FloatArray
    high: FloatArray
    watched: int

    @property
    def shared(self) -> int:
        """Number s of the shared parameters."""
        return len(self.low)

    @cached_property
    def joined(self) -> Joined:
        """Information of all blocks on the shared parameters."""
        return joined(self.blocks, self.precisions, self.shared)

    @cached_property
    def std(self) -> FloatArray:
        """Posterior std (s,) of the shared parameters."""
        return np.sqrt(np.diag(self.joined.covariance))

    def target(self, damping: float = 0.0) -> list[FloatArray]:
        """Return the place of least cost within the bounds.

        Parameters
        ----------
        damping
            Weight of staying here, as a part of the prior precision (Levenberg-Marquardt); 0 is
            Gauss-Newton.

        Returns
        -------
        list of (p,) arrays
            Parameters of each block.
        """
        blocks, found = self.blocks, self.joined
        if damping:
            each = zip(blocks, self.precisions, self.here, strict=True)
            blocks = [block.damped(precision, at, damping) for block, precision, at in each]
            found = joined(blocks, self.precisions, self.shared)
        # Where neither data nor prior say anything, the least information that has a root.
        matrix = found.posterior + 1e-14 * np.trace(found.posterior) * np.eye(self.shared)
        triangle = cholesky(matrix)
        right = np.linalg.solve(triangle.T, found.right)
        # Imported here: it takes a node's start long, and no node steps before a tow has begun.
        from scipy.optimize import lsq_linear

        common = lsq_linear(triangle, right, (self.low, self.high), 'bvls', max_iter=300).x
        return [
            np.concatenate((common, own_values(block, precision, common)))
            for block, precision in zip(blocks, self.precisions, strict=True)
        ]

    def projected(self, place: Place, free: Sequence[BoolArray]) -> list[FloatArray]:
        """Return a place with some parameters at their best, given all others.

        Parameters
        ----------
        place
            Parameters of each block.
        free : sequence of (p,) arrays
            Flags of the parameters that are found.
        """
        blocks, precisions = [], []
        for block, precision, z, own in zip(self.blocks, self.precisions, place, free, strict=True):
            left = block.about(np.where(own, 0.0, -z))
            matrix = left.matrix[np.ix_(own, own)]
            blocks.append(Information(matrix, left.right[own], left.square, left.log_determinant))
            precisions.append(precision[own])
        found = joined(blocks, precisions, int(np.sum(free[0][: self.shared])))
        common: FloatArray = np.asarray(np.linalg.solve(found.posterior, found.right), np.float64)
        best = [np.array(z) for z in place]
        for z, own, block, precision in zip(best, free, blocks, precisions, strict=True):
            z[own] = np.concatenate((common, own_values(block, precision, common)))
        return best

    def distance(self, place: Place) -> float:
        """Return the largest distance of a watched parameter from here, in posterior std."""
        own = slice(0, self.watched)
        return float(np.max(np.abs(place[0][own] - self.here[0][own]) / self.std[own]))

    def cost(self, place: Place) -> float:
        """Half the squares of the whitened residuals and of all parameters in prior std."""
        shared = self.shared
        total = 0.5 * float(np.sum((self.precisions[0] * place[0] ** 2)[:shared]))
        for block, z, precision in zip(self.blocks, place, self.precisions, strict=True):
            total += 0.5 * block.squared_misfit(z)
            total += 0.5 * float(np.sum((precision * z**2)[shared:]))
        return total

    def squared_misfit(self, place: Place) -> float:
        """Square of the whitened residuals of all blocks."""
        parts = zip(self.blocks, place, strict=True)
        return max(sum(block.squared_misfit(z) for block, z in parts), 0.0)
