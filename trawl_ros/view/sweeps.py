"""Sweeps of the trawl sonar, of which image and scan come as messages of their own."""

from trawl_ros.core.errors import MessageError
from trawl_ros.records.samples import SonarImageSample, SonarScanSample
from trawl_ros.view.records import Sweep


class SweepJoiner:
    """Joiner of an image and the scan of the same stamp, whichever comes first."""

    def __init__(self) -> None:
        self._half: SonarImageSample | SonarScanSample | None = None

    def take(self, half: SonarImageSample | SonarScanSample) -> Sweep | None:
        """Return the sweep that a half completes, None if the other is to come.

        Raises
        ------
        MessageError
            If they have different numbers of beams.
        """
        other, self._half = self._half, half
        if other is None or other.stamp != half.stamp:
            return None
        for image, scan in ((half, other), (other, half)):
            if isinstance(image, SonarImageSample) and isinstance(scan, SonarScanSample):
                if len(scan.ranges) != len(image.image):
                    raise MessageError(
                        f'sonar/image: {len(image.image)} beams, and sonar/scan of the same stamp '
                        f'has {len(scan.ranges)}; expected as many'
                    )
                return Sweep(image.stamp, image, scan)
        return None
