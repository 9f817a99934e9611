# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Diagnostic statuses of an identification, for ``identification/status``."""

import numpy as np

from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.estimate import Innovation as Innovations
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.planning.advice import Advice
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status
from trawl_ros.messages.estimates import ChannelInnovation
from trawl_ros.nodes.workers.motion_learner import MotionKnowledge
from trawl_ros.nodes.workers.outcome import EstimatorOutcome

WINDOWS, STEADY, WHOLE = 'steady windows', 'steady parts', 'all of the tow'
"""Words for where an estimate is from."""


def innovations_of(innovations: Innovations) -> list[ChannelInnovation]:
    """Return the innovations of a window channel by channel."""
    rows = zip(
        innovations.channels,
        innovations.values,
        innovations.stds,
        innovations.test_ratios,
        strict=True,
    )
    return [ChannelInnovation(name, float(v), float(s), float(r)) for name, v, s, r in rows]


def identification_statuses(outcome: EstimatorOutcome) -> list[Status]:
    """Return the statuses of coefficients, channels and instruments.

    The coefficients always come first; before there is an estimate, with the reason why.
    """
    statuses = [coefficients_status(outcome), channels_status(outcome)]
    if outcome.estimate is not None:
        statuses.append(instruments_status(outcome.estimate))
    if outcome.motion is not None:
        statuses.append(motion_status(outcome.motion, outcome.estimate))
    return statuses


def coefficients_status(outcome: EstimatorOutcome) -> Status:
    """Return the coefficients by name, with intervals, counts by reason, and their certainty."""
    name = 'identification: coefficients'
    estimate = outcome.told
    rejected = {f'rejected {reason}': str(count) for reason, count in outcome.rejected.items()}
    rejected |= {f'found {reason}': sentence for reason, sentence in outcome.found.items()}
    if estimate is None:
        values = {'stamp': f'{outcome.stamp / 1e9:.3f}', 'revision': '0', 'windows': '0'}
        why_not = outcome.why_not or ''
        values |= {'converged': 'false', 'reason': why_not, **rejected}
        return Status(name, WARN, why_not, values)
    values = {
        'stamp': f'{estimate.stamp / 1e9:.3f}',
        'revision': str(estimate.revision),
        'windows': str(estimate.windows),
        'converged': str(estimate.converged).lower(),
        'reason': estimate.reason,
        'objective': f'{estimate.objective:.6g}',
        'condition number': f'{estimate.condition_number:.6g}',
        'undetermined': '; '.join(map(str, estimate.undetermined)),
        'active bounds': ', '.join(estimate.active_bounds),
    }
    for factor in estimate.net:
        values |= {f'net {factor.what}': f'{factor.value:.6g}',
                   f'net {factor.what} std': f'{factor.std:.6g}'}  # fmt: skip
    for i, coefficient in enumerate(estimate.names):
        values |= {
            coefficient: f'{estimate.values[i]:.9g}',
            f'{coefficient} std': f'{estimate.std[i]:.6g}',
            f'{coefficient} low': f'{estimate.low[i]:.6g}',
            f'{coefficient} high': f'{estimate.high[i]:.6g}',
            f'{coefficient} shrink': f'{estimate.shrink[i]:.4f}',
            f'{coefficient} determined': str(estimate.determined[i]).lower(),
        }
    level = OK if estimate.converged else WARN
    by = f'{estimate.windows} windows'
    if outcome.motion is not None:
        values |= {'learned from': WINDOWS}
        if estimate is outcome.motion.estimate:
            by = f'{outcome.motion.minutes:.1f} min of tow'
            fitted = outcome.motion.outcome
            whole = fitted is None or not fitted.steady_only
            values |= {
                'learned from': WHOLE if whole else STEADY,
                'minutes': f'{outcome.motion.minutes:.1f}',
            }
    message = (
        f'{sum(estimate.determined)} of {len(estimate.names)} coefficients determined by '
        f'{by}; {estimate.reason}'
    )
    return Status(name, level, message, values | rejected)


def channels_status(outcome: EstimatorOutcome) -> Status:
    """Give per channel its readings, and innovation and whiteness where it is compared."""
    values = {}
    for name, count in outcome.readings.items():
        values[f'{name} arrived'] = str(count.arrived)
        values[f'{name} accepted'] = str(count.accepted)
    beyond = []
    if outcome.estimate is not None and (innovations := outcome.estimate.innovation) is not None:
        for innovation in innovations_of(innovations):
            values |= {
                f'{innovation.channel} innovation': f'{innovation.innovation:.6g}',
                f'{innovation.channel} std': f'{innovation.std:.6g}',
                f'{innovation.channel} test ratio': f'{innovation.ratio:.4g}',
            }
            if innovation.ratio > 1.0:
                beyond.append(f'{innovation.channel} is beyond what its stated errors allow')
    for name, white in outcome.whiteness.items():
        values[f'{name} whiteness'] = 'too few windows' if white is None else f'{white.p_value:.3g}'
        if white is not None and not white.white:
            beyond.append(f'the innovations of {name} are not white')
    message = '; '.join(beyond) or 'innovations are within what stated errors allow'
    return Status('identification: channels', WARN if beyond else OK, message, values)


def instruments_status(estimate: Estimate) -> Status:
    """Return the estimated errors of the instruments: noise scales and biases."""
    values = {
        f'noise scale {group}': f'{scale:.4g}' for group, scale in estimate.noise_scales.items()
    }
    values['misfit'] = f'{estimate.birge_ratio:.4g}'
    for bias in estimate.tow_biases:
        values[f'tow {bias.tow + 1} {bias.channel} bias'] = (
            f'{bias.value:.4g} ± {bias.std:.2g} {bias.unit}'
        )
    message = 'noise as found over noise as stated, and what each tow reads too high by'
    return Status('identification: instruments', OK, message, values)


def motion_status(motion: MotionKnowledge, windows: Estimate | None) -> Status:
    """Return the estimate of the whole tow, next to that of its steady windows."""
    values = {
        'minutes': f'{motion.minutes:.1f}',
        'used': str(motion.estimate is not None).lower(),
        'whole': str(motion.whole).lower(),
    }
    if (outcome := motion.outcome) is not None:
        left_out = sum(part.end - part.begin for _, part in outcome.left_out)
        values |= {
            'stamp': f'{motion.stamp / 1e9:.3f}',
            'left out': f'{left_out / 60:.1f}',
            'misfit': f'{outcome.fit.misfit:.4g}',
            'moved': f'{motion.moved:.3g}',
            'towings': str(motion.towings),
            'std over prior': f'{_std_over_prior(outcome.estimate):.4f}',
        }
        for i, coefficient in enumerate(outcome.prior.names):
            values[coefficient] = f'{outcome.fit.values[i]:.9g}'
            values[f'{coefficient} std'] = f'{outcome.estimate.std[i]:.6g}'
            if windows is not None:
                values[f'{coefficient} by windows'] = f'{windows.values[i]:.9g}'
                values[f'{coefficient} std by windows'] = f'{windows.std[i]:.6g}'
    if motion.lost:
        values['lost'] = motion.lost
    known = motion_diagnosis(motion)
    return Status('identification: all of the tow', known.level, known.message, values)


def _std_over_prior(estimate: Estimate) -> float:
    """Geometric mean over the coefficients."""
    return float(np.exp(np.mean(np.log(estimate.std / estimate.prior.std))))


def motion_diagnosis(motion: MotionKnowledge) -> Status:
    """Return how much is learned from the whole tow, or why nothing, for ``/diagnostics``."""
    values = {'minutes': f'{motion.minutes:.1f}', 'used': str(motion.estimate is not None).lower()}
    return Status('motion', ERROR if motion.failed else OK, _about(motion), values)


def _about(motion: MotionKnowledge) -> str:
    if motion.why_not or motion.outcome is None:
        return motion.why_not
    if motion.estimate is None:
        return f'the model is still {motion.outcome.fit.reason}'
    return f'learned from {motion.minutes:.1f} min of tow; {motion.outcome.fit.reason}'


def advice_status(advice: Advice | None, trouble: str) -> Status:
    """Return the next manoeuvre with its gain, or the reason why there is none."""
    name = 'identification: next manoeuvre'
    if advice is None:
        return Status(
            name,
            WARN if trouble else OK,
            trouble or 'none yet: it needs a window, and time to look up',
        )
    manoeuvre = advice.manoeuvre
    values = {
        'port_warp': f'{manoeuvre.port_length:g}',
        'starboard_warp': f'{manoeuvre.starboard_length:g}',
        'speed': f'{manoeuvre.speed:g}',
        'minutes': f'{advice.minutes:.0f}',
        'gain': f'{advice.nats:.3f}',
        'looked up': f'{advice.looked_up:.2f}',
    }
    for at, quantity in enumerate(QUANTITIES):
        before, after = advice.before.ratio[at], advice.after.ratio[at]
        values[f'{quantity} now'] = f'{before:.3f}'
        values[f'{quantity} then'] = f'{after:.3f}'
    return Status(name, OK, str(advice), values)
