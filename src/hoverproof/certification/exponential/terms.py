"""The norm-bounded terms of the inequality of vehicles within tolerance, in floating point."""

from __future__ import annotations

from hoverproof.certification.exponential.limits import Limits


def terms(limits: Limits) -> list[tuple[str, str, float]]:
    """Return the norm-bounded terms that are there: what they push, by what, and the radius.

    What they push are names of `form.Push`, by which of `form.PARTS`. "yaw" is d4 without what
    is turned across P δ3; "flow" is 2 M τ̄ y, "level" its P y, "swept" 2 M τ̄ ζ and "aside" P s,
    where a late feature s is not turned.

    Parameters
    ----------
    limits : Limits
    """
    v, h = limits.vehicles, limits.quickness[1]
    late = limits.sunk * h + v.thrust * limits.crosswind / 2
    wobble, twisted, strayed = limits.misled
    if not v.rotor_lag:
        own = 1 + v.torque
        each = [
            ("d4", "applied", v.torque),
            ("d4", "zeta", late + v.yaw_rate * v.torque + own * wobble),
            ("d4", "ahead", v.yaw_rate if v.age or v.missed else 0.0),
            ("d4", "missed", v.torque * v.yaw_rate + own * twisted),
            ("d4", "pulled", own * strayed),
        ]
    else:
        own = (1 + v.torque) * v.gyroscopic + v.torque
        late += (1 + v.thrust) * 2 * limits.sinking + v.yaw_rate * own
        slow = v.rotor_lag * v.pull
        each = [
            ("d4", "applied", v.torque),
            ("d4", "zeta", late),
            ("yaw", "h3", v.yaw_rate),
            (
                "torque",
                "zeta",
                v.yaw_rate * v.gyroscopic + slow * h * limits.reach.force + wobble,
            ),
            ("torque", "missed", v.yaw_rate + twisted),
            ("torque", "pulled", slow * v.yaw_rate + strayed),
            ("lift", "zeta", v.rotor_lag * v.pace * h * limits.reach.d3),
            ("torque", "applied", v.rotor_lag * limits.stretching),
        ]
    if v.swept:
        each += [
            ("flow", "zeta", limits.sweep),
            ("level", "aside", v.yaw_rate),
            ("swept", "aside", limits.sweep * v.yaw_rate),
        ]
    return [term for term in each if term[2]]
