# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Panels of netting: the model's drag and lift by angle and solidity, compared with tests."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, radians

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, between
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.panels.published import (
    KnotRecord,
    PanelRecord,
    PublishedPanels,
    netting_of,
    published_panels,
)
from trawl_ros.lab.validation.panels.whole_nets import (
    LEAST_SHARE_OF_REID,
    MOST_SHARE_OF_MACLENNAN,
    NETS,
    nets_table,
    whole_nets,
)
from trawl_ros.model.bar_pass import water_of
from trawl_ros.model.line import BarMotion, BarProperties, drag
from trawl_ros.model.lump_pass import add_sheet_forces
from trawl_ros.model.net.wake import exposure_of, sheet, viscous, viscous_knots
from trawl_ros.model.water import Water
from trawl_ros.report.pictures import Drawing


def panel_loads(
    section: SectionRecord, net: NettingRecord, angle: float, slope: float, speed: float
) -> FloatArray:
    """Drag and lift of a panel, divided by ½ ρ U² and its twine area.

    Parameters
    ----------
    section, net
        Netting, and the coefficients of its law.
    angle
        Of the bars of diamond meshes against the sheet's length, rad.
    slope
        Of the sheet to the flow, rad.
    speed
        Of the flow, m/s.

    Returns
    -------
    (3,) array
        Drag, lift, and the drag of the knots alone.
    """
    flat = sheet(section, net, angle, slope)
    left, water, diameter = exposure_of(flat, net), Water(), section.twine_diameter_m
    count = len(flat.bars)
    still, one = np.zeros(count), np.full(count, 1.0 / count)
    velocity = -speed * np.array([flat.flow] * count)
    growth = viscous(net, diameter)
    bars = BarProperties(
        stiffness=one,
        damping_time=still,
        mass=still,
        volume=still,
        normal_area=left.normal * one,
        wet_area=np.pi * left.friction * one,
        normal_drag=net.normal_drag * np.ones(count),
        friction=net.friction * np.ones(count),
        added_normal=still,
        added_tangential=still,
        bow=still,
        normal_viscous=growth[0] * np.ones(count),
        friction_viscous=growth[1] * np.ones(count),
    )
    motion = BarMotion(flat.bars, 0.0 * velocity, velocity, still, count * one, still)
    force = drag(bars, motion, flat.bars, water).sum(axis=0)
    pressure = 0.5 * water.density * speed**2
    growing = viscous_knots(net, max(net.knot_diameters, 1e-3) * diameter) / np.sqrt(speed)
    knots = left.knots * flat.knots * (net.knot_drag + growing)
    around, area = np.arange(3)[None], 1.0 / flat.solidity
    total = np.zeros((3, 3))
    add_sheet_forces(
        np.array([[0.0, 0.0, 0.0], [area, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        np.tile(velocity[0], (3, 1)),
        around,
        np.array([[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]),
        np.array([left.lift]),
        np.ones(1),
        water_of(water),
        total,
    )
    force = (force + total[0]) / pressure + knots * flat.flow
    upward = np.array([-flat.flow[2], 0.0, flat.flow[0]])
    return np.array([force @ flat.flow, force @ upward, knots])


GEAR = 'krill_800'
"""Gear whose netting has the default law."""

MEDIAN_PERCENT = 15.0
"""Largest allowed median error."""

EXPONENTS = (1.4, 1.8)
"""Range of exponents of drag in speed at sea and in flume tanks."""

SMALL_ANGLES = (5.0, 30.0)
"""Angles (degrees) of most netting of trawls to the flow."""

KINDS = 'drag', 'lift'

DIAMOND = pi / 4
"""Angle of the bars of a diamond as wide as long."""


@dataclass(frozen=True)
class PanelPoint:
    """Drag coefficients of a panel at an angle (degrees): published and modelled.

    Both use the reference area of the source.
    """

    panel: PanelRecord
    kind: str
    angle: float
    published: float
    model: float

    @property
    def error(self) -> float:
        """Error of the model, %."""
        return 100.0 * (self.model / self.published - 1.0)


def points_of(panel: PanelRecord, net: NettingRecord) -> list[PanelPoint]:
    """All coefficients of a panel; a lift of zero has no error and is left out."""
    across = panel_loads(panel.section, net, DIAMOND, 0.5 * pi, panel.speed_m_s)[0]
    scale = {'outline': panel.solidity, 'twine': 1.0, 'across': 1.0 / across}[panel.area]
    points = []
    for n, angle in enumerate(panel.angle_deg):
        loads = panel_loads(panel.section, net, DIAMOND, radians(angle), panel.speed_m_s)
        for kind, values, load in zip(KINDS, (panel.drag, panel.lift), loads):
            if values and values[n] > 0.0:
                points.append(PanelPoint(panel, kind, angle, values[n], scale * float(load)))
    return points


def added_by_knots(knot: KnotRecord, net: NettingRecord) -> float:
    """Drag of knotted netting over that of knotless netting, minus one."""
    with_knots, without = (
        panel_loads(
            netting_of(knot.solidity, 2.4e-3, knotless, square=False),
            net,
            DIAMOND,
            radians(knot.angle_deg),
            0.75,
        )[0]
        for knotless in (False, True)
    )
    return float(with_knots / without - 1.0)


def run(quick: bool) -> Findings:
    """Compare every published panel with the model."""
    published, net = published_panels(), load_gear(GEAR).netting
    every = [point for panel in published.panels for point in points_of(panel, net)]
    counted = [point for point in every if point.panel.use == 'counts']
    low, high = SMALL_ANGLES
    flat = [point for point in counted if low <= point.angle <= high]
    groups = [
        (f'{kind}, {low:g}° to {high:g}°', f'{kind}_small', [p for p in flat if p.kind == kind])
        for kind in KINDS
    ]
    groups += [
        ('drag and lift together, there', 'small', flat),
        ('drag across the flow', 'across', [p for p in counted if p.angle == 90.0]),
    ]
    rows = [
        MeasuredValue(
            f'median error of {what}',
            float(np.median(np.abs([p.error for p in some]))),
            '%',
            at_most(MEDIAN_PERCENT),
            f'{len(some)} values; median with its sign {np.median([p.error for p in some]):+.1f} %',
            key=key,
        )
        for what, key, some in groups
    ]
    rows.append(
        MeasuredValue(
            'solidities that count',
            float(len({p.panel.solidity for p in flat})),
            '',
            at_least(3.0),
            'Fits of Løland and of Aarsnes and others, whose tests are partly the same.',
            key='solidities',
        )
    )
    nets = whole_nets(tuple(NETS)[-2:] if quick else tuple(NETS))
    inside = [flag for net in nets for flag in net.inside]
    rows += [
        MeasuredValue(
            f'whole nets as built between {LEAST_SHARE_OF_REID:g} of Reid and '
            f'{MOST_SHARE_OF_MACLENNAN:g} of MacLennan',
            100.0 * float(np.mean(inside)),
            '%',
            at_least(100.0),
            'At 2, 3 and 4 knots. Both formulas are of nets whose mouth closes with speed, which '
            'that of a net as built does not; MacLennan counts ground gear.',
            key='bands',
        ),
        MeasuredValue(
            'median exponent of drag in speed, in equilibrium',
            float(np.nanmedian([net.exponent for net in nets])),
            '',
            between(*EXPONENTS),
            'By net: ' + ', '.join(f'{net.name} {net.exponent:.2f}' for net in nets) + '. Friction '
            'grows with a power of 1.5, all else with 2; the rest is the shape.',
            key='exponent',
        ),
    ]
    return Findings(
        rows=tuple(rows),
        tables=(
            nets_table(nets),
            _table(every),
            _knots(published, net),
            _not_used(published, every),
        ),
        drawings=(
            Drawing(
                'panels',
                'Drag and lift on the area of twine by the angle of the panel to the flow, 0 along '
                'it; lines: the model.',
                _figure(every, net),
            ),
        ),
        text=(
            'The panel of the model has the law of the netting of trawls: twines by their Reynolds '
            'number, knots, wakes and lift of sheets (docs/model.md, Netting). Its coefficients '
            'were chosen by these panels, and by nothing else; whole nets are compared with '
            'formulas. Most sources print fits to their tests, which are compared at these angles.'
        ),
    )


def _table(points: Sequence[PanelPoint]) -> TextTable:
    return TextTable(
        'Coefficients on the area of the source.',
        ('panel', 'use', 'area', 'coefficient', 'angle (°)', 'published', 'model', 'error (%)'),
        tuple(
            (
                one.panel.name,
                one.panel.use,
                one.panel.area,
                one.kind,
                f'{one.angle:g}',
                f'{one.published:.3f}',
                f'{one.model:.3f}',
                f'{one.error:+.0f}',
            )
            for one in points
        ),
    )


def _knots(published: PublishedPanels, net: NettingRecord) -> TextTable:
    return TextTable(
        'Drag that knots add to that of knotless netting.',
        ('source', 'angle (°)', 'published (%)', 'model (%)'),
        tuple(
            (
                one.name,
                f'{one.angle_deg:g}',
                f'{100 * one.more:.0f}',
                f'{100 * added_by_knots(one, net):.0f}',
            )
            for one in published.knots
        ),
    )


def _not_used(published: PublishedPanels, points: Sequence[PanelPoint]) -> TextTable:
    lines = []
    for panel in published.panels:
        if panel.use == 'shown':
            own = {k: [p.error for p in points if (p.panel, p.kind) == (panel, k)] for k in KINDS}
            errors = [f'{np.median(some):+.0f}' if some else '' for some in own.values()]
            lines.append((panel.name, *errors, panel.why))
    return TextTable(
        'Shown only, with the median error at all angles, or not used.',
        ('source', 'drag (%)', 'lift (%)', 'why'),
        (*lines, *((one.source.strip(), '', '', one.why.strip()) for one in published.not_used)),
    )


def _figure(points: Sequence[PanelPoint], net: NettingRecord) -> Figure:
    panels = [p.panel for p in points if p.panel.area != 'across']
    solidities = sorted({panel.solidity for panel in panels})
    figure, every = panes(10.0, 4.4, 1, 2)
    angles = np.linspace(0.0, 90.0, 46)
    for n, (axes, kind) in enumerate(zip(every, KINDS, strict=True)):
        for k, solidity in enumerate(solidities):
            netting = netting_of(solidity, 2.4e-3, knotless=True, square=True)
            loads = [panel_loads(netting, net, DIAMOND, radians(a), 0.75)[n] for a in angles]
            axes.plot(angles, loads, color=f'C{k}', label=f'model, S {solidity:g}')
        for one in points:
            if one.panel.area != 'across' and one.kind == kind:
                scale = one.panel.solidity if one.panel.area == 'outline' else 1.0
                colour = f'C{solidities.index(one.panel.solidity)}'
                filled = colour if one.panel.use == 'counts' else 'none'
                axes.plot(one.angle, one.published / scale, 'o', color=colour, mfc=filled, ms=4)
        axes.set(xlabel='angle to the flow / °', ylabel=f'coefficient of {kind}')
        axes.legend(fontsize='small')
    return figure


CASE = ValidationCase('netting', 'Netting panels', run)
