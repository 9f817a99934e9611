"""The catalogue is complete, takes effects of others, and gear files are held to it."""

import sys
from types import SimpleNamespace

import pytest

from trawl_ros.core.errors import GearError, TrawlError
from trawl_ros.effects import registry as module
from trawl_ros.effects.base.effect import Effect, Parameter
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.records import EffectRecord

PROMISED = {
    'current_shear', 'cross_current', 'speed_log', 'warp_strumming', 'counter_scale',
    'counter_offset', 'warp_asymmetry', 'catch_build_up', 'net_drag', 'board_stall', 'tilt_lift',
    'gear_weight', 'depth_sensor', 'tension_cell', 'spread_sensor', 'heave', 'bottom_contact',
    'board_added_mass', 'board_rigging', 'port_board_rigging', 'starboard_board_rigging',
    'board_damage', 'port_board_damage', 'starboard_board_damage', 'bridle_length',
    'port_bridle_length', 'starboard_bridle_length', 'floats', 'kite', 'port_clump',
    'starboard_clump', 'swapped_doors', 'swapped_cells', 'attitude_mount', 'leeway',
    'current_along_track', 'current_in_time', 'other_wire', 'port_net_damage',
    'starboard_net_damage', 'frozen_sensor',
}  # fmt: skip

FOREIGN = Effect(
    name='ice',
    sentence='Ice hangs on the warps.',
    parameters=(Parameter('mass', 'kg', 0.0, 0.0, 100.0, 10.0),),
    excited_by='cold',
)


@pytest.fixture
def points(monkeypatch):
    """Entry points of other packages."""
    found = []
    monkeypatch.setattr(module, 'entry_points', lambda group: found)
    catalogue.cache_clear()
    yield found
    catalogue.cache_clear()


def point(name, load):
    return SimpleNamespace(name=name, value=f'package:{name}', load=load)


def test_all_that_was_promised_is_there():
    assert set(catalogue()) == PROMISED


def test_every_effect_is_told_whole():
    for name, effect in catalogue().items():
        assert effect.name == name
        assert effect.sentence.endswith('.')
        assert set(effect.confused_with) <= PROMISED
        for parameter in effect.parameters:
            assert parameter.low <= parameter.neutral <= parameter.high
            assert 0.0 < parameter.std < parameter.high - parameter.low


def test_those_of_other_packages_are_found(points):
    points.append(point('ice', lambda: FOREIGN))
    assert catalogue()['ice'] is FOREIGN


def test_what_other_packages_get_wrong_is_told(points):
    def broken():
        raise ImportError('no such module')

    points.append(point('broken', broken))
    with pytest.raises(TrawlError, match='entry point broken = package:broken'):
        catalogue()
    points[:] = [point('leaving', lambda: sys.exit(0))]
    with pytest.raises(TrawlError, match='entry point leaving'):
        catalogue()
    points[:] = [point('number', lambda: 3)]
    with pytest.raises(TrawlError, match='entry point number'):
        catalogue()
    points[:] = [point('ice', lambda: FOREIGN), point('snow', lambda: FOREIGN)]
    with pytest.raises(TrawlError, match=r'entry point snow.* ice'):
        catalogue()


@pytest.mark.parametrize(
    ('record', 'key'),
    [
        (EffectRecord(name='ghost'), 'effects.0.name: found ghost'),
        (
            EffectRecord(name='heave', values={'height': 1.0}),
            'effects.0.values: found height',
        ),
        (
            EffectRecord(name='warp_strumming', values={'factor': 9.0}),
            'effects.0.values.factor: found 9',
        ),
    ],
)
def test_a_gear_file_is_held_to_it(gear, record, key):
    with pytest.raises(GearError, match=key):
        effects_of(gear.model_copy(update={'effects': (record,)}))


def test_values_that_are_not_given_are_neutral(gear):
    record = EffectRecord(name='speed_log', values={'bias': 0.1})
    (active,) = effects_of(gear.model_copy(update={'effects': (record,)})).effects
    assert active.values.tolist() == [0.0, 0.1]


def test_what_is_told_from_readings_alone_is_refused_in_a_gear_file(gear):
    record = EffectRecord(name='frozen_sensor', values={})
    with pytest.raises(GearError, match=r'effects\.0\.name: frozen_sensor'):
        effects_of(gear.model_copy(update={'effects': (record,)}))
