"""Swept area and volume of a haul: exact for exact readings, and with intervals that hold.

``python test/api/test_swept.py 200 12 10`` prints the study: 12 gears that differ from their file,
from number 200 on, each with 10 sets of instruments. Their errors of calibration are drawn as the
registry states them.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from trawl_ros import load_gear, simulate
from trawl_ros.api.swept import OPTIONS, swept_of_samples
from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import BagError, InstrumentError, NoSteadyState
from trawl_ros.core.resources import share_path
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.doors import DoorInstruments
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import InstrumentParameters, default_instruments_with
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.instruments.winch import WinchInstruments
from trawl_ros.records.channels import CHANNELS, Channel
from trawl_ros.records.samples import RangeSample, Sample, VelocitySample, WinchSample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import Truth

SECOND = 1_000_000_000
SCENARIO = """\
description: A haul with a step of speed and warp
gear: {gear}
seed: {seed}
start: {{warp_length_m: 450.0, speed_m_s: 2.0}}
steps:
  - {{name: first, minutes: 6.0}}
  - {{name: second, minutes: 8.0, speed_m_s: 2.2, warp_length_m: 480.0}}
truth_rate_hz: 2.0
record: [instruments]
"""


def coarse() -> GearRecord:
    return load_gear('kaifuha').refined(net=0.25)


def exact(spread: float = 150.0, speed: float = 2.0, seconds: int = 600) -> Iterator[Sample]:
    """Samples of a haul in which nothing changes, without errors."""
    for second in range(seconds):
        stamp = second * SECOND
        yield WinchSample(stamp, (500.0, 500.0), (0.0, 0.0), (1e5, 1e5))
        yield VelocitySample(stamp, 'ground', np.array([0.0, speed + 0.2, 0.0]), 0.0)
        yield VelocitySample(stamp, 'water', np.array([speed, 0.0, 0.0]), 0.0)
        # One reading of ten is a false echo.
        shown = spread + (210.0 if second % 10 == 3 else 0.0)
        yield RangeSample(stamp, 'spread', shown, 0.5, 1.0, 400.0)


def test_exact_readings_give_the_exact_area() -> None:
    found = {one.name: one for one in swept_of_samples(exact(), coarse())}
    seconds = 599.0
    assert found['distance over ground'].value == pytest.approx(2.2 * seconds, rel=1e-3)
    assert found['distance through water'].value == pytest.approx(2.0 * seconds, rel=1e-3)
    between = found['area between the doors']
    assert between.value == pytest.approx(150.0 * 2.2 * seconds, rel=1e-3)
    assert between.source == 'measured'
    low, high = between.interval
    assert 0.01 < (high - low) / between.value < 0.06
    net = found['area of the net']
    assert net.value < between.value
    assert 'modelled' in net.source
    assert net.half_width / net.value > OPTIONS.width_half


def test_the_way_over_ground_counts_for_the_area_and_that_through_water_for_the_volume() -> None:
    slow = {one.name: one.value for one in swept_of_samples(exact(speed=1.9), coarse())}
    fast = {one.name: one.value for one in swept_of_samples(exact(speed=2.1), coarse())}
    assert fast['area between the doors'] / slow['area between the doors'] == pytest.approx(
        2.3 / 2.1, rel=1e-3
    )
    volume, width, height = (
        fast[name] / slow[name]
        for name in ('volume of the net', 'width of the mouth, mean', 'height of the mouth, mean')
    )
    assert volume / (width * height) == pytest.approx(2.1 / 1.9, rel=1e-3)


def test_missing_readings_are_named() -> None:
    without = (one for one in exact() if not isinstance(one, RangeSample))
    with pytest.raises(BagError, match='door/spread'):
        swept_of_samples(without, coarse())


def test_the_command_says_what_is_measured(tmp_path: Path) -> None:
    log, mapping = tmp_path / 'log.csv', tmp_path / 'log.yaml'
    rows = [f'{second},500,500,2.1,90,150,2.0' for second in range(0, 400, 2)]
    log.write_text('\n'.join(['s,p,q,sog,cog,spread,stw', *rows]) + '\n')
    mapping.write_text(
        "clock: {columns: [s], format: elapsed seconds, start: '2026-08-01 12:00:00'}\n"
        'topics:\n'
        '  winch/joint_states:\n'
        '    fields: {port_length: {column: p, unit: m}, starboard_length: {column: q, unit: m}}\n'
        '  vessel/velocity_ground:\n'
        '    fields: {speed: {column: sog, unit: m/s}, compass_course: {column: cog, unit: deg}}\n'
        '  vessel/velocity_water: {fields: {forward: {column: stw, unit: m/s}}}\n'
        '  door/spread: {fields: {distance: {column: spread, unit: m}}}\n'
    )
    import_log(log, mapping, tmp_path / 'bag')
    gear = tmp_path / 'coarse.yaml'
    text = share_path('config', 'gear', 'kaifuha.yaml').read_text()
    gear.write_text(text.replace('around: 48', 'around: 12'))
    done = CliRunner().invoke(trawl, ['swept', str(tmp_path / 'bag'), '--gear', str(gear)])
    assert done.exit_code == 0, done.output
    row = next(line for line in done.output.splitlines() if 'area between the doors' in line)
    assert 'measured' in row


def changed_gear(draws: np.random.Generator) -> dict[str, Any]:
    """A gear that differs from its file as gears do."""
    data: dict[str, Any] = yaml.safe_load(share_path('config', 'gear', 'kaifuha.yaml').read_text())
    data['netting']['around'] = 12
    for name in ('a2', 'c2', 'a1'):
        data['board']['coefficients'][name] *= float(1 + 0.05 * draws.normal())
    for record, key, share in (
        ('bridle', 'length_m', 0.1), ('netting', 'normal_drag', 0.3), ('kite', 'area_m2', 0.3),
        ('clump', 'weight_in_water_n', 0.3), ('footrope', 'weight_in_water_n_m', 0.3),
    ):  # fmt: skip
        data[record][key] *= float(np.exp(share * draws.normal()))
    return data


def truth_of(truths: list[Truth]) -> dict[str, float]:
    """True values of a haul by the names of the result."""
    first, last = truths[0].stamp, truths[-1].stamp
    step = (last - first) / (len(truths) - 1) / SECOND
    ground = np.array([np.hypot(*truth.vessel.velocity_ground[:2]) for truth in truths])[1:]
    water = np.array([truth.vessel.velocity_water[0] for truth in truths])[1:]
    seen = [truth.observables for truth in truths][1:]
    spread, wide, high = (
        np.array([getattr(one, name) for one in seen])
        for name in ('door_spread', 'horizontal_opening', 'vertical_opening')
    )
    return {
        'distance over ground': float(ground.sum() * step),
        'distance through water': float(water.sum() * step),
        'door spread, mean': float(spread.mean()),
        'width of the mouth, mean': float(wide.mean()),
        'height of the mouth, mean': float(high.mean()),
        'area between the doors': float((spread * ground).sum() * step),
        'area of the net': float((wide * ground).sum() * step),
        'volume of the net': float((wide * high * water).sum() * step),
    }


def instruments(draws: np.random.Generator) -> InstrumentParameters:
    """Default instruments with errors of calibration."""
    spread, speed = CHANNELS['door_spread'], CHANNELS['speed']

    def errors(channel: Channel, unit: str) -> dict[str, float]:
        return {
            'scale_error': float(channel.bias_fraction * draws.normal()),
            f'offset_{unit}': float(channel.bias * draws.normal()),
        }

    return default_instruments_with(
        {
            'door': {'spread': errors(spread, 'm')},
            'vessel': {'velocity_water': {'velocity': errors(speed, 'm_s')}},
        },
        'study',
        InstrumentError,
        prefix='instruments',
    )


def coverage(gears: range, seeds: int, folder: Path) -> dict[str, list[tuple[float, float]]]:
    """Errors over half widths of the interval, and relative half widths, by quantity."""
    errors: dict[str, list[tuple[float, float]]] = {}
    surroundings = Surroundings(pressure_at=lambda depth: 101_325.0 + 10_052.0 * depth)
    for gear in gears:
        draws = np.random.default_rng(gear)
        (folder / 'gear.yaml').write_text(yaml.safe_dump(changed_gear(draws)))
        (folder / 'haul.yaml').write_text(SCENARIO.format(gear=folder / 'gear.yaml', seed=gear))
        try:
            truths = list(simulate(folder / 'haul.yaml'))
        except NoSteadyState:
            continue  # a gear that nobody could tow
        wanted = truth_of(truths)
        for seed in range(seeds):
            parameters = instruments(np.random.default_rng(seed + 1000 * gear))
            plan = SeedPlan(seed=1000 * gear + seed)
            groups = (
                WinchInstruments(parameters.winch, plan),
                DoorInstruments(parameters.door, plan, surroundings=surroundings),
                VesselInstruments(parameters.vessel, plan, surroundings=surroundings),
            )
            samples = (one for t in truths for group in groups for one in group.observe(t))
            for value in swept_of_samples(samples, coarse()):
                error = (value.value - wanted[value.name]) / value.half_width
                errors.setdefault(value.name, []).append((error, value.half_width / value.value))
    return errors


def share_within(errors: list[tuple[float, float]]) -> float:
    """Share of the hauls whose 95 % interval has the truth in it."""
    return float(np.mean([abs(error) <= 1.0 for error, _ in errors]))


@pytest.mark.slow
def test_intervals_hold_the_truth(tmp_path: Path) -> None:
    for name, errors in coverage(range(200, 204), 10, tmp_path).items():
        assert share_within(errors) >= 0.75, name


if __name__ == '__main__':
    import tempfile

    first, gears, seeds = map(int, sys.argv[1:])
    with tempfile.TemporaryDirectory() as place:
        table = coverage(range(first, first + gears), seeds, Path(place))
    say = sys.stdout.write
    say('| quantity | hauls | truth in the 95 % interval | mean half width | error, rms |\n')
    say('|---|---|---|---|---|\n')
    for name, errors in table.items():
        sizes = np.array(errors)
        say(
            f'| {name} | {len(errors)} | {100 * share_within(errors):.0f} % | '
            f'{100 * sizes[:, 1].mean():.1f} % | '
            f'{100 * np.sqrt(np.mean(np.prod(sizes, axis=1) ** 2)):.1f} % |\n'
        )
