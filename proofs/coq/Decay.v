(** What a certificate of gains means for a flight: L falls at the proved rate. *)

Require Import QArith Qreals Reals List Lra.
From Hoverproof Require Import Forms Space Calculus Loop Image Body Gains.
Import ListNotations.
Open Scope R_scope.

Lemma gains_sound_weakly : forall c, certificate_ok c = true ->
  forall J T q om x,
    admitted c J -> within (thrust_low c) (thrust_high c) T -> inside c q ->
    let g := loop_of (its c) in let w := weights_of (its c) in
    Q2R (margin c) * squares w x <= fall g w J (factor g T (pz q)) q om x.
Proof.
  intros c C J T q om x A B I g w.
  destruct (zero_or_not (coordinates x)) as [N|Z].
  - left. apply gains_sound; assumption.
  - assert (E : x = Errors zero zero zero 0 0).
    { destruct x as [[a b d] [e h i] [j k l] m n]. cbn in Z.
      rewrite (Z a), (Z b), (Z d), (Z e), (Z h), (Z i), (Z j), (Z k), (Z l), (Z m), (Z n) by tauto.
      reflexivity. }
    rewrite E, fall_in_J. unfold squares, fall, pull, rate1, rate2, rate3, rate4, flow, turn, d4.
    cbn [d1 d2 d3 d4x d4y]. generalize (J (zero + zero)%vec). intros y. right. number.
Qed.

Lemma slope_squares : forall w g J f q om (x : R -> errors) t,
  mass g <> 0 ->
  vslope (fun s => d1 (x s)) t (/ mass g * rate1 g J f q om (x t))%vec ->
  vslope (fun s => d2 (x s)) t (/ mass g * rate2 g J f q om (x t))%vec ->
  vslope (fun s => d3 (x s)) t (/ mass g * rate3 g J om (x t))%vec ->
  vslope (fun s => d4 (x s)) t (/ mass g * rate4 g J (x t))%vec ->
  slope (fun s => squares w (x s)) t (- (2 / mass g) * fall g w J f q om (x t)).
Proof.
  intros w g J f q om x t M S1 S2 S3 S4. unfold squares.
  eapply slope_is.
  - repeat apply slope_plus; apply slope_scale; eapply slope_dot; eassumption.
  - unfold fall.
    assert (Sym : forall u v, (/ mass g * u)%vec · v + v · (/ mass g * u) = 2 / mass g * (v · u)).
    { intros. components. field. exact M. }
    rewrite !Sym. ring.
Qed.

(** L = ½ Σ wᵢ|δᵢ|² of a motion of the closed loop with the numbers of a certificate falls at least as
    fast as exp(-r t), r = 2 margin/m, while J (or Q) and T are admitted, under each of the eight laws. What
    is fixed in the image is straight below, then whatever the yaw rate is, or there is none: by [no_yaw] if
    there is none at the start and it is damped. *)
Theorem lyapunov_decays : forall c m until,
  certificate_ok c = true ->
  of m = loop_of (its c) ->
  inside c (fixed m) ->
  closed_loop m until -> 0 <= until ->
  (forall t, 0 <= t <= until -> axial_or_still m t) ->
  (forall t, 0 <= t <= until ->
    admitted c (Jat m t) /\ within (thrust_low c) (thrust_high c) (thrust m t)) ->
  let lyapunov := fun t => squares (weights_of (its c)) (state m t) / 2 in
  lyapunov until <= lyapunov 0 * exp (- (2 * Q2R (margin c) / mass (of m)) * until).
Proof.
  intros c m until C E I L U Y A lyapunov.
  assert (G : positive_gains (of m)).
  { rewrite E. pose proof C as C'. unfold certificate_ok in C'.
    repeat (apply andb_prop in C'; let H := fresh "H" in destruct C' as [C' H]).
    repeat match goal with H : above _ _ = true |- _ => apply above_correct in H; rewrite ?Q2R_zero in H end.
    split; assumption. }
  assert (M : 0 < mass (of m)) by apply G.
  apply (decays lyapunov
    (fun t => - (/ mass (of m)) * fall (of m) (weights_of (its c)) (Jat m t)
      (factor (of m) (thrust m t) (pz (fixed m))) (fixed m) (omega m t) (state m t))); [exact U|].
  intros t T. destruct (errors_obey m until L G t T (Y t T)) as [S1 [S2 [S3 S4]]].
  destruct (A t T) as [Ad Th]. split.
  - unfold lyapunov. eapply slope_is.
    + eapply slope_ext; [|apply (slope_scale (/ 2)); eapply slope_squares; [|exact S1|exact S2|exact S3|exact S4]; lra].
      intros s. cbv beta. apply Rmult_comm.
    + field. lra.
  - pose proof (gains_sound_weakly c C (Jat m t) (thrust m t) (fixed m) (omega m t) (state m t) Ad Th I) as B.
    rewrite <- E in B. cbv zeta in B. unfold lyapunov.
    apply Rmult_le_reg_l with (mass (of m)); [exact M|].
    replace (mass (of m) * (- / mass (of m) * fall (of m) (weights_of (its c)) (Jat m t)
        (factor (of m) (thrust m t) (pz (fixed m))) (fixed m) (omega m t) (state m t)))
      with (- fall (of m) (weights_of (its c)) (Jat m t)
        (factor (of m) (thrust m t) (pz (fixed m))) (fixed m) (omega m t) (state m t)) by (field; lra).
    replace (mass (of m) * (- (2 * Q2R (margin c) / mass (of m)) * (squares (weights_of (its c)) (state m t) / 2)))
      with (- (Q2R (margin c) * squares (weights_of (its c)) (state m t))) by (field; lra).
    lra.
Qed.

(** * A level in place of an interval of thrust *)

(** |ρ| = 1: what Rᵀ does to the vertical. *)
Lemma length_zero : forall u, u · u = 0 -> u = zero.
Proof.
  intros [x y z] H. unfold dot in H. cbn [px py pz] in H.
  pose proof (Rle_0_sqr x) as X. pose proof (Rle_0_sqr y) as Y. pose proof (Rle_0_sqr z) as Z.
  unfold Rsqr in *. apply vec_eq; cbn [px py pz zero]; apply Rsqr_0_uniq; unfold Rsqr; lra.
Qed.

Lemma crossed : forall u v w, u · u = 1 -> v · v = 1 -> w · w = 1 -> u · v = 0 -> v · w = 0 -> w · u = 0 ->
  let d := u · (v × w)%vec in d * d = 1 -> (v × w)%vec = (d * u)%vec.
Proof.
  intros u v w U V W UV VW WU d D.
  assert (E : ((v × w) - d * u)%vec · ((v × w) - d * u) = (v · v) * (w · w) - (v · w) * (v · w)
    - 2 * d * d + d * d * (u · u)) by (unfold d; number).
  rewrite U, V, W, VW in E.
  assert (Z : ((v × w) - d * u)%vec = zero) by (apply length_zero; rewrite E; lra).
  clearbody d. revert Z. generalize (v × w)%vec u. intros [a b c] [x y z] Z.
  unfold minus, plus, scale, zero in Z. simpl in Z. injection Z as Z1 Z2 Z3.
  apply vec_eq; components; lra.
Qed.

Lemma upright_unit : forall r, orthonormal r -> back r e3 · back r e3 = 1.
Proof.
  intros [u v w] [U [V [W [UV [VW WU]]]]]. cbn [bx by_ bz] in *.
  set (d := u · (v × w)%vec).
  assert (D : d * d = 1).
  { assert (G : d * d = (u · u) * ((v · v) * (w · w) - (v · w) * (v · w))
      - (u · v) * ((u · v) * (w · w) - (v · w) * (w · u)) + (w · u) * ((u · v) * (v · w) - (v · v) * (w · u)))
      by (unfold d; number).
    rewrite G, U, V, W, UV, VW, WU. ring. }
  pose proof (crossed u v w U V W UV VW WU D) as C1. fold d in C1.
  assert (E2 : v · (w × u)%vec = d) by (unfold d; number).
  assert (E3 : w · (u × v)%vec = d) by (unfold d; number).
  pose proof (crossed v w u V W U VW WU UV) as C2. cbv zeta in C2. rewrite E2 in C2. specialize (C2 D).
  pose proof (crossed w u v W U V WU UV VW) as C3. cbv zeta in C3. rewrite E3 in C3. specialize (C3 D).
  assert (P1 : pz (v × w)%vec = d * pz u) by (rewrite C1; reflexivity).
  assert (P2 : pz (w × u)%vec = d * pz v) by (rewrite C2; reflexivity).
  assert (P3 : pz (u × v)%vec = d * pz w) by (rewrite C3; reflexivity).
  assert (X : pz u * pz (v × w)%vec + pz v * pz (w × u)%vec + pz w * pz (u × v)%vec = d) by (unfold d; number).
  rewrite P1, P2, P3 in X.
  assert (N : d <> 0) by (intro Z; rewrite Z in D; lra).
  apply Rmult_eq_reg_l with d; [|exact N]. rewrite Rmult_1_r.
  transitivity (pz u * (d * pz u) + pz v * (d * pz v) + pz w * (d * pz w)); [|exact X].
  unfold back, dot. cbn [bx by_ bz e3 px py pz]. ring.
Qed.

(** On {L <= l, T > 0}: |T - m g| <= c √(2 l (1/w2 + 1/w3)). *)
Theorem level_bounds_thrust : forall m w l root t,
  positive_gains (of m) -> 0 < w1 w -> 0 < w2 w -> 0 < w3 w -> 0 < w4 w ->
  orthonormal (rot m t) -> 0 < gravity m -> 0 < thrust m t ->
  squares w (state m t) / 2 <= l ->
  0 <= root -> 2 * l * (/ w2 w + / w3 w) <= root * root ->
  let weight := mass (of m) * gravity m in
  weight - stiffness (of m) * root <= thrust m t <= weight + stiffness (of m) * root.
Proof.
  intros m w l root t G W1 W2 W3 W4 O Gr T L R0 R weight.
  set (c := stiffness (of m)).
  assert (C : 0 < c) by (apply c_pos; assumption).
  destruct G as [M _ _ _ _].
  set (a := d2 (state m t)). set (b := d3 (state m t)).
  assert (F : force m t = (c * (b - a))%vec).
  { unfold a, b. cbn [state d2 d3]. unfold delta3. fold c. generalize (force m t) (delta2 m t).
    intros. apply vec_eq; components; field; apart. }
  (* |δ3 - δ2|² <= (1/w2 + 1/w3) (w2|δ2|² + w3|δ3|²) *)
  assert (D : (b - a)%vec · (b - a) <= root * root).
  { assert (S : w2 w * (a · a) + w3 w * (b · b) <= 2 * l).
    { unfold squares in L. fold a b in L.
      pose proof (square_pos (d1 (state m t))) as P1. pose proof (square_pos (d4 (state m t))) as P4.
      pose proof (Rmult_le_pos _ _ (Rlt_le _ _ W1) P1). pose proof (Rmult_le_pos _ _ (Rlt_le _ _ W4) P4). lra. }
    assert (I : 0 < / w2 w + / w3 w).
    { pose proof (Rinv_0_lt_compat _ W2). pose proof (Rinv_0_lt_compat _ W3). lra. }
    pose proof (Rmult_le_compat_r _ _ _ (Rlt_le _ _ I) S) as Z.
    assert (E : (w2 w * (a · a) + w3 w * (b · b)) * (/ w2 w + / w3 w) - (b - a)%vec · (b - a)
      = / (w2 w * w3 w) * ((w2 w * a + w3 w * b)%vec · (w2 w * a + w3 w * b))).
    { generalize a b. clear - W2 W3. intros. components. field. apart. }
    pose proof (square_pos (w2 w * a + w3 w * b)) as Q.
    assert (0 <= / (w2 w * w3 w)) by (left; apply Rinv_0_lt_compat, Rmult_lt_0_compat; assumption).
    pose proof (Rmult_le_pos _ _ H Q). lra. }
  (* |F|² = T² - 2 T m g ρ3 + (m g)² >= (T - m g)² *)
  pose proof (upright_unit _ O) as U. fold (rho m t) in U.
  assert (N : force m t · force m t = thrust m t * thrust m t
    - 2 * thrust m t * weight * pz (rho m t) + weight * weight * (rho m t · rho m t)).
  { unfold force. fold weight. generalize (rho m t). number. }
  rewrite U in N.
  assert (P : pz (rho m t) <= 1).
  { unfold dot in U. pose proof (Rle_0_sqr (px (rho m t))) as X. pose proof (Rle_0_sqr (py (rho m t))) as Y.
    unfold Rsqr in X, Y. assert (pz (rho m t) * pz (rho m t) <= 1) by lra.
    destruct (Rle_or_lt (pz (rho m t)) 1) as [K|K]; [exact K|].
    pose proof (Rmult_le_0_lt_compat 1 (pz (rho m t)) 1 (pz (rho m t)) ltac:(lra) ltac:(lra) K K). lra. }
  assert (Wt : 0 < weight) by (apply Rmult_lt_0_compat; assumption).
  assert (TW : 0 < thrust m t * weight) by (apply Rmult_lt_0_compat; assumption).
  assert (PP : 0 <= thrust m t * weight * (1 - pz (rho m t))) by (apply Rmult_le_pos; lra).
  assert (S : (thrust m t - weight) * (thrust m t - weight) <= (c * root) * (c * root)).
  { assert (K : force m t · force m t <= (c * root) * (c * root)).
    { rewrite F. replace ((c * (b - a))%vec · (c * (b - a))) with (c * c * ((b - a)%vec · (b - a)))
        by (generalize (b - a)%vec; number).
      replace (c * root * (c * root)) with (c * c * (root * root)) by ring.
      apply Rmult_le_compat_l; [|exact D]. left. apply Rmult_lt_0_compat; exact C. }
    lra. }
  assert (CR : 0 <= c * root) by (apply Rmult_le_pos; lra).
  assert (B : - (c * root) <= thrust m t - weight <= c * root); [|lra].
  split.
  - destruct (Rle_or_lt (- (c * root)) (thrust m t - weight)) as [K|K]; [exact K|].
    pose proof (Rmult_le_0_lt_compat (c * root) (- (thrust m t - weight)) (c * root)
      (- (thrust m t - weight)) CR CR ltac:(lra) ltac:(lra)). lra.
  - destruct (Rle_or_lt (thrust m t - weight) (c * root)) as [K|K]; [exact K|].
    pose proof (Rmult_le_0_lt_compat (c * root) (thrust m t - weight) (c * root)
      (thrust m t - weight) CR CR ltac:(lra) ltac:(lra)). lra.
Qed.

(** The interval of thrust of a certificate holds what a level l leaves, by a root of rationals. *)
Definition level_ok (g l root : Q) (c : certificate) : bool :=
  let n := its c in
  let stiff := (qk1 n * qk1 n * qk2 n / qmass n)%Q in
  above 0 g && Qle_bool 0 root && Qle_bool (2 * l * (/ qw2 n + / qw3 n)) (root * root)
  && Qle_bool (thrust_low c) (qmass n * g - stiff * root)
  && Qle_bool (qmass n * g + stiff * root) (thrust_high c).

Theorem level_sound : forall g l root c m t,
  level_ok g l root c = true -> certificate_ok c = true ->
  of m = loop_of (its c) -> gravity m = Q2R g -> orthonormal (rot m t) -> 0 < thrust m t ->
  squares (weights_of (its c)) (state m t) / 2 <= Q2R l ->
  within (thrust_low c) (thrust_high c) (thrust m t).
Proof.
  intros g l root c m t K C E Gr O T L.
  unfold level_ok in K. repeat (apply andb_prop in K; let H := fresh "K" in destruct K as [K H]).
  apply above_correct in K. rewrite Q2R_zero in K.
  repeat match goal with H : Qle_bool _ _ = true |- _ =>
    apply Qle_bool_iff, Qle_Rle in H; rewrite ?Q2R_zero in H end.
  pose proof C as C'. unfold certificate_ok in C'.
  repeat (apply andb_prop in C'; let H := fresh "H" in destruct C' as [C' H]).
  repeat match goal with H : above 0 _ = true |- _ =>
    apply above_correct in H; rewrite ?Q2R_zero in H end.
  assert (NZ : forall q, 0 < Q2R q -> ~ (q == 0)%Q).
  { intros q P Z. apply Qeq_eqR in Z. rewrite Q2R_zero in Z. lra. }
  unfold Qdiv in *.
  repeat match goal with H : context [Q2R _] |- _ =>
    progress (rewrite ?Q2R_minus, ?Q2R_plus, ?Q2R_mult in H) end.
  repeat match goal with H : context [Q2R (/ ?q)] |- _ =>
    rewrite (Q2R_inv q) in H by (apply NZ; assumption) end.
  replace (Q2R 2) with 2 in * by (unfold Q2R; simpl; field).
  assert (G : positive_gains (of m)) by (rewrite E; split; assumption).
  pose proof (level_bounds_thrust m (weights_of (its c)) (Q2R l) (Q2R root) t G
    ltac:(assumption) ltac:(assumption) ltac:(assumption) ltac:(assumption) O ltac:(lra) T L
    ltac:(assumption) ltac:(assumption)) as B.
  cbv zeta in B. rewrite E, Gr in B. unfold stiffness in B. cbn [loop_of mass k1 k2] in B.
  unfold Rdiv in B. unfold within. lra.
Qed.

