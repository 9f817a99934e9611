"""A log against a gear file as it is; all logs are synthetic."""

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros import compare, load_gear
from trawl_ros.cli.main import trawl
from trawl_ros.comparison.comparison import Comparison
from trawl_ros.comparison.reading import read_log
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import Sample, VelocitySample


def relative(found: Comparison) -> dict[str, float]:
    """Differences by channel, parts of the prediction."""
    return {sensor.channel: sensor.relative for sensor in found.sensors}


@pytest.mark.usefixtures('rough_pictures')
def test_one_command_reports_every_sensor_that_differs(
    off_log: Path, coarse_gear: Path, tmp_path: Path
) -> None:
    out = tmp_path / 'out'
    words = ['compare', str(off_log), '--gear', str(coarse_gear), '--out', str(out)]
    done = CliRunner().invoke(trawl, words, catch_exceptions=False)
    assert done.exit_code == 0
    found = json.loads((out / 'comparison.json').read_text())
    off = {sensor['channel']: sensor['mean']['fraction'] for sensor in found['sensors']}
    assert off['door_spread'] == pytest.approx(-0.06, abs=0.003)
    for side in ('port', 'starboard'):
        assert off[f'{side}_tension'] == pytest.approx(0.07, abs=0.003)
        assert off[f'{side}_door_depth'] == pytest.approx(0.05, abs=0.003)
    assert found['verdict']['step'] == 'identify'
    assert found['verdict']['sentence'] in done.output
    assert '6.0 % narrower' in done.output
    assert len(found['states']) == 4
    page = (out / 'comparison.html').read_text()
    assert found['verdict']['sentence'] in page
    assert page.count('<img') == len(list(out.glob('*.png'))) == 3


def test_a_log_of_the_gear_itself_agrees(changed_log, coarse_gear: Path) -> None:
    found = compare([changed_log({})], gear=coarse_gear)
    assert found.verdict.agrees
    assert found.verdict.step == 'none'
    assert max(abs(part) for part in relative(found).values()) < 0.005
    (course,) = found.courses
    near = np.isfinite(course.reference['door_spread'])
    assert near.mean() > 0.7
    off = course.measured['door_spread'] - course.reference['door_spread']
    assert np.nanmax(np.abs(off)) < 1.0


def test_a_sensor_that_contradicts_all_others_is_named(changed_log, coarse_gear: Path) -> None:
    found = compare([changed_log({'port_tension': 1.12})], gear=coarse_gear)
    assert found.verdict.suspects == ('port_tension',)
    assert 'port tension' in found.next_step
    assert relative(found)['port_tension'] == pytest.approx(0.12, abs=0.003)
    assert relative(found)['starboard_tension'] == pytest.approx(0.0, abs=0.003)


def test_two_logs_are_two_tows(changed_log, off_log: Path, coarse_gear: Path) -> None:
    other = changed_log({'door_spread': 0.96}, seed=5)
    found = compare([off_log, other], gear=coarse_gear)
    assert [state.log for state in found.states] == [0] * 4 + [1] * 4
    assert len(found.courses) == 2
    assert relative(found)['door_spread'] == pytest.approx(-0.05, abs=0.003)
    # Time is no axis that two tows share.
    assert {t.axis for sensor in found.sensors for t in sensor.trends} == {'warp', 'speed'}


def test_the_error_holds_what_averaging_cannot_remove(off_log: Path, coarse_gear: Path) -> None:
    found = compare([off_log], gear=coarse_gear)
    assert found.verdict.step == 'identify'
    spread = next(sensor for sensor in found.sensors if sensor.channel == 'door_spread')
    # Calibration of the spread sensor: 0.5 m and 0.5 %.
    assert spread.mean.std > math.hypot(0.5, 0.005 * spread.mean.measured)
    assert spread.mean.scaled < -3.0


def test_a_log_without_a_steady_state_is_refused(changed_log, coarse_gear: Path) -> None:
    with pytest.raises(TrawlError, match='steady'):
        compare([changed_log({}, leg_s=60)], gear=coarse_gear)


def test_a_table_is_compared_with_its_mapping(off_log: Path, coarse_gear: Path, tmp_path: Path):
    from trawl_ros import read_bag
    from trawl_ros.records.samples import RangeSample, VelocitySample, WinchSample

    rows = ['s,port,starboard,pull_port,pull_starboard,speed,spread']
    row: dict[str, str] = {}
    for sample in read_bag(off_log):
        seconds = sample.stamp // 1_000_000_000
        if isinstance(sample, WinchSample):
            pulls = ','.join(f'{tension / 9806.65:.4f}' for tension in sample.tensions)
            row['winch'] = f'{seconds},{sample.lengths[0]},{sample.lengths[1]},{pulls}'
        elif isinstance(sample, RangeSample):
            row['spread'] = f'{sample.distance:.3f}'
        elif isinstance(sample, VelocitySample):
            rows.append(f'{row["winch"]},{sample.velocity[0]:.4f},{row["spread"]}')
    (tmp_path / 'log.csv').write_text('\n'.join(rows) + '\n')
    (tmp_path / 'log.yaml').write_text("""
clock: {columns: [s], format: elapsed seconds, start: '2026-08-01 12:00:00'}
topics:
  winch/joint_states:
    fields:
      port_length: {column: port, unit: m}
      starboard_length: {column: starboard, unit: m}
      port_tension: {column: pull_port, unit: tf}
      starboard_tension: {column: pull_starboard, unit: tf}
  vessel/velocity_water:
    fields: {forward: {column: speed, unit: m/s}}
  door/spread:
    fields: {distance: {column: spread, unit: m}}
    std: {value: 0.3, unit: m}
    min_range: {value: 1.0, unit: m}
    max_range: {value: 500.0, unit: m}
""")
    found = compare([tmp_path / 'log.csv'], gear=coarse_gear, mapping=tmp_path / 'log.yaml')
    assert relative(found)['door_spread'] == pytest.approx(-0.06, abs=0.003)
    assert relative(found)['port_tension'] == pytest.approx(0.07, abs=0.003)
    assert 'net_depth' not in relative(found)


def test_a_gust_does_not_make_two_states_of_one(four_states: Any, coarse_gear: Path, tmp_path):
    one_leg = replace(four_states, states=four_states.states[:1])

    def samples() -> Iterator[Sample]:
        for sample in one_leg.samples(leg_s=1000):
            if isinstance(sample, VelocitySample) and 450 <= sample.stamp // SECOND < 470:
                yield replace(sample, velocity=sample.velocity + np.array([0.3, 0.0, 0.0]))
            else:
                yield sample

    bag = one_leg.write(tmp_path / 'bag', samples())
    windows = read_log(bag, load_gear(coarse_gear), 'trawl').found.windows
    assert min(window.start_ns for window in windows) < 450 * SECOND
    assert max(window.start_ns for window in windows) > 470 * SECOND
    assert {window.state for window in windows} == {0}
