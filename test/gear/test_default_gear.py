"""The default gear's model is what it was: figures of every array, stored when it was last changed
on purpose.
"""

from typing import Any

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model

FIGURES = {
    'bars.stiffness': (2151, 12067211.106500935),
    'bars.damping_time': (2151, 0.16435883623581604),
    'bars.mass': (2151, 1.7620754717593725),
    'bars.volume': (2151, 0.005364522654553858),
    'bars.normal_area': (2151, 0.0002522592634468246),
    'bars.wet_area': (2151, 0.0007924958488446515),
    'bars.normal_drag': (2151, 1.3372433022125945),
    'bars.friction': (2151, 0.02684926616030157),
    'bars.added_normal': (2151, 1.5395935420157791),
    'bars.added_tangential': (2151, 0.0),
    'bars.bow': (2151, 0.0),
    'bars.normal_viscous': (2151, 0.10770879212269918),
    'bars.friction_viscous': (2151, 1.6290954808558218),
    'rest': (2151, -23.065858828566263),
    'ends': (4302, -837.9209735946638),
    'warp_side': (2151, 0.35973850606067814),
    'lump_mass': (1114, -1022.633045442457),
    'lump_volume': (1114, 0.23597578162295435),
    'lump_drag_area': (1114, 21.48599235087187),
    'lump_viscous_area': (1114, 6.381975723262223),
    'lump_added': (1114, 0.11798789081147718),
    'first_guess': (3342, 247.56924041892512),
    'net': (1064, 1182.213906524014),
    'headrope': (25, 4.226052108706959),
    'footrope': (25, 5.90143053006976),
    'kite': (6, 1.040535964496704),
    'points': (9, 2.3866014269637366),
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
