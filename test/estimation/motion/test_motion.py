"""Stretches in motion: derivatives, what is left out, whitening, and calibrated estimates."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.least_squares.information import joined, own_values
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, GroupRows, changes
from trawl_ros.estimation.motion.sizes import LinearData, estimated_sizes
from trawl_ros.estimation.motion.towing import lineariser
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, on_grid
from trawl_ros.estimation.motion.towing.knots import hats, knots_of_counter, knots_of_log
from trawl_ros.estimation.motion.towing.linearisation import SLOW_MOTIONS
from trawl_ros.estimation.motion.towing.lineariser import BY_SENSOR, TowLineariser, linearise_tow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.lab.benchmark.motion import BAND, course_tow, run_motion_trial
from trawl_ros.lab.benchmark.motion_instruments import run_instrument_trial
from trawl_ros.model.gear_model import build_model

SHORT_S = 120.0
NO_ERRORS, NO_DRIFTS = np.zeros(len(INPUT_ERRORS)), np.zeros(0)


@pytest.fixture(scope='module')
def short_tow():
    """Two minutes of hauling, whose knots outnumber the columns that they share."""
    tow = course_tow(SHORT_S)
    knots = knots_of_log(np.arange(0.0, SHORT_S), 0.03, SHORT_S, tow.stretch_s, 60.0)
    assert knots.columns < knots.number
    counter = knots_of_counter('port_length', 0.5, 600.0, SHORT_S, 40.0, 40.0)
    assert counter.columns < counter.number
    return replace(tow, inputs=replace(tow.inputs, knots=(knots, counter)))


@pytest.fixture(scope='module')
def towed(coarse, short_tow):
    number = short_tow.inputs.number_of_knots
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, np.zeros(number))
    return linearise_tow(TowedGear(coarse), short_tow, point)


def by_knots(towed):
    """Derivatives by the errors at all knots, input after input."""
    return np.concatenate([towed.by[own.channel] for own in towed.tow.inputs.knots], axis=2)


def changed(towed, model, **changes):
    """Change of the means, and what the derivatives say of it, in the noise of a stretch."""
    return changed_gear(towed, TowedGear(model), **changes)


def changed_gear(towed, gear, **changes):
    point = replace(towed.point, **changes)
    again = linearise_tow(gear, towed.tow, point)
    told = (
        towed.by['errors'] @ point.errors
        + by_knots(towed) @ point.drifts
        + towed.by['added_mass'][..., 0] * point.added_mass
        + towed.by['coefficients'] @ (point.coefficients - towed.point.coefficients)
    )
    if towed.by['net'].size:
        told = told + towed.by['net'] @ (point.net - towed.point.net)
    return (again.values - towed.values) / towed.tow.noise, told / towed.tow.noise


def active(**values):
    return EffectSet(
        tuple(ActiveEffect(catalogue()[name], np.array(own)) for name, own in values.items())
    )


ON = active(current_shear=[0.03], tension_cell=[500.0, 0.05])


@pytest.fixture(scope='module')
def laden(coarse, short_tow):
    """A gear with effects of current and sensors on, whose net is not known; another length of the
    bridles of one side is looked for.
    """
    gear = TowedGear(coarse, ON, net_std=0.2, examined=(catalogue()['port_bridle_length'],))
    number = short_tow.inputs.number_of_knots
    net = np.array([1.1, 0.9])
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, np.zeros(number), net)
    return gear, linearise_tow(gear, short_tow, point)


def test_a_tow_has_the_effects_of_its_gear_and_its_sensors(laden):
    gear, linear = laden
    sheared = replace(gear, acting=active(current_shear=[0.03]), examined=())
    plain = linearise_tow(sheared, linear.tow, linear.point)
    cell = linear.tow.channels.index('port_tension')
    np.testing.assert_allclose(
        linear.values[:, cell], 1.05 * plain.values[:, cell] + 500.0, rtol=1e-9
    )
    np.testing.assert_allclose(
        linear.by['coefficients'][:, cell], 1.05 * plain.by['coefficients'][:, cell], rtol=1e-6
    )
    depth = linear.tow.channels.index('net_depth')
    np.testing.assert_allclose(linear.values[:, depth], plain.values[:, depth], rtol=1e-9)
    still = linearise_tow(replace(sheared, acting=EffectSet()), linear.tow, linear.point)
    assert np.abs(plain.values - still.values)[:, depth].max() > 1.0


def test_net_and_effects_that_are_looked_for_do_what_their_derivatives_say(laden):
    gear, linear = laden
    moved = linear.point.coefficients + 0.001
    real, told = changed_gear(linear, gear, net=np.array([1.102, 0.902]), coefficients=moved)
    assert np.abs(real).max() > 0.1
    np.testing.assert_allclose(told, real, atol=0.02 * np.abs(real).max())
    fewer = replace(
        gear, acting=gear.acting.having(ActiveEffect(gear.examined[0], np.array([0.01, 0.0])))
    )
    again = linearise_tow(fewer, linear.tow, linear.point)
    real = (again.values - linear.values) / linear.tow.noise
    told = 0.01 * linear.by['examined'][..., 0] / linear.tow.noise
    assert np.abs(real).max() > 0.1
    np.testing.assert_allclose(told, real, atol=0.02 * np.abs(real).max())


@pytest.mark.parametrize(('channel', 'knot', 'size'), [(0, 2, 0.002), (0, 5, 0.002), (1, 1, 0.02)])
def test_an_error_of_an_input_at_a_knot_does_what_its_derivative_says(
    towed, coarse, channel, knot, size
):
    drifts = np.zeros(towed.tow.inputs.number_of_knots)
    _, own, _ = towed.tow.inputs.knot_places[channel]
    drifts[own.start + knot] = size
    real, told = changed(towed, coarse, drifts=drifts)
    assert np.abs(real).max() > 0.1
    np.testing.assert_allclose(told, real, atol=0.02 * np.abs(real).max())


def test_an_error_of_the_log_is_left_in_slow_motions_when_another_takes_its_column(towed, coarse):
    knots, _ = towed.tow.inputs.knots
    # It began to act a spacing before its knot.
    last = knots.columns - 1
    assert by_knots(towed)[last, :, knots.columns].any()
    drifts = np.zeros(towed.tow.inputs.number_of_knots)
    drifts[0] = 0.05
    real, told = (change[last:] for change in changed(towed, coarse, drifts=drifts))
    assert np.abs(real).max() > 0.1
    np.testing.assert_allclose(told, real, atol=0.5 * np.abs(real).max())


def test_a_tow_that_grows_is_linearised_as_if_it_had_been_there_from_the_beginning(towed, coarse):
    tow = towed.tow
    growing = TowLineariser(TowedGear(coarse), tow.channels, replace(towed.point, drifts=NO_DRIFTS))
    for number in (2, 5, len(tow)):
        so_far = replace(
            tow, means=tow.means[:number], noise=tow.noise[:number], weights=tow.weights[:number]
        )
        growing.extend(so_far, towed.point.drifts)
        assert len(growing) == number
    found = growing.linearised(tow)
    np.testing.assert_array_equal(found.values, towed.values)
    for name, slopes in found.by.items():
        np.testing.assert_array_equal(slopes, towed.by[name])


@pytest.mark.parametrize('error', range(len(INPUT_ERRORS)))
def test_errors_of_counters_and_log_do_what_their_derivatives_say(towed, coarse, error):
    errors = 0.02 * np.eye(len(INPUT_ERRORS))[error]
    real, told = changed(towed, coarse, errors=errors)
    assert np.abs(real).max() > 0.001
    np.testing.assert_allclose(told, real, atol=0.03 * np.abs(real).max())


def test_a_counter_that_reads_too_long_has_the_gear_towed_on_less_warp(towed):
    depth = towed.tow.channels.index('port_door_depth')
    offset = [error.name for error in INPUT_ERRORS].index('port_length offset')
    starboard = [error.name for error in INPUT_ERRORS].index('starboard_length offset')
    both = towed.by['errors'][..., offset] + towed.by['errors'][..., starboard]
    assert np.all(both[:, depth] < 0.0)


def test_what_the_model_cannot_tow_is_left_out_and_told(coarse):
    tow = course_tow(100.0)
    gone = replace(tow.inputs, values=tow.inputs.values * [1.0, 1.0, 0.2])
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, np.zeros(0))
    there = linearise_tow(TowedGear(coarse), replace(tow, inputs=gone), point)
    assert not there.towed.any()
    assert len(there.left_out) == len(tow)
    assert 'towed' in there.left_out[0].why or 'surface' in there.left_out[0].why
    needed = np.ones(len(tow), dtype=bool)
    with pytest.raises(NoSteadyState, match=r'^0 s after'):
        linearise_tow(TowedGear(coarse), replace(tow, inputs=gone), point, needed)


def with_holds(tow, *held):
    """Tow whose stretches are steady, by their numbers, after ten minutes of held inputs."""
    held_s = np.zeros(len(tow))
    held_s[list(held)] = 600.0
    return replace(tow, held_s=held_s)


def held_tow(duration_s=640.0, held=(18, 19, 30, 31)):
    """Tow of the course, held after its end."""
    return with_holds(course_tow(duration_s), *held)


def test_a_board_that_falls_costs_its_own_part_of_the_tow(coarse):
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, NO_DRIFTS)
    fell = replace(held_tow(), fallen=(2, 3))
    there = linearise_tow(TowedGear(coarse), fell, point)
    assert list(np.flatnonzero(~there.towed)) == [*range(2, 18)]
    assert {part.why for part in there.left_out} == {BY_SENSOR}
    # The next steady part begins with unknown amplitudes of the slowest motions.
    assert there.by['starts'][18:, :, SLOW_MOTIONS].any(axis=1).all()
    assert not there.by['starts'][:2, :, SLOW_MOTIONS:].any()


def test_a_steady_part_goes_on_where_the_motion_before_it_ended(coarse):
    tow = course_tow(860.0)
    held_s = np.where(np.arange(len(tow)) >= 36, 240.0, 0.0)
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, NO_DRIFTS)
    moving = linearise_tow(TowedGear(coarse), tow, point)
    chain = linearise_tow(TowedGear(coarse), replace(tow, held_s=held_s), point)
    np.testing.assert_array_equal(chain.values[:36], moving.values[:36])
    depths = [tow.channels.index(name) for name in ('port_door_depth', 'net_depth')]
    away = np.abs(chain.values - moving.values)[36:]
    assert np.abs(moving.values[42] - moving.values[36])[depths].max() > 1.0
    assert np.all(away < 1.5 * tow.noise[36:])
    size = np.linalg.norm(moving.by['coefficients'][36:])
    assert np.linalg.norm((chain.by['coefficients'] - moving.by['coefficients'])[36:]) < 0.05 * size


def test_what_is_left_of_slow_motions_is_carried_through_a_steady_part(coarse):
    """Also of one that is not alike on both sides: the port warp is 2 m longer."""
    tow = course_tow(860.0)
    values = tow.inputs.values + [2.0, 0.0, 0.0]
    tow = replace(tow, inputs=replace(tow.inputs, values=values))
    held_s = np.zeros(len(tow))
    held_s[36:39] = 240.0
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, NO_DRIFTS)
    moving = linearise_tow(TowedGear(coarse), tow, point)
    chain = linearise_tow(TowedGear(coarse), replace(tow, held_s=held_s), point)
    assert np.all(np.abs(chain.values - moving.values) < 2.0 * tow.noise)
    size = np.linalg.norm(moving.by['coefficients'][36:])
    assert np.linalg.norm((chain.by['coefficients'] - moving.by['coefficients'])[36:]) < 0.05 * size


def test_held_inputs_are_followed_in_longer_steps(coarse):
    tow = replace(course_tow(680.0), step_s=2.0)
    quiet = [stretch for stretch in range(len(tow)) if tow.is_quiet(stretch)]
    assert quiet == [9, 10, *range(21, 34)]
    step_s, weights = tow.steps_of(30)
    assert step_s == 4.0
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    line = np.arange(0.0, 20.5, 4.0)
    np.testing.assert_allclose(weights @ line, tow.weights[30] @ np.arange(0.0, 20.5, 2.0))
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, NO_DRIFTS)
    longer = linearise_tow(TowedGear(coarse), tow, point)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(type(tow), 'is_quiet', lambda *_: False)
        usual = linearise_tow(TowedGear(coarse), tow, point)
    np.testing.assert_array_equal(longer.values[:9], usual.values[:9])
    assert np.all(np.abs(longer.values - usual.values) < 0.5 * tow.noise)
    away = np.linalg.norm(longer.by['coefficients'] - usual.by['coefficients'])
    assert 0.0 < away < 0.02 * np.linalg.norm(usual.by['coefficients'])


def test_steady_parts_alone_are_predicted_without_the_motion_between(coarse):
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, NO_DRIFTS)
    tow = held_tow().only_steady()
    there = linearise_tow(TowedGear(coarse), tow, point)
    assert list(np.flatnonzero(there.towed)) == [18, 19, 30, 31]
    assert tow.starts == 3 * SLOW_MOTIONS
    begun = there.by['starts'].reshape(*there.values.shape, 3, SLOW_MOTIONS).any(axis=(1, 3))
    assert [list(row) for row in begun[[18, 30]]] == [[False, True, False], [False, False, True]]


@pytest.mark.parametrize('error', [0, len(INPUT_ERRORS) - 1])
def test_derivatives_of_steady_parts_are_those_of_their_means(coarse, error):
    knots = knots_of_log(np.arange(0.0, 640.0), 0.03, 640.0, 20.0, 60.0)
    tow = held_tow().only_steady()
    tow = replace(tow, inputs=replace(tow.inputs, knots=(knots,)))
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, np.zeros(knots.number))
    linear = linearise_tow(TowedGear(coarse), tow, point)
    drifts = np.zeros(knots.number)
    drifts[14:17] = 0.005
    real, told = changed(
        linear, coarse, errors=0.05 * np.eye(len(INPUT_ERRORS))[error], drifts=drifts,
        coefficients=coarse.coefficients + 1e-4, added_mass=0.1,
    )  # fmt: skip
    there = linear.towed
    assert np.abs(real[there]).max() > 0.1
    np.testing.assert_allclose(told[there], real[there], atol=0.03 * np.abs(real[there]).max())


def test_a_motion_has_the_derivatives_of_the_mean_in_which_it_begins(coarse):
    """Also by errors that it has outlasted: its slowest motions have not."""
    knots = knots_of_log(np.arange(0.0, 640.0), 0.03, 640.0, 20.0, 60.0)
    tow = replace(held_tow(), inputs=replace(held_tow().inputs, knots=(knots,)))
    point = TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, np.zeros(knots.number))
    linear = linearise_tow(TowedGear(coarse), tow, point)
    drifts = np.zeros(knots.number)
    drifts[8:18] = 0.005
    real, told = (change[20:30] for change in changed(linear, coarse, drifts=drifts))
    assert np.abs(real).max() > 0.1
    np.testing.assert_allclose(told, real, atol=0.2 * np.abs(real).max())


def test_stretches_in_which_derivatives_explode_are_left_out_and_told(coarse, monkeypatch):
    tow, point = course_tow(100.0), TowedPoint(coarse.coefficients, 0.0, NO_ERRORS, NO_DRIFTS)
    usual = linearise_tow(TowedGear(coarse), tow, point)
    assert usual.towed.all()
    sharp = np.abs(usual.by['coefficients']) / tow.noise[..., None]
    assert sharp.max() < 0.1 * lineariser.UNSTABLE_DERIVATIVE
    silent = tow.noise.copy()
    silent[1, 0] = np.nan
    assert linearise_tow(TowedGear(coarse), replace(tow, noise=silent), point).towed.all()
    monkeypatch.setattr(lineariser, 'UNSTABLE_DERIVATIVE', 0.5 * sharp[1:].max())
    there = linearise_tow(TowedGear(coarse), tow, point)
    assert not there.towed.all()
    assert any('unstable' in part.why for part in there.left_out)


def rows(rng, number=60, noise=0.5, model=1.0):
    return GroupRows(
        stretches=np.repeat(np.arange(number), 2),
        channels=np.tile([0, 1], number),
        times=20.0 * np.repeat(np.arange(number), 2),
        noise=np.full(2 * number, noise),
        drift=np.ones(2 * number),
        model=np.full(2 * number, model),
        state=np.ones(2 * number),
        change=np.ones(2 * number),
    )


def test_tows_that_are_joined_are_one_least_squares_problem():
    rng, sizes, times = (
        np.random.default_rng(5),
        np.array([1.0, 0.3, 2.0, 0.5, 0.7]),
        ErrorTimes(),
    )
    shared, own = 3, 4
    groups = []
    for _ in range(2):
        columns = rng.standard_normal((120, shared + own))
        groups.append(LinearGroup(rows(rng), columns, rng.standard_normal(120)))
    precision = np.array([1.0] * shared + [4.0] * own)
    tows = [group.information(sizes, times) for group in groups]
    found = joined(tows, [precision, precision], shared)
    mean = np.linalg.solve(found.matrix + np.eye(shared), found.right)

    whole = np.zeros((240, shared + 2 * own))
    covariance = np.zeros((240, 240))
    for number, group in enumerate(groups):
        at = slice(120 * number, 120 * (number + 1))
        whole[at, :shared] = group.columns[:, :shared]
        first = shared + own * number
        whole[at, first : first + own] = group.columns[:, shared:]
        covariance[at, at] = group.rows.covariance(sizes, times)
    prior = np.diag(np.concatenate((np.ones(shared), np.full(2 * own, 0.25))))
    residual = np.concatenate([group.residual for group in groups])
    total = covariance + whole @ prior @ whole.T
    gain = prior @ whole.T @ np.linalg.inv(total)
    np.testing.assert_allclose(mean, (gain @ residual)[:shared], atol=1e-9)
    np.testing.assert_allclose(
        own_values(tows[1], precision, mean), (gain @ residual)[shared + own :], atol=1e-9
    )
    likelihood = 0.5 * (np.linalg.slogdet(total)[1] + residual @ np.linalg.solve(total, residual))
    assert found.negative_log_likelihood == pytest.approx(likelihood)


@pytest.mark.parametrize(('true', 'told'), [(3.0, 3.0), (0.2, 1.0)])
def test_sizes_of_errors_are_found_those_of_slow_ones_not_below_what_is_stated(true, told):
    rng, truth, times = (
        np.random.default_rng(8),
        np.array([1.6, 0.1, true, 0.3, 0.05]),
        ErrorTimes(),
    )
    own = rows(rng, 200)
    root = np.linalg.cholesky(own.covariance(truth, times))
    columns = rng.standard_normal((400, 14))
    nothing = GroupRows(*(np.zeros(0, dtype=int),) * 2, *np.zeros((6, 0)))
    empty = LinearGroup(nothing, np.zeros((0, 14)), np.zeros(0))
    one = LinearGroup(own, columns, root @ rng.standard_normal(400))
    groups = (one, *(empty,) * (len(GROUPS) - 1))
    data = LinearData((groups,), (slice(14, 14),), 14, times)
    found = estimated_sizes(data, ErrorSizes(), ErrorSizes())
    assert found.noise[0] == pytest.approx(1.6, rel=0.15)
    assert found.model[0] == pytest.approx(told, rel=0.4)
    assert found.state[0] >= ErrorSizes().state[0]
    assert found.noise[1] == 1.0


def test_knots_know_the_log_as_well_as_its_readings_allow():
    knots = knots_of_log(np.arange(0.0, 200.0), 0.03, 200.0, 20.0, 100.0)
    middle = np.sqrt(np.diag(knots.root @ knots.root.T))[5]
    assert 0.03 / np.sqrt(20.0) < middle < 0.03 / np.sqrt(10.0)
    np.testing.assert_allclose(hats(np.linspace(0.0, 200.0, 33), 11, 20.0).sum(axis=1), 1.0)


def test_smoothing_keeps_a_ramp_and_its_rate():
    times = np.arange(0.0, 60.0, 0.5)
    values, rates = on_grid(times, 3.0 + 0.4 * times, np.arange(5.0, 50.0), 5.0)
    np.testing.assert_allclose(values, 3.0 + 0.4 * np.arange(5.0, 50.0))
    np.testing.assert_allclose(rates, 0.4)


def test_a_gear_with_effects_on_is_fitted_and_its_net_along(coarse):
    laden = TowedGear(coarse, ON, net_std=0.02)
    trials = [run_motion_trial(laden, s, duration_s=80.0, std_factor=0.05) for s in (31, 32)]
    # Of 24 normal errors: 99 % of the sums of their squares lie here.
    assert 4.9 < np.mean([trial.squared_error for trial in trials]) < 22.8
    for trial in trials:
        assert trial.fit.converged, trial.fit.reason
        assert [factor.what for factor in trial.fit.net] == ['drag', 'weight']
        for factor in trial.fit.net:
            assert 0.0 < factor.std < factor.known
            assert abs(factor.value - 1.0) < 4.0 * factor.std
        assert trial.fit.misfit < 1.3


@pytest.mark.slow
@pytest.mark.parametrize('errors', [False, True])
def test_errors_of_the_estimate_are_as_large_as_it_says(gear, errors):
    """Twelve squared errors in the metric of the posterior are 12 in the mean."""
    netting = gear.netting.model_copy(update={'around': 24})
    model = build_model(gear.model_copy(update={'netting': netting}))
    trials = [run_motion_trial(TowedGear(model), seed, errors) for seed in (1, 2, 3, 4)]
    assert all(trial.fit.converged for trial in trials)
    squares = [trial.squared_error for trial in trials]
    assert 6.4 < np.mean(squares) < 17.3
    assert np.mean([BAND[0] <= square <= BAND[1] for square in squares]) >= 0.75


@pytest.mark.slow
def test_errors_of_tows_read_by_instruments_are_as_large_as_the_estimate_says(gear):
    """Counters and spread sensor are wrong by another amount after each command."""
    netting = gear.netting.model_copy(update={'around': 24})
    record = gear.model_copy(update={'netting': netting})
    for seed in (202, 203):
        truth, fit = run_instrument_trial(record, seed)
        assert fit.converged
        away = fit.values - truth
        assert away @ np.linalg.solve(fit.covariance, away) < BAND[1]


def test_the_fit_of_a_short_tow_is_calibrated(coarse):
    """The same on the coarsest net, near the prior's mean, where a few steps lead to rest."""
    trials = [
        run_motion_trial(TowedGear(coarse), seed, duration_s=80.0, std_factor=0.05)
        for seed in range(11, 15)
    ]
    assert all(trial.fit.converged for trial in trials)
    # Of 48 normal errors: 99 % of the sums of their squares lie here.
    assert 6.6 < np.mean([trial.squared_error for trial in trials]) < 19.3
    assert all(trial.fit.misfit < 1.3 for trial in trials)


def test_a_mean_counts_less_the_more_it_differs_from_its_neighbours():
    still, hauled = 50.0, 58.0
    means = np.array([[still, 1.0], [still, np.nan], [hauled, np.nan], [hauled, 2.0]])
    expected = [[0.0, 0.0], [hauled - still, 0.0], [hauled - still, 0.0], [0.0, 0.0]]
    np.testing.assert_allclose(changes(means), expected)
    own = rows(np.random.default_rng(1), 3)
    sizes = ErrorSizes(swift=0.5).of_group(0)
    more = own.covariance(sizes, ErrorTimes()) - own.covariance(
        sizes * [1, 1, 1, 1, 0], ErrorTimes()
    )
    np.testing.assert_allclose(more, 0.25 * np.eye(6), atol=1e-12)
