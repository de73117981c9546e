"""Which assumptions of theorem 5 held in a flight: each against its tolerance, over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.finding import Finding, over_time, untold
from hoverproof.audit.fitting import over
from hoverproof.audit.images import LOST, Images
from hoverproof.audit.log import FlightLog
from hoverproof.audit.vehicle import WINDOW, Vehicle
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]

THRUST_GAIN, TORQUE_GAIN, ROTOR_LAG = "thrust gain", "torque gain", "rotor lag"
EVERY_ROTOR, STEADY_WIND, GUSTS = "every rotor answers", "steady wind", "gusts"
OF_MOTION = THRUST_GAIN, TORQUE_GAIN, ROTOR_LAG, EVERY_ROTOR, STEADY_WIND, GUSTS
"""Findings that are told of how the motion changes from row to row."""
SURE = 3.0
"""So many standard deviations above a bound count as above it."""
TOLD = 0.1
"""A gain is told if its standard deviation is at most that, a share."""
ALIKE = 0.1
"""Shares of rotors that differ by more from the others' are no matter of mass or battery."""
AFTER = "a rotor does not answer as the others do"
GAIN_TOLD = 1e-3
"""What is less counts as no error of the thrust, a share: rows make as much."""
GUST_TOLD = 0.05
"""What is less counts as no gust, m/s²: the bias of a good accelerometer."""


def thrust(v: Vehicle) -> Finding:
    """Judge the gain of the thrust.

    Parameters
    ----------
    v : Vehicle
    """
    name, asked = THRUST_GAIN, v.mission.uncertainty
    if not v.log.has("specific_force", "thrust_command"):
        return untold(name, "needs specific force and thrust commands in N")
    whole, ratio, noise = v.thrust_gain
    gain = float(whole.value[0])
    by_wind = float(asked.wind + asked.gust) / float(v.mission.vehicle.gravity)
    words = (
        f"thrust over command: {gain:.4g} ± {whole.deviation[0]:.1g}, as with a mass of "
        f"{v.mass / gain:.4g} kg (a vertical wind would look the same)"
    )
    return over_time(
        name,
        "thrust",
        v.middle,
        abs(ratio - 1),
        float(asked.thrust),
        "1",
        deviation=float(whole.deviation[0]),
        words=words,
        allowed=by_wind + SURE * noise + GAIN_TOLD,
    )


def torque(v: Vehicle) -> Finding:
    """Judge the gain of the torques, or the bandwidth of the autopilot's rate loop.

    Parameters
    ----------
    v : Vehicle
    """
    name, bound = TORQUE_GAIN, float(v.mission.uncertainty.torque)
    loop = v.mission.interface.rate_bandwidth
    if loop is not None and v.log.has("rate", "rate_command"):
        fit = v.bandwidth
        off = abs(fit.value / float(loop) - 1)
        spread = fit.deviation / float(loop)
        worst = int(np.argmax(off))
        if not spread[worst] <= TOLD:
            return untold(name, "the rates commanded move too little to tell the bandwidth")
        roll, pitch = fit.value
        return Finding(
            name,
            "torque",
            bool(off[worst] <= bound + SURE * spread[worst]),
            float(off[worst]),
            bound,
            "1",
            float(spread[worst]),
            at=None if off[worst] <= bound + SURE * spread[worst] else float(v.log.times[0]),
            words=f"rate loop of {roll:.3g} and {pitch:.3g} rad/s, roll and pitch",
        )
    if not v.log.has("rate", "rotor_command"):
        return untold(name, "needs body rates and rotor commands in N")
    if rotors_alike(v).held is False:
        return untold(name, AFTER)
    fit = v.torque_gain
    if not fit.deviation.max() <= TOLD:
        return untold(name, "too little roll and pitch was commanded to tell it")
    times, off, spread = v.torque_gains
    sure = spread <= TOLD / SURE
    roll, pitch = fit.value
    spread_of = float(fit.deviation.max())
    return over_time(
        name,
        "torque",
        times[sure],
        off[sure],
        bound,
        "1",
        deviation=spread_of,
        words=f"torque over command: roll {roll:.4g}, pitch {pitch:.4g} (± {spread_of:.1g})",
        allowed=SURE * spread[sure],
    )


def rotor_lag(v: Vehicle) -> Finding:
    """Judge the lag of the rotors.

    Parameters
    ----------
    v : Vehicle
    """
    name, bound = ROTOR_LAG, float(v.mission.uncertainty.rotor_lag)
    if not v.log.has("rate", "rotor_command"):
        return untold(name, "needs body rates and rotor commands")
    if rotors_alike(v).held is False:
        return untold(name, AFTER)
    lag, spread = float(v.lag.value[0]), float(v.lag.deviation[0])
    resolution = float(np.median(np.diff(v.log.times)))
    if not spread <= max(resolution, 0.01):
        return untold(name, "too little roll and pitch was commanded to tell it")
    broken = lag > bound + SURE * spread + resolution / 4
    return Finding(
        name,
        "rotor_lag",
        not broken,
        lag,
        bound,
        "s",
        spread,
        at=float(v.log.times[0]) if broken else None,
        words=f"{lag:.4g} ± {spread:.1g} s, over all of the log",
    )


def rotors_alike(v: Vehicle) -> Finding:
    """Judge whether one rotor gives less, or more, than the others of what it is asked for.

    Parameters
    ----------
    v : Vehicle
    """
    name = EVERY_ROTOR
    if not v.log.has("rate", "rotor_command", "specific_force"):
        return untold(name, "needs body rates, specific force and rotor commands")
    if v.mixing.shape[1] != 4:
        return untold(name, "told of four rotors alone")
    times, shares = v.shares
    if not len(times):
        return untold(name, f"has too few rows in each {WINDOW:g} s to tell")
    off = shares / np.median(shares, axis=1, keepdims=True)
    worst = abs(off - 1).max(axis=1)
    found = over_time(name, "", times, worst, ALIKE, "1")
    at = int(np.nanargmax(worst))
    rotor = int(np.argmax(abs(off[at] - 1)))
    label = v.mission.vehicle.frame.names[rotor]
    words = f"rotor {label}: thrust over command {off[at, rotor]:.3g} times the median of all"
    return Finding(**{**vars(found), "words": words})


def wind(v: Vehicle) -> Iterator[Finding]:
    """Judge the steady wind and gusts.

    Parameters
    ----------
    v : Vehicle
    """
    asked = v.mission.uncertainty
    if not v.log.has("specific_force", "rotation"):
        yield untold(STEADY_WIND, "needs specific force and attitude")
        yield untold(GUSTS, "needs specific force and attitude")
        return
    fit, across, rest = v.wind
    spread = float(np.linalg.norm(fit.deviation))
    noise = SURE * v.wind_noise + GUST_TOLD
    size = float(np.linalg.norm(fit.value))
    steady = np.linalg.norm(over(v.log.times, across, 5 * WINDOW), axis=1)
    yield over_time(
        STEADY_WIND,
        "wind",
        v.log.times,
        steady,
        float(asked.wind),
        "m/s²",
        deviation=spread,
        allowed=noise,
        words=f"({fit.value[0]:.3g}, {fit.value[1]:.3g}) m/s² steadily, {size:.3g} ± "
        f"{spread:.1g}, level, world axes; the vertical part is not told",
    )
    gust = np.linalg.norm(rest, axis=1)
    yield over_time(
        GUSTS,
        "gust",
        v.log.times,
        gust,
        float(asked.gust),
        "m/s²",
        allowed=noise,
        words=f"the force across the thrust changes by {np.nanmax(gust):.3g} m/s² (with drag)",
    )


def yaw_rate(v: Vehicle) -> Finding:
    """Judge the rate about the vertical axis of the body.

    Parameters
    ----------
    v : Vehicle
    """
    rate = v.log.rate
    if rate is None or not v.log.has("rate"):
        return untold("yaw rate", "needs body rates")
    smooth = abs(over(v.log.times, rate[:, 2], WINDOW / 4))
    bound = float(v.mission.uncertainty.yaw_rate)
    words = f"at most {np.nanmax(smooth):.4g} rad/s"
    return over_time(
        "yaw rate", "yaw_rate", v.log.times, smooth, bound, "rad/s", words=words, allowed=1e-3
    )


def images(log: FlightLog, mission: Mission) -> Iterator[Finding]:
    """Judge latency, gaps between images, and whether the target was lost.

    Parameters
    ----------
    log : FlightLog
    mission : Mission
    """
    names, bound = ("latency", "frame gaps", "target seen"), float(mission.uncertainty.latency)
    seen = Images(log)
    if (log.image_age is None and log.frames is None) or len(seen.exposures[0]) < 3:
        yield from (untold(name, "the log has no time stamps of images") for name in names)
        return
    _, exposed = seen.exposures
    base, slack = max(seen.latency, 0.0), log_step(log)
    period = seen.period if seen.period > 1.5 * slack else 0.0  # else an image at every row
    if log.image_age is None and period > LOST / 2:
        why = f"the log has an image each {period:.3g} s: too few to tell"
        yield from (untold(name, why) for name in names)
        return
    if log.image_age is None:
        yield untold("latency", "the log has time stamps of images, not of their use")
    else:
        words = f"{base:.4g} ± {seen.jitter:.1g} s to use, {period:.4g} s to the next"
        late = base + seen.jitter + period > bound + slack
        old = log.image_age > bound + slack
        yield Finding(
            *("latency", "latency", not late, base + period, bound, "s", seen.jitter),
            float(log.times[old.argmax()]) if late and old.any() else None,
            *(words, log.times, log.image_age),
            needed=base + period + log_step(log),
        )
    short = [gap for gap in seen.gaps if gap[1] < LOST]
    worst = max(short, default=(0.0, period, 0), key=lambda gap: gap[1])
    left = max(bound - base, 1.5 * period)  # of the tolerance, for the time to the next image
    broken = [gap for gap in short if gap[1] > left + slack]
    words = f"{sum(gap[2] for gap in short)} images missed"
    if short:
        words += f", at most {worst[2]} at once: {worst[1]:.4g} s from {worst[0]:.4g} s on"
    yield Finding(
        *("frame gaps", "latency", not broken, worst[1], left, "s", seen.jitter),
        broken[0][0] + base + period if broken else None,
        *(words, exposed, np.r_[np.diff(exposed), np.nan]),
        needed=base + worst[1],
    )
    lost = [gap for gap in seen.gaps if gap[1] >= LOST]
    most = max((gap[1] for gap in lost), default=seen.period)
    words = f"without it for at most {most:.4g} s"
    words += f", from {lost[0][0]:.4g} s on" if lost else ""
    yield Finding(
        *("target seen", "", not lost, most, LOST, "s", seen.jitter),
        lost[0][0] + base + period if lost else None,
        words,
    )


def log_step(log: FlightLog) -> float:
    """Return the time from one sample to the next as a rule, s.

    Parameters
    ----------
    log : FlightLog
    """
    return float(np.median(np.diff(log.times)))


def rotor_limits(v: Vehicle) -> Finding:
    """Judge whether rotors were asked for what they can give, and no more.

    Parameters
    ----------
    v : Vehicle
    """
    name, command = "limits of the rotors", v.log.rotor_command
    if command is None or not v.log.has("rotor_command"):
        return untold(name, "needs rotor commands in N")
    each = v.mission.rotor_limits
    lows = np.array([-np.inf if low is None else float(low) for low, _ in each])
    highs = np.array([np.inf if high is None else float(high) for _, high in each])
    if not (np.isfinite(lows).any() or np.isfinite(highs).any()):
        return untold(name, "the mission gives no limits")
    use = np.fmax((command - highs), (lows - command)).max(axis=1)
    times, known = v.log.times, np.isfinite(use)
    at_limit = known & (use >= -1e-6 * np.abs(command).max(axis=1))
    share = float(at_limit.mean())
    words = f"at a limit in {100 * share:.3g} % of the time"
    first = float(times[at_limit.argmax()]) if at_limit.any() else None
    worst = float(np.nanmax(use))
    return Finding(
        name, "", first is None, worst, 0.0, "N", at=first, words=words, times=times, values=use
    )


JUDGES: tuple[Callable[[Vehicle], Finding], ...] = (
    thrust,
    torque,
    rotor_lag,
    rotors_alike,
    yaw_rate,
    rotor_limits,
)


def judged(log: FlightLog, mission: Mission) -> list[Finding]:
    """Return what is found of every assumption about vehicle, wind and images.

    Parameters
    ----------
    log : FlightLog
    mission : Mission
    """
    v = Vehicle(log, mission)
    if (apart := log_step(log)) > WINDOW:
        why = f"its rows are {apart:.3g} s apart; {WINDOW:g} s or less would tell it"
        found = [*(untold(name, why) for name in OF_MOTION), yaw_rate(v), rotor_limits(v)]
    else:
        found = [*(judge(v) for judge in JUDGES), *wind(v)]
    return [*found, *images(log, mission)]
