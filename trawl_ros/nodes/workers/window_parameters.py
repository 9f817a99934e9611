"""Parameters of the window finder in nodes."""

from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.nodes.runtime.parameters import Number, Parameters

WINDOW_SPECS = (
    Number('settle_s', WindowOptions.settle_s, 's', 0.0, 3600.0, 'Least time the gear is given '
           'after each change of warp length, speed or heading.'),
    Number('settle_passages', WindowOptions.settle_passages, 'times', 0.0, 10.0, 'How often the '
           'ship passes the length of her gear before it counts as settled.'),
    Number('window_s', WindowOptions.window_s, 's', 20.0, 3600.0, 'Length of a steady window.'),
)  # fmt: skip


def window_options(parameters: Parameters) -> WindowOptions:
    """Return the window options of a node that declares `WINDOW_SPECS`."""
    return WindowOptions(**{spec.name: parameters[spec.name] for spec in WINDOW_SPECS})
