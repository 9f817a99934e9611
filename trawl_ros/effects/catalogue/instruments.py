# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effects of instruments: their errors."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation

ANGLES = ('port_pitch', 'starboard_pitch', 'port_roll', 'starboard_roll')
CELLS = ('port_tension', 'starboard_tension')
DOOR_DEPTHS = ('port_door_depth', 'starboard_door_depth')


class AttitudeMount(Effect):
    """Offsets of pitch and roll of either door."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the offsets."""
        return readings | {
            name: readings[name] + offset for name, offset in zip(ANGLES, values, strict=True)
        }


class CounterOffset(Effect):
    """Offset (m) of both counters from the warp paid out."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the inputs with warp lengths without the offset."""
        true: FloatArray = inputs - values[0] * np.array([1.0, 1.0, 0.0])
        return true


class CounterScale(Effect):
    """Counters that show (1 + scale) times the warp paid out, more of it at port."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the inputs with warp lengths without the scale error."""
        scale, port_more = values
        shown = 1.0 + scale + 0.5 * port_more * np.array([1.0, -1.0])
        return np.append(inputs[:2] / shown, inputs[2])


class DepthSensor(Effect):
    """Offsets of doors and net, and scale and drift of all three depth sensors."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the errors of the depth sensors."""
        doors, net, scale, drift = values
        offsets = {**dict.fromkeys(DOOR_DEPTHS, doors), 'net_depth': net}
        return readings | {
            name: (1.0 + scale) * readings[name] + offset + drift * at.hours
            for name, offset in offsets.items()
        }


class SpeedLogError(Effect):
    """Speed log that shows (1 + scale) times the speed, and a bias."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return both warp lengths and the speed without scale and bias."""
        scale, bias = values
        port, starboard, speed = inputs
        return np.array([port, starboard, (speed - bias) / (1.0 + scale)])


class SpreadSensor(Effect):
    """Spread sensor that shows (1 + scale) times the spread, and an offset."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the error of the spread sensor."""
        scale, offset = values
        return readings | {'door_spread': (1.0 + scale) * readings['door_spread'] + offset}


@dataclass(frozen=True)
class SwappedSides(Effect):
    """Exchange of the readings of both sides: 0 is none, 1 a full swap."""

    channels: tuple[str, ...] = ()

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return readings in which each side has this share of the other side's reading."""
        shown = dict(readings)
        for channel in self.channels:
            port, starboard = f'port_{channel}', f'starboard_{channel}'
            more = values[0] * (readings[starboard] - readings[port])
            shown[port], shown[starboard] = readings[port] + more, readings[starboard] - more
        return shown


class TensionCell(Effect):
    """Tension cells that show (1 + scale) times the tension and an offset, on both sides."""

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the errors of the tension cells."""
        offset, scale = values
        return readings | {name: (1.0 + scale) * readings[name] + offset for name in CELLS}


class WarpAsymmetry(Effect):
    """Port warp longer than shown, and starboard warp shorter by as much."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the inputs with the true warp lengths."""
        true: FloatArray = inputs + 0.5 * values[0] * np.array([1.0, -1.0, 0.0])
        return true


def _swapped(name: str, whose: str, channels: tuple[str, ...], direct: str) -> SwappedSides:
    return SwappedSides(
        name=name,
        sentence=f'{whose} of port and starboard are swapped (a share of 1).',
        # Sensors are swapped or not; noise and asymmetry make other shares of a swap.
        parameters=(Parameter('share', '', 0.0, -0.3, 1.3, 0.5, whole=True),),
        excited_by='whatever differs between the sides: lean, unequal warps',
        direct=direct,
        causes='sensors hung on the wrong door, cables on the wrong plug, sides mistaken in the '
        'configuration.',
        channels=channels,
    )


FROZEN_SENSOR = Effect(
    name='frozen_sensor',
    sentence='A sensor shows one value whatever the gear does.',
    parameters=(),
    excited_by='three states of a tow or more, with warps half as long again',
    direct='Move the sensor, or lower it by some metres, and look whether its reading changes.',
    causes='a blocked port, a cable with water in it, a low battery, a display that holds the last '
    'value it received.',
)

EFFECTS = (
    AttitudeMount(
        name='attitude_mount',
        sentence='The sensor of a door sits askew and shows too much or too little pitch or roll.',
        parameters=tuple(Parameter(name, 'rad', 0.0, -0.35, 0.35, 0.05) for name in ANGLES),
        excited_by='any tow',
        confused_with=('board_rigging',),
        direct='Hold the doors upright against the gallows and read pitch and roll.',
        causes='a bent sensor pocket, a sensor that has turned in its clamp or was put in after '
        'the zero was set.',
    ),
    CounterOffset(
        name='counter_offset',
        sentence='The winch counters show too much or too little warp, by a constant length.',
        parameters=(Parameter('offset', 'm', 0.0, -50.0, 50.0, 10.0),),
        excited_by='warp length',
        confused_with=('counter_scale', 'warp_strumming'),
        direct='Pay out warp to a mark of known distance and read the counters.',
        instrument='counters',
        causes='counters zeroed at another mark, warp that was cut back without resetting the '
        'counter.',
    ),
    CounterScale(
        name='counter_scale',
        sentence='The winch counters show too much or too little warp, in proportion to its '
        'length; the factor may differ between the sides.',
        parameters=(
            Parameter('scale', '', 0.0, -0.2, 0.2, 0.03),
            Parameter('port_more', '', 0.0, -0.05, 0.05, 0.005),
        ),
        excited_by='warp length',
        confused_with=('warp_strumming', 'counter_offset'),
        direct='Pay out warp past marks of known distance and read the counters.',
        instrument='counters',
        causes='a worn counting sheave or another one, another wire diameter, layers miscounted on '
        'the drum.',
    ),
    DepthSensor(
        name='depth_sensor',
        sentence='Depth sensors show too much or too little: an offset, a scale error or a drift.',
        parameters=(
            Parameter('doors_offset', 'm', 0.0, -30.0, 30.0, 5.0),
            Parameter('net_offset', 'm', 0.0, -30.0, 30.0, 5.0),
            Parameter('scale', '', 0.0, -0.1, 0.1, 0.02),
            Parameter('drift', 'm per h', 0.0, -10.0, 10.0, 2.0),
        ),
        excited_by='depth, and time in the tow; a surfaced door shows the offset',
        confused_with=('gear_weight',),
        direct='Read the depth sensors with doors and sonar at the surface: the reading there is '
        'their offset.',
        causes='a sensor that has aged, mud in its port, air pressure not subtracted, another '
        'density of the water.',
    ),
    FROZEN_SENSOR,
    SpeedLogError(
        name='speed_log',
        sentence='The log shows too much or too little speed through the water.',
        parameters=(
            Parameter('scale', '', 0.0, -0.4, 0.4, 0.05),
            Parameter('bias', 'm/s', 0.0, -0.8, 0.8, 0.1),
        ),
        excited_by='speed',
        confused_with=('net_drag', 'heave'),
        direct='Run a measured mile in slack water, or compare with speed over ground on '
        'reciprocal tracks.',
        causes='growth on the log, a log that was calibrated for another ship or speed.',
    ),
    SpreadSensor(
        name='spread_sensor',
        sentence='The spread between the doors is shown too large or too small.',
        parameters=(
            Parameter('scale', '', 0.0, -0.2, 0.2, 0.03),
            Parameter('offset', 'm', 0.0, -15.0, 15.0, 3.0),
        ),
        excited_by='spread: warp length and speed',
        confused_with=('net_drag',),
        direct='Hold the doors a measured distance apart at the stern and read their sensor.',
        causes='another speed of sound than set, sensors askew in their pockets, an echo from the '
        'bottom.',
    ),
    _swapped(
        'swapped_doors',
        'Sensors of the doors',
        ('door_depth', 'pitch', 'roll'),
        "Tilt one door by hand and see which side's roll changes.",
    ),
    _swapped(
        'swapped_cells',
        'Tension cells',
        ('tension',),
        "Slacken one warp and see which side's tension falls.",
    ),
    TensionCell(
        name='tension_cell',
        sentence='The tension cells show too much or too little.',
        parameters=(
            Parameter('offset', 'N', 0.0, -20e3, 20e3, 3e3),
            Parameter('scale', '', 0.0, -0.3, 0.3, 0.04),
        ),
        excited_by='tension; a slack winch shows the offset',
        confused_with=('net_drag',),
        direct='Read the tension cells with slack warps: the reading there is their offset.',
        causes='a cell that has aged, a lead angle at the block other than at calibration, '
        'friction of sheaves.',
    ),
    WarpAsymmetry(
        name='warp_asymmetry',
        sentence='One warp is longer than the other, but the counters show equal lengths.',
        parameters=(Parameter('port_longer', 'm', 0.0, -15.0, 15.0, 3.0),),
        excited_by='any tow, short warps most',
        confused_with=('cross_current',),
        direct='Pay out both warps to marks of the same distance and compare the counters.',
        causes='warps that stretched unequally, a warp that was cut back, marks set wrongly.',
    ),
)
