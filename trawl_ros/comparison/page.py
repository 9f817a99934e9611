# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files of a comparison: JSON, figures, and a self-contained HTML page."""

from pathlib import Path

import numpy as np
from pydantic_core import to_jsonable_python

from trawl_ros.comparison.comparison import Comparison
from trawl_ros.comparison.figures import drawings, side_of
from trawl_ros.comparison.summary import Compared
from trawl_ros.core.display_units import DisplayUnits, quantity_of
from trawl_ros.core.files import made_folder, write_json, write_text
from trawl_ros.core.version import __version__
from trawl_ros.records.channels import CHANNELS
from trawl_ros.report.pictures import draw, embedded
from trawl_ros.report.rendering import page as filled

PAGE, DATA = 'comparison.html', 'comparison.json'

OUTSIDE_STD = 3.0
"""Std of its error beyond which a difference is marked."""


def write_comparison(comparison: Comparison, folder: Path, units: DisplayUnits) -> None:
    """Write ``comparison.json`` in SI units, the figures and ``comparison.html``.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    made_folder(folder)
    whole = {'next_step': comparison.next_step, **vars(comparison)}
    # Null where a number does not exist.
    plain = to_jsonable_python(whole, inf_nan_mode='null', fallback=np.ndarray.tolist)
    write_json(folder / DATA, plain, indent=1)
    text = filled(
        'trawl_ros.comparison',
        PAGE,
        comparison=comparison,
        pictures=embedded(folder, draw(folder, drawings(comparison, units))),
        units=units,
        cells=cells,
        version=__version__,
    )
    write_text(folder / PAGE, text)


def cells(channel: str, one: Compared, units: DisplayUnits) -> dict[str, str | bool]:
    """Return name, measured, reference, difference and std of a sensor as text."""
    unit = CHANNELS[channel].unit
    quantity = quantity_of(channel, unit)
    sign = '+' if one.difference >= 0.0 else '-'
    found = {
        'name': channel.replace('_', ' '),
        'measured': units.shown(one.measured, quantity),
        'reference': units.shown(one.reference, quantity),
        'difference': f'{sign}{units.shown(abs(one.difference), quantity)}',
        'percent': '' if unit == 'rad' else f'{100.0 * one.fraction:+.1f} %',
        'scaled': f'{one.scaled:+.1f}',
    }
    shown = {key: text.replace('-', '−') for key, text in found.items()}
    return {**shown, 'side': side_of(channel), 'outside': abs(one.scaled) > OUTSIDE_STD}
