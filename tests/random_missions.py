"""Random mission files: plausible, absurd and broken, each made again by its number.

For the file of mission 51: ``python tests/random_missions.py 51``.
"""

from __future__ import annotations

import copy
import math
import random
import string
import sys
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np

Content = dict[str, Any]

KINDS = ("plausible", "absurd", "broken")
DESIGNS = (  # mass, height, gravity; k1, k2, k3, k4: the presets, to be scaled by similarity
    (9.6, 3.0, 9.8, 0.2, 10, 30.5, 3),
    (9.6, 3.0, 9.8, 0.78, 5.9, 11, 176),
    (0.027, 1.0, 9.81, 0.0055, 4.8, 0.055, 0.458),
    (1.0, 1.5, 9.81, 0.248, 3.08, 1.66, 17.57),
    (1.5, 2.0, 9.81, 0.481, 2.25, 2.35, 26.56),
)


@dataclass(frozen=True)
class Case:
    """One mission file.

    Attributes
    ----------
    number : int
    kind : str
        One of `KINDS`.
    text : bytes
        What the file holds.
    refused : bool
        Whether no command may take it: it is broken for certain.
    """

    number: int
    kind: str
    text: bytes
    refused: bool


def case(number: int) -> Case:
    """Make the mission file of a number: the same on every machine.

    Parameters
    ----------
    number : int
    """
    rng = random.Random(f"mission {number}")
    kind = KINDS[number % len(KINDS)]
    content = plausible(rng, f"random-{number}")
    if kind == "absurd":
        for _ in range(rng.choice((1, 1, 2, 4))):
            rng.choice(ABSURDITIES)(rng, content)
    if kind != "broken":
        return Case(number, kind, toml(content).encode(), refused=False)
    if rng.random() < 0.5:
        return Case(number, kind, toml(mistaken(rng, content)).encode(), refused=True)
    return Case(number, kind, *garbled(rng, toml(content)))


# --- plausible ----------------------------------------------------------------------------------


def log_uniform(rng: random.Random, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def short(value: float, digits: int = 4) -> float:
    return float(f"{value:.{digits}g}")


def plausible(rng: random.Random, name: str) -> Content:
    """Return a mission as a person might write it: a vehicle from 20 g to 20 kg."""
    mass, gravity = short(log_uniform(rng, 0.02, 20)), rng.choice((9.81, 9.81, 9.8, 1.62, 3.71))
    arm = short(0.11 * mass ** (1 / 3) * rng.uniform(0.7, 1.5))
    turn = mass * arm**2 * rng.uniform(0.3, 0.8)
    roll, pitch = short(turn), short(turn * rng.uniform(0.8, 1.25))
    size = log_uniform(rng, 0.08, 2)
    points = target(rng, size)
    middle = np.mean(points, axis=0)
    height = short(size * rng.uniform(0.8, 6))
    place = middle - [0, 0, height]
    goal: Content = {"height": height}
    if rng.random() < 0.3:
        seen = centroid(points, place)
        tilted = rng.random() < 0.4
        aside = [rng.uniform(-0.1, 0.1) * len(points) if tilted else 0.0 for _ in range(2)]
        goal = {"centroid": [short(c) for c in aside] + [short(seen[2] * rng.uniform(0.95, 1))]}
    return {
        "name": name,
        "vehicle": {
            "mass": mass,
            "inertia": [roll, pitch, short((roll + pitch) * rng.uniform(0.5, 0.98))],
            "lever": arm,
            "drag_ratio": short(log_uniform(rng, 0.004, 0.1)),
            "gravity": gravity,
        },
        "target": {"points": points},
        "goal": goal,
        "gains": gains(rng, mass, height, gravity),
        "bounds": bounds(rng, points, place, mass * gravity),
        "start": start(rng, points, place, size),
        **conditions(rng, mass * gravity),
    }


def target(rng: random.Random, size: float) -> list[list[float]]:
    """Return the points of a target: a square, a rectangle, or 3 to 8 points as they fall."""
    half = short(size / 2)
    at = (
        [short(rng.uniform(-2, 2) * size, 2) for _ in range(3)] if rng.random() < 0.3 else [0.0] * 3
    )
    shape = rng.choice(("square", "square", "rectangle", "any", "any"))
    if shape == "any":
        deep = rng.choice((0.0, 0.3)) * size
        flat = [
            [rng.uniform(-half, half), rng.uniform(-half, half), rng.uniform(-deep, deep)]
            for _ in range(rng.randint(3, 8))
        ]
    else:
        wide = half if shape == "square" else short(half * rng.uniform(0.2, 0.9))
        flat = [[half, wide, 0.0], [half, -wide, 0.0], [-half, -wide, 0.0], [-half, wide, 0.0]]
    return [[short(c + a, 6) for c, a in zip(p, at, strict=True)] for p in flat]


def rays(points: Any, place: Any) -> tuple[Any, Any]:
    away = np.array(points, float) - np.array(place, float)
    distance = np.linalg.norm(away, axis=1)[:, None]
    return away / distance, distance


def centroid(points: Any, place: Any) -> Any:
    """Return what a level camera sees at a place."""
    return rays(points, place)[0].sum(axis=0)


def depth_eigenvalues(points: Any, place: Any) -> tuple[float, float]:
    """Return the lowest and the highest eigenvalue of Q at a place, 1/m."""
    p, distance = rays(points, place)
    Q = ((np.eye(3) - p[:, :, None] * p[:, None, :]) / distance[:, :, None]).sum(axis=0)
    values = np.linalg.eigvalsh(Q)
    return float(max(values[0], 1e-6)), float(values[-1])


def gains(rng: random.Random, mass: float, height: float, gravity: float) -> Content:
    """Return gains of a preset, scaled to the vehicle, as they are or somewhat changed."""
    m, h, g, k1, k2, k3, k4 = rng.choice(DESIGNS)
    slow = math.sqrt(gravity / g * h / height) * mass / m
    found = [k1 * mass / m * math.sqrt(gravity * height / (g * h)), k2 * h / height]
    found += [k3 * slow, k4 * slow]
    spread = rng.choice((0, 0, 0.5, 1.5))
    found = [k * math.exp(rng.uniform(-spread, spread)) for k in found]
    if rng.random() < 0.2:
        found[3] *= rng.uniform(0.02, 1)  # towards the boundary, where proofs end
    keys = ("k1", "k2", "k3", "k4")
    return {**{k: short(v) for k, v in zip(keys, found, strict=True)}, "k_yaw": short(0.01 * mass)}


def bounds(rng: random.Random, points: Any, place: Any, weight: float) -> Content:
    """Return bounds about the hover; one time in six they leave out Q at the goal."""
    low, high = depth_eigenvalues(points, place)
    wide = rng.choice((1.2, 2, 2, 5, 20))
    ends = [low / wide, high * wide]
    if rng.random() < 1 / 6:
        ends = rng.choice(([low / 20, low * 0.9], [high * 1.1, high * 9], [low * 1.1, high * 2]))
    if ends[0] >= ends[1]:
        ends = [ends[1] / 2, ends[1]]
    found: Content = {"eigenvalues": [short(e) for e in ends]}
    if rng.random() < 0.15:
        found["eigenvalues"] = "auto"
    if rng.random() < 0.15:
        return {**found, "level": short(log_uniform(rng, 1e-4, 1))}
    share = rng.choice((0.05, 0.1, 0.1, 0.25))
    return {**found, "thrust": [short(weight * (1 - share), 6), short(weight * (1 + share), 6)]}


def start(rng: random.Random, points: Any, place: Any, size: float) -> Content:
    """Return a start somewhere about the hover, above every point."""
    far = rng.choice((0.05, 0.5, 0.5, 2)) * size
    x, y, z = (float(c) + rng.uniform(-far, far) for c in place)
    top = min(p[2] for p in points)
    found: Content = {"position": [short(x), short(y), short(min(z, top - 0.2 * size))]}
    if rng.random() < 0.15:
        found["velocity"] = [short(rng.uniform(-0.5, 0.5), 2) for _ in range(3)]
    if rng.random() < 0.15:
        found["rotation"] = [short(rng.uniform(-0.3, 0.3), 2) for _ in range(3)]
    if rng.random() < 0.1:
        found["rates"] = [short(rng.uniform(-0.3, 0.3), 2) for _ in range(3)]
    return found


def conditions(rng: random.Random, weight: float) -> Content:
    """Return what a real flight adds: mostly nothing."""
    found: Content = {}
    if rng.random() < 0.15:
        found["sensors"] = {"frame_rate": 30, "latency": 0.03, "focal_length": 400, "width": 640}
        found["sensors"] |= {"height": 480, "pixel_noise": rng.choice((0, 1)), "control_rate": 100}
        found["sensors"]["out_of_view"] = rng.choice(("hold", "abort"))
    if rng.random() < 0.2:
        found["rotors"] = {"time_constant": 0.03, "min_thrust": 0, "max_thrust": short(weight / 2)}
    if rng.random() < 0.1:
        found["wind"] = {"mean": [0.3, 0, 0], "gust": rng.choice((0, 0.1)), "drag": 0.05}
    if rng.random() < 0.1:
        found["model_error"] = {"mass": 0.001, "inertia": [0.05, 0.05, 0]}
    if rng.random() < 0.15:
        found["scatter"] = {"position": [0.1, 0.1, 0.1], "mass": 0.001}
    return found


# --- absurd: every number in its range, yet nothing that flies ----------------------------------

LIMITS: dict[str, tuple[Any, ...]] = {
    "vehicle.mass": (1e6, 1e-6, 1e-30, 1e-300),
    "vehicle.inertia": ([1e6] * 3, [1e-300] * 3, [1, 1, 2], [1e-9, 1, 1], [1, 1e-3, 0.9991]),
    "vehicle.lever": (1e6, 1e-12, 1e-300),
    "vehicle.drag_ratio": (1e6, 1e-12, 1e-300),
    "vehicle.gravity": (1e3, 1e-3, 1e-12, 1e-300),
    "goal.height": (1e6, 1e3, 1e-3),
    "gains.k1": (1e9, 1e3, 1e-6, 1e-30, 1e-300),
    "gains.k2": (1e9, 1e3, 1e-6, 1e-30, 1e-300),
    "gains.k3": (1e9, 1e3, 1e-6, 1e-30, 1e-300),
    "gains.k4": (1e9, 1e3, 1e-6, 1e-30, 1e-300),
    "gains.k_yaw": (1e9, 1e-300),
    "bounds.eigenvalues": ([1e-300, 1e6], [1e-12, 1e-11], [9e5, 1e6], [1, 1.0000000000000002]),
    "bounds.level": (1e9, 1e-9, 1e-300),
    "start.position": ([1e6, 1e6, -1e6], [0, 0, -1e6], [1e5, 0, -0.1], [0, 0, -1e-9]),
    "start.velocity": ([1e4, -1e4, 1e4], [0, 0, 1e4], [1e-300, 0, 0]),
    "start.rotation": ([3.1416, 0, 0], [0, 1.5707963, 0], [-3.1416, 3.1416, 3.1416]),
    "start.rates": ([1e3, -1e3, 1e3], [0, 0, 1e3]),
    "sensors.control_rate": (1e6, 1e-6, 0.1),
    "sensors.frame_rate": (1e6, 1e-6, 99.99999),
    "sensors.latency": (1e3, 1e-300),
    "sensors.gyro_noise": (1e3, 1e-300),
    "sensors.gravity_bias": (1, 1e-300),
    "sensors.velocity_noise": (1e4,),
    "rotors.time_constant": (1e3, 1e-300, 1e-6),
    "rotors.max_thrust": (1e9, 1e-9, 1e-300),
    "rotors.min_thrust": (1e9, 1),
    "model_error.mass": (-0.9, 10, 1e-300),
    "model_error.inertia": ([-0.9] * 3, [10] * 3),
    "model_error.camera_tilt": ([1, -1, 1], [1e-300, 0, 0]),
    "scatter.position": ([1e6] * 3, [1e-300] * 3),
    "scatter.mass": (0.5,),
}


def put(content: Content, key: str, value: Any) -> None:
    section, name = key.split(".")
    content.setdefault(section, {})[name] = copy.deepcopy(value)


def at_a_limit(rng: random.Random, content: Content) -> None:
    key = rng.choice(sorted(LIMITS))
    put(content, key, rng.choice(LIMITS[key]))
    if key == "goal.height":
        content["goal"].pop("centroid", None)
    if key == "bounds.level":
        content["bounds"].pop("thrust", None)
    if key in ("vehicle.mass", "vehicle.gravity"):
        _thrust_about_weight(content, 0.1)


def _thrust_about_weight(content: Content, share: float) -> None:
    v = content["vehicle"]
    weight = Fraction(str(v["mass"])) * Fraction(str(v["gravity"]))
    if "thrust" in content["bounds"]:
        ends = (weight * (1 - Fraction(share)), weight * (1 + Fraction(share)))
        content["bounds"]["thrust"] = [Raw(decimal(end)) for end in ends]


def decimal(number: Fraction) -> str:
    """Write a number that has one as a decimal, exactly."""
    with localcontext(prec=2000):
        return f"{Decimal(number.numerator) / Decimal(number.denominator):e}"


def nearly_singular(rng: random.Random, content: Content) -> None:
    """Let the lowest thrust come just above, or just below, the singularity c q3*."""
    v, g = content["vehicle"], content["gains"]
    share = rng.choice((1 - 1e-9, 1 - 1e-3, 1 + 1e-9, 0.999999, 2))
    reach = float(v["mass"]) / float(g["k1"])
    k2 = reach * reach * float(v["gravity"]) * share / len(content["target"]["points"])
    if 0 < k2 < math.inf:  # another absurdity may have left no such number
        g["k2"] = k2


def thrust_of_hover_alone(rng: random.Random, content: Content) -> None:
    content["bounds"].pop("level", None)
    content["bounds"]["thrust"] = [1, 1]
    _thrust_about_weight(content, rng.choice((0.0, 1e-15, 0.999999)))


def points_nearly_coincide(rng: random.Random, content: Content) -> None:
    points = content["target"]["points"]
    points[1] = [c + rng.choice((1e-15, 1e-9, 1e-5)) for c in points[0]]


def nearly_on_a_line(rng: random.Random, content: Content) -> None:
    off = rng.choice((1e-12, 1e-6, 1e-3))
    content["target"]["points"] = [[0, 0, 0], [1, 0, 0], [2, off, 0]]


def huge_target(rng: random.Random, content: Content) -> None:
    times = rng.choice((1e3, 4e5, 1e-3, 1e-9))
    points = content["target"]["points"]
    content["target"]["points"] = [[c * times for c in p] for p in points]
    if rng.random() < 0.5 and "height" in content["goal"]:
        content["goal"]["height"] *= times
        content["start"]["position"] = [c * times for c in content["start"]["position"]]


def many_points(rng: random.Random, content: Content) -> None:
    n = rng.choice((2, 16, 64))
    points = [[math.cos(i), math.sin(i), 0.1 * math.cos(2 * i)] for i in range(n)]
    content["target"]["points"] = [[short(c, 6) for c in p] for p in points]


def start_at_a_point(rng: random.Random, content: Content) -> None:
    x, y, z = rng.choice(content["target"]["points"])
    content["start"]["position"] = [x, y, z - rng.choice((1e-12, 1e-6, 1e-3, 0, -1))]


def goal_at_the_points(rng: random.Random, content: Content) -> None:
    points = content["target"]["points"]
    top = float(np.mean([p[2] for p in points])) - min(p[2] for p in points)
    content["goal"] = {"height": top + rng.choice((1e-12, 1e-6, 1e-3))}


def goal_out_of_sight(rng: random.Random, content: Content) -> None:
    n = len(content["target"]["points"])
    aside = rng.choice((0.0, 0.5 * n, 1e-9))
    q3 = rng.choice((n - 1e-9, n - 1e-3, 1e-9, 1e-300, n / 2, 0.6 * n))
    content["goal"] = {"centroid": [aside, 0, q3]}


def long_decimals(rng: random.Random, content: Content) -> None:
    section = rng.choice(("vehicle", "gains"))
    key = rng.choice([k for k, v in content[section].items() if isinstance(v, float)])
    digits = "".join(rng.choice(string.digits) for _ in range(rng.choice((30, 300, 380))))
    content[section][key] = Raw(f"{content[section][key]:.9f}{digits}")


def odd_name(rng: random.Random, content: Content) -> None:
    content["name"] = rng.choice(("0", "x" * 64, "int", "stdint", "vehicle", "a.b-c", "CON", "7up"))


ABSURDITIES = (
    *(at_a_limit,) * 8,
    nearly_singular,
    thrust_of_hover_alone,
    points_nearly_coincide,
    nearly_on_a_line,
    huge_target,
    many_points,
    start_at_a_point,
    goal_at_the_points,
    goal_out_of_sight,
    long_decimals,
    odd_name,
)


# --- broken -------------------------------------------------------------------------------------


class Raw(str):
    """Text that stands in the file as it is."""


WRONG = (
    "many",
    "",
    "0.5",
    True,
    {},
    {"a": 1},
    [],
    [[]],
    [1, 2, 3, 4],
    Raw("nan"),
    Raw("-inf"),
    Raw("inf"),
    Raw("1979-05-27T07:32:00Z"),
    Raw("1e999"),
    Raw("1e-999"),
    Raw("-1e400"),
    Raw("9" * 5000),
    Raw("0." + "3" * 500),
    Raw("[" * 90 + "]" * 90),
    Raw('"""\nlines\n\n"""'),
    Raw("-0.0"),
    10**400,
)


ZEROS = ("-0.0", "1e-999")  # no mistake where a coordinate is wanted


def mistaken(rng: random.Random, content: Content) -> Content:
    """Return a mission with one entry of its demanded sections missing, unknown or wrong."""
    demanded = ("vehicle", "target", "gains", "start")
    section = rng.choice(demanded)
    key = rng.choice(
        sorted(k for k in content[section] if k not in ("velocity", "rotation", "rates"))
    )
    what = rng.choice(("missing key", "missing section", "unknown", "wrong", "wrong", "wrong"))
    if what == "missing key":
        del content[section][key]
    elif what == "missing section":
        del content[section]
    elif what == "unknown":
        word = rng.choice(
            ("mas", "k5", "Mass", "weight", "source", "__class__", "model_config", "é")
        )
        rng.choice((content, content[section]))[word] = rng.choice((1, "x", {}, [1]))
    elif isinstance(content[section][key], list) and rng.random() < 0.5:
        spot = content[section][key]
        while isinstance(spot[0], list):
            spot = rng.choice(spot)
        spot[rng.randrange(len(spot))] = rng.choice([w for w in WRONG if w not in ZEROS])
    else:
        content[section][key] = rng.choice(WRONG)
    return content


def garbled(rng: random.Random, text: str) -> tuple[bytes, bool]:
    """Return what is hardly text any more, and whether it is broken for certain."""
    whole = text.encode()
    at = rng.randrange(len(text))
    sign = rng.choice("[]{}=\"'#\n,.x0-\\\x00\ufeff\u202eé")
    surely: dict[str, Any] = {
        "empty": b"",
        "blank": b" \n\t\n",
        "noise": bytes(rng.randrange(256) for _ in range(rng.choice((10, 1000, 50_000)))),
        "utf-16": text.encode("utf-16"),
        "latin-1": ("# Größe in m\n" + text).encode("latin-1"),
        "cut": whole[: min(at, len(whole) // 2)],
        "huge": b"#" * 1_000_001,
        "deep": b"x = " + b"[" * 100_000,
        "deep tables": b"a." * 20_000 + b"b = 1\n",
        "twice": whole + whole,
        "json": b'{"name": "x", "vehicle": {}}',
        "nested": f"{text}\n[vehicle.inner]\nx = 1\n".encode(),
        "list of tables": text.replace("[vehicle]", "[[vehicle]]").encode(),
        "wrong bracket": text.replace("]", "}", 1).encode(),
    }
    perhaps: dict[str, Any] = {
        "byte order mark": b"\xef\xbb\xbf" + whole,
        "carriage returns": text.replace("\n", "\r\n").encode(),
        "one sign more": (text[:at] + sign + text[at:]).encode(),
        "one sign less": (text[:at] + text[at + 1 :]).encode(),
        "another sign": (text[:at] + sign + text[at + 1 :]).encode(),
        "zero bytes": whole + b"\x00" * 100,
        "comments": b"# " + b"x" * 900_000 + b"\n" + whole,
    }
    how = rng.choice([*surely, *perhaps, "one sign more", "one sign less", "another sign"])
    return (surely[how], True) if how in surely else (perhaps[how], False)


# --- TOML ---------------------------------------------------------------------------------------


def toml(content: Content) -> str:
    """Write a mission as TOML."""
    lines = [f"{key} = {value(v)}" for key, v in content.items() if not _is_section(v)]
    for name, section in content.items():
        if _is_section(section):
            lines += [
                "",
                f"[{bare(name)}]",
                *(f"{bare(k)} = {value(v)}" for k, v in section.items()),
            ]
    return "\n".join(lines) + "\n"


def _is_section(entry: Any) -> bool:
    return isinstance(entry, dict)


def bare(key: str) -> str:
    return key if key.isascii() else f'"{key}"'


def value(entry: Any) -> str:
    """Write one value as TOML."""
    if isinstance(entry, Raw):
        return str(entry)
    if isinstance(entry, bool):
        return str(entry).lower()
    if isinstance(entry, dict):
        return "{" + ", ".join(f"{k} = {value(v)}" for k, v in entry.items()) + "}"
    if isinstance(entry, list | tuple):
        return "[" + ", ".join(map(value, entry)) + "]"
    if isinstance(entry, str):
        return '"' + entry.replace('"', '\\"') + '"'
    return repr(float(entry)) if isinstance(entry, np.floating) else repr(entry)


if __name__ == "__main__":
    for number in sys.argv[1:]:
        sys.stdout.buffer.write(case(int(number)).text)
