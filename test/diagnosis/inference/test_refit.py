"""Refits of boards and effects together."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis.inference import refit as refits
from trawl_ros.diagnosis.inference.candidates import Candidate, signatures
from trawl_ros.diagnosis.inference.refit import fit_boards, refitted
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor


@pytest.fixture(scope='module')
def cells(coarse, hide):
    """Boards alone, and the effect that is hidden, to first order."""
    windows = hide.trial(coarse, hide.cells, 3)
    predictor = Predictor(build_model(coarse))
    base = fit_boards(predictor, board_prior(coarse), windows)
    effect = catalogue()['tension_cell']
    wanted = (Candidate(effect, effect.neutral),)
    return predictor, base, wanted, signatures(predictor, base.fit.windows, wanted)


def test_a_refit_finds_what_is_hidden_from_wherever_it_starts(cells):
    found = [refitted(*cells, np.array(away)) for away in ([0.0, 3.0], [0.0, 0.0])]
    for own in found:
        assert own.names == ('tension_cell',)
        assert own.cost(cells[1].fit.scales) < cells[1].cost(cells[1].fit.scales)
    std = found[0].estimate.std[found[0].fit.prior.slice_of('effect')]
    assert np.all(np.abs(found[0].values - found[1].values) < 0.3 * std)


def test_what_leaves_a_towed_state_without_steady_state_explains_nothing(cells, monkeypatch):
    whole = refits.converged

    def lossy(*args):
        found = whole(*args)
        fewer = replace(found.fit, windows=found.fit.windows[:-1])
        return replace(found, estimator=SimpleNamespace(fit=fewer))

    monkeypatch.setattr(refits, 'converged', lossy)
    assert refitted(*cells, np.zeros(2)) is None
