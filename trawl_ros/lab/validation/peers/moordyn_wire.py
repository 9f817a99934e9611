# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Towed wire compared with MoorDyn: steady, and through hauling and a turn."""

from contextlib import closing

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.reference_codes.manoeuvre import (
    Apart,
    History,
    WireManoeuvre,
    apart,
    haul_and_turn,
    short_manoeuvre,
)
from trawl_ros.lab.reference_codes.moordyn_wire import SETTLING_S, MoorDynWire
from trawl_ros.lab.reference_codes.own_wire import own_history, own_model, own_steady
from trawl_ros.lab.reference_codes.towed_wire import INTEGRATED, UNITS, WIRE, WireSteadyState
from trawl_ros.lab.report.measured import MeasuredValue, at_most, within_share
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.report.pictures import Drawing

SEGMENTS = 20

MAX_DIFFERENCE = 0.01
"""Largest allowed difference, as a share."""

OWN_STEP = 0.25
"""Step of this package's stepper, s; steps of 0.1 s change its histories by 1.2e-4 at most."""

SCHEME, STEP = 'RK4', 0.005
"""MoorDyn's scheme and its step (s); RK2 in steps of 2 ms changes its histories by 4e-5 at most."""

OURS, PEER = 'trawl_ros', 'MoorDyn'


def run(quick: bool) -> Findings:
    """Tow, haul and turn the same wire in both programs."""
    manoeuvre = short_manoeuvre() if quick else haul_and_turn()
    model = own_model(WIRE, SEGMENTS)
    start, ours = own_steady(WIRE, model)
    own = own_history(model, start, manoeuvre, OWN_STEP)
    lump = (INTEGRATED.lag, INTEGRATED.depth)
    with closing(MoorDynWire(WIRE, SEGMENTS, SCHEME, STEP, lump)) as wire:
        theirs = wire.settle(0.3 * SETTLING_S if quick else SETTLING_S)
        peer = wire.follow(manoeuvre)
    difference = apart(own, peer)
    return Findings(
        rows=(*_steady_checks(ours, theirs), *_history_checks(difference)),
        drawings=(
            Drawing(
                'histories',
                f'The wire while it is hauled and the ship turns, {SEGMENTS} segments in both: '
                f"histories, and the difference as a share of {PEER}'s value.",
                _histories(own, peer, manoeuvre),
            ),
        ),
        tables=(_steady_table(ours, theirs), _history_table(difference)),
        text=(
            f'The same wire, cut into {SEGMENTS} segments, in this model and in {PEER} 2.7: '
            f'{WIRE.length:g} m of {1e3 * WIRE.diameter:g} mm with a lump of '
            f'{WIRE.lump_mass:g} kg, towed at {WIRE.speed:g} m/s. Parameters are those of the '
            'same wire in the conventions of each program; nothing is tuned. Both damp axial '
            f'strain with EA · {WIRE.damping_time:g} s. Tension is the force on the block with '
            'the half segment that hangs on it. The manoeuvre hauls '
            f'{-manoeuvre.haul.total:g} m at 0.5 m/s and then turns the ship by '
            f'{np.degrees(manoeuvre.turn.total):.0f}° at 0.5°/s and {WIRE.speed:g} m/s. '
            f'{PEER}: {SCHEME} in steps of {STEP:g} s; here: generalised-α '
            f'in steps of {OWN_STEP:g} s.'
        ),
    )


def _steady_checks(ours: WireSteadyState, theirs: WireSteadyState) -> list[MeasuredValue]:
    return [
        MeasuredValue(
            f'steady {name}',
            getattr(ours, name),
            unit,
            within_share(MAX_DIFFERENCE, of=getattr(theirs, name)),
            f'Expected is what {PEER} settles at.',
            key=f'steady_{name}',
        )
        for name, unit in UNITS.items()
    ]


def _history_checks(difference: Apart) -> list[MeasuredValue]:
    return [
        MeasuredValue(
            f"largest difference of {name} over the manoeuvre, share of {PEER}'s value",
            getattr(difference, name),
            target=at_most(MAX_DIFFERENCE),
            note='Over all instants, each against the value at the same instant.',
            key=f'{name}_history',
        )
        for name in ('depth', 'tension')
    ]


def _steady_table(ours: WireSteadyState, theirs: WireSteadyState) -> TextTable:
    return TextTable(
        'The steady tow, and what the integrated equation of the wire gives',
        ('', OURS, PEER, 'integrated'),
        tuple(
            (
                f'{name} [{unit}]',
                *(f'{getattr(of, name):.2f}' for of in (ours, theirs, INTEGRATED)),
            )
            for name, unit in UNITS.items()
        ),
    )


def _history_table(difference: Apart) -> TextTable:
    return TextTable(
        f"Differences over the manoeuvre, shares of {PEER}'s value",
        ('', 'largest', 'root mean square'),
        tuple(
            (name, f'{getattr(difference, name):.2e}', f'{getattr(difference, name + "_rms"):.2e}')
            for name in ('depth', 'tension')
        ),
    )


def _histories(own: History, peer: History, manoeuvre: WireManoeuvre) -> Figure:
    figure = Figure(figsize=(9.0, 6.0), layout='constrained')
    panes = figure.subplots(2, 2, sharex=True, height_ratios=(2, 1))
    for column, (name, unit, scale) in enumerate((('depth', 'm', 1.0), ('tension', 'kN', 1e-3))):
        top, bottom = panes[:, column]
        top.plot(peer.times, scale * getattr(peer, name), color='#999999', lw=4, label=PEER)
        top.plot(own.times, scale * getattr(own, name), color='#1f77b4', lw=1.2, label=OURS)
        top.set_ylabel(f'{name} [{unit}]')
        ours = np.interp(peer.times, own.times, getattr(own, name))
        bottom.plot(peer.times, 100.0 * (ours / getattr(peer, name) - 1.0), color='#1f77b4')
        bottom.set(xlabel='time [s]', ylabel='difference [%]')
        for axes in (top, bottom):
            for pace, colour, label in (
                (manoeuvre.haul, '#2ca02c', 'hauling'),
                (manoeuvre.turn, '#ff7f0e', 'turning'),
            ):
                axes.axvspan(pace.start, pace.end, color=colour, alpha=0.12, lw=0, label=label)
            axes.grid(alpha=0.3)
    panes[0, 0].legend()
    return figure


CASE = ValidationCase('moordyn_wire', 'A towed wire compared with MoorDyn', run)
