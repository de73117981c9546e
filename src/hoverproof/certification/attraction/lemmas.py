"""The second ledger: the lemmas behind a region of attraction, each with its proof.

Whatever is an identity is proved in `identities` from the derived model, all parameters symbolic;
an inequality is reduced to an identity whose sign can be seen, or proved in words.
"""

from __future__ import annotations

from hoverproof.certification.attraction import identities
from hoverproof.certification.lemma import Lemma

LEMMAS = (
    Lemma(
        "W",
        "the natural potential",
        "Let 0 < q3* < n and the points not all on one vertical line. G(ξ) = Σ |P'ᵢ - ξ| + q3* z "
        "is least at exactly one point ξ*. W = G - G(ξ*) is convex, W > 0 but at ξ*, and its level "
        "sets are compact. Where ξ is no target point, W is smooth, its Hessian is Q, its gradient "
        "is -Re, e = q - q3* ρ, and W' = -eᵀV along the motion. If ξ* is no target point, it is "
        "the only one from which a level camera sees q = q3* e3; if it is one, no level camera "
        "sees that.",
        "G is convex and continuous, and G ≥ (n - q3*)|ξ| - Σ |P'ᵢ|: so it has a minimum, and its "
        "level sets are compact. Were it least at two points, it would be so on the segment "
        "between them, of direction x; take a ξ of that which is no target point. There ∇G = 0, so "
        "the unit vectors along the rays from ξ add up to q3* e3; and xᵀQx = Σ |pᵢ × x|²/rᵢ = 0, "
        "so all rays are along x. As q3* e3 ≠ 0, x is vertical, and all points are on one vertical "
        "line, which is excluded. Off the target points, a level camera sees q3* e3 just where ∇G "
        "= 0, and a convex G is least there.",
        identities.potential,
    ),
    Lemma(
        "height",
        "the part qz of the centroid",
        "Let h be the height of ξ above a target point, r its distance and d that from the "
        "vertical line through the point. Where r > 0, h/r does not fall as h grows with d fixed. "
        "So, if z ≥ z_s and ξ is no target point, qz(ξ) = Σ hᵢ/rᵢ is at most the sum of hᵢ/√(hᵢ² + "
        "dᵢ²) over the points deeper than z_s, hᵢ > 0 taken at z_s.",
        "If d > 0, h/r grows with h, by the identity. On the point's own vertical line, d = 0, it "
        "is -1 below the point and 1 above it: it jumps where it is not defined, and it jumps "
        "upward. So a term with hᵢ > 0 at z is at most what it is at z_s ≤ z, where hᵢ is larger; "
        "a term with hᵢ ≤ 0 at z is at most 0.",
        identities.height,
    ),
    Lemma(
        "slope",
        "how fast Q changes with the position",
        "Along a unit vector h the derivative of (I - ppᵀ)/r has norm at most (2/√3)/r².",
        "Its eigenvalues times r² are α = pᵀh, |α| ≤ 1, and the roots μ of μ² - α μ - (1 - α²), "
        "real as D is symmetric; by the last identity 3μ² ≤ 4.",
        identities.slope,
    ),
    Lemma(
        "tilt",
        "force, thrust and tilt",
        "With F = c(δ3 - δ2), η = δ1 - e = (q3* c/(m g)) (P - e3 θᵀ)(δ3 - δ2), θ = Pρ/(1 + ρ3), "
        "|θ| = tan(φ/2). While T > 0 and |F| < m g: |T - m g| <= |F|, sin φ <= |F|/(m g), φ < 90°.",
        "|F|² is (T - m g)² plus a term that is not negative. If ρ3 <= 0, that term is at least 2 "
        "T m g, so |F|² >= T² + (m g)², against |F| < m g. Hence ρ3 > 0, φ < 90°. |Pρ| = sin φ, "
        "and P F = m g Pρ gives the rest.",
        identities.tilt,
    ),
    Lemma(
        "loop",
        "the closed loop",
        "For an axial goal, and any yaw rate Ω3, with v = δ1 + δ2 = (m/k1) V, "
        "m δ2' = -m Ω×δ2 + k1 Q v - k1 k2 δ2 + k1 k2 δ3 - k1 f q3* P(δ4 - δ3), "
        "m δ3' = -m Ω×δ3 + k1 Q v - k1 k2 δ2 + (k1 k2 + k3) δ4 - k3 δ3, "
        "m δ4' = k1 P Q v - (k1 k2 + k3) Pδ3 - k4 δ4.",
        "By differentiation along the derived closed loop.",
        identities.closed_loop,
    ),
    Lemma(
        "form",
        "the derivative of Λ",
        "For Λ = W + ½(a2|δ2|² + a3|δ3|² + a4|δ4|²) and K = (k1 k2 + k3)/k1, "
        "-(m/k1) Λ' = eᵀv + a2 [k2|δ2|² - k2 δ2ᵀδ3 + f q3* δ2ᵀP(δ4 - δ3) - δ2ᵀQv] "
        "+ a3 [k2 δ3ᵀδ2 - K δ3ᵀδ4 + (k3/k1)|δ3|² - δ3ᵀQv] "
        "+ a4 [K δ4ᵀδ3 + (k4/k1)|δ4|² - δ4ᵀQv], v = e + η + δ2: a quadratic form of "
        "Y = (e, δ2, δ3, δ4), whatever Ω is.",
        "By differentiation; the terms in Ω drop out.",
        identities.quadratic_form,
    ),
    Lemma(
        "Q",
        "one bilinear form in Q",
        "For symmetric Q with eigenvalues in [0, λ] and any τ > 0, "
        "uᵀQv >= (λ/2)(uᵀv - ½(τ|v|² + |u|²/τ)).",
        "Q = (λ/2)(I + H), |H| <= 1, and uᵀHv >= -|u||v| >= -½(τ|v|² + |u|²/τ).",
        identities.bilinear,
    ),
    Lemma(
        "corners",
        "corners suffice",
        "If the form minus ε|Y|² is positive for every Q in [0, λ], at both ends of f and q3* (all "
        "four pairs), and at the one tilt θ = (t, 0), it is so for all f and q3* between and all "
        "|θ| <= t.",
        "A turn about e3 carries θ = (t, 0) to any θ with |θ| = t, and the set of all Q to itself. "
        "For fixed Q the form is affine in each of f, q3*, θ, and a disc is the hull of its edge.",
        lambda: identities.convexity() | identities.symmetry(),
    ),
    Lemma(
        "factor",
        "the factor f(T), and the body rates",
        "For T > c q3* > 0, f(T) falls with T and grows with q3*, and δ4 - Pδ3 tells the rates of "
        "roll and pitch: |δ4 - Pδ3| = (m/(c (k1 k2 + k3))) (T - c q3*) √(Ω1² + Ω2²).",
        "By the signs of the derivatives, as f > 0. |e3 × Ω|² = Ω1² + Ω2².",
        identities.factor,
    ),
    Lemma(
        "sums",
        "what a level bounds",
        "If a|x|² + b|y|² <= 2ℓ then |s x + t y| <= √(2ℓ(s²/a + t²/b)).",
        "Apply the identity to |s||x| + |t||y|.",
        identities.weighted_sums,
    ),
    Lemma(
        "z",
        "the vertical motion",
        "With κ = (k1 k2 + k3)/m, N = z + (m/(k1 k2))(z' + z''/κ) obeys N' = (k1/m) w, "
        "w = ρᵀq - q3* cos φ + (Pρ)ᵀ[(1 + γ) δ4 - γ Pδ3], γ = c q3*/(T - c q3*), ρᵀq = qz. "
        "While Λ <= ℓ, T >= T₋ > c q3* and φ <= φ̄ < 90°: w <= qz - q3* + ω with "
        "ω = q3*(1 - cos φ̄) + sin φ̄ √(2ℓ((1 + γ)²/a4 + γ²/a3)), γ taken at T₋.",
        "By differentiation. w - qz + q3* is at most q3*(1 - cos φ) + |Pρ|((1 + γ)|δ4| + γ|δ3|), "
        "where |Pρ| = sin φ, and a3|δ3|² + a4|δ4|² <= 2ℓ as W >= 0, so the lemma on sums gives ω "
        "with φ and T in the place of φ̄ and T₋. It grows with γ > 0, and γ falls as T grows; it "
        "grows with φ, as 1 - cos φ and sin φ do up to 90°.",
        identities.vertical,
    ),
    Lemma(
        "barrier",
        "nothing sinks below the barrier",
        "Let k3 >= 3 k1 k2, let r <= s be the roots of x² - κ x + κ k1 k2/m, and let "
        "D1 >= (k1/m) w_max/s, D2 >= s D1/r, w_max > 0, z_b = z_s + D1 + D2. Let z <= z_b, "
        "x = z + z'/r <= z_b, N <= z_b, N - x <= D1 and x - z <= D2 at the start, and on the way "
        "w <= w_max, and w <= 0 wherever z >= z_s. Then these five bounds hold on the way. "
        "At rest, z' = z'' = 0, N = x = z, and the least lags will do: D1 + D2 = w_max/k2.",
        "As κ >= 4 k1 k2/m, the roots are real, and positive. (N - x)' <= 0 where N - x >= D1, so "
        "N - x stays at most D1; then x - z stays at most D2 likewise. If N were above z_b at some "
        "time, let t0 be the last time before at which N = z_b: from then on N > z_b, so "
        "z = N - (N - x) - (x - z) > z_s, so N' <= 0, and N could not have grown. "
        "x' <= 0 where x >= z_b >= N, so x stays at most z_b; z follows x likewise.",
        identities.cascade,
    ),
    Lemma(
        "sinking",
        "the motion in world axes",
        "With Ω3 = 0, b = R e3, w = b', D = T - c q3*, κ = (k1 k2 + k3)/m: T' = κ(c bᵀy - D), "
        "w' = (cκ/D)(I - bbᵀ)a - |w|² b - h w, y = (m g/c) e3 + (m/k1) ξ' - Rq, "
        "a = (m g/k1) e3 + (κ + k4/m) y, h = (T' + cκ bᵀy)/D + k4/m; no heading is in it.",
        "Seen from the body, b is e3, w is Ω × e3 and w' is d(Ω × e3)/dt + Ω × (Ω × e3).",
        identities.sinking,
    ),
    Lemma(
        "hover",
        "a level hover",
        "In a level hover with T = m g, Λ = W + ½((a2 + a3)|δ1|² + a4|Pδ1|²), δ1 = q - q*.",
        "δ2 = δ3 = -δ1 and δ4 = -Pδ1 there.",
        identities.hover,
    ),
    Lemma(
        "starts",
        "a start that moves",
        "Let |V| <= v, φ <= φ0, √(Ω1² + Ω2²) <= ω0, |T - m g| <= τ0 < m g - c q3*, and let "
        "q_w = Rq = Σ (P'ᵢ - ξ)/rᵢ be what a level camera sees. Then |δ1| <= |q_w - q*| + q3* φ0, "
        "|δ2| <= (m/k1) v + |δ1|, |F| <= τ0 + m g φ0, |δ3| <= |F|/c + |δ2|, "
        "|Pδ3| <= (m g/c) φ0 + (m/k1) v + |P q_w| + n φ0, and |δ4| is at most the bound of |Pδ3| "
        "plus (m/(c (k1 k2 + k3)))(m g + τ0 - c q3*) ω0; |z'| <= v and |z''| <= |F|/m.",
        "Two unit vectors at an angle φ are 2 sin(φ/2) <= φ apart. R turns e3 by φ: "
        "|δ1| = |q_w - q3* R e3|, |R e3 - e3| <= φ, |ρ - e3| <= φ, |Pρ| = sin φ <= φ. R = R₂ R₁, "
        "where R₁ turns about e3 and R₂ by φ about a horizontal axis. q = R₁ᵀ R₂ᵀ q_w, and R₁ does "
        "not change the length of a P-part, so |P q| = |P R₂ᵀ q_w| <= |P q_w| + φ |q_w|, "
        "|q_w| <= n. The last term of δ4 is that of the lemma on the factor, with "
        "0 < T - c q3* <= m g + τ0 - c q3*. z' = (R V)₃ and z'' = (R F)₃/m.",
        identities.starts,
    ),
)
