"""A refit goes on while first order promises more than it explains."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis import refit
from trawl_ros.diagnosis.refit import fit_boards, refitted, refitted_without
from trawl_ros.diagnosis.rules import SCREEN
from trawl_ros.diagnosis.score_test import score_test
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

BOTH = ('net_drag', 'tension_cell')


@dataclass
class Walking:
    """Refit that explains as much χ² more with each round, until it is at rest."""

    explains: list
    estimate: SimpleNamespace
    fit: SimpleNamespace = None
    estimator: SimpleNamespace = None

    def __post_init__(self):
        self.fit = SimpleNamespace(scales=(1.0,))
        self.estimator = SimpleNamespace(finish=self.further)

    def further(self):
        self.explains.pop(0)
        return SimpleNamespace(converged=len(self.explains) == 1)

    def cost(self, scales):
        return 500.0 - 0.5 * self.explains[0]


@pytest.mark.parametrize(
    ('promised', 'rounds', 'comes_to'),
    [
        (720.0, 4, 717.0),
        (720.0, 2, 697.0),
        (571.0 + SCREEN - 1.0, 4, 571.0),
        (2000.0, 9, 718.0),
    ],
)
def test_a_refit_goes_on_while_first_order_promises_more(promised, rounds, comes_to, monkeypatch):
    monkeypatch.setattr(refit, 'lost_by', lambda base, fitted: frozenset())
    walking = Walking([571.0, 697.0, 717.0, 718.0], SimpleNamespace(converged=False))
    base = SimpleNamespace(cost=lambda scales: 500.0)
    found = refit._gone_on(base, walking, promised, rounds)
    assert found.explains[0] == comes_to


def test_one_of_two_rests_where_it_rests_by_itself_though_begun_from_both(coarse, hide):
    windows = hide.trial(coarse, hide.cells, 3)
    predictor = Predictor(build_model(coarse))
    base = fit_boards(predictor, board_prior(coarse), windows)
    test = score_test(predictor, base.fit, {name: catalogue()[name] for name in BOTH})
    wanted = {own.name: own for own in test.wanted}
    drag, cell = (wanted[name] for name in BOTH)
    both = refitted(predictor, base, test, (drag, cell))
    alone = refitted(predictor, base, test, (cell,))
    again = refitted_without(predictor, base, both, drag)
    assert again.names == ('tension_cell',)
    std = alone.estimate.std[alone.fit.prior.slice_of('effect')]
    assert np.all(np.abs(again.values - alone.values) < 0.5 * std)
    assert again.cost(base.fit.scales) == pytest.approx(alone.cost(base.fit.scales), abs=0.5)
