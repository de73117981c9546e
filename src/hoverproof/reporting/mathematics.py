"""Formulas in a page: MathML made of the LaTeX that the project prints."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from decimal import Decimal
from fractions import Fraction

from latex2mathml.converter import convert

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.exponential.verdict import Exponential

DENOMINATOR = 10**15
RELATIONS = "⪯⪰≺≻"

IMPLIED = (
    ("10", "image error"),
    ("17", "velocity error"),
    ("18", "force error"),
    ("25", "body-rate error"),
    ("32", "Lyapunov function"),
    ("f(T)", "thrust factor"),
    ("L̇ with A", "derivative along the closed loop; its right side times m is −XᵀΣX"),
    ("A", "the matrix A in it"),
)
"""Equations of the ledger that say what a theorem is about, and what each defines."""


def mathml(latex: str, *, block: bool = False) -> str:
    """Return a formula as MathML.

    Parameters
    ----------
    latex : str
    block : bool
        Whether it stands on a line of its own.
    """
    upright = latex.replace(r"\mathrm{", r"\text{")  # whole words, whatever stands around them
    made: str = convert(upright, display="block" if block else "inline")
    made = re.sub(r"&#x([0-9A-F]+);", lambda m: _character(int(m[1], 16)), made)
    made = re.sub(f"<mi>([{RELATIONS}])</mi>", r"<mo>\1</mo>", made)
    return made.replace('<math xmlns="http://www.w3.org/1998/Math/MathML"', "<math")


def claim(
    eigenvalues: tuple[Fraction, Fraction],
    thrust: tuple[Fraction, Fraction],
    margin: Fraction,
    rate: Fraction,
    symbol: str = "Q",
) -> list[str]:
    """Return theorem 1 with its numbers, as LaTeX, a line each (see `proofs/README.md`).

    Parameters
    ----------
    eigenvalues, thrust : (low, high)
        1/m, and N.
    margin : Fraction
        Σ ⪰ margin I, kg/s.
    rate : Fraction
        Of the decay of L, 1/s.
    symbol : str
        "Q", or "J" if the bounds are the ends of its ball.
    """
    return [
        *question(eigenvalues, thrust, symbol),
        rf"\Longrightarrow\quad X^T \Sigma({symbol}, T)\, X \ge \mu \left|X\right|^2",
        rf"\mu = {decimal(margin)}\ \mathrm{{kg/s}}",
        r"\Longrightarrow\quad \mathcal{L}(t) \le \mathcal{L}(0)\, e^{-r t}",
        rf"r = \frac{{2 \mu}}{{m}} \ge {decimal(decimal_below(rate, 8))}\ \mathrm{{s}}^{{-1}}",
    ]


def question(
    eigenvalues: tuple[Fraction, Fraction], thrust: tuple[Fraction, Fraction], symbol: str = "Q"
) -> list[str]:
    """Return what a theorem on gains supposes, as LaTeX, a line each.

    An end that is no short decimal is rounded inward: that claims a little less, never more.

    Parameters
    ----------
    eigenvalues, thrust : (low, high)
        1/m, and N.
    symbol : str
        "Q", or "J" if the bounds are the ends of its ball.
    """
    (a, b), (low, high) = map(_inward, (eigenvalues, thrust))
    bounds = rf"{a}\ \mathrm{{m}}^{{-1}}\, I \preceq Q = Q^T \preceq {b}\ \mathrm{{m}}^{{-1}}\, I"
    if symbol == "J":
        least, most = eigenvalues
        middle = (least + most) / 2
        j = middle if _is_short(middle) else decimal_below(middle, 8)
        _, reach = _inward((Fraction(0), min(most - j, j - least)))
        bounds = (
            rf"\left|J - {decimal(j)}\ \mathrm{{m}}^{{-1}}\, I\right| "
            rf"\le {reach}\ \mathrm{{m}}^{{-1}}"
        )
    return [
        bounds,
        rf"{low}\ \mathrm{{N}} \le T \le {high}\ \mathrm{{N}}",
    ]


def counterexample(
    Q: Sequence[Sequence[Fraction]],
    f: Fraction,
    X: Sequence[Fraction],
    value: Fraction,
    symbol: str = "Q",
) -> list[str]:
    """Return a refutation, as LaTeX, a line each.

    Parameters
    ----------
    Q : (3, 3)
        1/m.
    f : Fraction
        1/m.
    X : (11,)
        Dimensionless.
    value : Fraction
        XᵀΣX is no larger, kg/s.
    symbol : str
        "Q", or "J" if it stands for that.
    """
    rows = r" \\ ".join(" & ".join(map(fraction, row)) for row in Q)
    entries = r",\ ".join(map(fraction, X))
    return [
        rf"{symbol} = \begin{{pmatrix}} {rows} \end{{pmatrix}}\ \mathrm{{m}}^{{-1}}",
        rf"f(T) = {fraction(f)}\ \mathrm{{m}}^{{-1}}",
        rf"X = \left({entries}\right)^T",
        rf"X^T \Sigma({symbol}, T)\, X \le {decimal(value)}\ \mathrm{{kg/s}} < 0",
    ]


def attraction_claim(region: Attraction) -> list[str]:
    """Return theorem 3 with its numbers, as LaTeX, a line each (see `proofs/README.md`).

    Parameters
    ----------
    region : Attraction
        A region of attraction.
    """
    a2, a3, a4 = map(decimal, region.weights)
    symbol = r"\Psi" if region.tolerant else r"\Lambda"
    height = region.barrier_height
    above = "" if height is None else rf",\quad h \ge {decimal(height)}\ \mathrm{{m}}"
    return [
        rf"{symbol} = W(\xi) + \tfrac12\left("
        rf"{a2} \left|\delta_2\right|^2 + {a3} \left|\delta_3\right|^2 + "
        rf"{a4} \left|\delta_4\right|^2\right)",
        *_of_vehicles(region),
        r"W(\xi) = \sum_i \left|P'_i - \xi\right| + q_3^* e_3^T \xi - W_0",
        rf"{symbol}(0) \le {decimal(region.level)}{above}\quad\Longrightarrow\quad "
        r"\xi(t) \to \xi^*",
        rf"\dot{symbol} \le -\frac{{k_1}}{{m}}\, {decimal(region.rate)} \left("
        r"\left|q - q_3^* \rho\right|^2 + \left|\delta_2\right|^2 + "
        r"\left|\delta_3\right|^2 + \left|\delta_4\right|^2\right)",
    ]


def exponential_claim(verdict: Exponential) -> list[str]:
    """Return theorem 5 with its numbers, as LaTeX, a line each (see `proofs/README.md`).

    Parameters
    ----------
    verdict : Exponential
        What is proved of every vehicle within tolerance.
    """
    w2, w3, w4 = map(decimal, verdict.weights)
    radius, time = decimal(verdict.settling.radius), decimal(verdict.settling.time)
    return [
        r"\Psi = \tfrac12\left(\left|\delta_1\right|^2 + "
        rf"{w2} \left|\delta_2\right|^2 + {w3} \left|\delta_3\right|^2 + "
        rf"{w4} \left|\delta_4\right|^2\right)",
        *_of_vehicles(verdict),
        rf"\Psi(0) \le {decimal(verdict.level)}\quad\Longrightarrow\quad "
        rf"\Psi(t) \le \Psi(0)\, e^{{-r t}},\quad r = {decimal(verdict.rate)}\ \mathrm{{s}}^{{-1}}",
        rf"\Psi(0) \le {decimal(verdict.start_level)}\quad\Longrightarrow\quad "
        rf"\left|\xi(t) - \xi^*\right| \le {radius}\ \mathrm{{m}}\ "
        rf"\mathrm{{for}}\ t \ge {time}\ \mathrm{{s}}",
    ]


def _of_vehicles(verdict: Attraction | Exponential) -> Iterator[str]:
    """Yield what lag of the rotors and latency add to the Lyapunov function, as LaTeX."""
    content = verdict.certificate.content
    if content.get("lag"):
        a5, a6 = (decimal(Fraction(content["lag"][name])) for name in ("torque", "thrust"))
        yield rf"\qquad +\, \tfrac\tau 2 \left({a5} \left|\mu\right|^2 + {a6} \mu_T^2\right)"
    if content.get("memory"):
        weight = r"e^{r (x - t)} " if content["kind"] == "exponential" else ""
        memory = decimal(Fraction(content["memory"]))
        yield rf"\qquad +\, {memory} \iint {weight}\left|y(x)\right|^2"


def fraction(x: Fraction) -> str:
    """Write a rational number exactly, as LaTeX.

    Parameters
    ----------
    x : Fraction
        Any exact number.
    """
    if x.denominator == 1:
        return str(x.numerator)
    sign = "-" if x < 0 else ""
    return rf"{sign}\frac{{{abs(x.numerator)}}}{{{x.denominator}}}"


def decimal(x: Fraction) -> str:
    """Write a rational number exactly, as a decimal if it is a short one, else as LaTeX.

    Parameters
    ----------
    x : Fraction
        Any exact number.
    """
    if not _is_short(x):
        return fraction(x)
    text = f"{Decimal(x.numerator) / Decimal(x.denominator):f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def _is_short(x: Fraction) -> bool:
    return not DENOMINATOR % x.denominator


def _inward(ends: tuple[Fraction, Fraction]) -> tuple[str, str]:
    low, high = ends
    return (
        decimal(low if _is_short(low) else decimal_above(low, 8)),
        decimal(high if _is_short(high) else decimal_below(high, 8)),
    )


def _character(code: int) -> str:
    return {"<": "&lt;", ">": "&gt;", "&": "&amp;"}.get(chr(code), chr(code))
