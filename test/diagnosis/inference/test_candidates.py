"""Where the search for an effect starts."""

from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis.inference.candidates import lower_edges
from trawl_ros.effects.registry import catalogue


def window(**means):
    return SimpleNamespace(window=SimpleNamespace(means=means))


def test_the_lower_edge_lies_by_the_opening_below_the_headline():
    whole = window(net_depth=160.0, vertical_opening=60.0)
    without_opening = window(net_depth=200.0)
    without_net = window(port_door_depth=100.0, starboard_door_depth=104.0, vertical_opening=50.0)
    nothing = window()
    found = lower_edges([whole, without_opening, without_net, nothing])
    assert found == pytest.approx([220.0, 255.0, 152.0])
    assert lower_edges([without_opening]) == pytest.approx([200.0])
    assert lower_edges([nothing]) == pytest.approx([0.0])


def test_the_ground_is_looked_for_between_the_depths_of_the_wing_tips():
    tips = np.linspace(100.0, 250.0, 31)
    depths = [depth for _, depth in catalogue()['bottom_contact'].starts(tips)]
    assert max(np.diff(depths)) < 16.0
    assert max(depths) > 230.0
