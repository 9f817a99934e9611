"""Numbers of a gear file, changed one at a time, and the steady state or refusal that follows."""

from collections.abc import Iterator

from trawl_ros.core.errors import GearError, NoSteadyState, TrawlError
from trawl_ros.core.schema import validated
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state

SPEED = 2.1
"""Speed of the tows, m/s."""

LEFT_OUT = 'identification', 'effects', 'water.temperature', 'water.salinity_g_kg'
"""Parts of a gear file on which no steady state depends."""


def numbers(gear: GearRecord) -> Iterator[str]:
    """Keys, joined by dots, of all numbers that are not zero; counts are left alone."""
    yield from _numbers(gear.model_dump(), '')


def _numbers(value: object, key: str) -> Iterator[str]:
    if key.startswith(LEFT_OUT):
        return
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _numbers(part, f'{key}.{name}' if key else name)
    elif isinstance(value, tuple):
        for place, part in enumerate(value):
            yield from _numbers(part, f'{key}.{place}')
    elif isinstance(value, float) and value:
        yield key


def changed(gear: GearRecord, key: str, factor: float) -> GearRecord:
    """Return the gear with one number multiplied.

    Raises
    ------
    GearError
        If a gear file may not have that number.
    """
    data = _scaled(gear.model_dump(), key.split('.'), factor)
    return validated(GearRecord, data, 'changed gear', GearError)


def _scaled(value: object, way: list[str], factor: float) -> object:
    """Copy of plain values with one of them multiplied."""
    if not way:
        assert isinstance(value, float)
        return factor * value
    if isinstance(value, tuple):
        place = int(way[0])
        return tuple(
            _scaled(part, way[1:], factor) if k == place else part for k, part in enumerate(value)
        )
    assert isinstance(value, dict)
    return {**value, way[0]: _scaled(value[way[0]], way[1:], factor)}


def tow_outcome(gear: GearRecord, key: str, factor: float, length: float) -> tuple[str, str]:
    """Give the outcome of a tow of the changed gear, in a word and in a sentence."""
    try:
        steady_state(build_model(changed(gear, key, factor)), length, SPEED)
    except NoSteadyState as refusal:
        return refusal.reason, str(refusal)
    except TrawlError as reason:
        return 'impossible', str(reason).replace('\n', ' ')
    return 'usable', ''
