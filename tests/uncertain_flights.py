"""Flights of the bodies of `uncertain_body` against a claim: Ψ(t) <= Ψ(0) e^{-rt}.

Thrust, torque, yaw and delay are steady, switch at random, or are chosen at each step as what makes
Ψ fall least. The step is a whole part of the latency and at most 7.5 ms, a seventh of the fastest
time in the loop and a half of the shortest lag that is flown: a method of fourth order then errs by
1e-4 of what a step changes, and the claim has a hundred times that to spare.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import differential_evolution

from uncertain_body import (
    ANGULAR,
    ATTITUDE,
    LIFT,
    POSITION,
    THRUST,
    VELOCITY,
    Doubt,
    View,
    body_rate,
    dot,
    parts,
    quarter,
    quaternion_of,
    size,
    state_of,
    times,
)

LONGEST_STEP = 0.0075  # s
NOTED = 8  # steps between two looks at the bounds
OF_ROTORS = np.array([[-1, -1, -1], [-1, 1, 1], [1, -1, 1], [1, 1, -1]])
"""How each rotor's thrust grows with Γ1, Γ2 and Γ3: rear right, rear left, front right, left."""


def unit(a):
    return a / (size(a) + 1e-300)


def outer(a, b):
    return a[:, None] * b[None]


def directions(rng, count, n=3):
    return unit(rng.normal(size=(n, count)))


def any_matrix(rng, radius, count):
    """Return matrices (2, 2, N) of norm `radius`, of rank one or turns and mirrors."""
    a, b = directions(rng, count, 2), directions(rng, count, 2)
    second = rng.choice([-1.0, 0.0, 1.0], count) * outer(quarter(a), quarter(b))
    return radius * (outer(a, b) + second)


def inertia_and_rotors(case, rng, count):
    """Return γ and G_t of vehicles with other inertia and rotors, within the tolerance."""
    own, span = case.inertia[:, None], case.torque
    while True:
        more = 8 * count
        true = own * (1 + span * rng.uniform(-1, 1, (3, more)))
        gain = 1 + span * rng.uniform(-1, 1, (2, more))
        gamma = np.zeros((2, 2, more))
        gamma[0, 0], gamma[1, 1] = (gain * own[1::-1] / true[1::-1]) - 1
        turn = np.zeros((2, 2, more))
        turn[0, 1] = (true[2] - true[0]) / true[1]
        turn[1, 0] = (true[1] - true[2]) / true[0]
        left = turned_about(case, gamma) - turn
        good = (np.abs(gamma).max((0, 1)) <= span) & (np.abs(left).max((0, 1)) <= span)
        if good.sum() >= count:
            return gamma[..., good][..., :count], turn[..., good][..., :count]


def turned_about(case, gamma):
    """Return (I + γ) G_c, (2, 2, N)."""
    own = np.eye(2)[..., None] + gamma
    return np.einsum("ijn,jk->ikn", own, case.compensated)


class Nature:
    """What befalls N flights: drawn once, and anew or by choice at each step.

    Parameters
    ----------
    case : Case
    rng : Generator
    count : int
        N.
    step : float
        s.
    frames : int
        Steps in the latency.
    """

    def __init__(self, case, rng, count, step, frames):
        self.case, self.rng, self.count, self.step, self.frames = case, rng, count, step, frames
        draw = rng.random
        self.thrust, self.torque, self.yaw, self.delay = rng.integers(0, 5, (4, count))
        part = rng.random(count)
        share = np.where(part < 0.4, 1, np.where(part < 0.6, 0, (1 + draw(count)) / 2))
        self.slow = case.rotor_lag * share
        self.often = 1 / rng.uniform(0.03, 0.6, (4, count))  # switches a second
        self.pace, self.phase = rng.uniform(0.3, 10, count), 7 * draw(count)
        self.sign = rng.choice([-1.0, 1.0], count)
        self.period = rng.integers(2, max(frames, 3) + 1, count).clip(max=max(frames, 1))
        self.late = np.zeros(count, int)
        gust = case.wind * np.where(draw(count) < 0.8, 1, draw(count))
        way = directions(rng, count)
        plain = np.eye(3)[:, rng.integers(0, 3, count)] * rng.choice([-1, 1], count)
        self.doubt = Doubt(
            gain=1 + case.thrust * rng.uniform(-1, 1, count),
            torque=np.zeros((2, 2, count)),
            turn=np.zeros((2, 2, count)),
            yaw=np.zeros(count),
            wind=gust * np.where(draw(count) < 0.7, way, plain),
            lag=self.slow,
        )
        gamma, turn = inertia_and_rotors(case, rng, count)
        abstract = any_matrix(rng, case.torque, count)
        self.doubt.torque = np.where(self.torque < 2, gamma, abstract)
        self.doubt.turn = np.where(self.torque < 2, turn, self._turn(abstract))

    def _turn(self, gamma, way=None):
        """Return a G_t at the edge of what is covered, with γ."""
        case = self.case
        way = any_matrix(self.rng, 1, self.count) if way is None else way
        quick = turned_about(case, gamma) - case.torque * way
        return np.where(self.slow > 0, case.turn_radius * way, quick)

    def befall(self, time, view, ring):
        """Choose what is left open until the next step."""
        case, doubt, rng, k = self.case, self.doubt, self.rng, self.count
        d = view.errors()
        mu = np.where(self.slow > 0, view.lagging(d, (view.x[ANGULAR], view.x[LIFT])), 0)
        flips = rng.random((4, k)) < self.often * self.step
        self._delay(time, view, ring, Worst(case, view, d, mu, self.slow), flips[2])
        worst = Worst(case, view, d, mu, self.slow, self.used(view, 0))
        low, high = 1 - case.thrust, 1 + case.thrust
        gain = doubt.gain
        gain = np.where(self.thrust == 1, np.where(self.sign > 0, high, low), gain)
        start = (self.thrust == 2) & ((time == 0) | flips[0])
        gain = np.where(start, np.where(gain > 1, low, high), gain)
        doubt.gain = np.where(self.thrust > 2, np.where(worst.gain() > 0, high, low), gain)
        yaw = np.where(self.yaw == 1, case.yaw_rate * self.sign, doubt.yaw)
        yaw = np.where(self.yaw == 2, case.yaw_rate * np.sin(self.pace * time + self.phase), yaw)
        start = (self.yaw == 3) & ((time == 0) | flips[1])
        yaw = np.where(start, case.yaw_rate * np.where(yaw > 0, -1, 1), yaw)
        missed = view.feature(self.used(view, 0) - view.level_image)
        doubt.yaw = np.where(self.yaw == 4, case.yaw_rate * np.sign(worst.yaw(missed)), yaw)
        chosen, way = worst.torque(doubt.yaw)
        start, best = (self.torque == 3) & flips[3], self.torque == 4
        anew = np.where(best, case.torque * chosen, 0)
        if start.any():
            anew = np.where(start, any_matrix(rng, case.torque, k), anew)
            way = np.where(start, any_matrix(rng, 1, k), way)
        doubt.torque = np.where(start | best, anew, doubt.torque)
        doubt.turn = np.where(start | best, self._turn(anew, way), doubt.turn)

    def _delay(self, time, view, ring, worst, flips):
        k = self.frames
        tick = round(time / self.step)
        late = np.where(self.delay == 1, k, 0)
        late = np.where(self.delay == 2, k - self.period + tick % self.period, late)
        flips = flips | (time == 0)
        swing = np.where(flips, np.where(self.late > 0, 0, k), self.late)
        late = np.where(self.delay == 3, swing, late)
        if k and (self.delay == 4).any():
            tried = [0, k // 2, k]
            kept = (ring.level(np.full(self.count, j)) for j in tried)
            value = np.stack([worst.delay(view.as_level(each)) for each in kept])
            late = np.where(self.delay == 4, np.array(tried)[value.argmax(0)], late)
        self.late = late
        earlier = np.maximum(late - 1, 0)
        self.first, self.second = ring.level(late), ring.level(earlier)
        bend = self.step / 8 * (ring.flow(earlier) - ring.flow(late))
        self.middle = (self.first + self.second) / 2 + bend

    def used(self, view, part):
        """Return the level image that is used a part (0, 1/2, 1) into a step, seen now from there.

        A frame is held through a step; any other delay keeps its length, or there is none.
        """
        held = self.delay == 2
        aged = {0: self.first, 0.5: self.middle, 1: self.second}[part]
        late = view.as_level(np.where(held, self.first, aged))
        return np.where((self.late == 0) & ~held, view.level_image, late)


@dataclass
class Worst:
    """What makes Ψ fall least at a state."""

    case: object
    view: View
    d: np.ndarray
    mu: np.ndarray
    slow: np.ndarray
    level: np.ndarray | None = None

    def __post_init__(self):
        case, d, view = self.case, self.d, self.view
        self.d3, self.d4 = parts(d)[2:]
        self.zeta = self.d4 - self.d3[:2]
        self.u4 = case.w[3] * self.d4 + self.slow * case.K4 * case.a5 * self.mu[:2]
        held, lift = view.x[ANGULAR], view.x[LIFT]
        if self.level is not None and (self.slow == 0).any():
            now, asked = view.commanded(self.level)
            held, lift = np.where(self.slow > 0, held, asked), np.where(self.slow > 0, lift, now)
        self.s, self.u = view.D / (case.c * case.kappa) * held, lift / case.c

    def gain(self):
        case = self.case
        lever = case.c * self.u / self.view.D
        pull = case.a5 * self.slow * dot(self.mu[:2], self.s) + dot(self.u4, self.zeta)
        lift = case.w[2] * self.d3[2] - self.slow * case.kappa * case.a6 * self.mu[2]
        return lever * pull - lift * self.u

    def delay(self, level):
        case, n = self.case, self.view.feature(level - self.view.level_image)
        mine = self.slow > 0
        sideways = np.where(mine, case.a5 * self.mu[:2], case.w[3] * self.d4)
        lift = np.where(mine, -case.a6 * self.mu[2], case.w[2] * self.d3[2])
        return case.K4 * dot(sideways, n[:2]) + case.kappa * lift * n[2]

    def yaw(self, n):
        case, mu = self.case, self.mu[:2]
        aside = quarter(self.d3[:2])
        own = -dot(self.u4, aside) + dot(case.a5 * mu, aside - quarter(n[:2]))
        quick = -case.w[3] * dot(self.d4, quarter(n[:2]))
        return np.where(self.slow > 0, own, quick)

    def torque(self, yaw):
        """Return γ and the G_t (or -G) that are worst, of norm 1."""
        u = unit(self.u4)
        return outer(u, unit(self.s)), -np.sign(yaw) * outer(u, unit(self.zeta))


class Ring:
    """The last level images, their flow y and |y|², newest first, for delays and memory."""

    def __init__(self, case, view, step, frames):
        past = -step * np.arange(frames + 1)[:, None, None]
        position = view.x[POSITION] + past * view.x[VELOCITY]
        both = [case.image(p, view.x[VELOCITY]) for p in position]
        self.levels, self.flows = (np.stack(v) for v in zip(*both, strict=True))
        if case.late_axes:  # of a vehicle that has not turned
            self.levels = np.stack([view.feature(x) for x in self.levels])
            self.flows = np.broadcast_to(view.kept_flow(), self.levels.shape).copy()
        self.squares = (self.flows**2).sum(1)
        self.at, self.length = 0, frames + 1
        u = step * np.arange(frames + 1)
        simpson = np.ones(frames + 1) * step / 3 * (frames > 0)
        simpson[1:-1:2], simpson[2:-1:2] = 4 * step / 3, 2 * step / 3
        self.weights = case.M * simpson * (case.latency - u) * np.exp(-case.r * u)
        self.each = np.arange(position.shape[2])

    def _get(self, values, late):
        return values[(self.at + late) % self.length, :, self.each].T

    def level(self, late):
        return self._get(self.levels, late)

    def flow(self, late):
        return self._get(self.flows, late)

    def push(self, view):
        self.at = (self.at - 1) % self.length
        self.levels[self.at], self.flows[self.at] = view.kept(), view.kept_flow()
        self.squares[self.at] = dot(self.flows[self.at], self.flows[self.at])

    def memory(self):
        """Return M ∫ (τ̄ - u) e^{-ru} |y(t - u)|² du, by Simpson's rule."""
        return np.roll(self.weights, self.at) @ self.squares


def moved(view, nature, step):
    """Return the states a step later: Runge and Kutta's method, all delays as they are."""

    def rate(at, part):
        return body_rate(at, nature.used(at, part))

    x, case, doubt = view.x, view.case, view.doubt
    a = rate(view, 0)
    b = rate(View(case, x + step / 2 * a, doubt), 0.5)
    c = rate(View(case, x + step / 2 * b, doubt), 0.5)
    d = rate(View(case, x + step * c, doubt), 1)
    return x + step / 6 * (a + 2 * b + 2 * c + d)


# --- starts -------------------------------------------------------------------------------------


def hovers(case, rng, doubt, position):
    """Return states at rest without force, any heading, rotors steady, at positions (3, N)."""
    count = position.shape[1]
    x = np.zeros((16, count))
    down = case.g * np.array([[0], [0], [1.0]]) + doubt.wind  # what the thrust holds against
    x[THRUST], x[POSITION] = case.m * size(down), position
    # Rᵀ down = |down| e3: the attitude whose inverse turns e3 onto it
    tilt = quaternion_of(unit(down), np.zeros(count)) * np.array([[1], [-1], [-1], [-1.0]])
    a, b = (f(rng.uniform(0, np.pi, count)) for f in (np.cos, np.sin))
    a, b = a / np.hypot(a, b), b / np.hypot(a, b)
    w, p, q, r = tilt
    x[ATTITUDE] = np.stack([w * a - r * b, p * a + q * b, q * a - p * b, w * b + r * a])
    return x


def anywhere(case, rng, doubt):
    """Return states of the level set {Ψ <= ℓ}, NaN where a draw was outside of it.

    What the rotors have of U is what a lag may have of bounded commands.
    """
    count = len(doubt.gain)
    reach = case.offset / (2 * case.pace - case.slope)  # |σ - σ*| >= (j - ϱ) |ξ - ξ*|
    position = case.goal[:, None] + reach * directions(rng, count) * rng.random(count) ** (1 / 3)
    home = case.image(case.goal[:, None], np.zeros((3, 1)))[0]
    off = case.image(position, 0 * position)[0] - home
    room = case.level - dot(off, off) / 2
    room = np.where(room > 0, room, np.nan) * rng.random(count) ** 0.3
    raw = unit(rng.normal(size=(11, count)) * rng.normal(size=(11, count)) ** 2)
    weights = np.repeat(case.w[1:], [3, 3, 2])[:, None]
    d = raw[:8] * np.sqrt(2 * room / weights)
    lag = np.stack([case.a5 * doubt.lag, case.a5 * doubt.lag, case.a6 * doubt.lag])
    mu = raw[8:] * np.sqrt(2 * room / np.where(lag > 0, lag, np.inf))
    wind = directions(rng, count) * case.wind
    with np.errstate(invalid="ignore"):
        x = state_of(case, position, d, mu, wind, 7 * rng.random(count), doubt)
        most = case.bounds()["u"] * case.c
        x[LIFT] = np.clip(x[LIFT], -most, most)
    return x


# --- flights ------------------------------------------------------------------------------------


@dataclass
class Flown:
    """What flights came to; (N,) each.

    Attributes
    ----------
    ratio : largest Ψ(t) e^{rt}/Ψ(0) of the ends of steps.
    fall : slowest fall of Ψ in a step, 1/s: ln(Ψ(t)/Ψ(t + h))/h.
    level : Ψ(0)/ℓ.
    settled : since when the vehicle is within `radius` of the goal, s; inf if not at the end.
    offset : largest |σ - σ*|.
    cosine : of the largest angle of a point from the optical axis.
    pace : the slowest fall of Ψ over the whole flight, 1/s: ln(Ψ(0)/Ψ(T))/T.
    used : largest size of each bounded quantity over its bound, over all flights.
    thrust : the least and the largest thrust that a rotor makes or is set to, N, over all flights.
    """

    ratio: np.ndarray
    fall: np.ndarray
    level: np.ndarray
    settled: np.ndarray
    offset: np.ndarray
    cosine: np.ndarray
    pace: np.ndarray
    used: dict
    thrust: list

    def contradicts(self, case, duration=None):
        """Say what of a claim flights contradict, each with how many; nothing if they do not.

        Flights that are as long as the settling time are to have settled by then.
        """
        radius, soon = case.settling()
        told = {
            "start above the level": self.level > 1,
            f"do not keep Ψ(t) <= Ψ(0) exp(-{case.r:.4g} t)": ~(self.ratio <= 1),
            f"have a step in which Ψ falls more slowly than {case.r:.4g} 1/s": ~(
                self.fall >= case.r
            ),
            "leave the domain": ~(self.offset <= case.offset),
        }
        if case.cosine is not None:
            told["see a point outside of the proved cone"] = ~(self.cosine >= case.cosine)
        if duration is not None and duration >= soon:
            told[f"are not within {radius:.3g} m after {soon:.4g} s"] = ~(self.settled <= soon)
        said = [f"{int(wrong.sum())} {what}" for what, wrong in told.items() if wrong.any()]
        said += [f"{name} is {x:.4f} of its bound" for name, x in self.used.items() if not x <= 1]
        if case.rotors is not None:
            (low, high), (least, most) = case.rotors, self.thrust
            if not low <= least <= most <= high:
                said.append(f"rotors make {least:.4f} to {most:.4f} N")
        return said


def fly(case, rng, count, duration, radius, *, start=None):
    """Fly N vehicles from hovers at `start`, (3,), or else from all over the set {Ψ <= ℓ}."""
    frames = 2 * round(case.latency / LONGEST_STEP / 2 + 0.5) if case.latency else 0
    step = case.latency / frames if frames else LONGEST_STEP
    nature = Nature(case, rng, count, step, frames)
    if start is None:
        x = anywhere(case, rng, nature.doubt)
    else:
        x = hovers(case, rng, nature.doubt, np.tile(np.reshape(start, (3, 1)), count))
    ring = Ring(case, View(case, x, nature.doubt), step, frames)
    psi = View(case, x, nature.doubt).energy() + ring.memory()
    inside = np.isfinite(psi) & (psi <= case.level)
    x, ring, nature = _kept(x, inside, case, nature, step, frames)
    view, first = View(case, x, nature.doubt), psi[inside]
    before, home = first, case.image(case.goal[:, None], np.zeros((3, 1)))[0]
    n = int(inside.sum())
    made = Flown(
        ratio=np.zeros(n),
        fall=np.full(n, np.inf),
        level=first / case.level,
        settled=np.zeros(n),
        offset=np.zeros(n),
        cosine=np.ones(n),
        pace=np.zeros(n),
        used={},
        thrust=[np.inf, -np.inf],
    )
    for tick in range(1, round(duration / step) + 1):
        nature.befall((tick - 1) * step, view, ring)
        view.Omega[2] = nature.doubt.yaw
        if tick % NOTED == 1:
            _bounded(case, view, nature, ring, made.used)
            least, most = _rotors(case, view, nature)
            made.thrust = [min(made.thrust[0], least), max(made.thrust[1], most)]
        view = View(case, moved(view, nature, step), nature.doubt)
        ring.push(view)
        psi = view.energy() + ring.memory()
        there = before > 1e-9 * first  # below that rounding is seen
        fall = np.log(before / psi) / step
        made.fall = np.minimum(made.fall, np.where(there, fall, np.inf))
        grown = psi / first * np.exp(case.r * tick * step)
        made.ratio = np.maximum(made.ratio, np.where(there, grown, 0))
        far = size(view.x[POSITION] - case.goal[:, None]) > radius
        made.settled = np.where(far | ~np.isfinite(psi), tick * step, made.settled)
        made.offset = np.maximum(made.offset, size(view.level_image - home))
        made.cosine = np.minimum(made.cosine, _seen(case, view))
        before = psi
    made.pace = np.log(first / psi) / duration
    made.settled = np.where(far | ~np.isfinite(psi), np.inf, made.settled)
    return made


def _kept(x, inside, case, nature, step, frames):
    """Return states, ring and nature of those flights that start inside."""
    for record in (nature, nature.doubt):
        for name, value in vars(record).items():
            if isinstance(value, np.ndarray) and value.shape[-1:] == inside.shape:
                setattr(record, name, value[..., inside])
    nature.count = int(inside.sum())
    x = x[:, inside]
    return x, Ring(case, View(case, x, nature.doubt), step, frames), nature


def _seen(case, view):
    axis = view.R[:, 2]
    rays = case.points.T[:, :, None] - view.x[POSITION][:, None]
    return (np.einsum("kn,kpn->pn", axis, rays) / np.sqrt((rays**2).sum(0))).min(0)


def _rotors(case, view, nature):
    """Return the least and the largest thrust of a rotor, N: what it makes, and is set to make.

    Mass, inertia, arm and drag ratio are the mission's, and what is in doubt is in the rotors. What
    a lag has them make comes to what they are set to, if that stays. Γ3 is made like the others.
    """
    doubt, (_, torque) = nature.doubt, view.asked(nature.used(view, 0))
    first, second, _ = case.inertia
    slow, angular = nature.slow > 0, np.stack([-torque[1] / second, torque[0] / first])
    had = np.where(slow, view.x[ANGULAR], angular)
    ahead = np.where(slow, nature.slow * doubt.gain * view.x[LIFT], 0)
    ends = [np.inf, -np.inf]
    for thrust, turning in ((view.x[THRUST], had), (view.x[THRUST] + ahead, angular)):
        turning = turning + times(doubt.torque, turning)
        sideways = np.stack([first * turning[1], -second * turning[0]]) / case.arm
        for gain in (1 - case.torque, 1 + case.torque):
            each = np.stack([*sideways, gain * torque[2] / case.drag_ratio])
            rotors = (thrust + OF_ROTORS @ each) / 4
            ends = [min(ends[0], float(rotors.min())), max(ends[1], float(rotors.max()))]
    return ends


def _bounded(case, view, nature, ring, used):
    """Note how much of each bound is used."""
    bounds, d = case.bounds(), view.errors()
    d1, d2, d3, d4 = parts(d)
    n = view.feature(nature.used(view, 0) - view.level_image)
    h = case.c * case.kappa / view.D
    p1, p2 = h * d3[2], h * n[2]
    wind = case.m * view.wind
    p3 = (view.Omega[0] * wind[1] - view.Omega[1] * wind[0]) / view.D
    lift = np.where(nature.slow > 0, view.x[LIFT] / case.c, case.kappa * (d3[2] - n[2]))
    values = {
        "β1": (size(d1), bounds["b1"]),
        "β3": (size(d3), bounds["b3"]),
        "β32": (size(d3 - d2), bounds["b32"]),
        "βζ": (size(d4 - d3[:2]), bounds["bz"]),
        "v": (size(view.V), bounds["v"]),
        "n": (size(n), bounds["n"]),
        "h": (h, bounds["h"]),
        "1/h": (1 / h, 1 / bounds["h_low"]),
        "π": (np.abs(2 * (p1 - p2) + p3), bounds["pi"]),
        "q": (np.abs(nature.doubt.gain * case.c * lift / view.D + p3), bounds["q"]),
        "χ": (np.abs(wind[2] / view.D), bounds["chi"]),
    }
    for name, (value, bound) in values.items():
        most = float(value.max()) / bound if bound else 0.0
        used[name] = max(used.get(name, 0.0), most)


# --- the inequality, attacked by itself ---------------------------------------------------------

NUMBERS = 24


def excess(case, numbers):
    """Return (Ψ' + rΨ)/Ψ at states of the level set, and what they are; not above 0 if it holds.

    Thrust and torque are those that make Ψ fall least. The history is the one that has its n at
    least cost: y grows with e^{ru} into the past.

    Parameters
    ----------
    numbers : (NUMBERS, N)
        In [-1, 1]: position, errors δ2, δ3, δ4, μ and μT, n, wind, heading, level, lag, Ω3.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        return _excess(case, numbers)


def _excess(case, numbers):
    place, raw, n, wind, (heading, share, lag, yaw) = np.split(numbers, [3, 14, 17, 20])
    count, r = numbers.shape[1], case.r
    late, growth = case.latency, np.expm1(r * case.latency)
    tau = case.rotor_lag * np.clip(2 * np.abs(lag) - 0.5, 0, 1)
    doubt = Doubt(np.ones(count), *np.zeros((2, 2, 2, count)), case.yaw_rate * yaw, wind, tau)
    reach = case.offset / (2 * case.pace - case.slope)
    position = case.goal[:, None] + reach * place
    home = case.image(case.goal[:, None], np.zeros((3, 1)))[0]
    off = case.image(position, 0 * position)[0] - home
    whole = np.concatenate([raw, n])
    memory = case.M * (growth - r * late) / growth**2 if late else 1e300
    weights = np.concatenate(
        [
            np.broadcast_to(np.repeat(case.w[1:], [3, 3, 2])[:, None], (8, count)),
            [case.a5 * tau, case.a5 * tau, case.a6 * tau],
            np.full((3, count), 2 * memory),
        ]
    )
    first = dot(off, off) / 2
    room = np.where(first < case.level, case.level - first, np.nan) * np.abs(share)
    whole = unit(whole) * np.sqrt(2 * room / np.where(weights > 0, weights, np.inf))
    d, mu, n = np.split(whole, [8, 11])
    n = n * np.minimum(1, case.bounds()["n"] / (size(n) + 1e-300))
    gust = case.wind * wind / np.maximum(size(wind), 1)
    x = state_of(case, position, d, mu, gust, np.pi * heading, doubt)
    most = case.bounds()["u"] * case.c
    x[LIFT] = np.clip(x[LIFT], -most, most)
    view = View(case, x, doubt)
    level = view.level_image + times(view.R, n)
    e = view.errors()
    worst = Worst(
        case, view, e, np.where(tau > 0, view.lagging(e, (x[ANGULAR], x[LIFT])), 0), tau, level
    )
    nature = _Still(case, count, tau)
    chosen, way = worst.torque(doubt.yaw)
    doubt.torque = case.torque * chosen
    doubt.turn = Nature._turn(nature, doubt.torque, way)
    doubt.gain = 1 + case.thrust * np.where(worst.gain() > 0, 1, -1)
    rate = _energy_rate(view, level)
    cost = case.M * (late * dot(view.kept_flow(), view.kept_flow())) if late else 0
    cost = cost - (case.M * r / growth * dot(n, n) if late else 0)
    energy = view.energy()
    psi = energy + (memory * dot(n, n) if late else 0)
    value = (rate + cost + r * energy) / psi
    return np.where(np.isfinite(value) & (psi <= case.level * (1 + 1e-9)), value, -1e3), view


@dataclass
class _Still:
    case: object
    count: int
    slow: np.ndarray


def _energy_rate(view, level, tiny=1e-30):
    """Return E' along the motion, by a complex step."""
    ahead = view.x + 1j * tiny * body_rate(view, level)
    return View(view.case, ahead, view.doubt).energy().imag / tiny


def strongest(case, seed, generations=100, near=1.0):
    """Return the largest (Ψ' + rΨ)/Ψ that differential evolution finds, and where.

    Positions are those of the set, or of a small part of it about the goal.
    """
    found = differential_evolution(
        lambda numbers: -excess(case, numbers)[0],
        [(-near, near)] * 3 + [(-1, 1)] * (NUMBERS - 3),
        seed=seed,
        vectorized=True,
        updating="deferred",
        polish=False,
        maxiter=generations,
        popsize=12,
        tol=0,
        mutation=(0.4, 0.9),
        recombination=0.8,
    )
    return -found.fun, found.x
