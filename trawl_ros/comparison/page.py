"""Files of a comparison: JSON, figures, and a self-contained HTML page."""

from pathlib import Path

from trawl_ros.comparison.comparison import ComparedCourse, Comparison
from trawl_ros.comparison.figures import drawings, side_of
from trawl_ros.comparison.summary import Compared, ComparedSensor, ComparedState
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.display_units import DisplayUnits, quantity_of
from trawl_ros.core.files import finite, made_folder, write_json, write_text
from trawl_ros.core.version import __version__
from trawl_ros.records.channels import CHANNELS
from trawl_ros.report.pictures import draw, embedded
from trawl_ros.report.rendering import page as filled

PAGE, DATA = 'comparison.html', 'comparison.json'

OUTSIDE_STD = 3.0
"""Std of its error beyond which a difference is marked."""


def write_comparison(comparison: Comparison, folder: Path, units: DisplayUnits) -> None:
    """Write ``comparison.json`` in SI units, the figures and ``comparison.html``.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    made_folder(folder)
    write_json(folder / DATA, content(comparison), indent=1)
    pictures = embedded(folder, draw(folder, drawings(comparison, units)))
    text = filled(
        'trawl_ros.comparison',
        PAGE,
        comparison=comparison,
        title=title(comparison),
        pictures=pictures,
        sensors=[sensor_row(sensor, units) for sensor in comparison.sensors],
        states=[_state_row(state, comparison, units) for state in comparison.states],
        version=__version__,
    )
    write_text(folder / PAGE, text)


def title(comparison: Comparison) -> str:
    """Return the heading."""
    names = [Path(log).name for log in comparison.logs]
    other = comparison.gear if comparison.kind == 'gear' else names.pop()
    return f'{", ".join(names)} and {Path(other).name}'


def sensor_row(sensor: ComparedSensor, units: DisplayUnits) -> dict[str, str | int | bool]:
    """Return the cells of a sensor: means over its states."""
    return {**_cells(sensor.channel, sensor.mean, units), 'states': sensor.states}


def _cells(channel: str, one: Compared, units: DisplayUnits) -> dict[str, str | int | bool]:
    """Return name, measured, reference, difference and std as text."""
    unit = CHANNELS[channel].unit
    quantity = quantity_of(channel, unit)
    sign = '+' if one.difference >= 0.0 else '−'
    return {
        'name': channel.replace('_', ' '),
        'side': side_of(channel),
        'measured': units.shown(one.measured, quantity).replace('-', '−'),
        'reference': units.shown(one.reference, quantity).replace('-', '−'),
        'difference': f'{sign}{units.shown(abs(one.difference), quantity)}',
        'percent': '' if unit == 'rad' else f'{100.0 * one.fraction:+.1f} %'.replace('-', '−'),
        'scaled': f'{one.scaled:+.1f}'.replace('-', '−'),
        'outside': abs(one.scaled) > OUTSIDE_STD,
    }


def _state_row(
    state: ComparedState, comparison: Comparison, units: DisplayUnits
) -> dict[str, object]:
    return {
        'log': Path(comparison.logs[state.log]).name,
        'hours': f'{state.hours:.2f}',
        'minutes': state.minutes,
        'warp': units.shown(state.warp, 'warp', 0),
        'speed': units.shown(state.inputs[2], 'speed'),
        'sensors': [_cells(name, one, units) for name, one in state.sensors.items()],
    }


def content(comparison: Comparison) -> dict[str, object]:
    """Return the content of ``comparison.json`` in SI units, None where a number is missing."""
    verdict = comparison.verdict
    return {
        'kind': comparison.kind,
        'logs': list(comparison.logs),
        'gear': comparison.gear,
        'compared': list(comparison.names),
        'verdict': {
            'sentence': verdict.sentence,
            'agrees': verdict.agrees,
            'step': verdict.step,
            'suspects': list(verdict.suspects),
            'next_step': comparison.next_step,
            'p_values': {name: finite(value) for name, value in verdict.p_values.items()},
        },
        'sensors': {sensor.channel: _sensor(sensor) for sensor in comparison.sensors},
        'states': [
            {
                'log': comparison.logs[state.log],
                'hours': state.hours,
                'minutes': state.minutes,
                'warp_m': list(state.inputs[:2]),
                'speed_m_s': state.inputs[2],
                'sensors': {name: _numbers(one) for name, one in state.sensors.items()},
            }
            for state in comparison.states
        ],
        'courses': [_course(course) for course in comparison.courses],
        'notes': list(comparison.notes),
    }


def _sensor(sensor: ComparedSensor) -> dict[str, object]:
    return {
        'unit': sensor.unit,
        'states': sensor.states,
        **_numbers(sensor.mean),
        'trends': {
            trend.axis: {
                'ends': list(trend.ends),
                'at_ends': list(trend.at_ends),
                'scaled': finite(trend.scaled),
            }
            for trend in sensor.trends
        },
    }


def _numbers(one: Compared) -> dict[str, float | None]:
    return {
        'measured': one.measured,
        'reference': one.reference,
        'difference': one.difference,
        'fraction': finite(one.fraction),
        'std': one.std,
        'scaled': finite(one.scaled) if one.std else None,
    }


def _course(course: ComparedCourse) -> dict[str, object]:
    def listed(values: FloatArray) -> list[float | None]:
        return [finite(value) for value in values]

    return {
        'hours': listed(course.hours),
        'measured': {name: listed(values) for name, values in course.measured.items()},
        'reference': {name: listed(values) for name, values in course.reference.items()},
    }
