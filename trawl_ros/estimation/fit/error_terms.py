# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Error budget of the readings of a tow: error terms and their course over its windows.

Four kinds of error stand between a reading and the model: those of the single reading (scatter,
and what changes from one steady state to the next), those of the window's measured warp
lengths and speed and of a gear not quite at rest, calibration, which is wrong alike throughout
a tow, and the model's own, alike in all tows.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterGroup, ParameterVector, nuisance
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED


def group_of(channel: str) -> str:
    """Return the name of the quantity, which is the same for both sides."""
    return channel.removeprefix('port_').removeprefix('starboard_')


GROUPS = tuple(dict.fromkeys(map(group_of, MEASURED)))
"""Measured quantities; sensors of both sides are alike."""

GROUP_OF = np.array([GROUPS.index(group_of(name)) for name in MEASURED])
"""Index into `GROUPS` of each channel (k,)."""

MODEL_FRACTION = 0.003
MODEL_ANGLE = np.radians(0.2)
"""Std of what the model itself is wrong by, a part of the value, and for pitch and roll an angle
(rad). Assumed; ``make study NAME=coverage`` measures what a gear of twice as fine warps and
bridles and a net without joined meshes shows more than the default."""

USUAL_LENGTH, LONGER = 500.0, 1.5
"""The errors of the model at other lengths of warp differ from those at this one (m), and the more
so with every factor."""


@dataclass(frozen=True)
class Scheme:
    """Error scheme: division of errors among readings, steady states, tows and model.

    Attributes
    ----------
    state_share
        Part of a channel's bias, in std, that changes from one steady state to the next, where
        the channel table has nothing measured (`Channel.state_std`); the rest stays through the
        tow. At 0 nothing changes with the state.
    model_error
        Factor on the model's own errors; 0 is a model taken to be exact.
    model_trend
        By so many of their std these errors change where the warps are `LONGER` times as long.
    net_drag, net_weight
        Std of the factors on the net's drag and weight in water; where both are 0 the net is held.
    unsettled
        Std, as a part of the net's depth, of what is still to come of the gear's slowest motion
        in a window that is steady to the eye.
    """

    state_share: float = 0.3
    model_error: float = 1.0
    model_trend: float = 0.0
    unsettled: float = 0.05
    net_drag: float = 0.0
    net_weight: float = 0.0

    @classmethod
    def of(cls, options: EstimatorOptions) -> 'Scheme':
        """Error scheme of an estimator's options."""
        return cls(
            options.state_share,
            options.model_error,
            options.model_trend,
            options.unsettled,
            options.net_drag,
            options.net_weight,
        )

    @property
    def net_std(self) -> FloatArray:
        """Prior std of the net's factors (2,) on drag and weight."""
        return np.array([self.net_drag, self.net_weight])

    @property
    def model_errors(self) -> ParameterVector:
        """Errors of the model: one per group, then of their trends, and the net's factors."""
        return _model_errors(self.model_trend != 0.0, bool(self.net_std.any()))

    @property
    def tow_share(self) -> float:
        """Part of a bias in std that stays through the tow."""
        return float(np.sqrt(1.0 - self.state_share**2))


@dataclass(frozen=True)
class ErrorTerm:
    """Calibration error: the channel or input it belongs to, and its std there.

    ``relative`` errors are parts of the value, others are in the channel's unit.
    """

    channel: str
    std: float
    relative: bool


TERMS = tuple(
    ErrorTerm(name, std, relative)
    for name in (*MEASURED, *INPUTS)
    for std, relative in ((CHANNELS[name].bias, False), (CHANNELS[name].bias_fraction, True))
    if std > 0.0
)
"""Errors of calibration of one tow."""

CALIBRATION = nuisance(
    ParameterGroup('calibration', tuple(term.channel for term in TERMS), ('std',) * len(TERMS))
)
"""The same as parameters."""


@cache
def _model_errors(trend: bool, net: bool) -> ParameterVector:
    groups = [ParameterGroup('model', GROUPS, ('std',) * len(GROUPS))]
    if trend:
        longer = tuple(f'{name} by length' for name in GROUPS)
        groups.append(ParameterGroup('model', longer, ('std',) * len(GROUPS)))
    if net:
        groups.append(ParameterGroup('net', ('drag', 'weight'), ('std', 'std')))
    return nuisance(*groups)


@dataclass(frozen=True)
class TowErrors:
    """Errors of one tow: n windows by k channels (in the order of `MEASURED`).

    Attributes
    ----------
    rows : (n,) int array
        Indices into all windows.
    present : (n, k) bool array
        True if a window has the channel; all else is 0 where it has not.
    noise : (n, k) array
        Std of the single reading's own error as stated, 1 where absent.
    numbers : (n, k) array
        Number of independent readings of each: all windows of a state share what
        changes with the state.
    inputs : (n, k, 4) array
        Change by one std in warp lengths, speed and rest of this window.
    input_std : (n, 3) array
        The std of warp lengths (m) and speed (m/s).
    calibration : (n, k, p) array
        Change by one std of each of `TERMS`.
    input_calibration : (n, 3, p) array
        By how much one std of each of `TERMS` makes warp lengths and speed read too large.
    model : (n, k, m) array
        Change by one std of each of `Scheme.model_errors`.
    """

    rows: IntArray
    present: BoolArray
    noise: FloatArray
    numbers: FloatArray
    inputs: FloatArray
    input_std: FloatArray
    calibration: FloatArray
    input_calibration: FloatArray
    model: FloatArray


def in_all_channels(linear: Linearised, values: FloatArray) -> FloatArray:
    """Rows of a window's channels scattered among all channels, 0 for those it has not.

    Parameters
    ----------
    linear
        The window.
    values
        (channels of the window, ...) array.
    """
    full = np.zeros((len(MEASURED), *values.shape[1:]))
    full[[MEASURED.index(name) for name in linear.channels]] = values
    return full


def tow_errors(linearised: Sequence[Linearised], scheme: Scheme) -> tuple[TowErrors, ...]:
    """Errors of all windows, tow by tow.

    Parameters
    ----------
    linearised
        Linearised windows of any tows.
    scheme
        Scheme of the errors.
    """
    states = [linear.window.state for linear in linearised]
    in_state = {state: states.count(state) for state in set(states)}
    usual = _usual_noise([linear.window for linear in linearised])
    tows: dict[int, list[int]] = {}
    for row, linear in enumerate(linearised):
        tows.setdefault(linear.window.tow, []).append(row)
    return tuple(
        _of_one_tow(rows, [linearised[row] for row in rows], in_state, usual, scheme)
        for _, rows in sorted(tows.items())
    )


def _of_one_tow(
    rows: Sequence[int],
    linearised: Sequence[Linearised],
    in_state: Mapping[int, int],
    usual: Mapping[str, float],
    scheme: Scheme,
) -> TowErrors:
    present = np.array([[name in linear.channels for name in MEASURED] for linear in linearised])
    by_inputs = np.array([in_all_channels(linear, linear.by_inputs) for linear in linearised])
    own = np.array(
        [
            [_own_std(linear, name, in_state, usual, scheme) for name in MEASURED]
            for linear in linearised
        ]
    )
    alone = np.array(
        [[_own_std(linear, name, {linear.window.state: 1}, usual, scheme) for name in MEASURED]
         for linear in linearised]
    )  # fmt: skip
    input_std = np.array(
        [
            [_own_std(linear, name, in_state, usual, scheme) for name in INPUTS]
            for linear in linearised
        ]
    )
    slow = np.array([_unsettled(linear, in_state, scheme) for linear in linearised])
    return TowErrors(
        rows=np.array(rows),
        present=present,
        noise=own,
        numbers=present * alone**2 / own**2,
        inputs=np.concatenate((by_inputs * input_std[:, None, :], slow[:, :, None]), axis=2),
        input_std=input_std,
        calibration=np.array([_calibration(linear, scheme) for linear in linearised]),
        input_calibration=np.array([_of_inputs(linear, scheme) for linear in linearised]),
        model=np.array([_model(linear, scheme) for linear in linearised]),
    )


def _usual_noise(windows: Sequence[SteadyWindow]) -> dict[str, float]:
    """Median over windows of each quantity's noise."""
    by_group: dict[str, list[float]] = {}
    for window in windows:
        for name, noise in window.noise.items():
            by_group.setdefault(group_of(name), []).append(noise)
    return {group: float(np.median(noise)) for group, noise in by_group.items()}


def _own_std(
    linear: Linearised,
    name: str,
    in_state: Mapping[int, int],
    usual: Mapping[str, float],
    scheme: Scheme,
) -> float:
    window = linear.window
    if name not in window.means or (name in MEASURED and name not in linear.channels):
        return 1.0
    # All windows of a state share what changes with it, so their number must not wear it down.
    state_std = CHANNELS[name].state_std(window.bias[name], scheme.state_share)
    changing = in_state[window.state] * state_std**2
    # Some thirty readings tell their own noise badly: one that seems small is small by chance.
    noise = window.own_noise(name, usual[group_of(name)])
    return float(np.sqrt(noise**2 + changing))


def _unsettled(linear: Linearised, in_state: Mapping[int, int], scheme: Scheme) -> FloatArray:
    depth = linear.window.means.get('net_depth', 0.0)
    # The windows of one state have the same unsettled motion.
    size = scheme.unsettled * abs(depth) * np.sqrt(in_state[linear.window.state])
    return in_all_channels(linear, size * linear.slow)


def _calibration(linear: Linearised, scheme: Scheme) -> FloatArray:
    # An input read too large makes the prediction differ, not the reading.
    columns = -in_all_channels(linear, linear.by_inputs) @ _of_inputs(linear, scheme)
    for column, term in enumerate(TERMS):
        if term.channel in linear.channels:
            columns[MEASURED.index(term.channel), column] = _size(linear, term, scheme)
    return columns


def _of_inputs(linear: Linearised, scheme: Scheme) -> FloatArray:
    columns = np.zeros((len(INPUTS), len(TERMS)))
    for column, term in enumerate(TERMS):
        if term.channel in INPUTS:
            columns[INPUTS.index(term.channel), column] = _size(linear, term, scheme)
    return columns


def _size(linear: Linearised, term: ErrorTerm, scheme: Scheme) -> float:
    mean = linear.window.means[term.channel]
    return scheme.tow_share * term.std * (mean if term.relative else 1.0)


def _model(linear: Linearised, scheme: Scheme) -> FloatArray:
    columns = np.zeros((len(MEASURED), len(GROUPS)))
    for name, value in zip(linear.channels, linear.values, strict=True):
        row = MEASURED.index(name)
        size = MODEL_ANGLE if CHANNELS[name].unit == 'rad' else MODEL_FRACTION * abs(value)
        columns[row, GROUP_OF[row]] = scheme.model_error * size
    if scheme.model_trend:
        length = 0.5 * (
            linear.window.means['port_length'] + linear.window.means['starboard_length']
        )
        longer = np.log(length / USUAL_LENGTH) / np.log(LONGER)
        columns = np.hstack((columns, scheme.model_trend * longer * columns))
    if not scheme.net_std.any():
        return columns
    return np.hstack((columns, in_all_channels(linear, linear.by_net) * scheme.net_std))
