"""Quantities in the units of a user, read and printed."""

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.display_units import METRIC, parse_units, parse_value
from trawl_ros.core.errors import TrawlError


@pytest.mark.parametrize(
    ('text', 'quantity', 'value'),
    [
        ('250fm', 'warp', 457.2),
        ('250 fathoms', 'warp', 457.2),
        ('820ft', 'width', 249.936),
        ('4kn', 'speed', 4 * 1852 / 3600),
        ('4 knots', 'speed', 4 * 1852 / 3600),
        ('12.5t', 'tension', 12.5 * 9806.65),
        ('500', 'warp', 500.0),
        ('1e2', 'warp', 100.0),
        ('2.1m/s', 'speed', 2.1),
    ],
)
def test_a_number_carries_its_unit(text: str, quantity: str, value: float) -> None:
    assert parse_value(text, quantity) == pytest.approx(value)


def test_a_number_without_a_unit_is_in_the_chosen_ones() -> None:
    assert parse_value('4', 'speed', parse_units('sea')) == pytest.approx(4 * 1852 / 3600)
    assert parse_value('250', 'warp', parse_units('sea,warp=fm')) == pytest.approx(457.2)
    assert parse_value('4m/s', 'speed', parse_units('imperial')) == pytest.approx(4.0)


@pytest.mark.parametrize('text', ['', 'fm', '4 parsec', '4kn', '--', '5t'])
def test_another_unit_is_refused(text: str) -> None:
    with pytest.raises(TrawlError, match='expected'):
        parse_value(text, 'warp')


@pytest.mark.parametrize('text', ['nautical', 'speed=t', 'weight=t', ''])
def test_an_unknown_choice_is_refused(text: str) -> None:
    with pytest.raises(TrawlError, match='expected'):
        parse_units(text)


def test_values_are_shown_in_the_chosen_units() -> None:
    imperial = parse_units('imperial')
    assert METRIC.shown(150_400.0, 'tension') == '150.4 kN'
    assert parse_units('sea').shown(150_400.0, 'tension') == '15.34 t'
    assert imperial.shown(109.728, 'depth') == '60.0 fm'
    assert imperial.shown(30.48, 'width') == '100.0 ft'
    assert METRIC.shown(0.5, 'angle') == '28.6°'


def test_sentences_of_the_solver_are_converted() -> None:
    text = 'at 457.2 m and 2.06 m/s: spread 121.9 m, door depth 109.7 m, 98.1 kN, 3 m² of kite'
    assert METRIC.sentence(text) == text
    told = parse_units('imperial,tension=t').sentence(text)
    assert '250.0 fm and 4.00 kn: spread 399.9 ft, door depth 60.0 fm, 10.00 t, 3 m²' in told


def test_commands_read_and_print_them(coarse_gear) -> None:
    run = CliRunner().invoke
    state = ['gear', 'state', str(coarse_gear)]
    metric = run(trawl, [*state, '--warp', '365.76', '--speed', '2.3'], catch_exceptions=False)
    words = [*state, '--warp', '200fm', '--speed', '2.3m/s', '--units', 'sea,depth=fm']
    at_sea = run(trawl, words, catch_exceptions=False)
    assert metric.exit_code == at_sea.exit_code == 0
    depth = float(metric.output.split(' apart and ')[1].split(' m')[0])
    fathoms = float(at_sea.output.split(' apart and ')[1].split(' fm')[0])
    assert fathoms * 1.8288 == pytest.approx(depth, abs=0.2)
    assert ' t on a warp' in at_sea.output
    refused = run(trawl, [*state, '--warp', '5000fm', '--speed', '2.3'])
    assert refused.exit_code == 2
