"""Write certificates of gains as Coq literals, for the replay of `make -C proofs/coq`.

    python literals.py CERTIFICATE... > Replay.v
    python literals.py --plain CERTIFICATE... | extracted/decide
    python literals.py --about CERTIFICATE   what Coq shows of it and what not, in words, as JSON

Standard library only. What is written is no part of what is believed: Coq decides anew whether the
numbers are right, and the hints of each certificate are tested there as well.
"""

import itertools
import json
import math
import re
import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

N = 11
Forms = list[list[Fraction]]  # three linear forms


class Hint(NamedTuple):
    """What shows that a matrix is positive definite; see `Forms.hint`."""

    scaling: int
    times_more: int
    parts: list[tuple[int, list[int]]]

    def literal(self) -> str:
        """Return it as a term of `Forms.hint`."""
        parts = "; ".join(f"({d}, [{'; '.join(map(str, row))}])" for d, row in self.parts)
        return f"(Hint {self.scaling} {self.times_more} [{parts}]%Z)"

    def plain(self) -> str:
        """Return its numbers."""
        parts = "\n".join(" ".join(map(str, (d, *row))) for d, row in self.parts)
        return f"{self.scaling} {self.times_more} {len(self.parts)}\n{parts}"


def unit(i: int) -> list[Fraction]:
    """Return a linear form that is one component of X, or zero."""
    return [Fraction(int(k == i)) for k in range(N)]


def vector(i: int) -> Forms:
    """Return δ, whose first component is the i-th of X."""
    return [unit(k if k < N else -1) for k in range(i, i + 3)]


def plus(*terms: tuple[Fraction, Forms]) -> Forms:
    """Return a sum of multiples of vectors of linear forms."""
    return [[sum((c * u[k][i] for c, u in terms), Fraction(0)) for i in range(N)] for k in range(3)]


def flat(u: Forms) -> Forms:
    """Return P u."""
    return [u[0], u[1], [Fraction(0)] * N]


class Gains:
    """A certificate of gains, with the numbers of `Gains.certificate` in its order."""

    def __init__(self, c: dict[str, Any], name: str) -> None:
        mission, hints, number = c["mission"], c["enclosures"], Fraction
        self.name = name
        self.mass = number(mission["vehicle"]["mass"])
        self.k = [number(mission["gains"][key]) for key in ("k1", "k2", "k3", "k4")]
        self.weights = [number(w) for w in c["weights"]]
        self.low, self.high = map(number, c["region"]["eigenvalues"])
        self.thrust = [number(x) for x in mission["bounds"]["thrust"]]
        self.box = [[number(x) for x in side] for side in hints["centroid"]]
        self.factor = [number(x) for x in hints["factor"]]
        self.margin = number(c["claim"]["margin"])
        self.multipliers = [number(vertex["multiplier"]) for vertex in c["vertices"]]
        self.goal = c["goal_position"] and [number(x) for x in c["goal_position"]]
        self.points = [[number(x) for x in point] for point in mission["target"]["points"]]
        law = mission.get("law", {})
        choices = law.get("feature"), law.get("goal"), law.get("force")
        self.papers = choices in ((None, None, None), ("centroid", "image", "modelled"))
        self.of_target = (
            self.goal is not None
            and "weights" not in mission["target"]
            and choices[:2] in ((None, None), ("centroid", "image"))
        )

    def terms(self, f: Fraction, q: list[Fraction], tau: Fraction) -> list[tuple]:
        """Return the terms of `Gains.bound`."""
        k1, k2, k3, k4 = self.k
        j, rho = (self.low + self.high) / 2, (self.high - self.low) / 2
        one, (d1, d2, d3, d4) = Fraction(1), map(vector, (0, 3, 6, 9))
        e, v = plus((one, d4), (-one, d3)), plus((one, d1), (one, d2))
        along = [q[0] * x + q[1] * y for x, y in zip(e[0], e[1], strict=True)]
        turn = [[q[2] * x for x in e[0]], [q[2] * x for x in e[1]], [-x for x in along]]
        rates = [
            plus((k1 * f, turn), (-k1 * j, v)),
            plus((k1 * k2, d3), (-k1 * k2, d2), (k1 * j, v), (-k1 * f, turn)),
            plus((k1 * j, v), (k1 * k2 + k3, d4), (-k1 * k2, d2), (-k3, d3)),
            plus((k1 * j, flat(v)), (-(k1 * k2 + k3), flat(d3)), (-k4, d4)),
        ]
        w = self.weights
        pull = plus((w[0], d1), (-w[1], d2), (-w[2], d3), (-w[3], d4))
        loss = -k1 * rho / 2
        errors = (d1, d2, d3, d4)
        return [
            *((-w[i], errors[i], rates[i]) for i in range(4)),
            *((-self.margin * w[i], errors[i], errors[i]) for i in range(4)),
            (loss * tau, v, v),
            (loss / tau, pull, pull),
        ]

    def hint(self, f: Fraction, tau: Fraction) -> Hint:
        """Return a hint for the matrices at one end of the interval of f, of all corners alike."""
        corners = itertools.product(*(sorted(set(side)) for side in self.box))
        each = [products(self.terms(f, list(corner), tau)) for corner in corners]
        denominators = (x.denominator for m in itertools.chain(*each) for row in m for x in row)
        return hint(each[0], math.lcm(*denominators))

    def numbers(self) -> tuple[list[Fraction], list[Fraction]]:
        """Return mass, gains and weights, and all other rational numbers, in their order."""
        ends = [*self.thrust, *itertools.chain(*self.box), *self.factor]
        rest = [self.low, self.high, *ends, self.margin, *self.multipliers]
        return [self.mass, *self.k, *self.weights], rest

    def hints(self) -> list[Hint]:
        """Return those at either end."""
        return list(map(self.hint, self.factor, self.multipliers))

    def literal(self) -> str:
        """Return the certificate as a term of `Gains.certificate`."""
        its, rest = (" ".join(map(q, each)) for each in self.numbers())
        hints = "\n  ".join(hint.literal() for hint in self.hints())
        return f"Certificate (Numbers {its})\n  {rest}\n  {hints}"

    def roots(self) -> list[tuple[Fraction, Fraction]]:
        """Enclose the distances of the target's points from the goal, each once."""
        squares: list[Fraction] = []
        for point in reversed(self.points):
            square = sum((a - b) ** 2 for a, b in zip(point, self.goal, strict=True))
            if square not in squares:
                squares.append(square)
        return list(map(root, squares))

    def target(self) -> str:
        """Return the target as a term of `Target.target`."""
        roots = "; ".join(f"({q(low)}, {q(high)})" for low, high in self.roots())
        points = "; ".join(map(place, self.points))
        return f"Target [{points}] {place(self.goal)}\n  [{roots}]"

    def plain(self) -> str:
        """Return the certificate, and its target if any, as `extracted/main.ml` reads it."""
        its, rest = self.numbers()
        hints = "\n".join(hint.plain() for hint in self.hints())
        text = f"{self.name}\n{' '.join(map(str, its + rest))}\n{hints}\n"
        if not self.of_target:
            return f"{text}none\n"
        roots, points = self.roots(), [*itertools.chain(*self.points), *self.goal]
        ends = " ".join(map(str, itertools.chain(*roots)))
        where = " ".join(map(str, points))
        return f"{text}target {len(self.points)} {where} {len(roots)} {ends}\n"


def root(square: Fraction) -> tuple[Fraction, Fraction]:
    """Enclose a square root."""
    unit = 2**128
    low = math.isqrt(square.numerator * unit**2 // square.denominator)
    return Fraction(low, unit), Fraction(low + 1, unit)


def place(p: list[Fraction]) -> str:
    """Write a position."""
    return f"({', '.join(map(q, p))})"


def products(terms: list[tuple]) -> list[list[list[Fraction]]]:
    """Return twice the symmetric matrix of each product of two linear forms."""
    return [
        [
            [c * (x[i] * y[k] + x[k] * y[i]) if y[k] or y[i] else y[k] for k in range(N)]
            for i in range(N)
        ]
        for c, u, v in terms
        for x, y in zip(u, v, strict=True)
    ]


def factors(m: list[list[Fraction]]) -> list[tuple[Fraction, list[Fraction]]] | None:
    """Return (d, r) with M = Σ d r rᵀ, d > 0, or None where M is not positive definite."""
    found, rest = [], [row[:] for row in m]
    for k in range(N):
        d = rest[k][k]
        if d <= 0:
            return None
        r = [x / d for x in rest[k]]
        found.append((d, r))
        for i in range(k, N):
            rest[i] = [x - d * r[i] * y for x, y in zip(rest[i], r, strict=True)]
    return found


def hint(parts: list[list[list[Fraction]]], scaling: int) -> Hint:
    """Return what shows that a sum of matrices is positive definite: nearly all of it as squares.

    The squares are of M less a small multiple of I, rounded to whole numbers; what is left of M is
    nearly that multiple of I. Where M is not positive definite there is none, and an empty one.
    """
    m = [[scaling * sum(part[i][k] for part in parts) for k in range(N)] for i in range(N)]
    if factors(m) is None:
        return Hint(scaling, 1, [])
    size = max(m[i][i] for i in range(N))
    for bits in range(10, 200, 10):
        less = size / 2**bits
        shifted = [
            [x - (less if i == k else 0) for k, x in enumerate(row)] for i, row in enumerate(m)
        ]
        found = factors(shifted)
        if found:
            unit = 2 ** (bits + 12)  # of the rows; they are multiplied by it, M by its square
            rows = [(round(d), [round(x * unit) for x in r]) for d, r in found]
            return Hint(scaling, unit**2, rows)
    return Hint(scaling, 1, [])


def q(x: Fraction) -> str:
    """Write a rational number."""
    return f"({x.numerator} # {x.denominator})"


def gains_of(held: dict[str, Any], name: str) -> Iterator[Gains]:
    """Yield what is held, if it is a certificate of gains with an interval of thrust."""
    if held["kind"] == "gains" and "thrust" in held["mission"]["bounds"]:
        yield Gains(held, name)


def certificates(paths: list[str]) -> Iterator[Gains]:
    """Yield the certificates that Coq can decide."""
    for path in map(Path, paths):
        held = json.loads(path.read_text(encoding="utf-8"))
        yield from gains_of(held, path.name.removesuffix(".cert.json"))


PAPER = "theorems 2 to 6 are on paper, and checker.py alone checks their certificates"
UNTIED = "that the loop of another law than the paper's obeys the error dynamics is on paper"
ENCLOSED = "that the wanted feature is in its box is left to checker.py"
BOX = "that Q stays within its bounds over the box is left to checker.py"
LEVEL = "the bounds of the thrust that follow from a level are left to checker.py"


def about(held: dict[str, Any]) -> dict[str, Any]:
    """Return what Coq shows of a certificate, and what is left, in words."""
    found = list(gains_of(held, ""))
    if not found:
        return {"shown": [], "left": LEVEL if held["kind"] == "gains" else PAPER}
    (c,) = found
    shown = [
        "gains_sound: XᵀΣX > margin Σ wi|δi|² for every X ≠ 0, every J or Q and every thrust "
        "within the bounds, every q* in the box of the certificate, whatever Ω is"
    ]
    left = []
    if c.papers:
        shown.append(
            "lyapunov_decays: L falls at its rate along every motion of rigid body, camera and law "
            "while Q and T are within their bounds, if Ω3 is 0 at the start"
        )
    else:
        left.append(UNTIED)
    if c.of_target:
        shown.append("target_sound: what a level camera sees from the goal is in that box")
    else:
        left.append(ENCLOSED)
    if held["region"]["box"] is not None:
        left.append(BOX)
    return {"shown": shown, "left": "; ".join(left)}


def theorems(c: Gains) -> str:
    """Return what Coq is to decide of a certificate."""
    name, decided = re.sub(r"\W", "_", c.name), "Proof. vm_cast_no_check (eq_refl true). Qed."
    lines = [
        f"Definition cert_{name} : certificate :=\n  {c.literal()}.",
        f"Theorem gains_{name} : certificate_ok cert_{name} = true.\n{decided}",
        f"Definition falls_{name} := gains_sound cert_{name} gains_{name}.",
    ]
    if c.of_target:
        lines += [
            f"Definition target_{name} : target :=\n  {c.target()}.",
            f"Theorem seen_{name} : target_ok target_{name} cert_{name} = true.\n{decided}",
        ]
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> None:
    """Print theorems for certificates, or their numbers."""
    if arguments[:1] == ["--about"]:
        held = json.loads(Path(arguments[1]).read_text(encoding="utf-8"))
        sys.stdout.buffer.write(json.dumps(about(held)).encode())
        return
    if arguments[:1] == ["--plain"]:
        sys.stdout.writelines(c.plain() for c in certificates(arguments[1:]))
        return
    print("(* Written by literals.py from certificates. *)")
    print("From Hoverproof Require Import Forms Gains Target.")
    print("Require Import QArith List.\nImport ListNotations.\n")
    for c in certificates(arguments):
        print(theorems(c))


if __name__ == "__main__":
    main(sys.argv[1:])
