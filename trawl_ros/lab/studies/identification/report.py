"""Report of the study: JSON, Markdown, a self-contained page and a figure."""

import os
from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from trawl_ros.lab.report.machine import cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Page, Section, write_page
from trawl_ros.lab.studies.identification.plant import HELD_OUT, TOWS
from trawl_ros.lab.studies.identification.readings import CORRELATION_S
from trawl_ros.lab.studies.identification.study import COVERAGE, EstimationStudyPlan
from trawl_ros.lab.studies.identification.trial import WRONG_BY
from trawl_ros.report.pictures import Drawing

REPORT = 'identification.md'
CAPTION = (
    'Above: how often the 95 % interval of a coefficient covers the truth. Middle: root mean '
    'square error over the Bayesian Cramér–Rao bound. Below: errors on tows left out, those of a '
    'perfect model on the same data, and what is asked for. Bars are 95 % intervals, the green '
    'bands what is asked for.'
)


def write_identification(
    folder: Path, plan: EstimationStudyPlan, sections: Sequence[Section], figure: Figure
) -> list[MeasuredValue]:
    """Write ``identification.json``, ``.md``, ``.html``, ``.png`` into a folder; give the rows."""
    page = Page(
        name='identification',
        title='What identification is worth',
        command=f'trawl study identification{_options(plan)}',
        method=_method(plan),
    )
    return write_page(folder, page, sections, [Drawing(page.name, CAPTION, figure)])


def _options(plan: EstimationStudyPlan) -> str:
    usual = EstimationStudyPlan()
    words = [
        f'--{key.replace("_", "-")} {getattr(plan, key)}'
        for key in ('gear', 'seed', 'coverage', 'bound', 'mouth', 'around', 'tows', 'live_s')
        if getattr(plan, key) != getattr(usual, key)
    ]
    return ''.join(f' {word}' for word in words)


def _method(plan: EstimationStudyPlan) -> str:
    """Method in sentences."""
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    return (
        f'A trial draws the twelve coefficients from the prior of the gear file, until the plant '
        f'can be towed with them in all its steady states: under water, with the boards within '
        f'the range of their law, and stable. It has {plan.tows} tows of '
        f'{len(TOWS[0])} states, 300 to 900 m of warp at 2.0 to 2.4 m/s, and a further tow of '
        f'{len(HELD_OUT)} states that is predicted and not fitted. Windows are not towed but '
        f'worked out: readings of a minute are the observables of the plant with noise as in '
        f'bags/sea_trial.yaml, of which a part is autoregressive of first order (correlation time '
        f'{CORRELATION_S:g} s), an offset and an '
        f'error of scale per sensor and tow, drawn from the channel table, and an offset per state '
        f'as the error budget has it; their mean and its stated error come from these readings as '
        f'in the finder. The model has a net of '
        f'{plan.around} meshes around its mouth. For the coverage and the tows left out the plant '
        f'has {plan.cut(COVERAGE)}, and noise and biases of each kind of sensor are '
        f'{100.0 * WRONG_BY:g} % larger or smaller than stated, by chance. For the bound the plant '
        f'is the model, noise is as stated, nothing changes with the state, and the estimator is '
        f'told all three. '
        f'The catalogue of bad input is test/estimation/test_bad_input.py. '
        f'On {os.cpu_count()} cores of {cpu_model()}, with {versions}.'
    )
