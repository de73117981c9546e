"""The symbols of the paper, and their units; what they stand for is in `worlds`."""

from __future__ import annotations

from fractions import Fraction

from hoverproof.paper.notation import Formula, Number, Skew, SquaredNorm, Symbol
from hoverproof.paper.units import Unit

ONE = Unit()
KG, M, S = Unit(kg=Fraction(1)), Unit(m=Fraction(1)), Unit(s=Fraction(1))
NEWTON = KG * M / S**2


def number(value: int | Fraction) -> Number:
    """Return an exact number as a formula.

    Parameters
    ----------
    value : int or Fraction
        An exact number.
    """
    return Number(Fraction(value))


def sk(a: Formula) -> Formula:
    """Return sk(a).

    Parameters
    ----------
    a : Formula
    """
    return Skew(a)


def sq(a: Formula) -> Formula:
    """Return |a|².

    Parameters
    ----------
    a : Formula
    """
    return SquaredNorm(a)


m, g = Symbol("m", "m", KG), Symbol("g", "g", M / S**2)
k1, k2 = Symbol("k1", "k_1", KG * M / S), Symbol("k2", "k_2", M**-1)
k3, k4 = Symbol("k3", "k_3", KG / S), Symbol("k4", "k_4", KG / S)
k_Omega = Symbol("kΩ", r"k_\Omega", KG * M**2 / S)
inertia = Symbol("𝐈", r"\mathbf{I}", KG * M**2)
inertia_inverse = Symbol("𝐈⁻¹", r"\mathbf{I}^{-1}", KG**-1 * M**-2)
q, q_star = Symbol("q", "q", ONE), Symbol("q*", "q^*", ONE)
q3_star = Symbol("q3*", "q_3^*", ONE)
Q = Symbol("Q", "Q", M**-1)
V, Omega = Symbol("V", "V", M / S), Symbol("Ω", r"\Omega", S**-1)
Omega3 = Symbol("Ω3", r"\Omega_3", S**-1)
V_rate, Omega_rate = Symbol("V̇", r"\dot V", M / S**2), Symbol("Ω̇", r"\dot\Omega", S**-2)
q_rate = Symbol("q̇", r"\dot q", S**-1)
R_T_e3 = Symbol("Rᵀe3", "R^Te_3", ONE)
e3, pi, identity_matrix = (
    Symbol("e3", "e_3", ONE),
    Symbol("π", r"\pi_{e_3}", ONE),
    Symbol("I", "I", ONE),
)
F, T = Symbol("F", "F", NEWTON), Symbol("T", "T", NEWTON)
T_rate, U = Symbol("Ṫ", r"\dot T", NEWTON / S), Symbol("U", "U", NEWTON / S)
Gamma = Symbol("Γ", r"\Gamma", NEWTON * M)
Gamma3 = Symbol("Γ3", r"\Gamma_3", NEWTON * M)
d1, d2 = Symbol("δ1", r"\delta_1", ONE), Symbol("δ2", r"\delta_2", ONE)
d3, d4 = Symbol("δ3", r"\delta_3", ONE), Symbol("δ4", r"\delta_4", ONE)
d1_rate, d2_rate = Symbol("δ̇1", r"\dot\delta_1", S**-1), Symbol("δ̇2", r"\dot\delta_2", S**-1)
d3_rate, d4_rate = Symbol("δ̇3", r"\dot\delta_3", S**-1), Symbol("δ̇4", r"\dot\delta_4", S**-1)
f, A = Symbol("f(T)", "f(T)", M**-1), Symbol("A", "A", ONE)
L, L_rate = Symbol("L", r"\mathcal{L}", ONE), Symbol("L̇", r"\dot{\mathcal{L}}", S**-1)
d1_square_rate = Symbol("d|δ1|²/dt", r"\tfrac{d}{dt}|\delta_1|^2", S**-1)
