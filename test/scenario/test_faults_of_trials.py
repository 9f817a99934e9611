"""A trial's file brings faults at times and places, or is told why it cannot."""

from pathlib import Path

import pytest

from trawl_ros.core.errors import ScenarioError
from trawl_ros.instruments.errors.fault_plan import PlannedFault
from trawl_ros.scenario.scenario import load_scenario

TRIAL = """\
description: a counter fails
gear: kaifuha
start: {{warp_length_m: 300, speed_m_s: 2.0}}
steps: [{{name: hold, minutes: 30}}]
faults:
  - {fault}
"""


def load(folder: Path, fault: str):
    path = folder / 'trial.yaml'
    path.write_text(TRIAL.format(fault=fault))
    return load_scenario(path)


def test_faults_are_planned_in_seconds(tmp_path: Path) -> None:
    counter = 'winch/joint_states/port/length'
    found = load(tmp_path, f'{{at_min: 2, for_min: 3, where: {counter}, what: frozen}}').faults
    assert found == (PlannedFault(120.0, 300.0, counter, 'frozen'),)
    (endless,) = load(tmp_path, '{at_min: 0, where: door/spread, what: offset 3}').faults
    assert endless.end is None


@pytest.mark.parametrize(
    ('fault', 'sentence'),
    [
        ('{at_min: 2, where: door/spred, what: frozen}', "faults[0]: fault at 'door/spred'"),
        ('{at_min: 2, where: door/spread, what: broken}', "fault 'broken'"),
        ('{at_min: 2, where: door/spread, what: none}', "found 'none'"),
        ('{at_min: -2, where: door/spread, what: lost}', 'faults[0].at_min: found -2'),
        (
            '{at_min: 30, where: door/spread, what: lost}',
            'at_min: found 30,',
        ),
        ('{at_min: 999, where: door/spread, what: lost}', 'at_min: found 999,'),
    ],
)
def test_what_cannot_be_is_named(tmp_path: Path, fault: str, sentence: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        load(tmp_path, fault)
    assert sentence in str(caught.value)


def test_steps_that_are_all_wrong_are_not_said_to_be_missing(tmp_path: Path) -> None:
    path = tmp_path / 'trial.yaml'
    path.write_text(TRIAL.format(fault='{at_min: 2, where: door/spread, what: lost}').replace(
        'minutes: 30', 'minutes: -30'
    ))  # fmt: skip
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert str(caught.value).count('\n') == 0
    assert 'steps[0].minutes: found -30' in str(caught.value)
