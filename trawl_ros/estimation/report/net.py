# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sentences and JSON on the factors on drag and weight of the net."""

from collections.abc import Sequence

from trawl_ros.estimation.fit.estimate import NetFactor


def net_lines(factors: Sequence[NetFactor]) -> list[str]:
    """Sentences on the factors, none where the net is held."""
    return [
        f'{factor.what.capitalize()} of the net: {factor.value:.2f} times that of the gear '
        f'file, standard deviation {factor.std:.2f}, {factor.known:.2f} before any tow.'
        for factor in factors
    ]


def net_result(factors: Sequence[NetFactor]) -> dict[str, object]:
    """Build what ``identification.json`` has on the factors."""
    return {
        factor.what: {'value': factor.value, 'std': factor.std, 'known': factor.known}
        for factor in factors
    }
