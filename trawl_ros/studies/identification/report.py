"""The report of the study: JSON, Markdown, a self-contained page and a figure."""

import base64
import json
import os
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from trawl_ros.benchmark.machine import cpu_model, software
from trawl_ros.plots.style import DPI
from trawl_ros.reporting import number, templates
from trawl_ros.studies.identification.plant import HELD_OUT, TOWS
from trawl_ros.studies.identification.readings import CORRELATION_S
from trawl_ros.studies.identification.study import COVERAGE, Plan
from trawl_ros.studies.identification.trial import WRONG_BY
from trawl_ros.studies.row import Row

JSON, REPORT, PAGE, FIGURE = (f'identification.{kind}' for kind in ('json', 'md', 'html', 'png'))

Section = tuple[str, Sequence[Row]]


def write_identification(
    folder: Path, plan: Plan, sections: Sequence[Section], figure: Figure
) -> None:
    """Write ``identification.json``, ``.md``, ``.html`` and ``.png`` into a folder."""
    records = [row.record() for _, rows in sections for row in rows]
    text = json.dumps({'rows': records}, indent=1, ensure_ascii=False)
    (folder / JSON).write_text(text + '\n', encoding='utf-8')
    picture = BytesIO()
    figure.savefig(picture, format='png', dpi=DPI)
    (folder / FIGURE).write_bytes(picture.getvalue())
    asked = [row for _, rows in sections for row in rows if row.asked]
    content: dict[str, Any] = {
        'sections': [section for section in sections if section[1]],
        'asked': asked,
        'plan': plan,
        'options': _options(plan),
        'method': _method(plan),
        'figure': FIGURE,
        'data': base64.b64encode(picture.getvalue()).decode('ascii'),
    }
    environment = templates('trawl_ros.studies')
    environment.filters['wanted'] = wanted
    for name in (REPORT, PAGE):
        page = environment.get_template(f'{name}.j2').render(content)
        (folder / name).write_text(page.rstrip() + '\n', encoding='utf-8')


def wanted(row: Row) -> str:
    """What a row was asked for, in words."""
    if row.least is not None and row.target is not None:
        return f'{number(row.least)} to {number(row.target)}'
    if row.least is not None:
        return f'at least {number(row.least)}'
    return '' if row.target is None else f'at most {number(row.target)}'


def _options(plan: Plan) -> str:
    usual = Plan()
    words = [
        f'--{key.replace("_", "-")} {getattr(plan, key)}'
        for key in ('gear', 'seed', 'coverage', 'bound', 'mouth', 'around', 'tows', 'live_s')
        if getattr(plan, key) != getattr(usual, key)
    ]
    return ''.join(f' {word}' for word in words)


def _method(plan: Plan) -> str:
    """How the figures were made, in sentences."""
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    return (
        f'A trial draws the twelve coefficients from the prior of the gear file, until the plant '
        f'can be towed with them in all its steady states: under water, with the boards within '
        f'the range of their law, and stable in the first and the last. It has {plan.tows} tows of '
        f'{len(TOWS[0])} states, 300 to 900 m of warp at 2.0 to 2.4 m/s, and a further tow of '
        f'{len(HELD_OUT)} states that is predicted and not fitted. Windows are not towed but '
        f'worked out: readings of a minute are the observables of the plant with noise as in '
        f'bags/sea_trial.yaml, of which a part is autoregressive of first order (correlation time '
        f'{CORRELATION_S:g} s), an offset and an '
        f'error of scale per sensor and tow, drawn from the channel table; their mean and its '
        f'stated error come from these readings as in the finder. The model has a net of '
        f'{plan.around} meshes around its mouth. For the coverage and the tows left out the plant '
        f'has {plan.cut(COVERAGE)}, and noise and biases of each kind of sensor are '
        f'{100.0 * WRONG_BY:g} % larger or smaller than stated, by chance. For the bound the plant '
        f'is the model, noise is as stated, and the estimator is told both. '
        f'The catalogue of bad input is test/identification/test_bad_input.py. '
        f'On {os.cpu_count()} cores of {cpu_model()}, with {versions}.'
    )
