(** Certificates of gains: what one holds, the decision whether it is right, and what follows if it is.

    The decision is over rational numbers and lists; the theorem, over real vectors, is [gains_sound]. *)

Require Import QArith Qreals Reals List Bool Lra Lia.
From Hoverproof Require Import Forms Space Loop.
Import ListNotations.
Open Scope R_scope.

(** * The matrix, as forms in the eleven components of X *)

Record forms := F { fx : form; fy : form; fz : form }.

Definition unit (i : nat) : form := map (fun k => if (k =? i)%nat then 1%Q else 0%Q) (seq 0 11).
Definition nothing : form := map (fun _ => 0%Q) (seq 0 11).

Definition D1 := F (unit 0) (unit 1) (unit 2).
Definition D2 := F (unit 3) (unit 4) (unit 5).
Definition D3 := F (unit 6) (unit 7) (unit 8).
Definition D4 := F (unit 9) (unit 10) nothing.

Definition fplus (u v : forms) : forms :=
  F (add (fx u) (fx v)) (add (fy u) (fy v)) (add (fz u) (fz v)).
Definition fscale (k : Q) (u : forms) : forms :=
  F (Forms.scale k (fx u)) (Forms.scale k (fy u)) (Forms.scale k (fz u)).
Definition fflat (u : forms) : forms := F (fx u) (fy u) nothing.

(** c (u·v) as terms. *)
Definition fdot (c : Q) (u v : forms) : list term :=
  [(c, fx u, fx v); (c, fy u, fy v); (c, fz u, fz v)].

(** The real vector that three forms stand for. *)
Definition coordinates (x : errors) : list R :=
  [px (d1 x); py (d1 x); pz (d1 x); px (d2 x); py (d2 x); pz (d2 x);
   px (d3 x); py (d3 x); pz (d3 x); d4x x; d4y x].
Definition real (u : forms) (x : errors) : vec :=
  V (value (fx u) (coordinates x)) (value (fy u) (coordinates x)) (value (fz u) (coordinates x)).

Lemma Q2R_one : Q2R 1 = 1.
Proof. unfold Q2R. simpl. field. Qed.
Lemma Q2R_zero : Q2R 0 = 0.
Proof. unfold Q2R. simpl. ring. Qed.

Ltac evaluate :=
  intros; apply vec_eq; cbn -[Q2R]; rewrite ?Q2R_one, ?Q2R_zero; ring.

Lemma real_D1 : forall x, real D1 x = d1 x. Proof. evaluate. Qed.
Lemma real_D2 : forall x, real D2 x = d2 x. Proof. evaluate. Qed.
Lemma real_D3 : forall x, real D3 x = d3 x. Proof. evaluate. Qed.
Lemma real_D4 : forall x, real D4 x = d4 x. Proof. evaluate. Qed.

Lemma value_nothing : forall x, value nothing (coordinates x) = 0.
Proof. intros. cbn -[Q2R]. rewrite Q2R_zero. ring. Qed.

Lemma real_plus : forall u v x, real (fplus u v) x = (real u x + real v x)%vec.
Proof. intros. apply vec_eq; apply add_correct. Qed.
Lemma real_scale : forall k u x, real (fscale k u) x = (Q2R k * real u x)%vec.
Proof. intros. apply vec_eq; apply scale_correct. Qed.
Lemma real_flat : forall u x, real (fflat u) x = flat (real u x).
Proof. intros. apply vec_eq; try reflexivity. apply value_nothing. Qed.
Lemma total_fdot : forall c u v x,
  total (fdot c u v) (coordinates x) = Q2R c * (real u x · real v x).
Proof. intros. unfold fdot, real, total, dot. simpl. ring. Qed.

(** Gains, mass and weights as rationals. *)
Record numbers := Numbers {
  qmass : Q; qk1 : Q; qk2 : Q; qk3 : Q; qk4 : Q; qw1 : Q; qw2 : Q; qw3 : Q; qw4 : Q }.
Definition loop_of (n : numbers) : loop :=
  Loop (Q2R (qmass n)) (Q2R (qk1 n)) (Q2R (qk2 n)) (Q2R (qk3 n)) (Q2R (qk4 n)).
Definition weights_of (n : numbers) : weights :=
  Weights (Q2R (qw1 n)) (Q2R (qw2 n)) (Q2R (qw3 n)) (Q2R (qw4 n)).

Definition fflow : forms := fplus D1 D2.
Definition fdiff (u v : forms) : forms := fplus u (fscale (-1) v).

Lemma real_diff : forall u v x, real (fdiff u v) x = (real u x - real v x)%vec.
Proof.
  intros. unfold fdiff. rewrite real_plus, real_scale. unfold minus. f_equal. f_equal.
  unfold Q2R. simpl. field.
Qed.

(** A (δ4 - δ3) for q = (q1, q2, q3). *)
Definition fturn (q1 q2 q3 : Q) : forms :=
  let e := fdiff D4 D3 in
  F (Forms.scale q3 (fx e)) (Forms.scale q3 (fy e))
    (Forms.scale (-1) (add (Forms.scale q1 (fx e)) (Forms.scale q2 (fy e)))).

Lemma real_turn : forall q1 q2 q3 x,
  real (fturn q1 q2 q3) x = turn (V (Q2R q1) (Q2R q2) (Q2R q3)) x.
Proof.
  intros. set (e := fdiff D4 D3).
  assert (E : real e x = (d4 x - d3 x)%vec).
  { unfold e. rewrite real_diff, real_D4, real_D3. reflexivity. }
  unfold turn. rewrite <- E.
  assert (M : Q2R (-1) = -1) by (unfold Q2R; simpl; field).
  apply vec_eq; unfold fturn; fold e; cbn [real fx fy fz px py pz].
  - rewrite scale_correct. unfold real. components. ring.
  - rewrite scale_correct. unfold real. components. ring.
  - rewrite scale_correct, add_correct, !scale_correct, M. unfold real. components. ring.
Qed.

(** Sums of forms and real vectors, side by side: the rates for J = j I, Ω left out. *)
Definition frate1 (n : numbers) (j f q1 q2 q3 : Q) : forms :=
  fdiff (fscale (times (qk1 n) f) (fturn q1 q2 q3)) (fscale (times (qk1 n) j) fflow).
Definition frate2 (n : numbers) (j f q1 q2 q3 : Q) : forms :=
  let k12 := times (qk1 n) (qk2 n) in
  fdiff (fplus (fscale k12 (fdiff D3 D2)) (fscale (times (qk1 n) j) fflow))
    (fscale (times (qk1 n) f) (fturn q1 q2 q3)).
Definition frate3 (n : numbers) (j : Q) : forms :=
  let k12 := times (qk1 n) (qk2 n) in
  fdiff (fplus (fscale (times (qk1 n) j) fflow) (fscale (Forms.plus k12 (qk3 n)) D4))
    (fplus (fscale k12 D2) (fscale (qk3 n) D3)).
Definition frate4 (n : numbers) (j : Q) : forms :=
  let k12 := times (qk1 n) (qk2 n) in
  fdiff (fscale (times (qk1 n) j) (fflat fflow))
    (fplus (fscale (Forms.plus k12 (qk3 n)) (fflat D3)) (fscale (qk4 n) D4)).
Definition fpull (n : numbers) : forms :=
  fdiff (fdiff (fscale (qw1 n) D1) (fscale (qw2 n) D2))
    (fplus (fscale (qw3 n) D3) (fscale (qw4 n) D4)).

(** M of the theorem: what is left of XᵀΣX - t Σ wᵢ|δᵢ|² for J = j I when rho and tau have taken theirs. *)
Definition bound (n : numbers) (j rho t f q1 q2 q3 tau : Q) : list term :=
  let loss := times (qk1 n) (times rho (-1 # 2)) in
  fdot (Qopp (qw1 n)) D1 (frate1 n j f q1 q2 q3) ++ fdot (Qopp (qw2 n)) D2 (frate2 n j f q1 q2 q3)
  ++ fdot (Qopp (qw3 n)) D3 (frate3 n j) ++ fdot (Qopp (qw4 n)) D4 (frate4 n j)
  ++ fdot (times (Qopp t) (qw1 n)) D1 D1 ++ fdot (times (Qopp t) (qw2 n)) D2 D2
  ++ fdot (times (Qopp t) (qw3 n)) D3 D3 ++ fdot (times (Qopp t) (qw4 n)) D4 D4
  ++ fdot (times loss tau) fflow fflow ++ fdot (times loss (Qinv tau)) (fpull n) (fpull n).

Lemma real_flow : forall x, real fflow x = flow x.
Proof. intros. unfold fflow, flow. rewrite real_plus, real_D1, real_D2. reflexivity. Qed.

Lemma total_bound : forall n j rho t f q1 q2 q3 tau x, ~ (tau == 0)%Q ->
  let q := V (Q2R q1) (Q2R q2) (Q2R q3) in
  total (bound n j rho t f q1 q2 q3 tau) (coordinates x) =
    fall (loop_of n) (weights_of n) (fun v => (Q2R j * v)%vec) (Q2R f) q zero x
    - Q2R t * squares (weights_of n) x
    - Q2R (qk1 n) * (Q2R rho / 2 * (Q2R tau * (flow x · flow x)
        + / Q2R tau * (pull (weights_of n) x · pull (weights_of n) x))).
Proof.
  intros n j rho t f q1 q2 q3 tau x T q.
  assert (H : Q2R (-1 # 2) = -1 / 2) by (unfold Q2R; simpl; field).
  assert (P : real (fpull n) x = pull (weights_of n) x).
  { unfold fpull, pull. rewrite !real_diff, real_plus, !real_scale, real_D1, real_D2, real_D3, real_D4.
    cbn [weights_of w1 w2 w3 w4]. vector. }
  unfold bound. rewrite !total_app, !total_fdot, P.
  unfold frate1, frate2, frate3, frate4.
  repeat rewrite ?real_diff, ?real_plus, ?real_scale, ?real_flat, ?real_turn, ?real_flow, ?real_D1,
    ?real_D2, ?real_D3, ?real_D4, ?times_correct, ?plus_correct, ?Q2R_opp, ?H, ?times_correct.
  rewrite Q2R_inv by exact T. fold q.
  unfold fall, rate1, rate2, rate3, rate4, squares. cbn [loop_of weights_of mass k1 k2 k3 k4 w1 w2 w3 w4].
  assert (F : forall y, d4 x · flat y = d4 x · y) by (intros; unfold d4; number).
  repeat rewrite ?dot_plus, ?dot_minus, ?dot_scale, ?F.
  assert (Z : forall u w, u · (zero × w)%vec = 0) by number.
  rewrite !Z. field.
  intro E. apply T. apply eqR_Qeq. rewrite E, Q2R_zero. reflexivity.
Qed.

(** * The certificate *)

(** [low, high]: the eigenvalues of Q, or j - rho and j + rho (1/m). The thrust (N). The enclosure of q*
    (zero for a goal fixed to the vertical) and of f. The margin t (kg/s). Two multipliers tau, at the
    ends of the interval of f. A hint for the matrices at each end. *)
Record certificate := Certificate {
  its : numbers; low : Q; high : Q; thrust_low : Q; thrust_high : Q;
  q1_low : Q; q1_high : Q; q2_low : Q; q2_high : Q; q3_low : Q; q3_high : Q;
  f_low : Q; f_high : Q; margin : Q; tau_low : Q; tau_high : Q; hint_low : hint; hint_high : hint }.

Definition above (a b : Q) : bool := negb (Qle_bool b a).  (** a < b *)

Definition ends (a b : Q) : list Q := if Qeq_bool a b then [a] else [a; b].

Definition corners_ok (c : certificate) (f tau : Q) (s : hint) : bool :=
  let n := its c in
  let j := Qred ((low c + high c) * (1 # 2)) in
  let rho := Qred ((high c - low c) * (1 # 2)) in
  above 0 tau &&
  forallb (fun q1 => forallb (fun q2 => forallb (fun q3 =>
    positive 11 s (bound n j rho (margin c) f q1 q2 q3 tau))
    (ends (q3_low c) (q3_high c))) (ends (q2_low c) (q2_high c))) (ends (q1_low c) (q1_high c)).

(** f = k1 k2 (k1 k2 + k3)/(m (T - c q3)): with c = k1² k2/m the denominator is m T - k1² k2 q3. *)
Definition top (n : numbers) : Q := (qk1 n * qk2 n * (qk1 n * qk2 n + qk3 n))%Q.
Definition bottom (n : numbers) (thrust q3 : Q) : Q :=
  (qmass n * thrust - qk1 n * qk1 n * qk2 n * q3)%Q.

Definition certificate_ok (c : certificate) : bool :=
  let n := its c in
  above 0 (qmass n) && above 0 (qk1 n) && above 0 (qk2 n) && above 0 (qk3 n) && above 0 (qk4 n)
  && above 0 (qw1 n) && above 0 (qw2 n) && above 0 (qw3 n) && above 0 (qw4 n)
  && above (low c) (high c) && above 0 (margin c)
  (* f lies in its interval: T high and q3 low make it small *)
  && above 0 (bottom n (thrust_low c) (q3_high c))
  && Qle_bool (f_low c * bottom n (thrust_high c) (q3_low c)) (top n) && Qle_bool 0 (f_low c)
  && Qle_bool 0 (f_high c)
  && Qle_bool (top n) (f_high c * bottom n (thrust_low c) (q3_high c))
  && corners_ok c (f_low c) (tau_low c) (hint_low c)
  && corners_ok c (f_high c) (tau_high c) (hint_high c).

(** What is admitted: operators J, thrusts T and q*. *)
Definition within (a b : Q) (x : R) : Prop := Q2R a <= x <= Q2R b.
Definition inside (c : certificate) (q : vec) : Prop :=
  within (q1_low c) (q1_high c) (px q) /\ within (q2_low c) (q2_high c) (py q) /\
  within (q3_low c) (q3_high c) (pz q).
Definition some_error (x : errors) : Prop := nonzero (coordinates x).

Lemma above_correct : forall a b, above a b = true -> Q2R a < Q2R b.
Proof.
  intros a b H. unfold above in H. apply negb_true_iff in H. apply Qlt_Rlt.
  destruct (Qlt_le_dec a b) as [L|L]; [exact L|]. apply Qle_bool_iff in L. congruence.
Qed.

Lemma affine_between : forall a b lo hi s,
  lo <= s <= hi -> 0 < a + b * lo -> 0 < a + b * hi -> 0 < a + b * s.
Proof.
  intros a b lo hi s [L H] P Q. destruct (Rle_or_lt 0 b) as [B|B].
  - pose proof (Rmult_le_compat_l b lo s B L). lra.
  - assert (N : 0 <= - b) by lra. pose proof (Rmult_le_compat_l (- b) s hi N H). lra.
Qed.

(** A property that is affine holds on an interval if it does at the ends. *)
Lemma ends_sound : forall lo hi (g : R -> R),
  (exists a b, forall s, g s = a + b * s) ->
  (forall e, In e (ends lo hi) -> 0 < g (Q2R e)) ->
  forall s, within lo hi s -> 0 < g s.
Proof.
  intros lo hi g [a [b G]] E s W. unfold ends, within in *. destruct (Qeq_bool lo hi) eqn:B.
  - apply Qeq_bool_eq, Qeq_eqR in B. replace s with (Q2R lo) by lra. apply E. left. reflexivity.
  - rewrite G. apply affine_between with (Q2R lo) (Q2R hi); [exact W| |].
    + rewrite <- G. apply E. left. reflexivity.
    + rewrite <- G. apply E. right. left. reflexivity.
Qed.

(** At an end of the interval of f, all over the box of q*, for any admitted J. *)
Lemma corners_sound : forall c f tau s J om x,
  corners_ok c f tau s = true -> above 0 (qk1 (its c)) = true ->
  slack ((Q2R (low c) + Q2R (high c)) / 2) ((Q2R (high c) - Q2R (low c)) / 2) J ->
  some_error x -> forall q, inside c q ->
  0 < fall (loop_of (its c)) (weights_of (its c)) J (Q2R f) q om x
      - Q2R (margin c) * squares (weights_of (its c)) x.
Proof.
  intros c f tau s J om x C K S N.
  unfold corners_ok in C.
  set (j := Qred ((low c + high c) * (1 # 2))) in *.
  set (rho := Qred ((high c - low c) * (1 # 2))) in *.
  assert (Half : Q2R (1 # 2) = 1 / 2) by (unfold Q2R; simpl; field).
  assert (Ej : Q2R j = (Q2R (low c) + Q2R (high c)) / 2).
  { unfold j. rewrite (Qeq_eqR _ _ (Qred_correct _)), Q2R_mult, Q2R_plus, Half. field. }
  assert (Er : Q2R rho = (Q2R (high c) - Q2R (low c)) / 2).
  { unfold rho. rewrite (Qeq_eqR _ _ (Qred_correct _)), Q2R_mult, Q2R_minus, Half. field. }
  rewrite <- Ej, <- Er in S.
  apply andb_prop in C. destruct C as [T C]. apply above_correct in T. rewrite Q2R_zero in T.
  apply above_correct in K. rewrite Q2R_zero in K.
  set (g := loop_of (its c)). set (w := weights_of (its c)).
  (* the margin at q, as a function of q *)
  set (h := fun q1 q2 q3 => fall g w J (Q2R f) (V q1 q2 q3) om x - Q2R (margin c) * squares w x).
  assert (A : exists a b d e, forall q1 q2 q3, h q1 q2 q3 = a + (b * q1 + d * q2 + e * q3)).
  { destruct (fall_affine g w J x) as [a [b [d [e G]]]].
    exists (a - Q2R (margin c) * squares w x), (Q2R f * b), (Q2R f * d), (Q2R f * e).
    intros. unfold h. rewrite fall_in_J.
    pose proof (G (Q2R f) q1 q2 q3) as G1. rewrite fall_in_J in G1. rewrite G1. ring. }
  destruct A as [a [b [d [e A]]]].
  assert (Corner : forall q1 q2 q3, In q1 (ends (q1_low c) (q1_high c)) ->
    In q2 (ends (q2_low c) (q2_high c)) -> In q3 (ends (q3_low c) (q3_high c)) ->
    0 < h (Q2R q1) (Q2R q2) (Q2R q3)).
  { intros q1 q2 q3 I1 I2 I3.
    rewrite forallb_forall in C. specialize (C q1 I1). rewrite forallb_forall in C.
    specialize (C q2 I2). rewrite forallb_forall in C. specialize (C q3 I3).
    pose proof (positive_sound _ _ _ (coordinates x) C eq_refl N) as P.
    rewrite total_bound in P.
    2:{ intro E. apply Qeq_eqR in E. rewrite Q2R_zero in E. lra. }
    pose proof (fall_at_least g w J (Q2R f) (V (Q2R q1) (Q2R q2) (Q2R q3)) om x _ _ (Q2R tau) K S T) as L.
    unfold h. fold g in P. fold w in P. change (k1 g) with (Q2R (qk1 (its c))) in L. lra. }
  intros [q1 q2 q3] [W1 [W2 W3]]. simpl in W1, W2, W3. fold g. fold w. change (0 < h q1 q2 q3).
  refine (ends_sound (q3_low c) (q3_high c) (fun z => h q1 q2 z) _ _ q3 W3).
  { exists (a + b * q1 + d * q2), e. intros. rewrite A. ring. }
  intros z3 I3.
  refine (ends_sound (q2_low c) (q2_high c) (fun z => h q1 z (Q2R z3)) _ _ q2 W2).
  { exists (a + b * q1 + e * Q2R z3), d. intros. rewrite A. ring. }
  intros z2 I2.
  refine (ends_sound (q1_low c) (q1_high c) (fun z => h z (Q2R z2) (Q2R z3)) _ _ q1 W1).
  { exists (a + d * Q2R z2 + e * Q2R z3), b. intros. rewrite A. ring. }
  intros z1 I1. apply Corner; assumption.
Qed.

(** ** Theorem 1 *)

(** [admitted] says of which operators: those with eigenvalues in [low, high], or those of a ball. *)
Inductive admitted (c : certificate) (J : vec -> vec) : Prop :=
  | of_centroid : between (Q2R (low c)) (Q2R (high c)) J -> admitted c J
  | of_scaled : near ((Q2R (low c) + Q2R (high c)) / 2) ((Q2R (high c) - Q2R (low c)) / 2) J ->
      admitted c J.

(** For every admitted J, every thrust T of the certificate, every q* in its box, whatever the body
    rates are, and every X other than zero: XᵀΣX > t Σ wᵢ|δᵢ|². *)
Theorem gains_sound : forall c, certificate_ok c = true ->
  forall J T q om x,
    admitted c J -> within (thrust_low c) (thrust_high c) T -> inside c q -> some_error x ->
    let g := loop_of (its c) in let w := weights_of (its c) in
    Q2R (margin c) * squares w x < fall g w J (factor g T (pz q)) q om x.
Proof.
  intros c C J T q om x A B I N g w.
  unfold certificate_ok in C.
  repeat (apply andb_prop in C; let E := fresh "E" in destruct C as [C E]).
  assert (LH : Q2R (low c) < Q2R (high c)) by (apply above_correct; assumption).
  assert (S : slack ((Q2R (low c) + Q2R (high c)) / 2) ((Q2R (high c) - Q2R (low c)) / 2) J).
  { destruct A as [Q|Q]; [apply between_slack; exact Q|apply near_slack; [lra|exact Q]]. }
  repeat match goal with H : above _ _ = true |- _ =>
    let H' := fresh "P" in pose proof (above_correct _ _ H) as H'; rewrite ?Q2R_zero in H'; revert H end.
  intros.
  repeat match goal with H : Qle_bool _ _ = true |- _ =>
    apply Qle_bool_iff, Qle_Rle in H; rewrite ?Q2R_zero in H end.
  unfold top, bottom in *.
  repeat rewrite ?Q2R_mult, ?Q2R_minus, ?Q2R_plus in *.
  set (m := Q2R (qmass (its c))) in *. set (a1 := Q2R (qk1 (its c))) in *.
  set (a2 := Q2R (qk2 (its c))) in *. set (a3 := Q2R (qk3 (its c))) in *.
  destruct B as [B1 B2]. pose proof I as [_ [_ [I1 I2]]].
  assert (K0 : 0 < a1 * a2) by (apply Rmult_lt_0_compat; assumption).
  assert (K : 0 < a1 * a1 * a2) by (rewrite Rmult_assoc; apply Rmult_lt_0_compat; assumption).
  assert (N1 : 0 < a1 * a2 * (a1 * a2 + a3)) by (apply Rmult_lt_0_compat; lra).
  set (f := factor g T (pz q)).
  set (den := m * T - a1 * a1 * a2 * pz q).
  assert (D1 : m * Q2R (thrust_low c) - a1 * a1 * a2 * Q2R (q3_high c) <= den).
  { unfold den. pose proof (Rmult_le_compat_l m _ _ ltac:(lra) B1).
    pose proof (Rmult_le_compat_l (a1 * a1 * a2) _ _ ltac:(lra) I2). lra. }
  assert (D2 : den <= m * Q2R (thrust_high c) - a1 * a1 * a2 * Q2R (q3_low c)).
  { unfold den. pose proof (Rmult_le_compat_l m _ _ ltac:(lra) B2).
    pose proof (Rmult_le_compat_l (a1 * a1 * a2) _ _ ltac:(lra) I1). lra. }
  assert (D0 : 0 < den) by lra.
  assert (Ef : f = a1 * a2 * (a1 * a2 + a3) / den).
  { unfold f, factor, stiffness, den. cbn [g loop_of mass k1 k2 k3]. fold m. fold a1. fold a2. fold a3.
    f_equal. field. lra. }
  assert (F1 : Q2R (f_low c) <= f).
  { apply Rmult_le_reg_r with den; [exact D0|]. rewrite Ef. unfold Rdiv. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by (apply Rgt_not_eq; exact D0).
    eapply Rle_trans; [|eassumption]. apply Rmult_le_compat_l; [assumption|exact D2]. }
  assert (F2 : f <= Q2R (f_high c)).
  { apply Rmult_le_reg_r with den; [exact D0|]. rewrite Ef. unfold Rdiv. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by (apply Rgt_not_eq; exact D0).
    eapply Rle_trans; [eassumption|]. apply Rmult_le_compat_l; [assumption|exact D1]. }
  pose proof (corners_sound c _ _ _ J om x ltac:(eassumption) ltac:(assumption) S N q I) as L1.
  match goal with H : corners_ok c (f_low c) _ _ = true |- _ =>
    pose proof (corners_sound c _ _ _ J om x H ltac:(assumption) S N q I) as L2 end.
  fold g in L1, L2. fold w in L1, L2.
  destruct q as [q1 q2 q3]. destruct (fall_affine g w J x) as [a [b [d [e G]]]].
  assert (G' : forall y, fall g w J y (V q1 q2 q3) om x =
    a + k1 g * (pull w x · J (flow x)) * 0 + y * (b * q1 + d * q2 + e * q3)).
  { intros y. rewrite fall_in_J. pose proof (G y q1 q2 q3) as Y. rewrite fall_in_J in Y. rewrite Y. ring. }
  rewrite G' in L1, L2 |- *.
  set (s := Q2R (margin c) * squares w x) in *. set (z := b * q1 + d * q2 + e * q3) in *.
  assert (0 < (a - s) + z * f); [|fold f; lra].
  apply affine_between with (Q2R (f_low c)) (Q2R (f_high c)); [split; assumption| |]; lra.
Qed.
