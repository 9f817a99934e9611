# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes of the view: the trawl sonar's screen, and fish and echoes in space and from above."""

from typing import Protocol

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.plots.records import Quantities
from trawl_ros.plots.sonar import PIXELS, seen
from trawl_ros.records.truth import SchoolTruth
from trawl_ros.view.records import Echoes, Schools, Section, SeenSchools, Sweep
from trawl_ros.view.viewer.rerun_library import rr

LINE, THIN = -1.3, -0.7
"""Widths of lines in points of the screen, which Rerun takes for negative radii."""

FISH = (242, 166, 102)
ECHO = (1.0, 0.75, 0.3)

RINGS = 4
RING, TRUE, READ_OFF = (120, 120, 120), (255, 255, 255), (77, 210, 255)


class LogAt(Protocol):
    """Function that logs at a stamp (ns) the content of an entity from then on."""

    def __call__(self, stamp: int, path: str, shown: object) -> None:
        """Log it."""


class SonarScreen:
    """Screen of the trawl sonar, as large as its sweep reaches.

    Parameters
    ----------
    log
        Logs what is shown.
    """

    def __init__(self, log: LogAt) -> None:
        self._log = log
        self._reach: float | None = None

    def sweep(self, sweep: Sweep) -> None:
        """Show a sweep."""
        if sweep.scan.max_range != self._reach:
            self._reach = sweep.scan.max_range
            self._rings(sweep.stamp, self._reach)
        echoes = seen(sweep.image, sweep.scan, PIXELS).filled(0)
        image = rr.DepthImage(echoes, meter=1.0, colormap='inferno', depth_range=[0.0, 255.0])
        self._log(sweep.stamp, '/sonar/image', image)

    def section(self, section: Section) -> None:
        """Show the ropes and twine in the sonar's plane."""
        if self._reach is not None:
            points = _on_screen(section.points, self._reach)
            shown = rr.Points2D(points, colors=[TRUE], radii=[-1.5])
            self._log(section.stamp, '/sonar/truth', shown)

    def opening(self, readings: Quantities) -> None:
        """Show height and width read from the image, from the sonar down and across."""
        ends = {
            'opening_height': ((0.0, 0.0), (1.0, 0.0)),
            'opening_width': ((0.0, 0.5), (0.0, -0.5)),
        }
        for name, line in ends.items():
            size = readings.values.get(name)
            if size is not None and self._reach is not None:
                known = np.isfinite(size)
                strips = [_on_screen(size * np.array(line), self._reach)] if known else []
                labels = [f'{name.partition("_")[2]} {size:.1f} m'] if known else []
                shown = rr.LineStrips2D(strips, colors=[READ_OFF], radii=[LINE], labels=labels)
                self._log(readings.stamp, f'/sonar/{name}', shown)

    def _rings(self, stamp: int, reach: float) -> None:
        """Draw circles of equal range with their radii."""
        turn = np.linspace(0.0, 2.0 * np.pi, 91)
        circle = np.column_stack([np.cos(turn), np.sin(turn)])
        radii = [reach * k / RINGS for k in range(1, RINGS + 1)]
        shown = rr.LineStrips2D(
            [_on_screen(radius * circle, reach) for radius in radii],
            colors=[RING],
            radii=[THIN],
            labels=[f'{radius:.4g} m' for radius in radii],
            show_labels=False,
        )
        self._log(stamp, '/sonar/rings', shown)


def _on_screen(points: FloatArray, reach: float) -> FloatArray:
    """Points (n, 2) in the sonar's plane, x down and y port, as pixels of its image."""
    down, port = points.T
    return np.column_stack([reach - port, reach + down]) * (0.5 * PIXELS / reach)


class SeaScene:
    """Scene of the sea.

    Parameters
    ----------
    log
        Logs what is shown.
    """

    def __init__(self, log: LogAt) -> None:
        self._log = log

    def schools(self, record: Schools) -> None:
        """Show the schools that there are."""
        if not record.schools:
            return
        places = np.array([school.position for school in record.schools])
        halves = 0.5 * np.array([school.size for school in record.schools])
        bodies = rr.Ellipsoids3D(
            centers=places, half_sizes=halves, colors=[FISH], line_radii=[THIN]
        )
        self._log(record.stamp, '/map/schools', bodies)
        outlines = [_outline(school) for school in record.schools]
        flat = rr.LineStrips2D(outlines, colors=[FISH], radii=[LINE])
        self._log(record.stamp, '/top/schools', flat)

    def seen_schools(self, record: SeenSchools) -> None:
        """Show the places at which the fish sonar detects schools."""
        points = rr.Points3D(record.positions, colors=[FISH], radii=[-4.0])
        self._log(record.stamp, '/map/fish_sonar', points)
        flat = rr.Points2D(from_above(record.positions), colors=[FISH], radii=[-4.0])
        self._log(record.stamp, '/top/fish_sonar', flat)

    def echoes(self, record: Echoes) -> None:
        """Show the echoes of a sweep."""
        strength = np.clip(record.points[:, 3:] / 255.0, 0.0, 1.0)
        colours = np.round(255.0 * strength * [ECHO]).astype(np.uint8)
        points = rr.Points3D(record.points[:, :3], colors=colours, radii=[-1.2])
        self._log(record.stamp, '/map/echoes', points)


def from_above(points: FloatArray) -> FloatArray:
    """Points (n, 3) in ``map`` as seen from above (n, 2): north is up on the screen."""
    return points[:, :2] * [1.0, -1.0]


def _outline(school: SchoolTruth) -> FloatArray:
    """Outline (n, 2) of a school from above."""
    turn = np.linspace(0.0, 2.0 * np.pi, 37)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    outline: FloatArray = from_above(school.position[None]) + 0.5 * school.size[:2] * circle
    return outline
