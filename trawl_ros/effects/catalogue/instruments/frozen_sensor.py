"""Sensor that is frozen at a plausible value."""

from trawl_ros.effects.base.effect import Effect

EFFECT = Effect(
    name='frozen_sensor',
    sentence='A sensor shows one value whatever the gear does.',
    parameters=(),
    excited_by='three states of a tow or more, with warps half as long again',
    direct='Move the sensor, or lower it by some metres, and look whether its reading changes.',
    causes='a blocked port, a cable with water in it, a low battery, a display that holds the last '
    'value it heard.',
)
