# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Emulates the instruments of a mid-water trawler and keeps the model of its gear honest.

The names of `__all__` are the public face; each is loaded when it is first used.
"""

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

from trawl_ros.core.version import __version__ as __version__

# On matrices as sparse and small as a gear's, threads of BLAS only wait for one another: on a
# busy machine a check of stability takes ten times as long with them. This has an effect
# where numpy has not been imported before.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')

if TYPE_CHECKING:
    from trawl_ros.api.comparing import compare
    from trawl_ros.api.gear_check import GearCheck, check_gear
    from trawl_ros.api.tows import TowedBag, read_bag, simulate, tow
    from trawl_ros.api.trials import diagnose, identify, plan_trial
    from trawl_ros.bags.check import check_bag
    from trawl_ros.bags.export import export_bag
    from trawl_ros.bags.logs.import_log import import_log
    from trawl_ros.bags.reader import Bag, read_messages
    from trawl_ros.bags.repair import repair_bag
    from trawl_ros.core.errors import BagError, GearError, NoSteadyState, ScenarioError, TrawlError
    from trawl_ros.core.progress import WorkProgress
    from trawl_ros.diagnosis.diagnosis import Diagnosis
    from trawl_ros.effects.base.effect import Effect, Parameter
    from trawl_ros.effects.registry import catalogue
    from trawl_ros.estimation.planning.plan import TrialPlan
    from trawl_ros.estimation.report.report import Report
    from trawl_ros.gear.load import load_gear
    from trawl_ros.gear.records import GearRecord
    from trawl_ros.instruments.parameters import load_instruments
    from trawl_ros.instruments.suite import InstrumentSuite
    from trawl_ros.lab.validation.run import validate
    from trawl_ros.model.gear_model import GearModel, build_model
    from trawl_ros.plots.album import plot
    from trawl_ros.records.observables import Observables
    from trawl_ros.records.truth import Truth
    from trawl_ros.scenario.scenario import Scenario, load_scenario
    from trawl_ros.simulation.command import Command
    from trawl_ros.simulation.simulation import Simulation
    from trawl_ros.solver.equilibrium import SteadyState, steady_state
    from trawl_ros.solver.trim import trim

_MODULES = {
    'trawl_ros.api.comparing': ('compare',),
    'trawl_ros.api.gear_check': ('GearCheck', 'check_gear'),
    'trawl_ros.api.tows': ('TowedBag', 'read_bag', 'simulate', 'tow'),
    'trawl_ros.api.trials': ('diagnose', 'identify', 'plan_trial'),
    'trawl_ros.bags.check': ('check_bag',),
    'trawl_ros.bags.export': ('export_bag',),
    'trawl_ros.bags.logs.import_log': ('import_log',),
    'trawl_ros.bags.reader': ('Bag', 'read_messages'),
    'trawl_ros.bags.repair': ('repair_bag',),
    'trawl_ros.diagnosis.diagnosis': ('Diagnosis',),
    'trawl_ros.effects.registry': ('catalogue',),
    'trawl_ros.effects.base.effect': ('Effect', 'Parameter'),
    'trawl_ros.core.errors': (
        'BagError', 'GearError', 'NoSteadyState', 'ScenarioError', 'TrawlError',
    ),
    'trawl_ros.gear.load': ('load_gear',),
    'trawl_ros.gear.records': ('GearRecord',),
    'trawl_ros.estimation.planning.plan': ('TrialPlan',),
    'trawl_ros.estimation.report.report': ('Report',),
    'trawl_ros.instruments.parameters': ('load_instruments',),
    'trawl_ros.instruments.suite': ('InstrumentSuite',),
    # The one name of the lab; like all, it is loaded when it is first used.
    'trawl_ros.lab.validation.run': ('validate',),
    'trawl_ros.model.gear_model': ('GearModel', 'build_model'),
    'trawl_ros.records.observables': ('Observables',),
    'trawl_ros.plots.album': ('plot',),
    'trawl_ros.core.progress': ('WorkProgress',),
    'trawl_ros.scenario.scenario': ('Scenario', 'load_scenario'),
    'trawl_ros.simulation.command': ('Command',),
    'trawl_ros.simulation.simulation': ('Simulation',),
    'trawl_ros.records.truth': ('Truth',),
    'trawl_ros.solver.equilibrium': ('SteadyState', 'steady_state'),
    'trawl_ros.solver.trim': ('trim',),
}  # fmt: skip
_HOMES = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    'Bag', 'BagError', 'Command', 'Diagnosis', 'Effect', 'GearCheck', 'GearError', 'GearModel',
    'GearRecord', 'InstrumentSuite', 'NoSteadyState', 'Observables', 'Parameter', 'Report',
    'Scenario', 'ScenarioError', 'Simulation', 'SteadyState', 'TowedBag', 'TrawlError', 'TrialPlan',
    'Truth', 'WorkProgress', 'build_model', 'catalogue', 'check_bag', 'check_gear', 'compare',
    'diagnose', 'export_bag', 'identify', 'import_log', 'load_gear', 'load_instruments',
    'load_scenario', 'plan_trial', 'plot', 'read_bag', 'read_messages', 'repair_bag', 'simulate',
    'steady_state', 'tow', 'trim', 'validate',
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
