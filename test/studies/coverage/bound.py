"""Fisher information in the windows of a trial: the bound of any estimator."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.lab.trials.readings import Sensors
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES

ROWS = [OBSERVABLES.index(name) for name in MEASURED]


def information(tows: Sequence[Sequence[LinearisedState]], sensors: Sensors) -> FloatArray:
    """Fisher information (12, 12) of the coefficients in the windows of some tows.

    The covariance is the true one: noise of the windows' means, what changes with the state,
    offsets and errors of scale that go through a tow, and all of these of the warp lengths and
    speed, through the sensitivities.

    Parameters
    ----------
    tows
        Observables of the plant at the truth.
    sensors
        True errors of the instruments.
    """
    total = np.zeros((12, 12))
    for looks in tows:
        gain = np.vstack([look.by_coefficients[ROWS] for look in looks])
        whitened = np.linalg.solve(np.linalg.cholesky(_covariance(looks, sensors)), gain)
        total += whitened.T @ whitened
    return total


def _covariance(looks: Sequence[LinearisedState], sensors: Sensors) -> FloatArray:
    """Covariance of measured less predicted at the measured inputs, over all windows of a tow."""
    blocks = []
    for look in looks:
        own, inputs = (
            np.diag(
                [
                    sensors.mean_std(name) ** 2 + sensors.state_std(name, _size(look, name)) ** 2
                    for name in names
                ]
            )
            for names in (MEASURED, INPUTS)
        )
        sensitivity = look.by_inputs[ROWS]
        blocks.append(own + sensitivity @ inputs @ sensitivity.T)
    columns = []
    for name in (*MEASURED, *INPUTS):
        channel, factor = CHANNELS[name], sensors.factor(name)
        offset = np.concatenate([_effect(look, name) for look in looks])
        scale = np.concatenate([_effect(look, name) * _size(look, name) for look in looks])
        columns += [factor * channel.bias * offset, factor * channel.bias_fraction * scale]
    shared = np.column_stack(columns)
    covariance: FloatArray = np.asarray(block_diag(*blocks)) + shared @ shared.T
    return covariance


def _effect(look: LinearisedState, name: str) -> FloatArray:
    """Sensitivity (k,) of the residuals to an offset of a channel or input."""
    if name in INPUTS:
        return -look.by_inputs[ROWS, INPUTS.index(name)]
    return np.array([float(name == other) for other in MEASURED])


def _size(look: LinearisedState, name: str) -> float:
    return float(look.inputs[INPUTS.index(name)]) if name in INPUTS else look[name]
