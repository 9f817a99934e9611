"""Figures of the paper by their number, and the file that says how to cite."""

from pathlib import Path

import pytest
import yaml

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.version import __version__
from trawl_ros.lab.validation.cases import FIGURES, case_of_figure, load_case

ROOT = Path(__file__).parents[3]


def test_each_figure_with_results_has_a_case_that_names_it():
    assert set(FIGURES) == set(range(4, 17))
    for number in FIGURES:
        title = load_case(case_of_figure(number)).title
        first, last = (title.partition('Fig. ')[2].rstrip(')').replace('and', 'to') + ' to ').split(
            ' to '
        )[:2]
        assert int(first) <= number <= int(last or first), title


def test_a_drawing_is_refused_with_those_there_are():
    with pytest.raises(TrawlError, match=r'figure 2: .*4 to 16'):
        case_of_figure(2)


def test_the_citation_is_of_this_version():
    record = yaml.safe_load((ROOT / 'CITATION.cff').read_text())
    assert record['version'] == __version__
    assert record['authors'] == [{'name': 'trawl_ros developers'}]
