"""What the paper claims in and about its theorem: conditions, level, thrust bounds, decay."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from hoverproof.algebra.definite import quadratic_form
from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.identity import prove_equal
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.paper.conditions import printed_conditions
from hoverproof.paper.equations import FREE, c
from hoverproof.paper.judge import (
    Claim,
    Judgement,
    Verdict,
    Words,
    exact_point,
    proof_of,
    statement,
)
from hoverproof.paper.printed import Equation
from hoverproof.paper.symbols import F, d2, d3, g, k1, k2, m, number, q3_star
from hoverproof.servo.lyapunov import derive_lyapunov_form

Point = Sequence[Fraction]


def _exact(*values: int | Fraction) -> list[Fraction]:
    return [Fraction(v) for v in values]


def _sigma(
    mass: Fraction, gains: Point, goal: Point, depths: Point, f: Fraction
) -> list[list[Fraction]]:
    """Return the derived Σ exactly; gains are k1…k4, depths the lower triangle of Q."""
    one = Fraction(1)
    design = [mass, one, one, one, one, *gains, one, *goal]
    return evaluate(derive_lyapunov_form().function(), [design, [one] * 4, depths, [f]])[0]


MASS, GRAVITY, GOAL = Fraction(10_000), Fraction(10), _exact(0, 0, 1)
GAINS = _exact(100, 4, 1000, Fraction(1, 1000))
LOW, HIGH, BETWEEN = _exact(1, 2, Fraction(3, 2))
STATE = _exact(Fraction(1, 10), 0, 0, 0, 0, 0, 0, 0, 0, Fraction(1, 5), 0)
"""Gains that meet every printed condition, and a state with T = m g at which L grows."""


def _growing() -> tuple[bool, Fraction, dict[str, str]]:
    """Return whether the printed conditions hold at the example, XᵀΣX there, and the point."""
    a, b, k_3, _ = GAINS
    f = a * b * (a * b + k_3) / (MASS * (MASS * GRAVITY - a**2 * b / MASS * GOAL[2]))
    depths = [BETWEEN, Fraction(0), Fraction(0), BETWEEN, Fraction(0), BETWEEN]
    value = quadratic_form(_sigma(MASS, GAINS, GOAL, depths, f), STATE)
    met = all(printed_conditions(MASS, GRAVITY, GAINS, GOAL[2], LOW, HIGH).values())
    energy = sum(x * x for x in STATE) / 2
    margin = MASS * GRAVITY / (a**2 * b) - 2 * GOAL[2]
    allowed = met and margin > 0 and energy < margin**2 / 2
    point = exact_point(
        m=MASS,
        g=GRAVITY,
        gains=list(GAINS),
        q_star=list(GOAL),
        eigenvalues=[LOW, HIGH],
        Q=f"{BETWEEN} I",
        T=MASS * GRAVITY,
        X=list(STATE),
        XSigmaX=value,
    )
    return allowed, value, point


def _refuted_by_growth(claim: Claim, reason: str, derived: Words) -> Judgement:
    allowed, value, point = _growing()
    if not allowed or value >= 0:
        return claim.judged(Verdict.UNPROVED, "the counterexample fails")
    return claim.judged(Verdict.FALSE, reason, derived, counterexample=point)


def _judge_conditions(claim: Claim) -> Judgement:
    return _refuted_by_growth(
        claim,
        "gains that meet all of them, with k4 = 1/1000, have XᵀΣX < 0 (k4 > 0 is not enough)",
        Words(
            "no such conditions: decide Σ over the whole region, as `certify` does", r"\Sigma > 0"
        ),
    )


def _judge_exponential(claim: Claim) -> Judgement:
    return _refuted_by_growth(
        claim,
        "at a state that meets every condition, (33) included, m L̇ = -XᵀΣX > 0; "
        "true where Σ is certified and while Q stays in its bounds",
        Words(
            "if Σ ⪰ t I over the region: L̇ ≤ -(2t/m) L while Q and T stay in it",
            r"\dot{\mathcal{L}} \le -\tfrac{2t}{m}\mathcal{L}",
        ),
    )


K1_PRINTED = Equation(k1**2, number(2) * m * g * q3_star / k2, "<")
K1_DERIVED = Equation(k1**2, m**2 * g / (number(2) * k2 * q3_star), "<")


def _judge_k1(claim: Claim) -> Judgement:
    """The condition is there to make m g > 2 c q3*; prove what that means for k1."""
    world, _ = FREE()
    gap = (K1_DERIVED.right.value(world) - world["k1"] ** 2) * 2 * world["k2"] * world["q3*"]
    wanted = (m * g - number(2) * c * q3_star).value(world) * world["m"]
    fault = K1_PRINTED.unit_fault()
    if not fault or K1_DERIVED.unit_fault() or not prove_equal(gap, wanted):
        return claim.judged(Verdict.UNPROVED, "the corrected condition was not proved")
    return claim.judged(
        Verdict.CORRECTED,
        f"units: {fault}; what is needed is m g > 2 (k1² k2/m) q3*",
        K1_DERIVED,
    )


def _judge_33(claim: Claim) -> Judgement:
    """Units of the bracket; then, with √(2L) replaced by the proved 2√L, a smaller level."""
    from_weight, goal_part = m * g / (k1**2 * k2), number(2) * q3_star
    fault = Equation(from_weight, goal_part).unit_fault()
    counterexample = _level_counterexample()
    if not fault or Equation(m * g / c, goal_part).unit_fault() or counterexample is None:
        return claim.judged(Verdict.UNPROVED, "units or counterexample are not as expected")
    return claim.judged(
        Verdict.CORRECTED,
        "units: m g/(k1² k2) is in "
        f"{from_weight.unit()}, so m is missing; and ¼ stands for ½, as |F| <= 2c√L",
        Words(
            "L(0) < ¼ (m² g/(k1² k2) - 2 |q*|)²",
            r"\mathcal{L}(0) < \tfrac14\left(\frac{m^2g}{k_1^2k_2} - 2|q^*|\right)^2",
        ),
        difference="printed ½ and m g/(k1² k2); derived ¼ and m² g/(k1² k2)",
        counterexample=counterexample,
    )


def _level_counterexample() -> dict[str, str] | None:
    """Give a level that (33) allows as printed, with m g - c√(2L) < 2c|q*|, decided exactly."""
    mass, gravity, level, goal = _exact(Fraction(1, 2), 10, 4, 1)
    product = Fraction(1)  # k1² k2
    stiffness = product / mass
    printed = level < (mass * gravity / product - 2 * goal) ** 2 / 2
    root_below, _ = sqrt_enclosure(2 * level)
    broken = mass * gravity - stiffness * root_below < 2 * stiffness * goal
    if not (printed and broken):
        return None
    return exact_point(m=mass, g=gravity, k1=1, k2=1, q_star=[0, 0, goal], level=level)


def _force_is_error_difference() -> bool:
    return bool(proof_of(Equation(F, c * (d3 - d2)), FREE))


def _judge_thrust_by_errors(claim: Claim) -> Judgement:
    """|T - m g| <= |F| = c|δ3 - δ2|; at δ2 = δ3 = 0 all sides are equal, so < fails."""
    if not _force_is_error_difference():
        return claim.judged(Verdict.UNPROVED, "F = c (δ3 - δ2) was not proved")
    return claim.judged(
        Verdict.CORRECTED,
        "<= is right, not <: F = c (δ3 - δ2) is proved, and at rest in hover all sides are m g",
        Words(
            "m g - c (|δ2| + |δ3|) <= T <= m g + c (|δ2| + |δ3|), c = k1² k2/m, T > 0",
            r"mg - c(|\delta_2|+|\delta_3|) \le T \le mg + c(|\delta_2|+|\delta_3|)",
        ),
        counterexample=exact_point(delta2=_exact(0, 0, 0), delta3=_exact(0, 0, 0), T="m g"),
    )


def _judge_thrust_by_level(claim: Claim) -> Judgement:
    """δ2 = (0, 0, 1) = -δ3, δ1 = δ4 = 0: T - m g = 2c but c√(2L) = √2 c."""
    level = Fraction(1)  # L = ½(1 + 1)
    distance = Fraction(2)  # |T - m g| / c = |δ3 - δ2|
    if not _force_is_error_difference() or not distance**2 > 2 * level:
        return claim.judged(Verdict.UNPROVED, "the counterexample fails")
    return claim.judged(
        Verdict.CORRECTED,
        "factor: |δ2| + |δ3| reaches 2√L, not √(2L)",
        Words(
            "m g - 2c√L <= T <= m g + 2c√L",
            r"mg - 2c\sqrt{\mathcal{L}} \le T \le mg + 2c\sqrt{\mathcal{L}}",
        ),
        difference="printed √(2L); derived 2√L",
        counterexample=exact_point(
            delta1=_exact(0, 0, 0),
            delta2=_exact(0, 0, 1),
            delta3=_exact(0, 0, -1),
            delta4=_exact(0, 0, 0),
            L=level,
            T="m g + 2c",
        ),
    )


def _judge_start_thrust(claim: Claim) -> Judgement:
    counterexample = _level_counterexample()
    if counterexample is None:
        return claim.judged(Verdict.UNPROVED, "the counterexample fails")
    return claim.judged(
        Verdict.CORRECTED,
        "it does not follow from (33) as printed; it does with 2√L for √(2L) and (33) corrected",
        Words(
            "2c|q*| < m g - 2c√L0 <= T0 <= m g + 2c√L0",
            r"2c|q^*| < mg - 2c\sqrt{\mathcal{L}_0} \le T_0 \le mg + 2c\sqrt{\mathcal{L}_0}",
        ),
        difference="printed √(2L0) and strict bounds; derived 2√L0",
        counterexample=counterexample,
    )


K3_TEX = (
    r"k_3 > \frac{(k_2+\lambda_{\max})(\lambda_{\max}+f(T_{\min})|q^*|)^2}"
    r"{\lambda_{\min}(k_2-\lambda_{\max})}"
)

THEOREM = [
    statement("k1", "condition on k1, squared", K1_PRINTED, _judge_k1),
    statement(
        "conditions",
        "sufficient conditions on k1…k4",
        Words(
            "k1 > 0, k2 > λmax, k3 > (k2 + λmax) (λmax + f(Tmin) |q*|)²/(λmin (k2 - λmax)), k4 > 0 "
            "=> Σ > 0",
            rf"k_1 > 0,\ k_2 > \lambda_{{\max}},\ {K3_TEX},\ k_4 > 0 \Rightarrow \Sigma > 0",
        ),
        _judge_conditions,
    ),
    statement(
        "33",
        "the level at the start",
        Words(
            "L(0) < ½ (m g/(k1² k2) - 2 q3*)²",
            r"\mathcal{L}(0) < \tfrac12\left(\frac{mg}{k_1^2k_2} - 2q_3^*\right)^2",
        ),
        _judge_33,
    ),
    statement(
        "T by errors",
        "bound of the thrust by the errors",
        Words(
            "m g - (k1² k2/m) (|δ2| + |δ3|) < T < m g + (k1² k2/m) (|δ2| + |δ3|)",
            r"mg - \tfrac{k_1^2k_2}{m}(|\delta_2|+|\delta_3|) < T < "
            r"mg + \tfrac{k_1^2k_2}{m}(|\delta_2|+|\delta_3|)",
        ),
        _judge_thrust_by_errors,
    ),
    statement(
        "T by L",
        "bound of the thrust by the level",
        Words(
            "m g - (k1² k2/m) √(2L) < T < m g + (k1² k2/m) √(2L)",
            r"mg - \tfrac{k_1^2k_2}{m}\sqrt{2\mathcal{L}} < T < "
            r"mg + \tfrac{k_1^2k_2}{m}\sqrt{2\mathcal{L}}",
        ),
        _judge_thrust_by_level,
    ),
    statement(
        "T0",
        "bound of the thrust at the start",
        Words(
            "2 (k1² k2/m) |q*| < m g - (k1² k2/m) √(2L0) < T0 < m g + (k1² k2/m) √(2L0)",
            r"2\tfrac{k_1^2k_2}{m}|q^*| < mg - \tfrac{k_1^2k_2}{m}\sqrt{2\mathcal{L}_0} < T_0 < "
            r"mg + \tfrac{k_1^2k_2}{m}\sqrt{2\mathcal{L}_0}",
        ),
        _judge_start_thrust,
    ),
    statement(
        "theorem",
        "L is exponentially decreasing",
        Words(
            "under the conditions on k1…k4 and (33), L is exponentially decreasing",
            r"\mathcal{L}(t) \le e^{-rt}\mathcal{L}(0)",
        ),
        _judge_exponential,
    ),
]
