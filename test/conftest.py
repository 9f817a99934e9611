"""The default gear, whole and cut coarsely."""

import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model


@pytest.fixture(scope='session')
def gear() -> GearRecord:
    return load_gear('kaifuha')


@pytest.fixture(scope='session')
def default_model(gear: GearRecord) -> GearModel:
    return build_model(gear)


@pytest.fixture(scope='session')
def model(gear: GearRecord) -> GearModel:
    """The gear with its netting as coarse as it may be, which is quicker and no less general."""
    return build_model(
        gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})
    )
