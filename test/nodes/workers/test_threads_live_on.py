"""The estimator's threads outlive an error of the program, and say it."""

import asyncio
from queue import SimpleQueue
from threading import Event
from types import SimpleNamespace

import numpy as np

from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.gear.load import load_gear
from trawl_ros.nodes.workers.advice_worker import AdviceWorker
from trawl_ros.nodes.workers.identification_worker import IdentificationWorker
from trawl_ros.records.samples import WinchSample

PATIENCE_S = 10.0


def broken(*_):
    raise ZeroDivisionError('nothing to divide by')


async def granted(wish):
    await wish
    return wish.outcome


def said_whole(trouble):
    return (
        trouble.startswith('an error of the program; Traceback')
        and 'ZeroDivisionError: nothing to divide by' in trouble
    )


def test_a_state_that_cannot_be_saved_is_said_and_the_next_sample_is_used(coarse_gear):
    outcomes, dealt = [], []
    identification = identification_for(load_gear(coarse_gear))
    worker = IdentificationWorker(identification, outcomes.append, dealt.append, broken, str)
    worker.start()
    worker.put(WinchSample(1, (500.0, 500.0), (0.0, 0.0), (9e4, 9e4)))
    asyncio.run(granted(worker.finish()))
    assert said_whole(outcomes[-1].troubles['saving'])
    worker.put(WinchSample(2, (500.0, 500.0), (0.0, 0.0), (9e4, 9e4)))
    worker.stop()
    assert dealt == [1, 2]


def test_a_report_that_cannot_be_written_ends_the_wish_and_not_the_thread(coarse_gear):
    identification = identification_for(load_gear(coarse_gear))
    worker = IdentificationWorker(
        identification, lambda _: None, lambda _: None, lambda _: None, broken
    )
    worker.start()
    worker.put(WinchSample(1, (500.0, 500.0), (0.0, 0.0), (9e4, 9e4)))
    ended = asyncio.run(granted(worker.finish()))
    assert ended.failed
    assert said_whole(ended.finished)
    assert worker.is_alive()
    worker.stop()


def test_advice_that_fails_is_said_and_sought_again():
    told = SimpleQueue()
    adviser = SimpleNamespace(advise=broken, look_up=broken, trouble='')
    thread = AdviceWorker(adviser, np.zeros(12), 0.1, lambda: True, lambda *what: told.put(what))
    thread.start()
    for _ in range(2):
        thread.fitted(SimpleNamespace(windows=(), coefficients=np.zeros(12)))
        advice, trouble = told.get(timeout=PATIENCE_S)
        assert advice is None
        assert said_whole(trouble)
    thread.stop()


def test_a_manoeuvre_that_cannot_be_looked_up_takes_no_advice_away():
    told, advice = SimpleQueue(), object()
    rest = Event()
    adviser = SimpleNamespace(advise=lambda fit: advice, look_up=broken, trouble='none is towed')
    thread = AdviceWorker(adviser, np.zeros(12), 0.1, rest.is_set, lambda *what: told.put(what))
    thread.start()
    thread.fitted(SimpleNamespace(windows=(), coefficients=np.zeros(12)))
    assert told.get(timeout=PATIENCE_S) == (advice, 'none is towed')
    rest.set()
    kept, trouble = told.get(timeout=PATIENCE_S)
    assert kept is advice
    assert said_whole(trouble)
    thread.stop()


def test_advice_comes_though_all_manoeuvres_were_looked_up_before_the_first_fit():
    told, advice, looked_up = SimpleQueue(), object(), Event()

    def look_up(*_):
        looked_up.set()
        return False

    adviser = SimpleNamespace(look_up=look_up, advise=lambda fit: advice, trouble='')
    thread = AdviceWorker(adviser, np.zeros(12), 0.1, lambda: True, lambda *what: told.put(what))
    thread.start()
    assert looked_up.wait(PATIENCE_S)
    thread.fitted(SimpleNamespace(windows=(), coefficients=np.zeros(12)))
    assert told.get(timeout=PATIENCE_S) == (advice, '')
    thread.stop()
