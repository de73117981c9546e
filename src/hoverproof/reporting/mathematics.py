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
BREAK = r"\allowbreak "
"""Where a formula may go on in a new line, if the page is narrow."""
IMPLIES = rf"{BREAK}\Longrightarrow\quad "

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
    """Return a formula as MathML, in pieces that wrap like words where it may be broken.

    Parameters
    ----------
    latex : str
        With `BREAK` between what may stand in lines of their own.
    block : bool
        Whether it stands on a line of its own.
    """
    if BREAK in latex:
        return " ".join(mathml(piece) for piece in latex.split(BREAK))
    upright = latex.replace(r"\mathrm{", r"\text{")  # whole words, whatever stands around them
    made: str = convert(upright, display="block" if block else "inline")
    made = re.sub(r"&#x([0-9A-F]+);", lambda m: _character(int(m[1], 16)), made)
    made = made.replace("<mrow><mo>+</mo>", '<mrow><mo form="infix">+</mo>', 1)  # as it goes on
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
        rf"\Longrightarrow\quad X^T \Sigma({symbol}, T)\, X \ge "
        r"\mathrm{margin}\ \left|X\right|^2",
        rf"\mathrm{{margin}} = {decimal(margin)}\ \mathrm{{kg/s}}",
        r"\Longrightarrow\quad \mathcal{L}(t) \le \mathcal{L}(0)\, e^{-r t}",
        r"r = \frac{2\ \mathrm{margin}}{m} \ge "
        rf"{decimal(decimal_below(rate, 8))}\ \mathrm{{s}}^{{-1}}",
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
    thrust: Fraction,
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
    thrust : Fraction
        With that f(T), N.
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
        rf"f(T) = {fraction(f)}\ \mathrm{{m}}^{{-1}},{BREAK}"
        rf"T \approx {float(thrust):.6g}\ \mathrm{{N}}",
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
        BREAK.join(
            (
                rf"{symbol} = W(\xi) + {_half_of(a2, 2)}",
                rf"+ {_half_of(a3, 3)}",
                rf"+ {_half_of(a4, 4)}",
                *_of_vehicles(region),
            )
        ),
        rf"W(\xi) = \sum_i \left|P'_i - \xi\right| {BREAK}+ q_3^* e_3^T \xi - W_0",
        rf"{symbol}(0) \le {decimal(region.level)}{above}{IMPLIES}\xi(t) \to \xi^*",
        rf"\dot{symbol} \le -{decimal(region.rate)}\, \frac{{k_1}}{{m}}\, \left|Y\right|^2,{BREAK}"
        r"\left|Y\right|^2 = \left|q - q_3^* \rho\right|^2 + \left|\delta_2\right|^2 "
        rf"{BREAK}+ \left|\delta_3\right|^2 + \left|\delta_4\right|^2",
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
    left = "" if verdict.ultimate_radius is None else r" + \ell_\infty"
    return [
        BREAK.join(
            (
                rf"\Psi = {_half_of('', 1)}",
                rf"+ {_half_of(w2, 2)}",
                rf"+ {_half_of(w3, 3)}",
                rf"+ {_half_of(w4, 4)}",
                *_of_vehicles(verdict),
            )
        ),
        rf"\Psi(0) \le {decimal(verdict.level)}{IMPLIES}\Psi(t) \le \Psi(0)\, e^{{-r t}}{left},"
        rf"{BREAK}r = {decimal(verdict.rate)}\ \mathrm{{s}}^{{-1}}",
        rf"\Psi(0) \le {decimal(verdict.start_level)}{IMPLIES}"
        rf"\left|\xi(t) - \xi^*\right| \le {radius}\ \mathrm{{m}}\ {BREAK}"
        rf"\mathrm{{for}}\ t \ge {time}\ \mathrm{{s}}",
    ]


def _of_vehicles(verdict: Attraction | Exponential) -> Iterator[str]:
    """Yield what lag of the rotors and latency add to the Lyapunov function, as LaTeX."""
    content = verdict.certificate.content
    if content.get("lag"):
        a5, a6 = (decimal(Fraction(content["lag"][name])) for name in ("torque", "thrust"))
        yield rf"+ \tfrac\tau 2 \cdot {a5} \left|\mu\right|^2"
        yield rf"+ \tfrac\tau 2 \cdot {a6} \mu_T^2"
    if content.get("memory"):
        weight = r"e^{r (z - t)} " if content["kind"] == "exponential" else ""
        memory = decimal(Fraction(content["memory"]))
        yield (
            rf"+ {memory} \int_{{-\bar\tau}}^0 \int_{{t+x}}^t {BREAK}{weight}"
            r"\left|y(z)\right|^2 \mathrm{d}z\, \mathrm{d}x"
        )


def _half_of(weight: str, error: int) -> str:
    factor = rf"\cdot {weight} " if weight else ""
    return rf"\tfrac12 {factor}\left|\delta_{error}\right|^2"


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
