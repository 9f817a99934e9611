"""All windows beside the model at one set of coefficients: cost, rows, what is known."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trawl_ros.identification.estimate import Knowledge, know
from trawl_ros.identification.estimator_options import EstimatorOptions
from trawl_ros.identification.linearised import Linearised
from trawl_ros.identification.objective import objective, paper_values, stack
from trawl_ros.identification.prior import BoardPrior
from trawl_ros.identification.whitening import Whitened, whiten


@dataclass(frozen=True)
class Fit:
    """Linearised windows, coefficients (12,), and the factor ``scale`` on the stated noise."""

    windows: tuple[Linearised, ...]
    coefficients: np.ndarray
    scale: float
    prior: BoardPrior
    options: EstimatorOptions

    @cached_property
    def residuals(self) -> list[np.ndarray]:
        """Measured minus predicted per window, to first order."""
        return [part.measured - part.predicted(self.coefficients) for part in self.windows]

    @cached_property
    def whitened(self) -> list[Whitened]:
        """The robust whitening of each window."""
        return self._whitened_by(self)

    @cached_property
    def cost(self) -> float:
        """Robust loss of all windows plus half the squared departure from the prior."""
        return self.cost_beside(self)

    def cost_beside(self, other: 'Fit') -> float:
        """The cost with the sensitivities to the inputs of another fit of the same windows.

        These set how much the errors of warp lengths and speed explain. A step is judged
        with them held still, as the step itself was found.
        """
        away = (self.coefficients - self.prior.start) / self.prior.std
        data = sum(part.cost for part in self._whitened_by(other))
        return float(data + 0.5 * self.options.prior_weight * away @ away)

    def _whitened_by(self, other: 'Fit') -> list[Whitened]:
        states = [part.window.state for part in self.windows]
        found = []
        for part, residual, peer in zip(self.windows, self.residuals, other.windows, strict=True):
            number = states.count(part.window.state)
            found.append(
                whiten(
                    residual,
                    self.scale * part.std(number),
                    peer.by_inputs,
                    self.scale * part.input_std(number),
                    self.options.huber,
                )
            )
        return found

    @cached_property
    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Whitened sensitivities (m, 12) per prior std, and whitened residuals (m,)."""
        rows, rest = [np.zeros((0, len(self.coefficients)))], [np.zeros(0)]
        for part, residual, white in zip(self.windows, self.residuals, self.whitened, strict=True):
            rows.append(white.root @ part.by_coefficients * self.prior.std)
            rest.append(white.root @ residual)
        return np.vstack(rows), np.concatenate(rest)

    @cached_property
    def system(self) -> tuple[np.ndarray, np.ndarray]:
        """Square-root information, prior included: triangle (12, 12) and right side (12,).

        The step in prior std minimises ‖triangle · step − right side‖.
        """
        number = len(self.coefficients)
        root = np.sqrt(self.options.prior_weight)
        away = (self.prior.start - self.coefficients) / self.prior.std
        rows, rest = self.rows
        left = np.vstack((rows, root * np.eye(number)))
        right = np.concatenate((rest, root * away))
        _, triangle = np.linalg.qr(np.column_stack((left, right)))
        return triangle[:number, :-1], triangle[:number, -1]

    @cached_property
    def knowledge(self) -> Knowledge:
        """Covariance and singular directions."""
        return know(self.rows[0], self.prior.std, self.options.prior_weight)

    @property
    def std(self) -> np.ndarray:
        """Standard deviations (12,) of the coefficients."""
        return np.sqrt(np.diag(self.knowledge.covariance))

    @property
    def freedom(self) -> float:
        """Readings less the parameters they settle."""
        readings = sum(len(part.channels) for part in self.windows)
        return max(readings - self.knowledge.data_parameters, 0.0)

    @cached_property
    def objective(self) -> float:
        """Eq. 35, to first order around the last solutions."""
        predicted, measured = [], []
        for part in self.windows:
            values = part.predicted(self.coefficients)
            predicted.append(paper_values(dict(zip(part.channels, values, strict=True))))
            measured.append(paper_values(part.window.means))
        return objective(stack(predicted), stack(measured))

    def rescaled(self) -> 'Fit':
        """The same fit with the noise scale that its residuals tell.

        Clipped squares beside what they would be on normal noise (Huber's proposal 2), per
        degree of freedom, pooled with the imagined readings that speak for the stated noise.
        Never below 1: part of the stated noise is what stays wrong in every state alike,
        which the fit absorbs and residuals cannot show.
        """
        readings = sum(len(part.channels) for part in self.windows)
        if self.freedom <= 0.0:
            return self
        spread = sum(part.spread for part in self.whitened)
        expected = sum(part.expected for part in self.whitened)
        squared = self.scale**2 * spread / expected * readings / self.freedom
        stated = self.options.stated_noise_readings
        pooled = (stated + self.freedom * squared) / (stated + self.freedom)
        return replace(self, scale=max(1.0, float(np.sqrt(pooled))))
