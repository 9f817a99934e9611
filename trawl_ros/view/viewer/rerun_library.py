# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Import of Rerun, with a clear error if it is not installed."""

from pathlib import Path

from trawl_ros.core.errors import TrawlError


class ViewerAbsent(TrawlError):
    """Error: Rerun is not installed."""


try:
    import rerun as rr
    import rerun.blueprint as rrb
    import rerun_cli
    from rerun.experimental import ViewerClient
except ModuleNotFoundError as reason:
    raise ViewerAbsent(
        f'the view of a tow needs Rerun, and there is no {reason.name}; expected the extra `view`: '
        "pip install 'trawl_ros[view]' (170 MB)"
    ) from None

EXECUTABLE = str(Path(rerun_cli.__file__).with_name('rerun'))
"""Program of the viewer."""

__all__ = ['EXECUTABLE', 'ViewerClient', 'rr', 'rrb']
