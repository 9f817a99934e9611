"""Out of ``map`` and back."""

import numpy as np
import pytest

from trawl_ros.core.geodesy import Datum, to_east_north, to_latitude_longitude


@pytest.mark.parametrize('datum', [Datum(0.0, 0.0), Datum(62.5, 5.3), Datum(-45.0, 179.95)])
def test_a_place_comes_back(datum):
    places = np.array([[0.0, 0.0], [9_000.0, -4_000.0], [-15_000.0, 12_000.0]])
    found = [to_latitude_longitude(np.array([*place, 0.0]), datum) for place in places]
    latitudes, longitudes = np.array(found).T
    # A plane 19 km away lies 29 m above the ellipsoid, where a degree is longer by 5 in a million.
    np.testing.assert_allclose(
        np.column_stack(to_east_north(latitudes, longitudes, datum)), places, atol=0.1
    )


def test_a_minute_of_latitude_is_a_nautical_mile():
    east, north = to_east_north(np.array([45.0 + 1 / 60]), np.array([10.0]), Datum(45.0, 10.0))
    assert north[0] == pytest.approx(1852.0, abs=1.0)
    assert east[0] == 0.0
