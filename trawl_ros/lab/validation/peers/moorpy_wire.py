# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady towed wire compared with MoorPy."""

from trawl_ros.lab.reference_codes.moorpy_wire import MoorPyWire
from trawl_ros.lab.reference_codes.own_wire import own_model, own_steady
from trawl_ros.lab.reference_codes.towed_wire import INTEGRATED, UNITS, WIRE
from trawl_ros.lab.report.measured import MeasuredValue, within_share
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.cases import ValidationCase

SEGMENTS = 20

MAX_DIFFERENCE = 0.01
"""Largest allowed difference, as a share."""


def run(quick: bool) -> Findings:
    """Solve the same steady tow in both programs; ``quick`` makes no difference."""
    _, ours = own_steady(WIRE, own_model(WIRE, SEGMENTS))
    theirs = MoorPyWire(WIRE).solve()
    table = TextTable(
        'The steady tow, and what the integrated equation of the wire gives',
        ('', 'trawl_ros', 'MoorPy', 'integrated', 'trawl_ros error', 'MoorPy error'),
        tuple(
            (
                f'{name} [{unit}]',
                *(f'{getattr(of, name):.2f}' for of in (ours, theirs, INTEGRATED)),
                *(
                    f'{100 * (getattr(of, name) / getattr(INTEGRATED, name) - 1):+.3f} %'
                    for of in (ours, theirs)
                ),
            )
            for name, unit in UNITS.items()
        ),
    )
    return Findings(
        rows=tuple(
            MeasuredValue(
                f'steady {name}',
                getattr(ours, name),
                unit,
                within_share(MAX_DIFFERENCE, of=getattr(theirs, name)),
                "Expected is MoorPy's.",
                key=f'steady_{name}',
            )
            for name, unit in UNITS.items()
        ),
        tables=(table,),
        text=(
            'MoorPy solves the same wire as one catenary, with its drag spread evenly over its '
            'length. That is what sets the two apart: cut into two lines, MoorPy comes within '
            '0.03 % of the integrated depth.'
        ),
    )


CASE = ValidationCase('moorpy_wire', 'A steady towed wire compared with MoorPy', run)
