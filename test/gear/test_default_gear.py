"""The default gear's model is what it was: figures of every array, stored when it was last changed
on purpose.
"""

from typing import Any

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model

FIGURES = {
    'bars.stiffness': (2175, 19345008.696676858),
    'bars.damping_time': (2175, 0.14166783694779092),
    'bars.mass': (2175, 11.067705636635182),
    'bars.volume': (2175, 0.013156713979732074),
    'bars.normal_area': (2175, -0.038600834570300085),
    'bars.wet_area': (2175, -0.12126809830848971),
    'bars.normal_drag': (2175, 0.20631045533964865),
    'bars.friction': (2175, 0.007438464562186508),
    'bars.added_normal': (2175, 1.0162871339878878),
    'bars.added_tangential': (2175, 0.0),
    'bars.bow': (2175, 0.0),
    'bars.normal_viscous': (2175, 0.11049186458385658),
    'bars.friction_viscous': (2175, 1.6711894518308306),
    'rest': (2175, -22.131223054322707),
    'ends': (4350, 733.5846780891708),
    'warp_side': (2175, 0.8830449140885697),
    'lump_mass': (1126, -1137.15669783062),
    'lump_volume': (1126, -0.1457949414445258),
    'lump_drag_area': (1126, 19.156707805096502),
    'lump_viscous_area': (1126, 4.829643483291197),
    'lump_added': (1126, -0.0728974707222629),
    'first_guess': (3378, -90.46727563876146),
    'net': (1076, 1057.0040757469428),
    'headrope': (25, 4.226052108706959),
    'footrope': (25, 5.90143053006976),
    'kite': (6, 0.34635637913638806),
    'points': (9, 0.7160533247739016),
    'inertia': (9, 1838.2303215837821),
    'coefficients': (12, -1.5270333176692787),
}
"""Size of each array, and its sum with the weights cos 0, cos 1, cos 2 …, which see every place."""


@pytest.fixture(scope='module')
def arrays() -> dict[str, Any]:
    model = build_model(load_gear('kaifuha'))
    return {
        **{f'bars.{name}': values for name, values in vars(model.bars).items()},
        'rest': model.rest,
        'ends': model.ends,
        'warp_side': model.warp_side,
        'lump_mass': model.lump_mass,
        'lump_volume': model.lump_volume,
        'lump_drag_area': model.lump_drag_area,
        'lump_viscous_area': model.lump_viscous_area,
        'lump_added': model.lump_added,
        'first_guess': model.first_guess,
        'net': model.layout.net,
        'headrope': model.layout.headrope,
        'footrope': model.layout.footrope,
        'kite': model.layout.kite.weights,
        'points': model.board.points,
        'inertia': model.board.inertia,
        'coefficients': model.coefficients,
    }


@pytest.mark.parametrize('name', FIGURES)
def test_an_array_of_the_default_gear_is_unchanged(arrays: dict[str, Any], name: str) -> None:
    values = np.nan_to_num(np.asarray(arrays[name], float).ravel())
    weights = np.cos(np.arange(len(values)))
    size, figure = FIGURES[name]
    assert len(values) == size
    # The order of a sum may differ from machine to machine, the arrays do not.
    close = 1e-13 * np.abs(values).sum() + 1e-300
    assert np.sum(values * weights) == pytest.approx(figure, abs=close, rel=0)
