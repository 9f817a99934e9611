"""Scene of the sea in space and from above: schools of fish, and echoes of the trawl sonar."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.records.truth import SchoolTruth
from trawl_ros.view.records import Echoes, Schools, SeenSchools
from trawl_ros.view.sonar_screen import LINE, THIN, LogAt
from trawl_ros.view.viewer.rerun_library import rr

FISH = (242, 166, 102)
ECHO = (1.0, 0.75, 0.3)


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
