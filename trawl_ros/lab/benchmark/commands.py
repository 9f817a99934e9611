# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""CPU time of the commands from recorded bags to a result."""

import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Sequence, Set
from dataclasses import replace
from pathlib import Path

import psutil
import yaml

from trawl_ros.api.tows import tow
from trawl_ros.api.trials import DEFAULT_GEAR
from trawl_ros.cli.diagnose import EXIT
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.estimation.bag_windows import BagTask, read_tow
from trawl_ros.estimation.fit.nuisance import eliminate_nuisance
from trawl_ros.estimation.tows import numbered
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import Part, bytecode_kept, shares, timed
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.solver.effect_sensitivity import by_effects
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.sensitivity import sensitivities
from trawl_ros.solver.slow_mode import slow_mode

OVER_REAL_TIME, DIAGNOSIS_S = 200.0, 12.0

TOWS = ('hidden_baseline', 'hidden_tow_1', 'hidden_tow_2', 'hidden_tow_3')
"""Scenarios towed for the diagnosis, each with two seeds."""

PARTS: dict[str, Part] = {
    'steady states': find_equilibrium,
    'their derivatives': sensitivities,
    'those by effects and changes of the gear file': by_effects,
    'their slowest motions': slow_mode,
    'errors of instruments and tows': eliminate_nuisance,
}
"""Main functions of a diagnosis."""

LOADED = (
    'trawl_ros.cli.diagnose',
    'trawl_ros.cli.identify',
    'trawl_ros.diagnosis.report.writing',
    'trawl_ros.estimation.bag_motion',
    'trawl_ros.estimation.report.page',
)
"""Modules that the commands load."""

SUCCESS = frozenset({0})
COARSE = 12
SHORT_S = 540.0
"""Duration of the tow of the small version."""


def measure(quick: bool) -> Findings:
    """Run each command in a separate process."""
    with tempfile.TemporaryDirectory() as name, bytecode_kept(*LOADED):
        folder = Path(name)
        rows = [_identified(folder, quick=quick)]
        if not quick:
            rows.append(_diagnosed(folder))
    return Findings(
        tuple(rows),
        text='A command is run as a user runs it, imports, reading, hold-out, figures and page '
        'included; processor time of its processes together. Its compiled code, that of Python '
        'too, is in the cache.',
    )


def _identified(folder: Path, *, quick: bool) -> MeasuredValue:
    asked = MeasuredValue(
        'replay of a trial through trawl identify --steady, with hold-out, figures and page',
        math.nan,
        '× real time',
        at_least(OVER_REAL_TIME),
    )
    bag, gear, towed_s = share_path('bags', 'sea_trial'), 'kaifuha', None
    if quick:
        scenario = _short(folder)
        towed_s = tow(scenario, folder / 'short').duration_s
        bag, gear = folder / 'short', str(folder / 'coarse.yaml')
    else:
        towed_s = _length_s(bag)
    words = 'identify', '--steady', str(bag), '--gear', gear, '--out', str(folder / 'result')
    seconds = command_s(*words)
    note = f'{towed_s:.0f} s of tow in {seconds:.1f} s'
    return replace(asked, value=towed_s / seconds, note=note)


def _diagnosed(folder: Path) -> MeasuredValue:
    bags: dict[str, list[str]] = {'baseline': [], 'suspect': []}
    for number, name in enumerate(TOWS):
        for seed in (1, 2):
            scenario = yaml.safe_load(
                share_path('config', 'scenarios', f'{name}.yaml').read_text('utf-8')
            )
            scenario['seed'] = 10 * number + seed
            file = folder / f'{name}_{seed}.yaml'
            file.write_text(yaml.safe_dump(scenario), encoding='utf-8')
            bag = tow(file, folder / f'{name}_{seed}').path
            bags['suspect' if number else 'baseline'].append(str(bag))
    baselines = [word for bag in bags['baseline'] for word in ('--baseline', bag)]
    out = folder / 'diagnosis'
    words = 'diagnose', *bags['suspect'], *baselines, '--out', str(out)
    seconds = command_s(*words, codes=frozenset(EXIT.values()))
    verdict = json.loads((out / 'diagnosis.json').read_text(encoding='utf-8'))['verdict']
    every = [Path(bag) for bag in (*bags['baseline'], *bags['suspect'])]
    note = (
        f'two of them a baseline, three steady states each, net as it ships; {verdict}; '
        f'{_of_diagnosis(every, len(bags["baseline"]))}'
    )
    return MeasuredValue('trawl diagnose of eight tows', seconds, 's', at_most(DIAGNOSIS_S), note)


def _of_diagnosis(bags: Sequence[Path], baselines: int) -> str:
    """Parts of a diagnosis in words."""
    gear = load_gear(DEFAULT_GEAR)
    started = command_s('diagnose', '--help')
    read, reading = timed(lambda: [read_tow(BagTask(bag, gear, NAMESPACE)) for bag in bags])
    windows, names = numbered(read)
    known = frozenset(window.tow for window in numbered(read[:baselines])[0])
    taken = shares(lambda: diagnose_windows(gear, windows, names, known), PARTS)
    return (
        f'{started:.1f} s to start, {reading:.1f} s to read the bags, the rest for figures, page '
        f'and the diagnosis, of which {taken}'
    )


def command_s(*words: str, codes: Set[int] = SUCCESS) -> float:
    """CPU time (s) of a command of ``trawl`` with all its processes.

    ``codes`` are exit codes of a command that has done its work.

    Raises
    ------
    TrawlError
        If it fails.
    """
    code = 'import sys; from trawl_ros.cli.main import main; sys.exit(main())'
    before = _children_s()
    done = subprocess.run([sys.executable, '-c', code, *words], capture_output=True, text=True)
    if done.returncode not in codes:
        raise TrawlError(f'trawl {words[0]}: ended with {done.returncode}: {_last(done.stderr)}')
    return _children_s() - before


def _last(lines: str) -> str:
    return lines.strip().rpartition('\n')[2]


def _children_s() -> float:
    """CPU time (s) of all ended child processes and of their children."""
    times = psutil.Process().cpu_times()
    return float(times.children_user + times.children_system)


def _length_s(bag: Path) -> float:
    """Duration (s) of a bag by its metadata."""
    metadata = yaml.safe_load((bag / 'metadata.yaml').read_text(encoding='utf-8'))
    return 1e-9 * float(metadata['rosbag2_bagfile_information']['duration']['nanoseconds'])


def _short(folder: Path) -> Path:
    """Write a scenario of one steady state of a coarse gear, and that gear."""
    gear = yaml.safe_load(share_path('config', 'gear', 'kaifuha.yaml').read_text('utf-8'))
    gear['netting']['around'] = COARSE
    (folder / 'coarse.yaml').write_text(yaml.safe_dump(gear), encoding='utf-8')
    steps: Sequence[dict[str, object]] = [{'name': 'steady', 'minutes': SHORT_S / 60.0}]
    scenario = {
        'description': 'One steady state',
        'gear': 'coarse.yaml',
        'start': {'warp_length_m': 300.0, 'speed_m_s': 2.3},
        'steps': steps,
        'truth_rate_hz': 2.0,
        'record': ['instruments'],
    }
    file = folder / 'short.yaml'
    file.write_text(yaml.safe_dump(scenario), encoding='utf-8')
    return file
