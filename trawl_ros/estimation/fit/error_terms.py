# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Error budget of the readings of a tow.

A reading differs from the model by four kinds of error:

- of the single reading: noise, and an offset that changes from one steady state to the next;
- of the window: measured warp lengths and speed, and a gear that still settles a little;
- of calibration, the same throughout a tow;
- of the model, the same in all tows.
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
"""Std of the error of the model, as a fraction of the value; assumed. ``make study NAME=coverage``
compares the default mesh with twice as fine warps and bridles and a net without joined meshes."""
MODEL_ANGLE = np.radians(0.2)
"""The same for pitch and roll, rad."""

USUAL_LENGTH, LONGER = 500.0, 1.5
"""Warp length (m) at which the error of the model has no trend, and the factor on this length at
which the trend is one unit."""


@dataclass(frozen=True)
class ChannelError:
    """Error of a channel that is constant through the tow: measured minus true.

    Attributes
    ----------
    channel
        Name of the channel.
    std
        Prior std, in the channel's unit, or as a fraction of the value if ``relative``.
    relative
        True for a scale error, False for an offset.
    """

    channel: str
    std: float
    relative: bool

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return f'{self.channel} {"scale" if self.relative else "offset"}'

    def size(self, value: float) -> float:
        """Std of the error at a value of the channel, in its unit."""
        return self.std * (value if self.relative else 1.0)


def channel_errors(channels: Sequence[str]) -> tuple[ChannelError, ...]:
    """Return the constant errors of channels that the channel table gives a std for."""
    return tuple(
        ChannelError(name, std, relative)
        for name in channels
        for std, relative in ((CHANNELS[name].bias, False), (CHANNELS[name].bias_fraction, True))
        if std > 0.0
    )


TERMS = channel_errors((*MEASURED, *INPUTS))
"""Errors of calibration of one tow."""

CALIBRATION = nuisance(
    ParameterGroup('calibration', tuple(term.channel for term in TERMS), ('std',) * len(TERMS))
)
"""`TERMS` as parameters."""


def model_std(channel: str, values: FloatArray) -> FloatArray:
    """Std (n,) of the model's error in predicted values (n,) of a channel."""
    angle = CHANNELS[channel].unit == 'rad'
    return np.full(len(values), MODEL_ANGLE) if angle else MODEL_FRACTION * np.abs(values)


def model_errors(options: EstimatorOptions) -> ParameterVector:
    """Errors of the model: one per group, then of their trends, and the net's factors."""
    return _model_errors(options.model_trend != 0.0, bool(options.net_std.any()))


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
        True if a window has the channel; other arrays are 0 if it has not.
    noise : (n, k) array
        Stated std of the error of the single reading; 1 if absent.
    numbers : (n, k) array
        Number of independent readings. It is below one if windows of a state share an offset.
    inputs : (n, k, 4) array
        Change of the reading by one std in warp lengths, speed and settling of this window.
    input_std : (n, 3) array
        Std of warp lengths (m) and speed (m/s).
    calibration : (n, k, p) array
        Change of the reading by one std of each of `TERMS`.
    input_calibration : (n, 3, p) array
        Change of the measured warp lengths and speed by one std of each of `TERMS`.
    model : (n, k, m) array
        Change of the reading by one std of each of `model_errors`.
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
    """Return values of a window's channels as rows among all channels, 0 for missing channels.

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


def tow_errors(
    linearised: Sequence[Linearised], options: EstimatorOptions
) -> tuple[TowErrors, ...]:
    """Return the errors of all windows, tow by tow.

    Parameters
    ----------
    linearised
        Linearised windows of any tows.
    options
        How errors are divided among readings, steady states, tows and model.
    """
    states = [linear.window.state for linear in linearised]
    in_state = {state: states.count(state) for state in set(states)}
    usual = _usual_noise([linear.window for linear in linearised])
    tows: dict[int, list[int]] = {}
    for row, linear in enumerate(linearised):
        tows.setdefault(linear.window.tow, []).append(row)
    return tuple(
        _of_one_tow(rows, [linearised[row] for row in rows], in_state, usual, options)
        for _, rows in sorted(tows.items())
    )


def _of_one_tow(
    rows: Sequence[int],
    linearised: Sequence[Linearised],
    in_state: Mapping[int, int],
    usual: Mapping[str, float],
    options: EstimatorOptions,
) -> TowErrors:
    present = np.array([[name in linear.channels for name in MEASURED] for linear in linearised])
    by_inputs = np.array([in_all_channels(linear, linear.by_inputs) for linear in linearised])
    noise, state = np.array([_variances(one, usual, options) for one in linearised]).swapaxes(0, 1)
    # All windows of a state share its offset. Times their number, their mean keeps its variance.
    number = np.array([in_state[linear.window.state] for linear in linearised])[:, None]
    variance, alone = noise + number * state, noise + state
    std, k = np.sqrt(variance), len(MEASURED)
    slow = np.array([_unsettled(linear, in_state, options) for linear in linearised])
    return TowErrors(
        rows=np.array(rows),
        present=present,
        noise=std[:, :k],
        numbers=present * alone[:, :k] / variance[:, :k],
        inputs=np.concatenate((by_inputs * std[:, None, k:], slow[:, :, None]), axis=2),
        input_std=std[:, k:],
        calibration=np.array([_calibration(linear, options) for linear in linearised]),
        input_calibration=np.array([_of_inputs(linear, options) for linear in linearised]),
        model=np.array([_model(linear, options) for linear in linearised]),
    )


def _usual_noise(windows: Sequence[SteadyWindow]) -> dict[str, float]:
    """Median over windows of each quantity's noise."""
    by_group: dict[str, list[float]] = {}
    for window in windows:
        for name, noise in window.noise.items():
            by_group.setdefault(group_of(name), []).append(noise)
    return {group: float(np.median(noise)) for group, noise in by_group.items()}


def _variances(
    linear: Linearised, usual: Mapping[str, float], options: EstimatorOptions
) -> FloatArray:
    """Variances (2, channels and inputs) of the noise and of the offset in a window's state.

    Where there is no reading they are 1 and 0.
    """
    window, found = linear.window, np.zeros((2, len(MEASURED) + len(INPUTS)))
    for column, name in enumerate((*MEASURED, *INPUTS)):
        if name not in linear.channels and name not in INPUTS:
            found[0, column] = 1.0
            continue
        # About thirty readings measure their noise badly; a small value may be chance.
        noise = window.own_noise(name, usual[group_of(name)])
        offset = CHANNELS[name].state_std(window.bias[name], options.state_share)
        found[:, column] = noise**2, offset**2
    return found


def _unsettled(
    linear: Linearised, in_state: Mapping[int, int], options: EstimatorOptions
) -> FloatArray:
    depth = linear.window.means.get('net_depth', 0.0)
    # Windows of one state settle together, so their number is a factor as in `_of_one_tow`.
    size = options.unsettled * abs(depth) * np.sqrt(in_state[linear.window.state])
    return in_all_channels(linear, size * linear.slow)


def _calibration(linear: Linearised, options: EstimatorOptions) -> FloatArray:
    # An input that reads too large changes the prediction, not the reading.
    columns = -in_all_channels(linear, linear.by_inputs) @ _of_inputs(linear, options)
    for column, term in enumerate(TERMS):
        if term.channel in linear.channels:
            columns[MEASURED.index(term.channel), column] = _size(linear, term, options)
    return columns


def _of_inputs(linear: Linearised, options: EstimatorOptions) -> FloatArray:
    columns = np.zeros((len(INPUTS), len(TERMS)))
    for column, term in enumerate(TERMS):
        if term.channel in INPUTS:
            columns[INPUTS.index(term.channel), column] = _size(linear, term, options)
    return columns


def _size(linear: Linearised, term: ChannelError, options: EstimatorOptions) -> float:
    return options.tow_share * term.size(linear.window.means[term.channel])


def _model(linear: Linearised, options: EstimatorOptions) -> FloatArray:
    columns = np.zeros((len(MEASURED), len(GROUPS)))
    for name, value in zip(linear.channels, linear.values, strict=True):
        row = MEASURED.index(name)
        columns[row, GROUP_OF[row]] = options.model_error * model_std(name, np.array([value]))[0]
    if options.model_trend:
        length = 0.5 * (
            linear.window.means['port_length'] + linear.window.means['starboard_length']
        )
        longer = np.log(length / USUAL_LENGTH) / np.log(LONGER)
        columns = np.hstack((columns, options.model_trend * longer * columns))
    if not options.net_std.any():
        return columns
    return np.hstack((columns, in_all_channels(linear, linear.by_net) * options.net_std))
