"""Diagnosis in a thread of its own: the newest windows count, and none that are forgotten."""

import asyncio
from threading import Event

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.nodes.workers.diagnosis_worker import DiagnosisOutcome, DiagnosisWorker


class Slow:
    """Gives back what it is asked to diagnose, as soon as it is let."""

    def __init__(self):
        self.asked, self.may = [], Event()
        self.begun = Event()

    def __call__(self, windows):
        self.asked.append(windows)
        self.begun.set()
        assert self.may.wait(10.0)
        if not windows:
            raise TrawlError('nothing to diagnose')
        if windows == (0,):
            raise ZeroDivisionError('nothing to divide by')
        return windows


@pytest.fixture
def watched():
    slow, told = Slow(), []
    thread = DiagnosisWorker(slow, told.append)
    thread.start()
    yield thread, slow, told
    slow.may.set()
    thread.stop()


def test_of_several_the_newest_count(watched):
    thread, slow, told = watched
    thread.look_at((1,))
    assert slow.begun.wait(10.0)
    thread.look_at((1, 2))
    thread.look_at((1, 2, 3))
    assert not thread.idle
    slow.may.set()
    asyncio.run(at_rest(thread))
    assert thread.idle
    assert [outcome.diagnosis for outcome in told] == [(1,), (1, 2, 3)]


def test_nothing_is_said_of_windows_that_are_forgotten(watched):
    thread, slow, told = watched
    thread.look_at((1,))
    assert slow.begun.wait(10.0)
    thread.forget()
    slow.may.set()
    asyncio.run(at_rest(thread))
    assert told == []
    thread.look_at((4,))
    asyncio.run(at_rest(thread))
    assert told == [DiagnosisOutcome((4,))]


def test_what_goes_wrong_is_said(watched):
    thread, slow, told = watched
    slow.may.set()
    thread.look_at(())
    asyncio.run(at_rest(thread))
    assert told == [DiagnosisOutcome(None, 'nothing to diagnose')]


def test_an_error_of_the_program_is_told_whole_and_the_next_windows_are_diagnosed(watched):
    thread, slow, told = watched
    slow.may.set()
    thread.look_at((0,))
    asyncio.run(at_rest(thread))
    thread.look_at((1,))
    asyncio.run(at_rest(thread))
    assert told[0].trouble.startswith('an error of')
    assert 'ZeroDivisionError: ' in told[0].trouble
    assert told[1:] == [DiagnosisOutcome((1,))]


def test_it_ends_after_what_it_has_to_do(watched):
    thread, slow, told = watched
    thread.look_at((1,))
    slow.may.set()
    thread.stop()
    assert not thread.is_alive()
    assert [outcome.diagnosis for outcome in told] == [(1,)]


async def at_rest(thread):
    await thread
