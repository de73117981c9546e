"""What the paper claims beyond its equations: bounds, conditions, the theorem, the example."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import casadi as ca

from hoverproof.algebra.decimals import written
from hoverproof.algebra.definite import is_positive_definite
from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.mission.reading import load
from hoverproof.mission.sections import Mission
from hoverproof.paper.conditions import k3_limit, printed_conditions
from hoverproof.paper.equations import FREE
from hoverproof.paper.judge import (
    Claim,
    Judgement,
    Verdict,
    Words,
    exact_point,
    statement,
    witness,
)
from hoverproof.paper.symbols import F, k1, k2, m
from hoverproof.paper.worlds import closed_loop_no_yaw
from hoverproof.plant import camera

Point = Sequence[Fraction]


# --- the image ----------------------------------------------------------------------------------


def _judge_positive_q(claim: Claim) -> Judgement:
    """Prove xᵀQx = |p × x|²/r for one point, and Q e3 = 0 for two points on one ray."""
    point, x, r = ca.SX.sym("P", 3), ca.SX.sym("x", 3), ca.SX.sym("r")
    roots = {r: ca.dot(point, point)}
    turned = ca.cross(point / r, x)
    form = x.T @ camera.depth_matrix(point) @ x
    square = prove_equal(form, ca.dot(turned, turned) / r, roots)
    below = ca.DM(camera.depth_matrix(ca.SX([[0, 0], [0, 0], [1, 2]])))[:, 2]
    if not square or not below.is_zero():
        return claim.judged(Verdict.UNPROVED, "xᵀQx = Σ |pᵢ × x|²/rᵢ was not proved")
    return claim.judged(
        Verdict.HOLDS,
        "proved: xᵀQx = Σ |pᵢ × x|²/rᵢ, so Q > 0 unless all points are in line with the camera",
        Words("Q > 0 if the points are not all in line with the camera", r"Q > 0"),
    )


def _judge_bounded_q(claim: Claim) -> Judgement:
    return claim.judged(Verdict.CONVENTION, "an assumption about where the vehicle flies")


def _judge_equilibrium(claim: Claim) -> Judgement:
    """F = 0 gives T e3 = m g Rᵀe3, so T = ±m g; a magnitude is not negative."""
    world, _ = FREE()
    force = world["F"]
    down = world["m"] * world["g"] * world["Rᵀe3"] - world["T"] * world["e3"]
    weight = world["m"] * world["g"]
    for sign in (1, -1):
        there = ca.substitute(
            ca.substitute(force, world["T"], sign * weight), world["Rᵀe3"], sign * world["e3"]
        )
        if not prove_zero(there):
            return claim.judged(Verdict.UNPROVED, "the equilibrium was not confirmed")
    if not prove_equal(force, down):
        return claim.judged(Verdict.UNPROVED, "F is not m g Rᵀe3 - T e3")
    return claim.judged(
        Verdict.HOLDS, "as T is a magnitude; T = -m g with R e3 = -e3 would be another solution"
    )


def _judge_no_depth(claim: Claim) -> Judgement:
    world = closed_loop_no_yaw()
    control = ca.vertcat(world["U"], world["Γ"])
    depths = ca.vertcat(*ca.symvar(world["Q"]))
    if ca.depends_on(control, depths):
        return claim.judged(Verdict.FALSE, "Q is in the control")
    return claim.judged(Verdict.HOLDS, "the graph of U and Γ contains no entry of Q")


# --- Σ ------------------------------------------------------------------------------------------


def _judge_sigma(claim: Claim) -> Judgement:
    """Compare XᵀΣX with -L̇ as printed, and with -m L̇ when the upper blocks are transposed."""
    world = closed_loop_no_yaw()
    Q, fA = world["Q"], world["f(T)"] * world["A"]
    k_1, k_2 = world["k1"], world["k2"]
    M, N = Q - fA.T, Q + fA.T
    unit, zero, half = ca.SX.eye(3), ca.SX.zeros(3, 3), -k_1 / 2
    X = ca.vertcat(*(world[f"δ{i}"] for i in range(1, 5)))

    def form(upper_m: ca.SX, upper_n: ca.SX) -> ca.SX:
        rows = [
            [k_1 * Q, zero, half * upper_m, half * upper_n],
            [zero, k_1 * (k_2 * unit - Q), half * upper_n, half * upper_m],
            [half * M, half * N, world["k3"] * unit, zero],
            [half * N, half * M, zero, world["k4"] * unit],
        ]
        return X.T @ ca.vertcat(*(ca.horzcat(*row) for row in rows)) @ X

    printed = prove_equal(-world["L̇"], form(M, N))
    scaled = prove_equal(-world["m"] * world["L̇"], form(M, N))
    corrected = prove_equal(-world["m"] * world["L̇"], form(M.T, N.T))
    if printed:
        return claim.judged(Verdict.HOLDS, "proved, all parameters symbolic")
    if not corrected:
        return claim.judged(Verdict.UNPROVED, "no proof of the printed or the corrected form")
    transposed = "" if scaled else "; the blocks above the diagonal are Mᵀ and Nᵀ"
    return claim.judged(
        Verdict.CORRECTED,
        f"factor: m is missing{transposed}; an equality, Ω3 = 0, M and N as printed below it",
        Words(
            "m L̇ = -XᵀΣX with Σ13 = Σ24 = -(k1/2) Mᵀ, Σ14 = Σ23 = -(k1/2) Nᵀ, "
            "Σ33 = k3 I, Σ44 = k4 π, the rest as printed",
            r"m\dot{\mathcal{L}} = -X^T\Sigma X,\quad \Sigma_{13} = \Sigma_{24} = "
            r"-\tfrac{k_1}{2}M^T,\ \Sigma_{14} = \Sigma_{23} = -\tfrac{k_1}{2}N^T",
        ),
        difference="printed L̇, M, N; derived m L̇, Mᵀ, Nᵀ above the diagonal",
        counterexample=witness(-world["L̇"], form(M, N)),
    )


def _judge_sylvester(claim: Claim) -> Judgement:
    """Prove the LDLᵀ of a general symmetric 3 x 3 matrix with ratios of minors as pivots."""
    a = ca.tril2symm(ca.SX(ca.Sparsity.lower(3), ca.SX.sym("a", 6)))
    two = a[0, 0] * a[1, 1] - a[0, 1] ** 2
    pivots = ca.vertcat(a[0, 0], two / a[0, 0], ca.det(a) / two)
    lower = ca.SX.eye(3)
    lower[1, 0], lower[2, 0] = a[1, 0] / a[0, 0], a[2, 0] / a[0, 0]
    lower[2, 1] = (a[2, 1] - a[2, 0] * a[1, 0] / a[0, 0]) / pivots[1]
    if not prove_equal(lower @ ca.diag(pivots) @ lower.T, a):
        return claim.judged(Verdict.UNPROVED, "LDLᵀ was not proved")
    return claim.judged(
        Verdict.HOLDS, "Sylvester's criterion; LDLᵀ with ratios of minors, proved for any 3 x 3"
    )


def _judge_norm(claim: Claim) -> Judgement:
    """Prove |q*|²|x|² - |Aᵀx|² = (q*·x)² + (e3·(q* × x))²."""
    q, x = ca.SX.sym("q", 3), ca.SX.sym("x", 3)
    e3 = ca.SX([0, 0, 1])
    turned = (-ca.skew(q) @ ca.skew(e3)).T @ x
    gap = ca.dot(q, q) * ca.dot(x, x) - ca.dot(turned, turned)
    squares = ca.dot(q, x) ** 2 + ca.dot(e3, ca.cross(q, x)) ** 2
    if not prove_equal(gap, squares):
        return claim.judged(Verdict.UNPROVED, "the sum of squares was not proved")
    return claim.judged(
        Verdict.HOLDS,
        "‖AAᵀ‖^½ <= |q*|: the gap |q*|²|x|² - |Aᵀx|² is a sum of squares; equal for q* along e3",
    )


# --- the example --------------------------------------------------------------------------------


def _paper_mission() -> tuple[Mission, Fraction, Fraction]:
    """Return the mission of the paper, and its bounds of the eigenvalues of Q, 1/m."""
    mission = load("x4-flyer")
    if not isinstance(mission.bounds.eigenvalues, tuple):
        raise TypeError("the paper assumes its bounds")
    return mission, *mission.bounds.eigenvalues


def _judge_gain_units(claim: Claim) -> Judgement:
    """The unit of k2 follows from δ3 having none."""
    unit = (m * F / k1**2).unit()
    agrees = unit == k2.unit()
    if not agrees or str(unit) == "kg^-1":
        return claim.judged(Verdict.UNPROVED, "the units are not as expected")
    return claim.judged(
        Verdict.CORRECTED,
        f"units: k2 is in {unit}, as k1² k2/m is a force; k1, k3 and k4 are as printed",
        Words("k2 = 10 m⁻¹", r"k_2 = 10\ \mathrm{m}^{-1}"),
        difference="printed kg⁻¹; derived m⁻¹",
    )


def _judge_paper_gains(claim: Claim) -> Judgement:
    """The condition on k3 at the paper's numbers; f(Tmin)|q*| = (k1 k2 + k3)/k1 for axial q*."""
    mission, low, high = _paper_mission()
    v, k = mission.vehicle, mission.gains
    gains = [k.k1, k.k2, k.k3, k.k4]
    met = printed_conditions(v.mass, v.gravity, gains, Fraction(1), low, high)
    needed = k3_limit(k.k1, k.k2, k.k3, Fraction(1), Fraction(1), low, high)
    if met["k3"] or not k.k3 < needed:
        return claim.judged(Verdict.UNPROVED, "the condition on k3 holds")
    return claim.judged(
        Verdict.FALSE,
        f"the condition on k3 asks for more than {written(needed, 3)} kg/s, not {float(k.k3):g}; "
        "it is not needed either: see `hoverproof certify x4-flyer`",
        counterexample=exact_point(k3=k.k3, needed=needed),
    )


def _judge_start_eigenvalues(claim: Claim) -> Judgement:
    """Enclose Q at the start and decide λ- I ≺ Q ≺ λ+ I exactly."""
    mission, low, high = _paper_mission()
    middle = [[Fraction(0)] * 3 for _ in range(3)]
    radius = Fraction(0)
    for point in mission.target.points:
        ray = [a - b for a, b in zip(point, mission.start.position, strict=True)]
        square = sum((x * x for x in ray), Fraction(0))
        ends = [1 / r for r in sqrt_enclosure(square)]
        inverse = (ends[0] + ends[1]) / 2
        radius += abs(ends[0] - ends[1])  # |I - ppᵀ| <= 1, so each term errs by less than this
        for i in range(3):
            for j in range(3):
                middle[i][j] += inverse * (Fraction(int(i == j)) - ray[i] * ray[j] / square)
    n = range(3)
    above = [[middle[i][j] - (low + radius if i == j else 0) for j in n] for i in n]
    below = [[(high - radius if i == j else 0) - middle[i][j] for j in n] for i in n]
    if not (is_positive_definite(above) and is_positive_definite(below)):
        return claim.judged(Verdict.UNPROVED, "Q at the start is not shown to be inside")
    return claim.judged(
        Verdict.HOLDS, "proved for a square of side 2 m; the paper gives no size for its square"
    )


SIGMA_TEX = (
    r"\dot{\mathcal{L}} \le -X^T\Sigma X,\quad \Sigma = \begin{pmatrix} "
    r"k_1Q & 0 & -\frac{k_1}{2}M & -\frac{k_1}{2}N \\ "
    r"0 & k_1(k_2I-Q) & -\frac{k_1}{2}N & -\frac{k_1}{2}M \\ "
    r"-\frac{k_1}{2}M & -\frac{k_1}{2}N & k_3 & 0 \\ "
    r"-\frac{k_1}{2}N & -\frac{k_1}{2}M & 0 & k_4 \end{pmatrix},\ "
    r"M = Q - f(T)A^T,\ N = Q + f(T)A^T"
)

CLAIMS = [
    statement("Q > 0", "Q is positive definite", Words("Q > 0", "Q > 0"), _judge_positive_q),
    statement(
        "12",
        "bounds of the eigenvalues of Q",
        Words("λmin < λᵢ(Q) < λmax", r"\lambda_{\min} < \{\lambda_i(Q)\} < \lambda_{\max}"),
        _judge_bounded_q,
    ),
    statement(
        "no depth",
        "the control needs no depth",
        Words("U and Γ do not contain Q", r"U, \Gamma \text{ do not contain } Q"),
        _judge_no_depth,
    ),
    statement(
        "19",
        "hover is the only rest",
        Words("-T e3 + m g Rᵀe3 = 0 => R e3 = e3, T = m g", r"Re_3 = e_3,\quad T = mg"),
        _judge_equilibrium,
    ),
    statement(
        "Σ",
        "derivative of L as a quadratic form",
        Words(
            "L̇ <= -XᵀΣX, Σ = [k1 Q, 0, -(k1/2) M, -(k1/2) N; 0, k1 (k2 I - Q), -(k1/2) N, "
            "-(k1/2) M; -(k1/2) M, -(k1/2) N, k3, 0; -(k1/2) N, -(k1/2) M, 0, k4], "
            "M = Q - f(T) Aᵀ, N = Q + f(T) Aᵀ",
            SIGMA_TEX,
        ),
        _judge_sigma,
    ),
    statement(
        "minors",
        "Σ is positive definite iff its principal minors are positive",
        Words("Σ > 0 iff the principal minors are positive", r"\Sigma > 0"),
        _judge_sylvester,
    ),
    statement(
        "‖AAᵀ‖^½",
        "the norm in the condition on k3, replaced by |q*|",
        Words("‖AAᵀ‖^½ <= |q*|", r"\|AA^T\|^{1/2} \le |q^*|"),
        _judge_norm,
    ),
    statement(
        "units of gains",
        "units of the gains in the example",
        Words(
            "k1 = 0.2 kg m/s, k2 = 10 kg⁻¹, k3 = 30.5 kg/s, k4 = 3 kg/s",
            r"k_2 = 10\ \mathrm{kg}^{-1}",
        ),
        _judge_gain_units,
    ),
    statement(
        "gains",
        "these gains satisfy the conditions of the theorem",
        Words(
            "k1 = 0.2, k2 = 10, k3 = 30.5, k4 = 3 satisfy the conditions",
            r"k_1 = 0.2,\ k_2 = 10,\ k_3 = 30.5,\ k_4 = 3",
        ),
        _judge_paper_gains,
    ),
    statement(
        "start",
        "the eigenvalue bounds hold at the start",
        Words(
            "0.01 < λᵢ(Q) < 5 at ξ0 = (5, 2.5, -4) m",
            r"0.01 < \lambda_i(Q) < 5 \text{ at } \xi_0 = (5, 2.5, -4)",
        ),
        _judge_start_eigenvalues,
    ),
]
