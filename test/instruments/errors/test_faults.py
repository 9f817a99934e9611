"""Each fault does what it says, where it is put, and leaves no trace after its end."""

import math
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.core.errors import InstrumentError
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.fault_plan import FaultPlan, PlannedFault
from trawl_ros.instruments.errors.faults import KINDS, FaultPanel, parse_fault
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.instruments.winch import WinchInstrument
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.truth import WinchTruth

COUNTER = 'winch/joint_states/port/length'
WINCH = 'winch/joint_states'


def winch() -> WinchInstrument:
    return WinchInstrument(load_instruments().winch, SeedPlan(3))


def towed(
    instrument: WinchInstrument, panel: FaultPanel, switches: dict[int, tuple[str, str]], n: int
) -> list[WinchSample]:
    """Samples at 2 Hz for ``n`` seconds of paying out; faults are switched at whole seconds."""
    found = []
    for k in range(2 * n):
        if k % 2 == 0 and k // 2 in switches:
            panel.switch(*switches[k // 2])
        truth = WinchTruth(500.0 + 0.2 * k, 0.4, 160e3)
        found += instrument.observe((truth, truth), k * SECOND // 2)
    return found


def lengths(switches: dict[int, tuple[str, str]], n: int = 300) -> np.ndarray:
    instrument = winch()
    samples = towed(instrument, FaultPanel([instrument]), switches, n)
    return np.array([sample.lengths for sample in samples])


SOUND = lengths({})
ON = slice(100, 400)
"""Samples of a fault from 50 to 200 s."""


def faulty(what: str) -> np.ndarray:
    found = lengths({50: (COUNTER, what), 200: (COUNTER, 'none')})
    np.testing.assert_array_equal(found[:, 1], SOUND[:, 1], 'the other side is sound')
    np.testing.assert_array_equal(found[:100], SOUND[:100], 'before the fault')
    np.testing.assert_array_equal(found[400:], SOUND[400:], 'after its end')
    return found[ON, 0]


def test_frozen_stays_at_the_last_reading() -> None:
    assert set(faulty('frozen')) == {SOUND[99, 0]}


def test_lost_is_not_a_number() -> None:
    assert np.isnan(faulty('lost')).all()


def test_offset_is_added_scale_multiplies_and_drift_begins_with_the_fault() -> None:
    sound, seconds = SOUND[ON, 0], np.arange(300) / 2
    np.testing.assert_allclose(faulty('offset -3.5'), sound - 3.5, atol=0.051)
    np.testing.assert_allclose(faulty('scale 1.02'), sound * 1.02, atol=0.11)
    np.testing.assert_allclose(faulty('drift 360'), sound + 0.1 * seconds, atol=0.11)


def test_noise_has_the_size_that_is_asked_for() -> None:
    assert (faulty('noise 4') - SOUND[ON, 0]).std() == pytest.approx(4.0, rel=0.17)


def test_outliers_are_as_many_as_asked_for_and_far_off() -> None:
    off = np.abs(faulty('outliers 0.2') - SOUND[ON, 0])
    hit = off > 1.0
    assert hit.mean() == pytest.approx(0.2, abs=4 * math.sqrt(0.2 * 0.8 / 300))
    assert np.median(off[hit]) > 100.0


def test_saturated_reads_no_more() -> None:
    found = faulty('saturated 530')
    assert found.max() == 530.0
    low = SOUND[ON, 0] < 530.0
    np.testing.assert_array_equal(found[low], SOUND[ON, 0][low])


def sent(what: str, n: int = 2000) -> np.ndarray:
    """Stamps (s) of samples with a fault on from the beginning."""
    instrument = winch()
    samples = towed(instrument, FaultPanel([instrument]), {0: (WINCH, what)}, n)
    return np.array([sample.stamp / SECOND for sample in samples])


def test_silent_sends_nothing() -> None:
    assert len(sent('silent', 50)) == 0


def test_dropouts_lose_the_share_that_is_asked_for_in_bursts() -> None:
    stamps = sent('dropouts 0.3', 20_000)
    assert len(stamps) / 40_000 == pytest.approx(0.7, abs=0.03)
    gaps = np.diff(stamps) - 0.5
    assert gaps[gaps > 0].mean() == pytest.approx(10.0, rel=0.15)


def test_late_samples_carry_the_time_they_were_taken() -> None:
    instrument = winch()
    FaultPanel([instrument]).switch(WINCH, 'late 3')
    truth = (WinchTruth(500.0, 0.0, 1e5),) * 2
    arrived = [instrument.observe(truth, k * SECOND // 2) for k in range(8)]
    assert [len(samples) for samples in arrived] == [0] * 6 + [1, 1]
    assert arrived[6][0].stamp == 0


def test_jitter_takes_samples_off_the_beat() -> None:
    instrument = winch()
    FaultPanel([instrument]).switch(WINCH, 'jitter 0.1')
    truth = (WinchTruth(500.0, 0.0, 1e5),) * 2
    stamps = [
        s.stamp / SECOND for k in range(20_000) for s in instrument.observe(truth, k * SECOND // 50)
    ]
    off = np.array(stamps) - np.round(2 * np.array(stamps)) / 2
    assert off.std() == pytest.approx(0.1, rel=0.15)


def test_every_kind_of_fault_is_tried_here() -> None:
    text = Path(__file__).read_text()
    for kind, about in KINDS.items():
        assert f"'{kind} " in text if about.sized else f"'{kind}'" in text, kind


@pytest.mark.parametrize(
    ('where', 'what', 'named'),
    [
        ('winch/joint_state', 'frozen', "'winch/joint_state'"),
        (COUNTER, 'fozen', "'fozen'"),
        (COUNTER, 'offset', "'offset'"),
        (COUNTER, 'offset x', "'offset x'"),
        (COUNTER, 'outliers 2', "'outliers 2'"),
        (COUNTER, 'frozen 3', "'frozen 3'"),
        (COUNTER, 'silent', f"'{COUNTER}'"),
    ],
)
def test_a_fault_that_cannot_be_is_refused(where: str, what: str, named: str) -> None:
    panel = FaultPanel([winch()])
    with pytest.raises(InstrumentError) as caught:
        panel.switch(where, what)
    assert named in str(caught.value)
    assert panel.active() == {}


def test_the_panel_lists_what_is_on() -> None:
    panel = FaultPanel([winch()])
    panel.switch(WINCH, 'late 2')
    panel.switch(COUNTER, 'frozen')
    panel.switch(COUNTER, 'offset 1')
    panel.switch(COUNTER, 'offset 2')
    assert panel.active() == {WINCH: 'late 2', COUNTER: 'frozen, offset 2'}
    panel.switch_off(COUNTER, 'frozen')
    assert panel.active()[COUNTER] == 'offset 2'
    panel.switch(WINCH, 'none')
    assert panel.active() == {}


def test_a_fault_says_itself_as_it_is_read() -> None:
    for text in ('frozen', 'offset -3.5', 'dropouts 0.25'):
        assert str(parse_fault(text)) == text


def test_a_plan_switches_faults_on_and_off_and_starts_anew_with_time() -> None:
    panel = FaultPanel([winch()])
    faults = [
        PlannedFault(10.0, 20.0, COUNTER, 'frozen'),
        PlannedFault(15.0, None, WINCH, 'silent'),
        PlannedFault(0.0, None, 'door/spread', 'silent'),
    ]
    plan = FaultPlan(faults, panel)
    start = 1_700_000_000 * SECOND
    for _ in range(2):
        seen = []
        for second in range(0, 31, 5):
            plan.follow(start + second * SECOND)
            seen.append(sorted(panel.active().values()))
        assert seen == [
            [], [], ['frozen'], ['frozen', 'silent'], ['silent'], ['silent'], ['silent'],
        ]  # fmt: skip
