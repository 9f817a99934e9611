# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reproduction of Fig. 6: the boards' angles against warp length."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.paper.sweeps import (
    FEW_LENGTHS,
    LENGTHS,
    SPEED,
    paper_model,
    sighting,
    warp_sweep,
)
from trawl_ros.report.pictures import Drawing


def run(quick: bool) -> Findings:
    """Solve the default gear from 200 to 900 m of warp."""
    lengths = FEW_LENGTHS if quick else LENGTHS
    model = paper_model(quick)
    sweep = warp_sweep(model, lengths, SPEED)
    seen = [steady.observables for steady in sweep]
    normals = [sighting(model, steady).board.normal for steady in sweep]
    angles = {
        name: np.degrees([getattr(one, f'port_{name}') for one in seen])
        for name in ('attack', 'slip', 'inclination')
    }
    checks = (
        MeasuredValue(
            'least growth of α from one length to the next',
            float(np.diff(angles['attack']).min()),
            '°',
            at_least(0.0),
            'section IV.D, Fig. 13: α grows with warp length',
            key='attack_grows',
        ),
        MeasuredValue(
            'least growth of δ from one length to the next',
            float(np.diff(angles['inclination']).min()),
            '°',
            at_least(0.0),
            'section IV.D, Fig. 14 and 15: δ grows with warp length',
            key='inclination_grows',
        ),
        MeasuredValue(
            'least vertical part of the outward normal',
            float(min(normals)),
            target=at_least(0.0),
            note='section IV.D: δ gives lift an upward part, so the normal points up',
            key='normal_up',
        ),
    )
    return Findings(
        checks,
        (Drawing('fig6', f'Fig. 6 remade, at {SPEED:g} m/s.', _figure(np.array(lengths), angles)),),
    )


def _figure(lengths: FloatArray, angles: dict[str, FloatArray]) -> Figure:
    figure, (axes,) = panes(7.5, 4.5)
    for name, style, label in (
        ('attack', 'b--o', 'attack angle α'),
        ('slip', 'k:s', 'slip angle β'),
        ('inclination', 'r-^', 'inclination δ'),
    ):
        axes.plot(lengths, angles[name], style, ms=4, label=label)
    axes.axhline(0.0, color='0.6', lw=0.8)
    axes.set(xlabel='warp length [m]', ylabel='angle [°]')
    axes.legend()
    return figure


CASE = ValidationCase('warp_sweep', 'Angles of the boards against warp length (Fig. 6)', run)
