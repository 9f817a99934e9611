"""Measured counters: their table is read, or refused, and hidden as it is."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.studies.counters.study import FATHOM, read_table
from trawl_ros.lab.studies.discrepancy.trials.tows import FULL

MEASURED = Path(__file__).parents[5] / 'shared/data/noaa_trawlmetrics/nwx_wire_vs_counter.csv'

TEXT = """\
wire_out_fm,winch_stbd_fm,winch_port_fm
50,60,58
100,111,110
400,420,418
"""


@pytest.fixture
def table(tmp_path):
    path = tmp_path / 'counters.csv'
    path.write_text(TEXT)
    return read_table(path)


def test_a_table_gives_the_wire_that_is_out(table):
    at = FULL.tows[0].moment(0)
    inputs = np.array([110.0 * FATHOM, 111.0 * FATHOM, 2.1])
    towed = table.hidden().towed(1.0, inputs, at)
    np.testing.assert_allclose(towed, [100.0 * FATHOM, 100.0 * FATHOM, 2.1])
    between = table.hidden().towed(1.0, np.array([264.0 * FATHOM, 265.5 * FATHOM, 2.1]), at)
    np.testing.assert_allclose(between[:2], 250.0 * FATHOM)


@pytest.mark.parametrize(
    'text', ['', 'a,b\n1,2\n', TEXT.replace('110', 'x'), TEXT.replace('400', '90'), TEXT[:70]]
)
def test_what_is_no_such_table_is_refused(tmp_path, text):
    path = tmp_path / 'counters.csv'
    path.write_text(text)
    with pytest.raises(TrawlError, match=r'counters\.csv: .*expected'):
        read_table(path)
    done = CliRunner().invoke(
        trawl, ['study', 'counters', '--table', str(path), '--out', str(tmp_path / 'out')]
    )
    assert done.exit_code == 1
    assert not (tmp_path / 'out').exists()


@pytest.mark.skipif(not MEASURED.is_file(), reason='the measured counters are not beside this')
def test_the_measured_counters_read_three_per_cent_and_thirteen_metres_long():
    scale, offset = read_table(MEASURED).lines()
    assert scale == pytest.approx(0.028, abs=0.002)
    assert offset == pytest.approx(13.0, abs=0.5)
