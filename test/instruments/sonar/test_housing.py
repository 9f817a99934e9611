"""The sounder in the sonar's housing, and sonars that cannot be."""

import math
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.core.errors import InstrumentError
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import BottomParameters, load_instruments
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.model.water import Water
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import RangeSample, Sample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import NetTruth, SeabedTruth, Truth

SEA = Surroundings(Water().pressure)
DEPTH = 100.0


def truth(stamp: int, seabed: float) -> Truth:
    """An instant of a headrope at 100 m over a seabed at a depth (m)."""
    level = np.array([0.0, 0.0, 0.0, 1.0])
    position = np.array([0.0, 0.0, -DEPTH])
    net = NetTruth(np.zeros((0, 3)), math.nan, math.nan, DEPTH, position, level)
    return partial_truth(stamp, net=net, seabed=SeabedTruth(math.inf, seabed))


def with_exact_sounder(sound_speed: float) -> SonarInstruments:
    """The default sonar with a sounder whose only error is its speed of sound (m/s)."""
    bottom = BottomParameters(
        rate_hz=1.0, min_range_m=1.0, max_range_m=300.0, assumed_sound_speed_m_s=sound_speed
    )
    record = load_instruments().sonar.model_copy(update={'bottom': bottom})
    return SonarInstruments(record, SeedPlan(1), surroundings=SEA)


def sounded(instruments: SonarInstruments, now: Truth) -> list[RangeSample]:
    samples: list[Sample] = instruments.observe(now)
    return [s for s in samples if isinstance(s, RangeSample) and s.what == 'bottom']


def test_the_sounder_measures_the_seabed_below_the_headrope() -> None:
    instruments = with_exact_sounder(SEA.mean_sound_speed(DEPTH, 190.0))
    readings = [
        sounded(instruments, truth(k * SECOND, depth))[0].distance
        for k, depth in enumerate((190.0, math.inf, 500.0, DEPTH + 0.5))
    ]
    assert readings == pytest.approx([90.0, math.inf, math.inf, -math.inf])


def test_a_set_speed_of_sound_stretches_the_sounding_too() -> None:
    (sample,) = sounded(with_exact_sounder(1500.0), truth(0, 190.0))
    assert sample.distance == pytest.approx(90.0 * 1500.0 / SEA.mean_sound_speed(DEPTH, 190.0))


@pytest.mark.parametrize(
    ('key', 'value', 'sentence'),
    [
        (
            'max_range_m',
            200.0,
            'rate_hz: found 0.0625, expected 0.0474 at most: 76 pings of 0.278 s',
        ),
        (
            'min_range_m',
            155.0,
            'max_range_m: found 150, expected more than min_range_m, which is 155',
        ),
        ('white_db', -70.0, 'white_db: found -70, expected more than black_db, which is -60'),
        ('freeze_s', 3.0, 'freezes_per_hour: found 0 with freeze_s 3, expected both or neither'),
    ],
)
def test_a_sonar_that_cannot_be_is_refused(
    tmp_path: Path, key: str, value: float, sentence: str
) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text(f'base: default\nsonar: {{sweep: {{{key}: {value}}}}}\n')
    with pytest.raises(InstrumentError) as caught:
        load_instruments(path)
    assert sentence in str(caught.value)
