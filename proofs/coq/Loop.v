(** The error dynamics, the Lyapunov function, and how fast it falls. *)

Require Import Reals Lra.
From Hoverproof Require Import Space.
Open Scope R_scope.

(** What the loop is made of: the mass (kg), k1 (kg m/s), k2 (1/m), k3, k4 (kg/s). *)
Record loop := Loop { mass : R; k1 : R; k2 : R; k3 : R; k4 : R }.

(** c = k1² k2/m (N), and f(T) = k1 k2 (k1 k2 + k3)/(m (T - c q3)). *)
Definition stiffness (g : loop) : R := k1 g * k1 g * k2 g / mass g.
Definition factor (g : loop) (thrust q3 : R) : R :=
  k1 g * k2 g * (k1 g * k2 g + k3 g) / (mass g * (thrust - stiffness g * q3)).

(** X = (δ1, δ2, δ3, δ4); the third component of δ4 is zero. *)
Record errors := Errors { d1 : vec; d2 : vec; d3 : vec; d4x : R; d4y : R }.
Definition d4 (x : errors) : vec := V (d4x x) (d4y x) 0.

(** v = δ1 + δ2, and A (δ4 - δ3) with A = q3 I - e3 qᵀ. *)
Definition flow (x : errors) : vec := (d1 x + d2 x)%vec.
Definition turn (q : vec) (x : errors) : vec :=
  let e := (d4 x - d3 x)%vec in (pz q * e - (q · e) * e3)%vec.

(** m δ1', ..., m δ4'. J is Q, or the slope of the scaled centroid; f is f(T); q is q* for a goal in the
    image and zero for one fixed to the vertical; Ω are the body rates. *)
Definition rate1 (g : loop) (J : vec -> vec) (f : R) (q w : vec) (x : errors) : vec :=
  ((- mass g) * (w × d1 x) - k1 g * J (flow x) + k1 g * f * turn q x)%vec.
Definition rate2 (g : loop) (J : vec -> vec) (f : R) (q w : vec) (x : errors) : vec :=
  ((- mass g) * (w × d2 x) + k1 g * J (flow x) - (k1 g * k2 g) * d2 x + (k1 g * k2 g) * d3 x
   - k1 g * f * turn q x)%vec.
Definition rate3 (g : loop) (J : vec -> vec) (w : vec) (x : errors) : vec :=
  ((- mass g) * (w × d3 x) + k1 g * J (flow x) - (k1 g * k2 g) * d2 x
   + (k1 g * k2 g + k3 g) * d4 x - k3 g * d3 x)%vec.
Definition rate4 (g : loop) (J : vec -> vec) (x : errors) : vec :=
  (k1 g * flat (J (flow x)) - (k1 g * k2 g + k3 g) * flat (d3 x) - k4 g * d4 x)%vec.

(** Σ wᵢ|δᵢ|² = 2 L. *)
Record weights := Weights { w1 : R; w2 : R; w3 : R; w4 : R }.
Definition squares (w : weights) (x : errors) : R :=
  w1 w * (d1 x · d1 x) + w2 w * (d2 x · d2 x) + w3 w * (d3 x · d3 x) + w4 w * (d4 x · d4 x).

(** XᵀΣX = -m L': how fast L falls, in the body rates Ω too. *)
Definition fall (g : loop) (w : weights) (J : vec -> vec) (f : R) (q om : vec) (x : errors) : R :=
  - (w1 w * (d1 x · rate1 g J f q om x) + w2 w * (d2 x · rate2 g J f q om x)
     + w3 w * (d3 x · rate3 g J om x) + w4 w * (d4 x · rate4 g J x)).

(** uᵀ J v is all that J does in it, u = w1 δ1 - w2 δ2 - w3 δ3 - w4 δ4. *)
Definition pull (w : weights) (x : errors) : vec :=
  (w1 w * d1 x - w2 w * d2 x - w3 w * d3 x - w4 w * d4 x)%vec.

Lemma fall_in_J : forall g w J f q om x,
  fall g w J f q om x = fall g w (fun _ => zero) f q zero x + k1 g * (pull w x · J (flow x)).
Proof.
  intros. unfold fall, pull, rate1, rate2, rate3, rate4.
  assert (F : forall y, d4 x · flat y = d4 x · y) by (intros; unfold d4; number).
  repeat rewrite ?dot_plus, ?dot_minus, ?dot_scale, ?dot_zero, ?F, ?dot_turned,
    ?plus_dot, ?minus_dot, ?scale_dot. ring.
Qed.

Lemma fall_of_multiple : forall g w j f q x,
  fall g w (fun v => (j * v)%vec) f q zero x =
    fall g w (fun _ => zero) f q zero x + k1 g * (j * (pull w x · flow x)).
Proof.
  intros. rewrite fall_in_J, dot_scale. reflexivity.
Qed.

(** With J in a ball about j I, L falls at least so fast, whatever the body rates are. *)
Lemma fall_at_least : forall g w J f q om x j rho tau,
  0 < k1 g -> slack j rho J -> 0 < tau ->
  fall g w (fun v => (j * v)%vec) f q zero x
    - k1 g * (rho / 2 * (tau * (flow x · flow x) + / tau * (pull w x · pull w x)))
  <= fall g w J f q om x.
Proof.
  intros g w J f q om x j rho tau K S T.
  rewrite (fall_in_J g w J), fall_of_multiple.
  specialize (S (pull w x) (flow x) tau T).
  pose proof (Rmult_le_compat_l (k1 g) _ _ (Rlt_le _ _ K) S) as H.
  rewrite Rmult_minus_distr_l in H. lra.
Qed.

(** In f and in each component of q, it is affine: f times one number that is linear in q. *)
Lemma fall_affine : forall g w J x, exists a b c d : R, forall f q1 q2 q3,
  fall g w J f (V q1 q2 q3) zero x = a + f * (b * q1 + c * q2 + d * q3).
Proof.
  intros g w J x.
  set (e := (d4 x - d3 x)%vec). set (s := (w2 w * d2 x - w1 w * d1 x)%vec).
  exists (fall g w J 0 zero zero x).
  exists (- k1 g * (pz s * px e)). exists (- k1 g * (pz s * py e)).
  exists (k1 g * (s · flat e)).
  intros. unfold fall, rate1, rate2, rate3, rate4.
  assert (T : forall d, d · turn (V q1 q2 q3) x =
    q3 * (d · flat e) - (q1 * (pz d * px e) + q2 * (pz d * py e))).
  { intros d. unfold turn. fold e. number. }
  assert (Z : forall d, d · turn zero x = 0) by (intros d; unfold turn; fold e; number).
  repeat rewrite ?dot_plus, ?dot_minus, ?dot_scale, ?T, ?Z.
  replace (s · flat e) with (w2 w * (d2 x · flat e) - w1 w * (d1 x · flat e)) by (unfold s; number).
  replace (pz s) with (w2 w * pz (d2 x) - w1 w * pz (d1 x)) by (unfold s; components; ring).
  ring.
Qed.
