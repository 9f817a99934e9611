"""A finding has the likeliest name, and those with similar evidence."""

import numpy as np

from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.diagnosis.onset.judging import finding
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence
from trawl_ros.effects.registry import catalogue

TABLE = candidate_table({'attitude_mount': catalogue()['attitude_mount']})
CANDIDATES = {candidate.name: candidate for candidate in TABLE.candidates}


def evidence(name, ratio):
    values = len(CANDIDATES[name].columns)
    return OnsetEvidence(
        CANDIDATES[name], 4, ratio, 20.0, np.zeros(values), 1e-6 * np.eye(values), np.array([4])
    )


def found(mount):
    told = [
        evidence('port_pitch_offset', 229.3), evidence('attitude_mount', mount),
        evidence('starboard_pitch_offset', 60.0),
    ]  # fmt: skip
    return finding(TABLE, told, 10**12, 9.0)


def test_an_effect_that_fits_no_worse_is_told_however_many_values_it_takes():
    one = found(mount=229.6)
    assert one.name == 'port_pitch_offset'
    assert one.alike == ('attitude_mount',)


def test_one_that_fits_worse_and_takes_more_values_is_not():
    assert found(mount=229.0).alike == ()
