"""A towed wire with a lump at its end, against the integrated equation of a steady elastic
wire: the same line kernel, assembly and solver as the whole gear."""

import numpy as np
import pytest

from trawl_ros.lab.reference_codes.towed_wire import INTEGRATED, UNITS
from trawl_ros.lab.validation.closed_forms.towed_wire import Wire, integrated, modelled


def errors(segments: int) -> np.ndarray:
    """Relative errors of depth, lag and top tension against the integrated equation."""
    exact = integrated(segments)
    return np.array([getattr(modelled(segments), key) / getattr(exact, key) - 1 for key in UNITS])


def test_twenty_segments_agree_within_one_per_mille() -> None:
    assert np.abs(errors(20)).max() < 0.001


def test_the_error_falls_with_the_square_of_the_segments() -> None:
    falling = np.abs([errors(segments) for segments in (10, 20, 40)])
    print('errors of depth, lag, tension at 10, 20, 40 segments', falling, sep='\n')  # noqa: T201
    np.testing.assert_allclose(falling[:-1] / falling[1:], 4.0, rtol=0.02)


def test_the_integrated_wire_hangs_on_its_block_and_is_as_long_as_it_was_stretched() -> None:
    wire: Wire = integrated(2000)
    np.testing.assert_array_equal(wire.places[0], 0.0)
    length = np.linalg.norm(np.diff(wire.places, axis=0), axis=1).sum()
    # Between the strains at its lower and upper end.
    assert 600.0 * (1 + 29_000 / 4e7) < length < 600.0 * (1 + 41_100 / 4e7)
    assert wire.tension == pytest.approx(INTEGRATED.tension, rel=1e-5)
