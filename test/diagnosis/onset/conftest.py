"""Stretches of a tow in which a board falls."""

from dataclasses import replace

import pytest


@pytest.fixture(scope='session')
def with_fall():
    def changed(stretches, number):
        """Stretches of a tow with a fall in one of them."""
        places = [last.place - (last.number - number) for last in stretches]
        return [
            replace(last, tow=replace(last.tow, fallen=(*last.tow.fallen, place)))
            if last.tow is not None and 0 <= place < len(last.tow)
            else last
            for last, place in zip(stretches, places, strict=True)
        ]

    return changed
