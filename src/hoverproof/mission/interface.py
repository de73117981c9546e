"""What the law hands its commands to: the motors, or an autopilot's own rate loop."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from hoverproof.mission.fields import Section, quantity, reject
from hoverproof.mission.uncertainty import Uncertainty


class Interface(Section):
    """An autopilot that takes body rates and thrust in place of torques.

    It is flown by exported firmware; a proof is about it by the tolerance `uncertainty.torque`,
    which then is that of the bandwidth: 0.2 is a loop within 20 % of it.

    Attributes
    ----------
    rate_bandwidth : rad/s
        ω_r of a rate loop that answers as Ω' = ω (Ω_c - Ω): 1 over the time after which a step of
        the command is followed by 63 %. The law then commands Ω_c = Ω + Ω'/ω_r, Ω' the angular
        acceleration it wants.
    """

    rate_bandwidth: Annotated[Fraction, quantity("rad/s", "0", "1e4", open_low=True)] | None = None

    def check_covered(self, asked: Uncertainty) -> None:
        """Refuse tolerances that no theorem has for a rate loop.

        Parameters
        ----------
        asked : Uncertainty
        """
        if self.rate_bandwidth is not None and asked.control_period:
            raise reject(
                "is proved for torques that are held from run to run, and a rate loop holds body "
                "rates: leave it out with interface.rate_bandwidth",
                key="uncertainty.control_period",
            )
