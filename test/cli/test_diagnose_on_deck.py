"""``trawl diagnose`` names what went wrong on deck, from bags of the default gear."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.studies.discrepancy.hidden_effects.on_deck import ON_DECK, with_other_law
from trawl_ros.lab.studies.discrepancy.trials.course import quasi_steady
from trawl_ros.lab.studies.discrepancy.trials.plant import Plant
from trawl_ros.lab.studies.discrepancy.trials.recording import record_tows
from trawl_ros.lab.studies.discrepancy.trials.tows import BlindTrialPlan, PlannedTow
from trawl_ros.lab.studies.identification.readings import AS_STATED
from trawl_ros.model.gear_model import build_model

GEAR = 'kaifuha'
SEED = 17
PLAN = BlindTrialPlan(
    (
        PlannedTow(((300.0, 2.4), (550.0, 2.0), (800.0, 2.2)), eastward=True),
        PlannedTow(((450.0, 2.0), (650.0, 2.4), (300.0, 2.2)), eastward=False),
        PlannedTow(((650.0, 2.0), (800.0, 2.4), (300.0, 2.0)), eastward=True),
        PlannedTow(((300.0, 2.4), (550.0, 2.0), (800.0, 2.2)), eastward=False),
    ),
    baseline=1,
)
"""An hour and a half of a gear in order, and three such tows after something happened on deck."""


@pytest.mark.slow
@pytest.mark.timeout(1500)
@pytest.mark.parametrize(
    ('cause', 'size', 'name', 'parameter', 'value', 'told'),
    [
        ('rigging_epsilon', 2.5, 'board_rigging', 'epsilon', np.radians(2.5), '°'),
        ('floats_gone', 0.3, 'floats', 'lost', 0.3, 'Count the floats'),
        ('doors_swapped', 1.0, 'swapped_doors', 'share', 1.0, 'Tilt one door by hand'),
    ],
)
def test_what_went_wrong_on_deck_is_named(tmp_path, cause, size, name, parameter, value, told):
    gear, chance = load_gear(GEAR), np.random.default_rng(SEED)
    model = with_other_law(build_model(gear))
    # Boards are those of the gear file, which are not those from which the fit starts.
    plant = Plant(model, model.coefficients, {})
    tows = plant.towed([(ON_DECK[cause](chance), size)], PLAN)
    courses = [quasi_steady(tow, looks) for tow, looks in zip(PLAN.tows, tows, strict=True)]
    record_tows(tmp_path / 'bags', courses, plant.model.water, AS_STATED, 0.0, chance)
    baseline, *examined = map(str, sorted((tmp_path / 'bags').iterdir()))
    out = tmp_path / 'out'
    words = ['diagnose', *examined, '--baseline', baseline, '--gear', GEAR, '--out', str(out)]
    done = CliRunner().invoke(trawl, words)
    assert done.exit_code == 10, done.output
    found = json.loads((out / 'diagnosis.json').read_text())
    assert found['verdict'] == 'NAMED', done.output
    (effect,) = found['effects']
    assert effect['name'] == name
    interval = effect['parameters'][parameter]
    assert abs(interval['value'] - value) < 0.15 * value
    assert interval['low'] < interval['value'] < interval['high']
    assert told in done.output
    assert 'What to do now' in done.output
    assert name in (out / 'model.yaml').read_text()
