"""An estimate as statuses, for ``identification/status`` and ``/diagnostics``."""

from collections.abc import Mapping

from trawl_ros.identification.estimate import Estimate
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.model.board import COEFFICIENTS


def estimate_status(estimate: Estimate, rejected: Mapping[str, int]) -> Status:
    """Give the coefficients by name, with intervals, counts by reason, and how sure they are."""
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
    for i, name in enumerate(COEFFICIENTS):
        values |= {
            name: f'{estimate.values[i]:.9g}',
            f'{name} std': f'{estimate.std[i]:.6g}',
            f'{name} low': f'{estimate.low[i]:.6g}',
            f'{name} high': f'{estimate.high[i]:.6g}',
            f'{name} determined': str(estimate.determined[i]).lower(),
        }
    values |= {f'rejected {reason}': str(count) for reason, count in rejected.items()}
    determined = sum(estimate.determined)
    level = OK if estimate.converged else WARN
    message = (
        f'{determined} of {len(COEFFICIENTS)} coefficients determined by {estimate.windows} '
        f'windows; {estimate.reason}'
    )
    return Status('identification: coefficients', level, message, values)
