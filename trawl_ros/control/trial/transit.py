"""Transit of ship and winches from one state to the next, at limited rates."""

from dataclasses import dataclass

from trawl_ros.control.trial.records import TrialSettings, TrialTarget

LEAST_PAY_OUT = 0.05
"""Pay-out speed (m/s) of a ship that is as slow as she may be."""


@dataclass(frozen=True)
class Wanted:
    """Wanted warp lengths (m) and speed (m/s) at one instant."""

    port: float
    starboard: float
    speed: float


class Transit:
    """Transit: wanted lengths and speed on the way to a target.

    Warp runs out no faster than lets the gear go through the water at the least speed, and the
    ship goes faster for it first. Warp comes in at the winches' speed.

    Parameters
    ----------
    settings
        Rates and the range of speeds.
    here
        State in which ship and winches are.
    """

    def __init__(self, settings: TrialSettings, here: TrialTarget) -> None:
        self.settings = settings
        self.wanted = Wanted(here.port, here.starboard, here.speed)
        self.target = here

    @property
    def arrived(self) -> bool:
        """True if what is wanted is the target."""
        wanted, target = self.wanted, self.target
        return (wanted.port, wanted.starboard, wanted.speed) == (
            target.port,
            target.starboard,
            target.speed,
        )

    def advance(self, dt: float, haul_share: float = 1.0) -> None:
        """Advance by ``dt`` seconds; ``haul_share`` of the winches' speed is used to haul."""
        settings, now, target = self.settings, self.wanted, self.target
        left = (target.port - now.port, target.starboard - now.starboard)
        speed = target.speed
        if max(left) > 0.0:
            veering = min(settings.least_speed + settings.winch_speed, settings.most_speed)
            speed = max(speed, veering)
        most = settings.ship_acceleration * dt
        faster = now.speed + min(max(speed - now.speed, -most), most)
        out = min(max(now.speed - settings.least_speed, LEAST_PAY_OUT), settings.winch_speed) * dt
        haul = settings.winch_speed * haul_share * dt
        self.wanted = Wanted(
            _towards(now.port, target.port, out, haul),
            _towards(now.starboard, target.starboard, out, haul),
            faster,
        )


def _towards(length: float, target: float, out: float, haul: float) -> float:
    return length + min(max(target - length, -haul), out)
