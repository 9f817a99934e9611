"""Progress of long work: bars on a terminal, else a line now and then."""

import io
import time

from rich.console import Console

from trawl_ros.cli.console import progress as shown
from trawl_ros.cli.console.progress import ProgressDisplay
from trawl_ros.core.progress import WorkProgress, step_counter


def test_steps_are_counted_from_none() -> None:
    told: list[WorkProgress] = []
    step = step_counter('trials', 2, told.append)
    step()
    step()
    assert told == [WorkProgress('trials', done, 2) for done in (0, 1, 2)]


def test_without_a_terminal_a_line_says_how_far_it_is(monkeypatch) -> None:
    monkeypatch.setattr(shown, 'LINE_EVERY_S', 0.0)
    monkeypatch.setattr(shown, 'FIRST_RATE_S', 0.2)
    console = Console(file=io.StringIO(), width=200)
    with ProgressDisplay(console) as display:
        display(WorkProgress('towing', 60.0, 600.0, 's', 'haul'))
        time.sleep(0.2)
        display(WorkProgress('towing', 90.0, 600.0, 's', 'haul'))
        display(WorkProgress('trials', 3, 12))
        display(WorkProgress('planning'))
    at_once, first, *others = console.file.getvalue().splitlines()
    assert at_once.startswith('towing: 1.0 of 10.0 min')
    assert at_once.endswith('haul')
    assert first.startswith('towing: 1.5 of 10.0 min, ')
    assert first.endswith(' × real time, haul')
    assert others == ['trials: 3 of 12', 'planning']
