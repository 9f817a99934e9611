"""Log of all scorings of blind trials, so that none is left out that came out worse."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime, timezone
from hashlib import sha256
from pathlib import Path

from trawl_ros.diagnosis import rules
from trawl_ros.files import appending
from trawl_ros.studies.discrepancy.study import Plan
from trawl_ros.studies.row import Row
from trawl_ros.version import __version__

SCORINGS = 'scorings.jsonl'


def log_scoring(folder: Path, plan: Plan, trials: int, rows: Sequence[Row]) -> None:
    """Add a line: when, of which plan and rules, which targets were asked for, and missed."""
    asked = [row for row in rows if row.asked]
    source = Path(rules.__file__).read_bytes()
    line = {
        'time': datetime.now(timezone.utc).isoformat(timespec='seconds'),
        'version': __version__,
        'rules_sha256': sha256(source).hexdigest(),
        'plan': asdict(plan),
        'trials': trials,
        'asked': len(asked),
        'missed': [row.what for row in asked if not row.ok],
    }
    with appending(folder / SCORINGS) as log:
        log.write(json.dumps(line) + '\n')
