# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Detectable size of a hidden effect, from the plant's own likelihood.

The plant is linearised around its board. The change by the effect is compared with the errors of
the instruments, and with what the coefficients could reproduce. No detector is used.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import norm

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.holdout import split
from trawl_ros.diagnosis.inference.blocks import ErrorSize, blocks_of
from trawl_ros.diagnosis.inference.candidates import Candidate, signatures, values_vector
from trawl_ros.diagnosis.inference.marginal import Marginal, marginal
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.refit import OPTIONS
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.lab.trials.plant import Plant
from trawl_ros.lab.trials.readings import SENSED_CHANNELS
from trawl_ros.lab.trials.tows import FULL_PLAN, BlindTrialPlan
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

FALSE_ALARM = 0.01 / 30.0
"""False-alarm probability of each of about thirty tests, for 1 % over all of them."""

DETECTED_SIGMAS = float(norm.isf(0.5 * FALSE_ALARM)) + InferenceOptions().power_quantile
"""Strength in standard deviations that is detected in 80 % of cases."""

ERRORS_AS_STATED = ErrorSize(calibration=1.0, model=1.0, form=0.0)
"""Size of errors where each is as it is stated."""

MAX_PROBES = 10
"""Largest number of probes near the wanted size."""

SIZE_TOLERANCE = 0.05
"""Relative tolerance of a size."""


@dataclass(frozen=True)
class Likelihood:
    """Likelihood of the plant, linearised around its board in the fitted windows."""

    plant: Plant
    fit: Fit
    plan: BlindTrialPlan

    def detectable(self, hidden: Hidden, sign: float, *, after_catalogue: bool) -> float:
        """Smallest size that is detected in 80 % of trials, infinite if no possible one is.

        Parameters
        ----------
        hidden, sign
            The effect, and to which side.
        after_catalogue
            True if what the best effect of the catalogue could mimic does not count.

        Returns
        -------
        float
            In units of the effect; of what is there as a whole or not at all, the part of its
            strength that would do.
        """
        most = hidden.most[0] if sign < 0.0 else hidden.most[1]
        size, low, high, enough = min(hidden.probe, most), 0.0, np.inf, np.inf
        for _ in range(MAX_PROBES):
            try:
                seen = self._sigmas(hidden, sign * size, after_catalogue)
            except NoSteadyState:
                high, size = size, 0.5 * (low + size)
                continue
            if seen <= 0.0:
                return np.inf
            wanted = size * DETECTED_SIGMAS / seen
            close = abs(wanted / size - 1.0) < SIZE_TOLERANCE
            if close or hidden.whole or (wanted > most and np.isinf(high)):
                return float(wanted)
            if wanted > size:
                low = size
            else:
                high = enough = size
            # A gear that leans far to one side does so at some size, and hardly before.
            size = wanted if low < wanted < high else 0.5 * (low + high)
        # Beyond what is too small to be seen the gear cannot be towed, or it is that strong.
        return float(enough)

    def _sigmas(self, hidden: Hidden, size: float, after_catalogue: bool) -> float:
        """Strength of an effect in standard deviations."""
        changed = self.plant.towed([(hidden, size)], self.plan)
        rows = [OBSERVABLES.index(name) for name in SENSED_CHANNELS]
        columns = [
            (there.values - clean.values)[rows][:, None]
            for there, clean in zip(_flat(changed), self._clean, strict=True)
        ]
        chosen = {part.window.index for part in self.fit.windows}
        columns = [own for number, own in enumerate(columns) if number in chosen]
        if not after_catalogue:
            return float(np.sqrt(self._information(columns).information[0, 0]))
        mimics = self._mimics
        both = [np.hstack((own, other)) for own, other in zip(columns, mimics, strict=True)]
        found = self._information(both)
        left = [found.information[0, 0]]
        for block in values_vector(self.wanted).blocks('effect'):
            cosine = found.covered([0], np.ones(1), [place + 1 for place in block])
            left.append(found.information[0, 0] * (1.0 - cosine**2))
        return float(np.sqrt(max(0.0, min(left))))

    @cached_property
    def _clean(self) -> list[LinearisedState]:
        return _flat(self.plant.towed((), self.plan))

    def _information(self, columns: Sequence[FloatArray]) -> Marginal:
        return marginal(blocks_of(self.fit, columns, errors=ERRORS_AS_STATED))

    @cached_property
    def wanted(self) -> tuple[Candidate, ...]:
        """All effects of the catalogue, from each start."""
        depths = np.array([part.window.means['net_depth'] for part in self.fit.windows])
        return tuple(
            Candidate(effect, start, place)
            for effect in catalogue().values()
            if effect.fitted
            for place, start in enumerate(effect.starts(depths))
        )

    @cached_property
    def _mimics(self) -> list[FloatArray]:
        predictor = Predictor(self.plant.model, without=frozenset(range(self.plan.baseline)))
        return signatures(predictor, self.fit.windows, self.wanted)


def likelihood(
    plant: Plant,
    prior: ParameterVector,
    windows: Sequence[SteadyWindow],
    plan: BlindTrialPlan = FULL_PLAN,
) -> Likelihood:
    """Linearise a plant.

    Parameters
    ----------
    plant
        The plant.
    prior
        Prior of the boards.
    windows
        All windows of the plan, with nothing hidden and without noise, their indices in the order
        of the plan; those that are not held out are used.
    plan
        Tows of the trial.
    """
    fitted = {window.index for window in split(windows, frozenset(range(plan.baseline))).fitted}
    rows = [OBSERVABLES.index(name) for name in SENSED_CHANNELS]
    parts = []
    states = [state for tow in plan.tows for state in tow.states]
    for window, state in zip(windows, states, strict=True):
        if window.index not in fitted:
            continue
        clean = plant.clean[state]
        parts.append(
            Linearised(
                window=window,
                channels=SENSED_CHANNELS,
                at=plant.coefficients,
                inputs=np.array(clean.look.inputs),
                net=np.ones(2),
                measured=clean.look.values[rows],
                values=clean.look.values[rows],
                by_coefficients=clean.look.by_coefficients[rows],
                by_inputs=clean.look.by_inputs[rows],
                by_net=np.zeros((len(rows), 2)),
                slow=clean.slow[rows],
                state=clean.state,
            )
        )
    fit = Fit(tuple(parts), plant.coefficients, AS_STATED, prior, OPTIONS)
    return Likelihood(plant, fit, plan)


def _flat(tows: Sequence[Sequence[LinearisedState]]) -> list[LinearisedState]:
    return [look for tow in tows for look in tow]
