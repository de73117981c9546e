"""What a log tells of the vehicle: gains of thrust and torque, each rotor's share, lag, wind."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from hoverproof.audit.fitting import Fit, followed, least_squares, noise_over, over
from hoverproof.audit.log import FlightLog
from hoverproof.mission.sections import Mission
from hoverproof.plant.rotors import wrench

Array = NDArray[np.float64]

WINDOW = 0.2
"""Gains are told anew over so long a time, s."""
MOST_LAG = 0.5


@dataclass(frozen=True, eq=False)
class Vehicle:
    """The vehicle of a log, by what it was asked for and what it felt.

    Attributes
    ----------
    log : FlightLog
    mission : Mission
        Whose mass, moments and rotors the controller has.
    """

    log: FlightLog
    mission: Mission

    @property
    def mass(self) -> float:
        """Of the mission, kg."""
        return float(self.mission.vehicle.mass)

    @cached_property
    def inertia(self) -> Array:
        """Of the mission, (3, 3), kg m²."""
        i = [float(m) for m in self.mission.vehicle.moments]
        products = i[3:] or [0.0, 0.0, 0.0]
        matrix = np.diag(i[:3])
        for (a, b), value in zip(((0, 1), (0, 2), (1, 2)), products, strict=True):
            matrix[a, b] = matrix[b, a] = value
        return matrix

    @cached_property
    def mixing(self) -> Array:
        """Thrust and torques of thrusts of the rotors, (4, r), N and N m of N."""
        vehicle = self.mission.vehicle
        each = ca.SX.sym("each", len(vehicle.frame.names))
        lengths = ca.SX(float(vehicle.reach)), ca.SX(float(vehicle.drag_ratio))
        made = wrench(vehicle.frame, each, *lengths)
        return np.asarray(ca.DM(ca.evalf(ca.jacobian(made, each))).full())

    @cached_property
    def middle(self) -> Array:
        """Middles of the steps between samples, (n - 1,), s."""
        return (self.log.times[1:] + self.log.times[:-1]) / 2

    @cached_property
    def torque(self) -> Array:
        """That acted over each step, of the mission's moments, (n - 1, 3), N m."""
        rate = self.log.rate
        assert rate is not None
        turning = (rate[1:] + rate[:-1]) / 2
        change = np.diff(rate, axis=0) / np.diff(self.log.times)[:, None]
        return np.asarray(change @ self.inertia + np.cross(turning, turning @ self.inertia))

    @cached_property
    def acceleration(self) -> Array:
        """Of roll and pitch, without the gyroscopic part, (n - 1, 2), rad/s²."""
        return np.asarray(np.linalg.solve(self.inertia, self.torque.T).T[:, :2])

    def held(self, commands: Array) -> Array:
        """Return commands so that a row has what was asked for since the row before, (n, k).

        Parameters
        ----------
        commands : (n, k)
            As in the log, any unit.
        """
        if self.log.ahead:
            return commands
        before = np.concatenate([commands[:1], commands[:-1]])
        return (commands + before) / 2 if self.log.continuous else before

    def asked(self, lag: float) -> Array:
        """Return what was asked for with a lag, (n - 1, 2), rad/s².

        Parameters
        ----------
        lag : float
            s.
        """
        command = self.log.rotor_command
        assert command is not None
        torque = followed(self.log.times, self.held(command), lag) @ self.mixing[1:].T
        return np.asarray(np.linalg.solve(self.inertia, torque.T).T[:, :2])

    @cached_property
    def felt(self) -> Array:
        """Thrust over each step of the mission's mass, wind in it, (n - 1,), N."""
        force = self.log.specific_force
        assert force is not None
        return np.asarray(-self.mass * (force[1:, 2] + force[:-1, 2]) / 2)

    @cached_property
    def lag(self) -> Fit:
        """Time constant of the rotors, s, by what turns the vehicle."""

        def left(lag: float) -> float:
            return sum(fit.residual**2 for fit in self._gains(self.asked(lag)))

        grid = np.linspace(0, MOST_LAG, 51)
        costs = [left(x) for x in grid]
        best = int(np.argmin(costs))
        ends = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
        found = float(minimize_scalar(left, bounds=ends, options={"xatol": 1e-5}).x)
        small = 1e-3
        slope = (self.asked(found + small) - self.asked(max(found - small, 0))) / (
            small + min(small, found)
        )
        kept = self._known
        gain = self._gains(self.asked(found))
        matrix = np.concatenate([slope[kept, i] for i in range(2)])[:, None]
        noise = np.sqrt(sum(fit.residual**2 for fit in gain) / 2)
        size = float(np.linalg.norm(matrix))
        return Fit(np.array([found]), np.array([noise / size if size else np.inf]), float(noise))

    @cached_property
    def _known(self) -> NDArray[np.bool_]:
        both = np.column_stack([self.acceleration, self.asked(0)])
        return np.asarray(np.isfinite(both).all(axis=1))

    def _gains(self, asked: Array, part: slice = slice(None)) -> list[Fit]:
        """Return the fits of roll and pitch: the gain of what was asked, and a constant."""
        known = self._known[part]
        asked = asked[part][known]
        ones = np.ones(len(asked))
        made = self.acceleration[part][known]
        return [least_squares(np.column_stack([asked[:, i], ones]), made[:, i]) for i in range(2)]

    @cached_property
    def torque_gain(self) -> Fit:
        """Gains of the torques of roll and pitch, (2,), shares."""
        roll, pitch = self._gains(self.asked(float(self.lag.value[0])))
        return Fit(
            np.array([roll.value[0], pitch.value[0]]),
            np.array([roll.deviation[0], pitch.deviation[0]]),
            float(np.hypot(roll.residual, pitch.residual)),
        )

    def windows(self, length: float) -> Iterator[tuple[float, slice]]:
        """Yield middles, s, and places of windows of time.

        Parameters
        ----------
        length : float
            s.
        """
        times = self.middle
        for begin in np.arange(times[0], max(times[-1] - length, times[0]) + 1e-9, length / 4):
            part = slice(*np.searchsorted(times, [begin, begin + length]))
            if part.stop - part.start >= 6:
                yield begin + length / 2, part

    @cached_property
    def torque_gains(self) -> tuple[Array, Array, Array]:
        """How far the gain of an axis is from 1 over time: times, s, shares, deviations."""
        asked, rows = self.asked(float(self.lag.value[0])), []
        for middle, part in self.windows(2 * WINDOW):
            fits = self._gains(asked, part)
            off = [abs(f.value[0] - 1) for f in fits]
            axis = int(np.argmax([o - 3 * f.deviation[0] for o, f in zip(off, fits, strict=True)]))
            rows.append((middle, off[axis], fits[axis].deviation[0]))
        table = np.array(rows).reshape(-1, 3)
        return table[:, 0], table[:, 1], table[:, 2]

    @cached_property
    def thrust_gain(self) -> tuple[Fit, Array, float]:
        """Thrust felt over thrust asked for: over all; over time, (n - 1,), and its noise."""
        command = self.log.thrust_command
        assert command is not None
        lag = float(self.lag.value[0]) if self.log.rotor_command is not None else 0.0
        asked = followed(self.log.times, self.held(command[:, None]), lag)[:, 0]
        known = np.isfinite(asked) & np.isfinite(self.felt)
        whole = least_squares(asked[known, None], self.felt[known])
        ratio = self.felt / asked
        noise = noise_over(self.middle, ratio, WINDOW)
        return whole, over(self.middle, ratio, WINDOW), noise

    @cached_property
    def shares(self) -> tuple[Array, Array]:
        """Each rotor's thrust over what it was asked for: times, s, and shares, (w, 4).

        Of the mission's mass and moments: an error of these is common to all rotors at hover.
        """
        command = self.log.rotor_command
        assert command is not None
        made = followed(self.log.times, self.held(command), float(self.lag.value[0]))
        acted = np.column_stack([self.felt, self.torque])
        weights = 1 / np.r_[1.0, np.abs(self.mixing[1:]).max(axis=1)]
        times, found = [], []
        for middle, part in self.windows(WINDOW):
            rows = (weights[:, None] * self.mixing)[None] * made[part][:, None, :]
            fit = least_squares(rows.reshape(-1, 4), (acted[part] * weights).ravel())
            times.append(middle)
            found.append(fit.value)
        return np.array(times), np.array(found).reshape(-1, 4)

    @cached_property
    def wind(self) -> tuple[Fit, Array, Array]:
        """Steady wind across the world's vertical, its force over the mass, m/s²; the rest.

        The thrust is along the axis of the body, so what is felt across it is wind, or drag. The
        part along it is not told from the gain of the thrust. Returns the fit (2,), and what is
        felt across and what of it is not steady, means over time, (n, 2), m/s², body axes.
        """
        force, turned = self.log.specific_force, self.log.rotation
        assert force is not None and turned is not None
        across = force[:, :2]
        known = np.isfinite(across).all(axis=1) & np.isfinite(turned).all(axis=(1, 2))
        rows = turned.transpose(0, 2, 1)[:, :2, :2]
        fit = least_squares(rows[known].reshape(-1, 2), across[known].ravel())
        steady = np.einsum("nij,j->ni", rows, fit.value)
        smooth = over(self.log.times, across, WINDOW)
        return fit, smooth, over(self.log.times, across - steady, WINDOW)

    @property
    def wind_noise(self) -> float:
        """One standard deviation of what is felt across the thrust over a window, m/s²."""
        assert self.log.specific_force is not None
        felt = self.log.specific_force
        each = [noise_over(self.log.times, felt[:, i], WINDOW) for i in range(2)]
        return math.hypot(*each)

    @cached_property
    def bandwidth(self) -> Fit:
        """Of the autopilot's rate loop, of roll and pitch, (2,), rad/s: Ω' = ω (Ω_c - Ω)."""
        rate, command = self.log.rate, self.log.rate_command
        assert rate is not None and command is not None
        slope = np.diff(rate, axis=0) / np.diff(self.log.times)[:, None]
        behind = self.held(command)[1:] - (rate[1:] + rate[:-1]) / 2
        fits = []
        for i in range(2):
            known = np.isfinite(slope[:, i]) & np.isfinite(behind[:, i])
            fits.append(least_squares(behind[known, i : i + 1], slope[known, i]))
        return Fit(
            np.array([f.value[0] for f in fits]),
            np.array([f.deviation[0] for f in fits]),
            math.hypot(*(f.residual for f in fits)),
        )
