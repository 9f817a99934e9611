"""Modules and memory of nodes: each loads what it uses, and the instruments fit in 120 MB."""

import json
import os
import subprocess
import sys

import pytest
import yaml

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.errors import ScenarioError
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import load_yaml
from trawl_ros.gear.records import EffectRecord
from trawl_ros.lab.running.own_graph import own_graph

HEAVY = ('dask', 'jinja2', 'jsonschema', 'llvmlite', 'matplotlib', 'numba', 'pandas', 'rich',
         'scipy', 'scipy.interpolate', 'scipy.optimize', 'scipy.stats')  # fmt: skip
MODEL = {'llvmlite', 'numba', 'scipy'}

LIMIT_MB = 120.0

INSTRUMENTS = [
    ('winch_node', 'WinchNode'),
    ('door_sensor_node', 'DoorSensorNode'),
    ('vessel_node', 'VesselNode'),
    ('trawl_sonar_node', 'TrawlSonarNode'),
]
OTHERS = [
    ('bag_recorder', 'BagRecorder'),
    ('autopilot_node', 'AutopilotNode'),
    ('trial_node', 'TrialNode'),
    ('autotrawl_node', 'AutotrawlNode'),
    ('nmea_in', 'NmeaIn'),
    ('nmea_out', 'NmeaOut'),
    ('foxglove_node', 'FoxgloveNode'),
]
ESTIMATORS = [
    ('identification_node', 'IdentificationNode'),
    ('discrepancy_node', 'DiscrepancyNode'),
]

CODE = """
import json, sys
import psutil, rclpy
from trawl_ros.nodes.{module} import {kind}

rclpy.init(args=['node', '--ros-args', *sys.argv[2:]])
node = {kind}()
loaded = [name for name in json.loads(sys.argv[1]) if name in sys.modules]
print(json.dumps([loaded, psutil.Process().memory_info().rss / 1e6]))
node.destroy_node()
"""


def started(module, kind, folder, **parameters):
    """Names of `HEAVY` that a node has loaded once it is made, and its resident memory (MB)."""
    options = [word for key, value in parameters.items() for word in ('-p', f'{key}:={value}')]
    with own_graph(folder) as environment:
        done = subprocess.run(
            [sys.executable, '-c', CODE.format(module=module, kind=kind), json.dumps(HEAVY)]
            + options,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            check=True,
            timeout=60.0,
        )
    loaded, memory_mb = json.loads(done.stdout.splitlines()[-1])
    return set(loaded), memory_mb


def with_effect(gear, folder):
    """Path of a scenario whose gear file switches on an effect, as instruments meet it."""
    effect = EffectRecord(name='speed_log', values={'bias': 0.3})
    path = folder / 'gear.yaml'
    path.write_text(
        yaml.safe_dump(gear.model_copy(update={'effects': (effect,)}).model_dump(mode='json'))
    )
    scenario = load_yaml(packaged('demo', 'scenarios'), ScenarioError) | {'gear': 'gear.yaml'}
    (folder / 'tow.yaml').write_text(yaml.safe_dump(scenario))
    return folder / 'tow.yaml'


@pytest.mark.parametrize(('module', 'kind'), INSTRUMENTS)
def test_an_instrument_loads_neither_the_model_nor_its_compiler(module, kind, gear, tmp_path):
    loaded, memory_mb = started(module, kind, tmp_path, scenario=with_effect(gear, tmp_path))
    assert not loaded
    assert memory_mb < LIMIT_MB


@pytest.mark.parametrize(('module', 'kind'), OTHERS)
def test_recorder_and_controllers_load_no_numerics(module, kind, tmp_path):
    needed = {'bag_recorder': {'output': tmp_path / 'bag'}, 'foxglove_node': {'port': 20235}}
    loaded, memory_mb = started(module, kind, tmp_path, **needed.get(module, {}))
    assert not loaded
    assert memory_mb < LIMIT_MB


@pytest.mark.parametrize(('module', 'kind'), ESTIMATORS)
def test_figures_are_loaded_with_the_report_only(module, kind, tmp_path):
    loaded, _ = started(module, kind, tmp_path)
    assert loaded == MODEL
