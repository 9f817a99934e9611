# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What the demo prints of its results."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.demo.short_tows import Finding


def load_result(folder: Path) -> dict[str, Any]:
    """Read ``identification.json`` of a folder.

    Raises
    ------
    TrawlError
        If it is not there.
    """
    path = folder / 'identification.json'
    try:
        return dict(json.loads(path.read_text(encoding='utf-8')))
    except (OSError, ValueError) as reason:
        raise TrawlError(
            f'{path}: cannot be read; expected the report of the identification'
        ) from reason


def refitted_line(result: Mapping[str, Any], truth: Mapping[str, float]) -> str:
    """Return the errors of the model before and after the refit, from ``identification.json``.

    Parameters
    ----------
    result
        Content of the file.
    truth
        True coefficients by name.
    """
    errors = ', '.join(
        f'{100.0 * channel["mnae_start"]:.1f} to {100.0 * channel["mnae_end"]:.1f} % in '
        f'{name.replace("_", " ")}'
        for name, channel in result['channels'].items()
        if name != 'net_depth'
    )
    held = sum(
        own['low'] <= truth[name] <= own['high'] for name, own in result['coefficients'].items()
    )
    data = result.get('chain', {}).get('fitted', f'{result["windows"]} steady windows')
    return (
        f'The boards were refitted from {data}; the model errs less: '
        f'{errors}. {held} of {len(truth)} intervals hold the true coefficient.'
    )


def finding_lines(found: Finding) -> tuple[str, str, str]:
    """Return what the model missed, what was named, and what is left with the repaired gear."""
    (effect,) = found.numbers['effects']
    values = ', '.join(
        f'{name} {own["value"]:.3g} (95 %: {own["low"]:.3g} to {own["high"]:.3g}) '
        f'{own["unit"]}'.rstrip()
        for name, own in effect['parameters'].items()
    )
    made, smallest, times = found.sizes.values()
    return (
        f'In the short tows the model, boards refitted, misses by: {found.errors("before")}.',
        f'Named: {found.name}: {values}. It was made {made} m/s too much, {times:.1f} × '
        f'the {smallest:.3f} m/s that four of five such trials detect.',
        f'Repaired: with it in the gear file the errors are: {found.errors("after")}. '
        f'Instruments alone would give: {found.errors("expected")}.',
    )
