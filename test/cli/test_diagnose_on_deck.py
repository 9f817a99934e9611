"""``trawl diagnose`` names what went wrong on deck, from bags of the default gear."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.trials.hidden_effects.on_deck import with_other_law
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.trials.plant import Plant
from trawl_ros.lab.trials.readings import AS_STATED
from trawl_ros.lab.trials.recording import record_tows
from trawl_ros.lab.trials.towing import quasi_steady
from trawl_ros.lab.trials.tows import BlindTrialPlan, PlannedTow
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

HEAVIER = 3.0
"""Part by which a kite is heavier than the gear file says."""


def diagnosed(folder, cause, size):
    """Diagnose bags of tows of which all but the first have a cause hidden in them.

    Gives ``diagnosis.json``, what was printed, and the folder of the reports.
    """
    gear, rng = load_gear(GEAR), np.random.default_rng(SEED)
    model = with_other_law(build_model(gear))
    # Boards are those of the gear file, which are not those from which the fit starts.
    plant = Plant(model, model.coefficients, {})
    tows = plant.towed([(CAUSES[cause](rng), size)], PLAN)
    courses = [quasi_steady(tow, looks) for tow, looks in zip(PLAN.tows, tows, strict=True)]
    record_tows(folder / 'bags', courses, plant.model.water, AS_STATED, 0.0, rng)
    baseline, *examined = map(str, sorted((folder / 'bags').iterdir()))
    out = folder / 'out'
    words = ['diagnose', *examined, '--baseline', baseline, '--gear', GEAR, '--out', str(out)]
    done = CliRunner().invoke(trawl, words)
    assert done.exit_code == 10, done.output
    return json.loads((out / 'diagnosis.json').read_text()), done.output, out


@pytest.mark.slow
@pytest.mark.timeout(1500)
@pytest.mark.parametrize(
    ('cause', 'size', 'name', 'parameter', 'value', 'told'),
    [
        ('rigging_epsilon', 2.5, 'board_rigging', 'epsilon', np.radians(2.5), '°'),
        ('heavy_kite', HEAVIER, 'kite_weight', 'change', HEAVIER, 'Look at the kite'),
        ('doors_swapped', 1.0, 'swapped_doors', 'share', 1.0, 'door by hand'),
    ],
)
def test_what_went_wrong_on_deck_is_named(tmp_path, cause, size, name, parameter, value, told):
    found, printed, out = diagnosed(tmp_path, cause, size)
    assert found['verdict'] == 'NAMED', printed
    (effect,) = found['effects']
    assert effect['name'] == name
    interval = effect['parameters'][parameter]
    assert abs(interval['value'] - value) < 0.15 * value
    assert interval['low'] < interval['value'] < interval['high']
    assert told in printed
    assert 'What to do' in printed
    assert effect['probability'] > 0.9
    assert (out / 'model.yaml').is_file()
