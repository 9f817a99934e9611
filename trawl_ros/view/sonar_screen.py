"""Screen of the trawl sonar: its sweep, with what is read off it and what is there."""

from typing import Protocol

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.plots.sonar import PIXELS, seen
from trawl_ros.view.records import Quantities, Section, Sweep
from trawl_ros.view.viewer.rerun_library import rr

LINE, THIN = -1.3, -0.7
"""Widths of lines in points of the screen, which Rerun takes for negative radii."""

RINGS = 4
RING, TRUE, READ_OFF = (120, 120, 120), (255, 255, 255), (77, 210, 255)


class LogAt(Protocol):
    """Function that logs at a stamp (ns) what an entity shows from then on."""

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
        """Show the ropes and twine that are there."""
        if self._reach is not None:
            points = _on_screen(section.points, self._reach)
            shown = rr.Points2D(points, colors=[TRUE], radii=[-1.5])
            self._log(section.stamp, '/sonar/truth', shown)

    def opening(self, readings: Quantities) -> None:
        """Show height and width as read off the image, from the sonar down and across."""
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
        """Draw circles of equal range, with their radii."""
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
