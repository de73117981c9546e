"""What symbols mean: at the foot of an answer, beside the formulas of a report, in the manual."""

from __future__ import annotations

STATED = '"Theorems and proofs" in the documentation (proofs/README.md)'
"""Where the theorems stand with their proofs."""

SYMBOLS = {
    "Q": "3x3, from velocity to motion of the centroid in the image; holds the unknown depths",
    "J": "3x3, from velocity to motion of the scaled centroid; holds the unknown depths",
    "T": "thrust",
    "L": "Lyapunov function of theorem 1, half the weighted sum of the squared errors",
    "Σ": "11x11, decay of L: m L' = -XᵀΣX, X the errors",
    "W": "diagonal, weights of L",
    "f": "f(T) = k1 k2 (k1 k2 + k3)/(m (T - c s)), how the thrust enters Σ; c = k1² k2/m, s the "
    "third entry of what is wanted of the image, 0 if the goal is fixed to the vertical",
    "Λ": "Lyapunov function of theorem 3, for the vehicle as modelled",
    "Ψ": "Lyapunov function of theorems 5 and 6, for every vehicle within tolerance",
}
"""Of answers, in the order in which they are explained."""

IN_FORMULAS = {
    "margin": "what every eigenvalue of Σ is at least, kg/s",
    "X": "all errors, (δ1, δ2, δ3, δ4) of 3, 3, 3 and 2 entries",
    "δ2": "velocity error, (m/k1) V − δ1, V the velocity",
    "δ3": "force error, F/c + δ2, F the sum of all forces, c = k1² k2/m",
    "P": "takes the horizontal part of a vector in body axes",
    "τ": "lag of the rotors, s",
    "μ, μT": "angular acceleration and thrust rate that lagging rotors make, less what the law "
    "asks for with the present errors; scaled, 1/s",
    "τ̄": "greatest age of an image, s",
    "y": "how fast the velocity moves the feature, 1/s: J V, of the centroid Q V",
    "r": "decay rate, 1/s",
    "ξ, ξ*": "position of the vehicle and of the hover at its goal, m",
    "ρ": "unit vector down in body axes",
    "W": "sum of the distances to the target points P′, weighted as these, plus q3* z, z the depth "
    "of the vehicle; W0 is the least value of that, so that W ≥ 0",
    "h": "height above the mean of the target points",
}
"""Of formulas in a report, where they are not among those of answers or the law's own."""
