"""The third ledger: the lemmas behind convergence of every vehicle within tolerances.

As in the second one, an identity is proved from the derived model, all parameters symbolic, and an
inequality is reduced to identities, or proved in words. The goal is straight below, Ω₃ arbitrary.
"""

from __future__ import annotations

from hoverproof.certification.exponential import energy_identities, identities, noise_identities
from hoverproof.certification.lemma import Lemma

LEMMAS = (
    Lemma(
        "late",
        "an image that is late, and the memory of it",
        "In a controller that turns the feature of t - τ(t), 0 <= τ(t) <= τ̄, to now by the turn "
        "since, n, what is used less the present one, has |n|² <= τ̄ ∫ |y|² over the last τ̄. "
        "With Z = ∫_{-τ̄}^0 ∫_{t+x}^t e^{r(z-t)} |y(z)|² dz dx, for almost all t, Z' <= -r Z + "
        "τ̄|y|² - (ε/τ̄)|n|², ε = 1 - x + x²/2 - x³/6 at x = r τ̄. If |y| <= b on [t - τ̄, t], Z "
        "<= τ̄² b²/2.",
        "n = Rᵀ(t) ∫ R y over [t - τ(t), t], by the first identity, in which R is a rotation; "
        "Cauchy and Schwarz give the first bound. Z = ∫ K |y(z)|² dz over [t - τ̄, t], K = (z - t "
        "+ τ̄) e^{r(z-t)}, which is 0 at the lower end and τ̄ at the upper one: so Z' = τ̄|y|² - "
        "r Z - ∫ e^{r(z-t)}|y|² dz by the second identity, and e^{r(z-t)} >= e^{-rτ̄} there. e^x "
        "(1 - x + x²/2 - x³/6) is 1 at x = 0 and does not grow with x >= 0, by the third "
        "identity: so ε <= e^{-rτ̄}. The last claim is K <= z - t + τ̄.",
        identities.latency,
    ),
    Lemma(
        "rates",
        "how the errors of a vehicle with rotor lag move",
        "With Ω = (-h ζ turned by 90°, Ω3), U_a/c = κ δ3z + μT, η = ς U_a/D_c + p3, π = 2 h (δ3 - "
        "n)z + p3, s_n = -(κ + k4/m) δ4 - k12 P(δ3 - δ2): δ1' = -Ω×δ1 - y + s3 h ζ, δ2' = -Ω×δ2 + "
        "y + k12 (δ3 - δ2) - s3 h ζ, δ3' = -Ω×δ3 + y + k12 (δ3 - δ2) + κ χ ζ - ς (U_a/c) e3, δ4' "
        "= P y + k12 P(δ3 - δ2) + (κ χ + η + h δ3z) ζ - Ω3 e3×Pδ3 + (I + γ)(s_n + μ) - Ω3 G_t ζ, "
        "τ μ' = (κ + k4/m) P n - π ζ - μ + Ω3 e3×P(δ3 - n) + Ω3 G_c ζ + τ [η (s_n + μ) + (κ + "
        "k4/m) δ4' + k12 P(δ3' - δ2')], τ μT' = -κ nz - μT - τ κ δ3z'. With τ = 0, τ μ' = 0, τ "
        "μT' = 0 and G = (I + γ) G_c - G_t they are the rates without lag.",
        "By differentiation along the motion of the true vehicle under the derived controller.",
        identities.rates,
    ),
    Lemma(
        "upright",
        "force, thrust and tilt in the wind",
        "Let |F| <= f, |w̃| <= w, f + w < m g. T̃ > 0, T_c > 0 and ρ3 > 0 say the same; and if "
        "they hold, (m g - f)² - w² <= T_c² <= (m g + f)², and sin φ <= (f + w)/(m g), φ < 90°. "
        "With D_lo <= D_c, D_lo > 0, h <= h̄ = cκ/D_lo: |χ - 1| <= w/D_lo, |p3| <= h̄ |ζ| w/D_lo, "
        "and |(Ω×u)3| <= h̄ |ζ||Pu| for any u.",
        "Let A = F - w̃ = m g ρ - T̃ e3, |A| < m g. If T̃ > 0, the lemma on the tilt has ρ3 > 0. "
        "If ρ3 > 0 and T̃ <= 0, |A|² = (m g)² - 2 T̃ m g ρ3 + T̃² >= (m g)², against |A| < m g. "
        "If ρ3 > 0 and T_c <= 0, by the third identity F3 = m g ρ3 - T_c >= m g ρ3 >= 0 and P F = "
        "P(m g ρ + w̃), so |F| >= |m g ρ + P w̃| >= m g - w > f. If ρ3 <= 0 and T_c > 0, F3 = m g "
        "ρ3 - T_c <= m g ρ3 <= 0, and |F| > f in the same way. Hence the three say the same. The "
        "bounds of T_c are the second identity with m g - f <= |F - m g ρ| <= m g + f and 0 <= |P "
        "w̃| <= w, that of sin φ is |P A| = m g |Pρ|. The rest is read off the identities.",
        identities.upright,
    ),
    Lemma(
        "falls",
        "the derivative of E",
        "With E = ½ Σ wᵢ|δᵢ|² + ½ τ (a5|μ|² + a6 μT²), E' is a quadratic form whose coefficients "
        "are the ends of χ, h, ς, τ and π, the turns -Ω×δᵢ having dropped out, plus terms uᵀHv. "
        "Without lag, u = w4 δ4: (s, γ), (ζ, p2 - (ς - 1) p3/2 + Ω3 G), (P n, -Ω3 e3×), (P(δ3 - "
        "n), Ω3 γ e3×), as (v, H). With lag, u = w4 δ4 + τ (κ + k4/m) a5 μ: (s_n + μ, γ), (ζ, p2 "
        "- (ς - 1) p3/2 + ς (U_a - U)/D_c - Ω3 G_t); u = w4 ζ + τ (κ + k4/m) a5 μ: (Pδ3, -Ω3 "
        "e3×); u = a5 μ: (ζ, Ω3 G_c + τ k12 h (δ3 - δ2)z), (P(δ3 - n), Ω3 e3×), (P(δ3 - δ2), -τ "
        "k12 Ω3 e3×), (s_n + μ, τ η); u = a6 μT: (ζ, τ κ h (Pδ3)ᵀ).",
        "By the rates of the lemma above; δ4 = ζ + Pδ3, and (Pδ3)ᵀ(e3×Pδ3) = 0. The form is that "
        "of the derived graph.",
        energy_identities.energy,
    ),
    Lemma(
        "vertices",
        "vertices suffice",
        "For any fixed variables and multipliers, the form of the inequality is concave in each "
        "of χ, s3 h, ς, τ and π while the others are fixed. So it is positive all over a box of "
        "them if it is so at its vertices.",
        "-E' without the terms is affine in each; so is -r E. Of the terms, u is affine in τ and "
        "v in π, and -½(t|v|² + |u|²/t) is concave in u and in v; the radii are the same all over "
        "the box. h stands in it only where it is multiplied by s3. A function that is concave in "
        "each variable is least at a vertex: move one variable after the other to an end.",
        energy_identities.vertices,
    ),
    Lemma(
        "alike",
        "x and y are alike",
        "The form does not change if all variables are turned about e3, or mirrored at a vertical "
        "plane. So no product of components along different axes is in it, and those along y "
        "stand in it as those along x.",
        "A mirror at the plane of x and e3 changes the sign of the products of a y with another "
        "component, and a quarter turn carries x to y.",
        energy_identities.alike,
    ),
    Lemma(
        "terms",
        "terms of bounded norm",
        "uᵀHv <= (R/2)(t|v|² + |u|²/t) for |H| <= R, t > 0. If |J - jI| <= ϱ, y = JV has ϱ²|V|² - "
        "|y - jV|² >= 0.",
        "uᵀHv <= R|u||v|, and the first identity with |u| and |v|. |(J - jI)V| <= ϱ|V|.",
        identities.bounded,
    ),
    Lemma(
        "offset",
        "how far off the feature of a level camera is",
        "Let σ = R s be what a level camera sees and w1 = 1. For an inertial goal |σ - s3* e3| = "
        "|δ1|. For one in the image, with ρ3 > 0, sin φ <= (c|δ3 - δ2| + w)/(m g) <= sin φ̄ and "
        "κ_t = 1/√((1 + cos φ̄)/2): |σ - s3* e3| <= √(2 A E) + s3* κ_t w/(m g), A = 1 + (s3* κ_t "
        "c/(m g))² (1/w2 + 1/w3).",
        "R δ1 = σ - s3* e3 or σ - s3* R e3, and |R e3 - e3| = |ρ - e3| = sin φ/√((1 + cos φ)/2) "
        "<= κ_t sin φ. |δ1| + a|δ2| + a|δ3| <= √((1 + a²/w2 + a²/w3) 2 E) by the second identity.",
        identities.offset,
    ),
    Lemma(
        "begin",
        "a start within tolerance",
        "Let |V| <= v, |F| <= f0, √(Ω1² + Ω2²) <= ω0, T_c > 0, e1 >= |σ - s3* e3|, e_h >= |P(σ - "
        "s3* e3)|, and let a >= 2 sin(φ/2). Then |δ1| <= d1 and |Pδ1| <= min(d1, e_h + a(e1 + "
        "s3)), d1 = e1 + s3 a, s3 = s3* for a goal in the image, else 0; |δ2| <= d1 + (m/k1) v, "
        "|δ3| <= |δ2| + f0/c, |δ4| <= |Pδ1| + (m/k1) v + f0/c + (m g + f0 - c s3) ω0/(c κ), |s_n| "
        "<= (κ + k4/m)|δ4| + k12 f0/c.",
        "R = R₂ R₁, R₁ a turn about e3 and R₂ one by φ about a horizontal axis: |R₂ᵀx - x| <= 2 "
        "sin(φ/2)|x|, and R₁ does not change the length of a P-part. So |P Rᵀ x| <= |P x| + a|x|, "
        "with x = σ - s3* e3 or, for a goal in the image, x = σ, P x = P(σ - s3* e3), |x| <= e1 + "
        "s3. 0 < D_c = T_c - c s3 <= |F - m g ρ| - c s3. The rest is read off the identities.",
        identities.begin,
    ),
    Lemma(
        "axes",
        "a late image that is not turned",
        "A feature s in the axes of the camera has s' = -Ω×s - y. Used at the age τ(t) in the axes "
        "that the camera had then, it is n more than the present one, |n|² <= τ̄ ∫ |y + Ω×s|² over "
        "the last τ̄. Ω×s is the sum of Ω_h×s, |Ω_h×s| <= h|s||ζ|, and Ω3 e3×s, of which P s = Pδ1 "
        "for a goal in the image, and P s = Pδ1 + (s3*/(m g))(c P(δ3 - δ2) - P w̃) for an inertial "
        "one.",
        "n = ∫ (y + Ω×s) over [t - τ(t), t]; Cauchy and Schwarz. |Ω_h| = h|ζ| [upright].",
        noise_identities.axes,
    ),
    Lemma(
        "noise",
        "noise and gusts",
        "Let a controller have its feature wrong by n + b, V, ρ and P Ω, turned by e3×, by v, d "
        "and ω, Ω3 by ω3, and a measured specific force by α/m; else α = 0. φ = (α + m g d)/c, "
        "B = b - (m/k1) v - φ, for an inertial goal less s3* d. Then it has δ3 - n - B and (δ3 "
        "- δ2) + φ, its lever is D_c - αz, so its h is (1 + ι) h, ι = D_c/(D_c - αz) - 1. U = "
        "cκ (δ3 - n - B)z, and its command over h, with what it adds for its gyroscopic torque, "
        "is s_n + K P(n + B) - π ζ + Ω3 e3×q + Ω3 G_c ζ + C - (π_c - π) ζ + ω3 G_c ζ + (1 + ι) "
        "ω3 e3×q - ι (K q - Ω3 e3×q) - ι k12 P(δ3 - δ2), q = P(δ3 - n - B), C = -(1 + ι) k12 Pφ "
        "- (K + π_c) ω/h + (Ω3 + ω3) G_c ω/h, π_c the π of what it has, K = κ + k4/m. A gust g "
        "beside F is in V' alone, and adds (m/k1) g to δ2' and δ3', and P of it to δ4'.",
        "By the controller of each law at any measurement, and by differences.",
        noise_identities.noise,
    ),
    Lemma(
        "held",
        "a controller that runs in steps, and an accelerometer that lags",
        "Let U and the torque commanded at t be those asked for at tk, t - p' <= tk <= t, by what "
        "is measured then, the specific force with a low-pass whose time is f' at most and which "
        "was settled at the start. Let n be the n of tk and ∫ y over [tk, t], κ = 1 on [tk, t] and "
        "0 <= κ <= e^{(x - tk)/f'} before. The lemma on noise holds with Ω3(tk) for Ω3 + ω3, its "
        "own noise, αz at most c ∫ κ (|ς u| + |p3| D_c/c) more, B more by E and a b of at most f' "
        "|Ω×w̃|/c, φ more by as much, and C by H: E = ∫_{tk}^t (k12 (δ3 - δ2) + P κχζ - Ω×δ3) - e3 "
        "∫ κ ς u, H = ∫_{tk}^t ((1 + ι) k12 P(κχζ + s3 h ζ - Ω×(δ3 - δ2)) + (K + π_c - Ω3(tk) G_c) "
        "(h/h(t)) ((I + γ)(s_n + μ) - Ω3 G_t ζ)). |n|² <= (τ̄ + p') ∫ |y|² over the last τ̄ + p'. "
        "If w = ∫_{tk}^t g, Z = ∫_{tk}^t e^{r(x - t)} ((2p'/π)² e^{rp'} g² - w²) dx >= 0 and Z' = "
        "-r Z + (2p'/π)² e^{rp'} g² - w². If w <= ∫ κ g, w² <= (p' + f') ∫ κ g², and with k(x) = "
        "∫_x^∞ e^{r(z - x)} κ'(z) dz, κ'(z) = 1 up to p' and e^{(p' - z)/f'} beyond, Z = ∫ k(t - x"
        ") g² dx has Z' <= -r Z + k(0) g² - w²/(p' + f') and k(0) <= (p' + f'/(1 - r f'))/(1 - r "
        "p').",
        "What is measured at tk less what is now are errors b, v, d, ω and α, of coordinates in "
        "body axes, as in the lemma on noise: that of δ3 is n and the integral of δ3' - y, but for "
        "the force; m a = w̃ - T̃ e3 has (m a)' = -Ω×w̃ - ς U_a e3, and what a low-pass of it is "
        "behind is the integral of that with κ. By the first two identities B, and φ, are then "
        "what is said. ω = -∫ (h ζ)', by the third, and D_c(t)/D_c = h/h(t). w(tk) = 0. With ψ = a "
        "cot(a (x - tk)), a = π/(2p'), w²ψ is 0 at tk, as w² <= (x - tk) ∫ g², and 0 or more until "
        "tk + p': so by the fourth identity ∫ g² >= a² ∫ w² up to any t, and e^{rp'} e^{r(x - t)} "
        ">= 1. The last two identities are -k' - r k = κ' beyond and up to p', and κ(x) <= κ'(t - "
        "x). (e^{rp'} - 1)/r <= p' e^{rp'}, e^{rp'} <= 1/(1 - r p').",
        noise_identities.held,
    ),
    Lemma(
        "natural",
        "the natural potential and vehicles within tolerance",
        "For 0 ⪯ Q ⪯ λI, y = QV has yᵀ(λV - y) >= 0. With the centroid as feature and e = q - q3* "
        "ρ, δ1 = e for an inertial goal and δ1 = e + q3*(ρ - e3) for one in the image; δ1 is in "
        "no other rate than its own, but through y. For an inertial goal, with the thrust as "
        "commanded, N of the lemma on the vertical motion obeys N' = (k1/m) w, w = qz - q3* + "
        "(Pρ)ᵀδ4: so w <= qz - q3* + sin φ √(2ℓ/a4) while Λ <= ℓ.",
        "|H| <= 1 in the first identity. |ρ| = 1, |Pρ| = sin φ, and a4|δ4|² <= 2ℓ as W >= 0.",
        lambda: identities.natural() | identities.height(),
    ),
)
