"""Gear that tests of tows in motion share."""

import pytest

from trawl_ros.model.gear_model import build_model


@pytest.fixture(scope='module')
def coarse(gear):
    """The gear with its netting as coarse as it may be."""
    return build_model(
        gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})
    )
