# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion between positions in ``map`` and latitude and longitude.

``map`` is the tangent plane of the ellipsoid WGS 84 at the datum (NIMA TR8350.2). A point is
rotated from east, north, up at the datum to geocentric coordinates. Bowring's formula (1976) then
gives the latitude, with an error far below a millimetre near the surface.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray

SEMI_MAJOR_M = 6_378_137.0
FLATTENING = 1 / 298.257_223_563
_SEMI_MINOR = SEMI_MAJOR_M * (1 - FLATTENING)
_ECCENTRICITY_2 = FLATTENING * (2 - FLATTENING)
_SECOND_ECCENTRICITY_2 = _ECCENTRICITY_2 / (1 - _ECCENTRICITY_2)


@dataclass(frozen=True)
class Datum:
    """Datum: latitude and longitude (degrees, WGS 84) of the origin of ``map``."""

    latitude: float
    longitude: float


def to_latitude_longitude(position: FloatArray, datum: Datum) -> tuple[float, float]:
    """Return latitude and longitude (degrees) of a position (3,) in ``map``, m."""
    east, north, up = (float(part) for part in position)
    lat, lon = math.radians(datum.latitude), math.radians(datum.longitude)
    curvature = SEMI_MAJOR_M / math.sqrt(1 - _ECCENTRICITY_2 * math.sin(lat) ** 2)
    # Distances from and along the Earth's axis, in the meridian plane of the datum.
    outward = (curvature + up) * math.cos(lat) - north * math.sin(lat)
    axial = (curvature * (1 - _ECCENTRICITY_2) + up) * math.sin(lat) + north * math.cos(lat)
    longitude = lon + math.atan2(east, outward)
    distance = math.hypot(outward, east)
    parametric = math.atan2(axial * SEMI_MAJOR_M, distance * _SEMI_MINOR)
    latitude = math.atan2(
        axial + _SECOND_ECCENTRICITY_2 * _SEMI_MINOR * math.sin(parametric) ** 3,
        distance - _ECCENTRICITY_2 * SEMI_MAJOR_M * math.cos(parametric) ** 3,
    )
    return math.degrees(latitude), math.degrees(math.remainder(longitude, 2 * math.pi))


def to_east_north(
    latitudes: FloatArray, longitudes: FloatArray, datum: Datum
) -> tuple[FloatArray, FloatArray]:
    """Return east and north (n,) in ``map``, m, of places (n,) on the ellipsoid, degrees.

    This is the inverse of `to_latitude_longitude`, without the height.
    """
    lat, lon = np.radians(latitudes), np.radians(longitudes - datum.longitude)
    at = math.radians(datum.latitude)
    outward, axial = _in_meridian_plane(lat)
    outward_at, axial_at = _in_meridian_plane(np.array(at))
    along = outward * np.cos(lon) - outward_at
    north = (axial - axial_at) * math.cos(at) - along * math.sin(at)
    return outward * np.sin(lon), north


def _in_meridian_plane(latitude: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distance (m) from the Earth's axis and the height above the equator."""
    curvature = SEMI_MAJOR_M / np.sqrt(1 - _ECCENTRICITY_2 * np.sin(latitude) ** 2)
    return curvature * np.cos(latitude), curvature * (1 - _ECCENTRICITY_2) * np.sin(latitude)
