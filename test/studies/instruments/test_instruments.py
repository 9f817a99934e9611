"""Measured sensors and simulated ones are held to the same statistics, and to the same gates."""

import gzip
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from studies.harness import Work, run_study
from studies.instruments.calibrations import read_calibrations
from studies.instruments.comparison import simulated
from studies.instruments.guards import CLASSES, classified, gate
from studies.instruments.statistics import (
    EDGES_M,
    SPREAD_LIMITS,
    STATISTICS,
    noise_at,
    running_median,
    statistics,
    towing,
)
from studies.instruments.study import STUDY, InstrumentsPlan
from studies.instruments.survey import (
    FILE,
    HEIGHT,
    SPREAD,
    Series,
    SurveyHaul,
    read_survey,
)
from studies.instruments.wire_steps import read_steps
from trawl_ros.core.errors import TrawlError
from trawl_ros.instruments.parameters import RangeParameters, load_instruments

MEASURED = Path(__file__).parents[4] / 'shared/data/noaa_trawlmetrics' / FILE
ABSENT = 'the measured readings are not beside this'


def haul(number=1, seconds=2000, seed=1, far=0.1):
    """A haul of a sensor that reads 16 m every 3 s, and 226 m in a share of the readings."""
    drawn = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 3.0)
    level = np.interp(time, [0.0, 200.0, seconds - 200.0, seconds], [3.0, 16.0, 16.0, 3.0])
    value = level + 0.3 * drawn.standard_normal(len(time))
    value += np.where(drawn.random(len(time)) < far, 210.0, 0.0)
    return SurveyHaul(number, Series(time, np.round(value, 1), np.zeros(len(time), dtype=np.int64)))


def written(path, hauls):
    rows = ['HAUL,t,CABINET_SENSOR_FLAG,VALUE,DATUM_CODE']
    for flag in (SPREAD, HEIGHT):
        for one in hauls:
            pairs = zip(one.series.time, one.series.value, strict=True)
            rows += [f'{one.number},{t:.0f},{flag},{v:.1f},0' for t, v in pairs]
    with gzip.open(path, 'wt') as file:
        file.write('\n'.join(rows))
    return path


def test_statistics_find_what_was_put_in():
    found = statistics(haul(far=0.1).series, SPREAD_LIMITS)
    assert list(found) == list(STATISTICS)
    assert found['rate'] == pytest.approx(20.0, rel=0.01)
    assert (found['interval'], found['longest'], found['silent']) == (3.0, 3.0, 0.0)
    assert found['scatter'] == pytest.approx(0.3, rel=0.1)
    assert found['far'] == pytest.approx(10.0, abs=3.0)
    assert found['above'] == 0.0
    assert np.isnan(found['excess'])
    assert abs(found['next']) < 0.2
    assert found['runs'] == pytest.approx(10.0, abs=8.0)


def test_towing_leaves_shooting_and_hauling_out():
    begin, end = towing(haul().series)
    assert 200.0 < begin < 280.0
    assert 1720.0 < end < 1800.0


def test_a_running_median_does_not_follow_outliers():
    series = haul(far=0.2).series
    course = running_median(series.time, series.value, 60.0)
    assert np.abs(course[100:500] - 16.0).max() < 1.0


def test_a_perfect_sensor_gives_the_course_and_one_with_errors_has_their_statistics():
    limits = {'rate_hz': 1 / 3, 'min_range_m': 0.1, 'max_range_m': 400.0}
    perfect = simulated(haul(), RangeParameters(**limits), 3)
    towed = (perfect.time > 300.0) & (perfect.time < 1700.0)
    assert np.abs(perfect.value[towed] - 16.0).max() < 0.3
    assert len(np.unique(perfect.time)) == len(perfect.time)
    errors = {'noise_m': 0.3, 'ambiguity_share': 0.1, 'ambiguity_m': 210.0}
    found = statistics(simulated(haul(), RangeParameters(**limits, **errors), 3), SPREAD_LIMITS)
    assert found['far'] == pytest.approx(10.0, abs=3.0)
    assert found['scatter'] == pytest.approx(0.3, rel=0.1)


def test_gates_reject_repeated_seconds_and_far_readings_and_say_what_editors_did():
    series = haul(far=0.05).series
    time = np.insert(series.time, 300, series.time[300])
    value = np.insert(series.value, 301, 16.4)
    code = np.insert(series.code, 301, 2)
    found = gate(Series(time, value, code), 'door_spread', 0.3)
    counts, reasons = found.counts, found.reasons
    assert found.differing['period'] == counts.off
    assert (counts.readings, counts.by_editors) == (len(time), 1)
    assert (counts.stamps, counts.both) == (1, 1)
    assert counts.agreement(with_outliers=False) == 1.0
    assert counts.off == counts.off_kept == pytest.approx(0.05 * counts.towed, rel=0.5)
    assert counts.agreement(with_outliers=True) < 0.1
    assert counts.used + sum(reasons.values()) == counts.windows


@pytest.mark.parametrize('text', ['', 'a,b\n1,2\n', 'HAUL,t\n1,2\n'])
def test_what_is_no_survey_is_refused(tmp_path, text):
    path = tmp_path / 'survey.csv.gz'
    with gzip.open(path, 'wt') as file:
        file.write(text)
    with pytest.raises(TrawlError, match=r'survey\.csv\.gz: .*expected'):
        read_survey(path)
    path.write_text('not packed')
    with pytest.raises(TrawlError, match=r'survey\.csv\.gz: cannot be read'):
        read_survey(path)


def test_the_study_writes_a_report_with_all_statistics(tmp_path):
    table = written(tmp_path / 'survey.csv.gz', [haul(n, seed=n) for n in range(1, 5)])
    out = tmp_path / 'out'
    rows = run_study(STUDY, InstrumentsPlan(table=str(table)), Work(out))
    assert len(rows) == 2 * (len(STATISTICS) + 3)
    assert (out / 'instruments.png').is_file()
    report = (out / 'instruments.md').read_text()
    assert all(sentence in report for sentence, _ in STATISTICS.values())


def test_without_a_table_the_option_is_named(tmp_path):
    with pytest.raises(TrawlError, match='--table'):
        run_study(STUDY, InstrumentsPlan(), Work(tmp_path))


@pytest.mark.skipif(not MEASURED.is_file(), reason=ABSENT)
def test_measured_hauls_repeat_seconds_and_are_ambiguous_by_210_metres():
    survey = read_survey(MEASURED)
    assert {flag: len(hauls) for flag, hauls in survey.items()} == {SPREAD: 71, HEIGHT: 70}
    for hauls in survey.values():
        for one in hauls:
            series = one.series
            repeated = np.append(False, np.diff(series.time) == 0.0)
            assert np.count_nonzero(series.code) == np.count_nonzero(repeated)
    ship = load_instruments()
    far = [statistics(one.series.kept(), SPREAD_LIMITS)['far'] for one in survey[SPREAD][1::2]]
    made = simulated(survey[SPREAD][0], ship.door.spread, 20)
    low, high = np.percentile(far, [5, 95])
    assert low < statistics(made, SPREAD_LIMITS)['far'] < high


def test_disagreements_are_told_by_what_is_wrong_with_the_readings():
    values = np.full(40, 16.0)
    wrong = {3: 226.5, 8: 32.5, 12: 50.0, 15: 19.0, 20: 12.0, 30: 18.5, 31: 18.5, 32: 18.6}
    values[list(wrong)] = list(wrong.values())
    found = classified(values, values != 16.0)
    assert found == {'period': 1, 'multiple': 2, 'long': 1, 'short': 1, 'level': 3}
    assert set(found) < set(CLASSES)


def test_silences_and_calibrations_are_read_from_tables_beside_the_survey(tmp_path):
    (tmp_path / 'scope_steps_2023_treatments.csv').write_text(
        'HAUL_ID,start,end,WIRE_OUT\n7,0,100,90\n7,200,300,180\n8,0,,200\n'
    )
    stamps = [*range(0, 101, 5), *range(200, 231, 5), *range(280, 301, 5)]
    for name in ('width', 'height'):
        with gzip.open(tmp_path / f'scope_steps_2023_{name}_pings.csv.gz', 'wt') as file:
            file.write('t,HAUL_ID\n' + ''.join(f'{t},7\n' for t in stamps))
    first, second = read_steps(tmp_path)['spread']
    assert (first.wire_m, first.readings, first.silent_s) == (90.0, 21, 0.0)
    assert (second.wire_m, second.readings, second.silent_s) == (180.0, 12, 50.0)
    rows = ''.join(f'{k},{1.03 * k + 7},{1.02 * k + 6}\n' for k in range(25, 500, 25))
    (tmp_path / 'nwx_wire_vs_counter.csv').write_text(
        'wire_out_fm,winch_stbd_fm,winch_port_fm\n' + rows
    )
    (tmp_path / 'dock_spread_sensor_calibration.csv').write_text(
        'distance_m,obs_wing_m\n0,2.7\n10,12.5\n20,22.7\n'
    )
    starboard, port, dock = read_calibrations(tmp_path)
    assert (starboard.scale_error, starboard.offset) == pytest.approx((0.03, 7 * 1.8288))
    assert (port.scale_error, port.offset) == pytest.approx((0.02, 6 * 1.8288))
    assert dock.scatter == pytest.approx(np.sqrt(4 / 6 * 0.2**2), rel=0.01)
    with pytest.raises(TrawlError, match='cannot be read, expected'):
        read_steps(tmp_path / 'nowhere')
    with pytest.raises(TrawlError, match='cannot be read, expected'):
        read_calibrations(tmp_path / 'nowhere')


def test_noise_against_the_distance_is_that_of_readings_and_not_of_a_steady_change():
    draw = np.random.default_rng(3).standard_normal
    time = 3.0 * np.arange(4000.0)
    far = 10.0 + 0.001 * time
    series = Series(time, far + 0.3 * draw(4000), np.zeros(4000, dtype=np.int64))
    for (low, high), (std, number) in zip(pairwise(EDGES_M), noise_at([series]), strict=True):
        if low >= 12.0 and high <= 20.0:
            assert (std, number) == (pytest.approx(0.3, rel=0.1), pytest.approx(1333, rel=0.03))
        if high <= 8.0:
            assert np.isnan(std)
            assert number == 0
