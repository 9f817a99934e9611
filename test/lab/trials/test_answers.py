"""Right answers of blind trials are leaves of the library at nodes of one check each."""

from trawl_ros.diagnosis.library.entries import library
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.trials.answers import (
    NOT_IN_LIBRARY,
    right_leaves,
    right_nodes,
)
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.trials.hidden_effects.outside import OUTSIDE


def test_each_hidden_cause_has_leaves_of_the_library_or_is_outside():
    leaves = {entry.name for entry in library(load_gear('kaifuha'))}
    for cause in {*INSIDE, *OUTSIDE, *CAUSES}:
        right = right_leaves(cause)
        assert bool(right) != (cause in NOT_IN_LIBRARY), cause
        # A gear without floats has no buoyancy in its file.
        assert not right or set(right) & leaves, cause
        assert bool(right_nodes(cause)) == bool(right)


def test_the_edge_of_a_current_and_a_log_that_drifts_are_one_thing_and_a_tide_another():
    assert set(right_leaves('edge_of_current')) == {'current_along_track', 'log_drift'}
    assert right_nodes('edge_of_current') == ('water/speed',)
    assert right_leaves('tide') == ('current_in_time',)
