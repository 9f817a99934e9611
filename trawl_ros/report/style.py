# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Style of all figures of a tow: colours and axes."""

import numpy as np
from matplotlib.axes import Axes

from trawl_ros.core.arrays import FloatArray

PORT, STARBOARD = '#d62728', '#009e73'
"""Red and green, as the side lights of a ship; the green has enough blue for the colour-blind."""

PORT_TRUTH, STARBOARD_TRUTH = '#5a0a0b', '#00523b'
MEASURED, SECOND = '#1f77b4', '#e08214'
MEASURED_TRUTH, SECOND_TRUTH = '#0b2f4a', '#6b3c05'
SURFACE, NETTING, FAINT = '#4a90c2', '#7f8c8d', '#9aa5ab'
DPI = 130


def quiet(axes: Axes) -> None:
    """Set a faint grid, without a frame on the right and at the top."""
    axes.grid(color='#e3e6e8', linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[['top', 'right']].set_visible(False)
    axes.tick_params(color='#8a9399')


def clock(seconds: float) -> str:
    """Format a time since the start: ``1:05`` is a minute and five seconds, ``2:00:00`` 2 h."""
    minutes, rest = divmod(round(float(seconds)), 60)
    hours, minutes = divmod(minutes, 60)
    return f'{hours}:{minutes:02d}:{rest:02d}' if hours else f'{minutes}:{rest:02d}'


def compass(yaw: FloatArray) -> FloatArray:
    """Convert ENU yaw (n,), rad, to compass degrees, continuous, with the mean within a turn."""
    degrees = 90.0 - np.degrees(yaw)
    return degrees - 360.0 * np.floor(np.nanmean(degrees) / 360.0) if len(degrees) else degrees
