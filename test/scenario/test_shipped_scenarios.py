"""The scenarios that come with the package: each loads, is told in a line, and runs.

They run in shortened form here: the same steps, faults and weather in half a minute each, with
the gear cut coarsely. Whole, `trawl tow NAME --out BAG` runs them.
"""

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.resources import share_path
from trawl_ros.messages.cdr import serialize
from trawl_ros.model.gear_model import build_model
from trawl_ros.scenario.recording import recorded_messages
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import Scenario, load_scenario

SHIPPED = (
    'shakedown',
    'paper_trial',
    'cross_current',
    'shear',
    'rough_sea',
    'shoot_and_haul',
    'failing_counter',
    'dropouts',
    'reciprocal_tracks',
    'quiet_day',
    'states_by_autotrawl',
)
SECONDS = 30.0
SHORTEST_STEP_S = 1.0


def load(name: str) -> Scenario:
    return load_scenario(share_path('config', 'scenarios', f'{name}.yaml'))


def shortened(scenario: Scenario, seconds: float) -> Scenario:
    """The same trial with all its times in proportion, and its gear cut coarsely."""
    record = scenario.record
    share = seconds / scenario.duration_s
    steps = tuple(
        step.model_copy(update={'minutes': max(share * step.minutes, SHORTEST_STEP_S / 60)})
        for step in record.steps
    )
    faults = tuple(
        fault.model_copy(
            update={
                'at_min': share * fault.at_min,
                'for_min': fault.for_min and share * fault.for_min,
            }
        )
        for fault in record.faults
    )
    sea = record.sea
    if sea.heave is not None:
        grown = {'begin_minutes': share * sea.heave.begin_minutes, 'growth_minutes': 0.25}
        sea = sea.model_copy(update={'heave': sea.heave.model_copy(update=grown)})
    plant = scenario.plant
    netting = plant.netting.model_copy(update={'around': 12})
    return replace(
        scenario,
        record=record.model_copy(update={'steps': steps, 'faults': faults, 'sea': sea}),
        plant=plant.model_copy(update={'netting': netting}),
    )


def test_all_are_there_and_told_in_one_line_each():
    result = CliRunner().invoke(trawl, ['scenarios'], env={'COLUMNS': '200'})
    assert result.exit_code == 0, result.output
    lines = {line.split()[0]: line for line in result.output.splitlines() if line.strip()}
    for name in SHIPPED:
        assert load(name).record.description in lines[name]
        text = share_path('config', 'scenarios', f'{name}.yaml').read_text()
        assert text.startswith('# '), 'its comment says what it shows'


@pytest.mark.parametrize('name', SHIPPED)
def test_it_runs_to_its_end_with_every_instrument_on(name):
    scenario = shortened(load(name), SECONDS)
    trial = Trial(scenario, model=build_model(scenario.plant))
    counts: Counter[str] = Counter()
    for _, messages in recorded_messages(trial):
        for topic, message in messages:
            assert serialize(message)
            counts[topic] += 1
    assert trial.time_s == pytest.approx(trial.duration_s, abs=1.0 / scenario.record.truth_rate_hz)
    truth = trial.simulation.truth()
    assert np.isfinite(truth.net.mouth).all()
    assert all(math.isfinite(winch.tension) and winch.tension > 0 for winch in truth.winches)
    for topic in ('winch/joint_states', 'door/port/attitude', 'sonar/pressure', 'vessel/fix'):
        assert counts[topic], topic


def test_steps_faults_and_controllers_cover_what_a_file_can_say():
    steers, works, faults = set(), set(), set()
    for name in SHIPPED:
        scenario = load(name)
        for step in scenario.record.steps:
            if step.steer is not None:
                steers |= step.steer.model_fields_set - {'max_turn_deg_s', 'look_ahead_m'}
            if step.autotrawl is not None:
                works.add(step.autotrawl.mode)
        faults |= {fault.what.split()[0] for fault in scenario.record.faults}
    assert steers == {'heading_deg', 'course_deg', 'track_m', 'to_school'}
    assert works == {'lengths', 'tension'}
    assert {'drift', 'frozen', 'silent', 'dropouts', 'late', 'lost'} <= faults
