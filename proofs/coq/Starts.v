(** Theorem 5: what a start is, and when the vehicle is near.

    A start is a set of states: by how far what a level camera sees is off, by speed, force and body rates, with
    the rotors steady. From bounds of these follows that Ψ is at most what the certificate says. *)

Require Import QArith Qreals Reals List Bool Lra.
From Hoverproof Require Import Forms Space Calculus Loop Image Body Gains Tolerant Late Vehicle Length Stays.
Import ListNotations.
Open Scope R_scope.

(** How far what a level camera sees is off, and the part of that along the horizon; speed (m/s), force (N) and
    rate of roll and pitch (1/s). And what follows: the cosine of the tilt from below, 2 sin(tilt/2) from above,
    the horizontal part of δ1, and the Ω that goes with ζ. *)
Record start (A : Type) := Start {
  off_by : A; level_off : A; speed0 : A; force0 : A; rate0 : A; cosine : A; lean : A; flat1 : A; turn0 : A }.
Arguments off_by {A}. Arguments level_off {A}. Arguments speed0 {A}. Arguments force0 {A}. Arguments rate0 {A}.
Arguments cosine {A}. Arguments lean {A}. Arguments flat1 {A}. Arguments turn0 {A}. Arguments Start {A}.

(** |P Rᵀx| is at most |Px| and what a tilt adds. *)
Lemma flat_back : forall r u a, orthonormal r -> 0 <= a -> 2 - 2 * pz (back r e3) <= a * a ->
  len (flat (back r u)) <= len (flat u) + a * len u.
Proof.
  intros r u a O A H. pose proof (len_pos (flat u)). pose proof (len_pos u).
  assert (AU : 0 <= a * len u) by (apply Rmult_le_pos; assumption).
  assert (Z : bz r · bz r = 1) by apply O.
  set (w := (u - pz u * bz r)%vec).
  assert (W : len w <= len (flat u) + a * len u).
  { replace w with (flat u + pz u * (e3 - bz r))%vec by (unfold w; vector).
    eapply Rle_trans; [apply len_plus|]. apply Rplus_le_compat_l. rewrite len_scale, Rmult_comm.
    apply Rmult_le_compat; [apply len_pos|apply Rabs_pos| |apply pz_len].
    apply len_at_most; [exact A|]. eapply Rle_trans; [|exact H]. right.
    replace ((e3 - bz r)%vec · (e3 - bz r)) with (1 - 2 * pz (bz r) + bz r · bz r) by number. rewrite Z.
    unfold back. number. }
  apply Rle_trans with (len w); [|exact W]. apply below_square; [apply len_pos|]. rewrite !len_square.
  assert (E1 : flat (back r u) · flat (back r u) = u · u - (bz r · u) * (bz r · u)).
  { rewrite <- (back_square r u O). unfold back. number. }
  assert (E2 : w · w = u · u - 2 * pz u * (bz r · u) + pz u * pz u * (bz r · bz r)) by (unfold w; number).
  rewrite E1, E2, Z. pose proof (Rle_0_sqr (bz r · u - pz u)) as S. unfold Rsqr in S. lra.
Qed.

(** What a start's numbers are to be. *)
Record begun (g : loop) (grav : R) (b : limits R) (c : matrices) (s : start R) : Prop := {
  start_sizes : 0 <= off_by s /\ 0 <= level_off s /\ 0 <= speed0 s /\ 0 <= force0 s /\ 0 <= rate0 s /\
    0 <= cosine s /\ 0 <= lean s /\ 0 <= flat1 s /\ 0 <= turn0 s;
  force_low : force0 s + mass g * windy b < mass g * grav;
  cosine_is : let sine := force0 s + mass g * windy b in
    cosine s * cosine s * (mass g * grav * (mass g * grav)) + sine * sine <= mass g * grav * (mass g * grav);
  lean_is : let sine := force0 s + mass g * windy b in
    2 * (sine * sine) <= lean s * lean s * (1 + cosine s) * (mass g * grav * (mass g * grav));
  flat_is : off_by s <= flat1 s \/ level_off s + lean s * off_by s <= flat1 s;
  turn0_is : (mass g * grav + force0 s) * rate0 s <= Vehicle.c g * kappa_ g * turn0 s;
  speed0_is : speed0 s <= k1 g / mass g * fast b;
  psi_is : let k := real_constants (its_constants c) in
    let moved := mass g / k1 g * speed0 s in let pushed := / Vehicle.c g * force0 s in
    let e2 := off_by s + moved in let e3 := e2 + pushed in
    let e4 := flat1 s + moved + pushed + turn0 s in
    let asked := stiff_ g * e4 + k12_ g * pushed in
    let flows := (Q2R (middle c) + Q2R (reach c)) * speed0 s in
    off_by s * off_by s + v2 k * (e2 * e2) + v3 k * (e3 * e3) + v4 k * (e4 * e4)
    + Q2R (lag_most c) * (a5 k * (asked * asked) + a6 k * (kappa_ g * e3 * (kappa_ g * e3)))
    + keeps b * (latest b * flows * (latest b * flows)) <= 2 * start_of b }.

(** The states that it holds. *)
Record held (v : craft) (b : limits R) (inside : vec -> Prop) (s : start R) : Prop := {
  held_up : 0 < lifts_by v 0;
  held_off : len (from v (place v 0) - wanted_height v * e3)%vec <= off_by s;
  held_level : len (flat (from v (place v 0) - wanted_height v * e3)%vec) <= level_off s;
  held_force : len (pull (gains v) (pull_down v) (breeze v) (attitude v) (lifts_by v) 0) <= force0 s;
  held_rate : len (flat (spins_by v 0)) <= rate0 s;
  held_rise : set_rise v 0 = 0;
  held_turn : set_turn v 0 = zero;
  held_inside : forall t, - latest b <= t <= 0 -> inside (place v t);
  held_speed : forall t, - latest b <= t <= 0 -> len (speeds_by v t) <= speed0 s }.

Lemma product_below : forall a u v e, 0 <= a -> u · v <= e -> a * (u · v) <= a * e.
Proof. intros. apply Rmult_le_compat_l; assumption. Qed.

Section Start.
Variables (v : craft) (b : limits R) (c : matrices) (until : R) (inside : vec -> Prop) (flown again : R -> R)
  (s : start R).
Hypothesis F : follows (gains v) (pull_down v) b c.
Hypothesis Kept : exists MQ TQ, memory_ok MQ TQ c = true /\ keeps b = Q2R MQ /\ latest b = Q2R TQ.
Hypothesis D : domain v c (far b) inside.
Hypothesis Mo : motion v b c until.
Hypothesis In : integrals v b c until flown again.
Hypothesis Bs : begun (gains v) (pull_down v) b c s.
Hypothesis H : held v b inside s.
Hypothesis U : 0 < until.

Local Notation K := (real_constants (its_constants c)).
Local Notation g := (gains v).
Local Notation x := (moment_of v).
Local Notation W := (mass (gains v) * pull_down v).

Lemma pos_latest : 0 < latest b.
Proof. apply (sizes _ _ _ _ F). Qed.
Lemma orthonormal_0 : orthonormal (attitude v 0).
Proof. apply (is_whole _ _ _ _ Mo). pose proof pos_latest. lra. Qed.

Lemma W_pos : 0 < W.
Proof. destruct (positive _ _ _ _ F) as [[P1 _ _ _ _] P]. apply Rmult_lt_0_compat; assumption. Qed.
Lemma C0 : 0 < Vehicle.c g /\ 0 < kappa_ g.
Proof. destruct (positive _ _ _ _ F) as [P _]. split; [apply c_is_pos|apply kappa_pos]; exact P. Qed.

(** ** The tilt *)
Lemma tilt_0 : 2 - 2 * pz (below (attitude v) 0) <= lean s * lean s.
Proof.
  pose proof W_pos as W0. pose proof orthonormal_0 as O. set (r := below (attitude v) 0).
  destruct (start_sizes _ _ _ _ _ Bs) as [S1 [S2 [S3 [S4 [S5 [S6 [S7 _]]]]]]].
  pose proof (force_low _ _ _ _ _ Bs) as FL. pose proof (cosine_is _ _ _ _ _ Bs) as CI.
  pose proof (lean_is _ _ _ _ _ Bs) as LI. cbv zeta in CI, LI. set (sine := force0 s + mass g * windy b) in *.
  set (w := blown g (breeze v) (attitude v) 0).
  set (f := pull g (pull_down v) (breeze v) (attitude v) (lifts_by v) 0).
  assert (Wb : len w <= mass g * windy b).
  { unfold w, blown. apply len_scaled; [|rewrite len_back by exact O; apply (wind_within _ _ _ _ Mo)].
    destruct (positive _ _ _ _ F) as [[P1 _ _ _ _] _]. rewrite Rabs_right; lra. }
  assert (A : len (f - w)%vec <= sine) by (apply len_minus_to; [apply (held_force _ _ _ _ H)|exact Wb]).
  assert (Fe : f = ((- lifts_by v 0) * e3 + W * r + w)%vec) by reflexivity.
  assert (RR : r · r = 1) by (unfold r, below; rewrite back_square by exact O; number).
  pose proof (held_up _ _ _ _ H) as Up. set (T := lifts_by v 0) in *.
  pose proof (at_most_len _ _ A) as S. assert (S0 : 0 <= sine) by (pose proof (len_pos (f - w)%vec); lra).
  assert (Q : sine * sine < W * W) by (apply Rmult_le_0_lt_compat; lra).
  assert (Rz : 0 < pz r).
  { assert (E : (f - w)%vec · (f - w) = W * W * (r · r) - 2 * (T * W) * pz r + T * T).
    { rewrite Fe. generalize w r T. number. }
    rewrite E, RR in S. pose proof (Rmult_lt_0_compat _ _ Up Up). pose proof (Rmult_lt_0_compat _ _ Up W0) as TW.
    destruct (Rle_or_lt (pz r) 0) as [N|N]; [|exact N].
    assert (0 <= T * W * (- pz r)) by (apply Rmult_le_pos; lra). lra. }
  assert (Fl : W * W * (1 - pz r * pz r) <= sine * sine).
  { eapply Rle_trans; [|exact S].
    assert (E : (f - w)%vec · (f - w) = W * W * (r · r - pz r * pz r) + (T - W * pz r) * (T - W * pz r)).
    { rewrite Fe. generalize w r T. number. }
    rewrite E, RR. pose proof (Rle_0_sqr (T - W * pz r)) as Sq. unfold Rsqr in Sq. lra. }
  assert (WW : 0 < W * W) by (apply Rmult_lt_0_compat; exact W0).
  assert (Co : cosine s <= pz r).
  { apply below_square; [lra|]. apply Rmult_le_reg_l with (W * W); [exact WW|]. lra. }
  apply Rmult_le_reg_r with ((1 + pz r) * (W * W)); [apply Rmult_lt_0_compat; lra|].
  apply Rle_trans with (2 * (sine * sine)); [lra|]. eapply Rle_trans; [exact LI|].
  replace (lean s * lean s * (1 + cosine s) * (W * W)) with (lean s * lean s * (W * W) * (1 + cosine s)) by ring.
  replace (lean s * lean s * ((1 + pz r) * (W * W))) with (lean s * lean s * (W * W) * (1 + pz r)) by ring.
  apply Rmult_le_compat_l; [|lra]. apply Rmult_le_pos; [apply Rmult_le_pos; assumption|lra].
Qed.

(** ** The errors *)
Local Notation moved := (mass (gains v) / k1 (gains v) * speed0 s).
Local Notation pushed := (/ Vehicle.c (gains v) * force0 s).
Local Notation F0 := (pull (gains v) (pull_down v) (breeze v) (attitude v) (lifts_by v) 0).
Local Notation V0 := ((mass (gains v) / k1 (gains v)) * speeds_by v 0)%vec.

Lemma off_0 : d1 (err (x 0)) = back (attitude v 0) (from v (place v 0) - wanted_height v * e3)%vec.
Proof.
  change (d1 (err (x 0))) with (er1 (wanted_height v) (sees_by v) To_vertical (marks v) (counted v) (place v)
    (attitude v) 0). unfold er1, sight, wants, below. rewrite feature_turned by exact orthonormal_0.
  rewrite <- back_scale, <- back_minus. reflexivity.
Qed.
Lemma d1_0 : len (d1 (err (x 0))) <= off_by s.
Proof. rewrite off_0, len_back by exact orthonormal_0. apply (held_off _ _ _ _ H). Qed.
Lemma flat_0 : len (flat (d1 (err (x 0)))) <= flat1 s.
Proof.
  destruct (start_sizes _ _ _ _ _ Bs) as [S1 [S2 [S3 [S4 [S5 [S6 [S7 _]]]]]]].
  destruct (flat_is _ _ _ _ _ Bs) as [L|L]; (eapply Rle_trans; [|exact L]).
  - eapply Rle_trans; [apply len_flat|exact d1_0].
  - rewrite off_0. eapply Rle_trans; [apply (flat_back _ _ (lean s) orthonormal_0 S7 tilt_0)|].
    apply Rplus_le_compat; [apply (held_level _ _ _ _ H)|]. apply Rmult_le_compat_l; [exact S7|apply (held_off _ _ _ _ H)].
Qed.
Lemma moved_0 : len V0 <= moved.
Proof.
  destruct (positive _ _ _ _ F) as [[P1 P2 _ _ _] _]. apply len_scaled.
  - rewrite Rabs_right; [lra|]. apply Rle_ge, Rlt_le, Rdiv_lt_0_compat; assumption.
  - apply (held_speed _ _ _ _ H). pose proof pos_latest. lra.
Qed.
Lemma pushed_0 : len (/ Vehicle.c g * F0)%vec <= pushed.
Proof.
  destruct C0 as [C _]. apply len_scaled; [|apply (held_force _ _ _ _ H)].
  rewrite Rabs_right; [lra|]. apply Rle_ge, Rlt_le, Rinv_0_lt_compat, C.
Qed.
Lemma d2_is : d2 (err (x 0)) = (V0 - d1 (err (x 0)))%vec. Proof. reflexivity. Qed.
Lemma d3_is : d3 (err (x 0)) = (/ Vehicle.c g * F0 + d2 (err (x 0)))%vec. Proof. reflexivity. Qed.
Lemma d2_0 : len (d2 (err (x 0))) <= off_by s + moved.
Proof. rewrite d2_is, Rplus_comm. apply len_minus_to; [exact moved_0|exact d1_0]. Qed.
Lemma d3_0 : len (d3 (err (x 0))) <= off_by s + moved + pushed.
Proof. rewrite d3_is, (Rplus_comm (off_by s + moved)). apply len_plus_to; [exact pushed_0|exact d2_0]. Qed.
Lemma zeta_0 : len (zeta g (wanted_height v) To_vertical (breeze v) (attitude v) (spins_by v) (lifts_by v) 0) <= turn0 s.
Proof.
  destruct C0 as [C Kp]. pose proof W_pos as W0. pose proof orthonormal_0 as O.
  assert (CK : 0 < Vehicle.c g * kappa_ g) by (apply Rmult_lt_0_compat; assumption).
  destruct (start_sizes _ _ _ _ _ Bs) as [S1 [S2 [S3 [S4 [S5 _]]]]].
  assert (A : Rabs (arm_of v 0) <= W + force0 s).
  { set (r := (W * below (attitude v) 0)%vec).
    assert (E : (F0 - r)%vec · (F0 - r) = arm_of v 0 * arm_of v 0
      + flat (blown g (breeze v) (attitude v) 0) · flat (blown g (breeze v) (attitude v) 0)).
    { rewrite arm_is. unfold pull, r. generalize (below (attitude v) 0) (blown g (breeze v) (attitude v) 0). number. }
    assert (L : len (F0 - r)%vec <= force0 s + W).
    { apply len_minus_to; [apply (held_force _ _ _ _ H)|]. unfold r. rewrite len_scale.
      unfold below. rewrite len_back by exact O. replace (len e3) with 1.
      - rewrite Rabs_right; lra.
      - unfold len. replace (e3 · e3) with 1 by number. symmetry. apply sqrt_1. }
    apply below_square; [lra|]. rewrite <- Rabs_mult, Rabs_right by (apply Rle_ge, Rle_0_sqr).
    pose proof (at_most_len _ _ L) as Q. rewrite E in Q.
    pose proof (square_pos (flat (blown g (breeze v) (attitude v) 0))). lra. }
  unfold zeta, per. fold (arm_of v 0).
  apply Rle_trans with ((W + force0 s) / (Vehicle.c g * kappa_ g) * rate0 s).
  - apply len_scaled; [|rewrite len_quarter; apply (held_rate _ _ _ _ H)].
    unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ _)) by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat, CK).
    apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, CK|exact A].
  - apply Rmult_le_reg_l with (Vehicle.c g * kappa_ g); [exact CK|].
    replace (Vehicle.c g * kappa_ g * ((W + force0 s) / (Vehicle.c g * kappa_ g) * rate0 s))
      with ((W + force0 s) * rate0 s) by (field; lra).
    apply (turn0_is _ _ _ _ _ Bs).
Qed.
Local Notation er4_0 := (er4 (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v)
  (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) 0).
Local Notation most4 := (flat1 s + moved + pushed + turn0 s).
Lemma er4_within : len er4_0 <= most4.
Proof.
  unfold er4. change (er3 (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v)
    (breeze v) (place v) (attitude v) (speeds_by v) (lifts_by v) 0) with (d3 (err (x 0))).
  rewrite (Rplus_comm _ (turn0 s)). apply len_plus_to; [exact zeta_0|].
  rewrite d3_is, d2_is.
  replace (flat (/ Vehicle.c g * F0 + (V0 - d1 (err (x 0)))))%vec
    with (flat V0 - flat (d1 (err (x 0))) + flat (/ Vehicle.c g * F0))%vec
    by (generalize (/ Vehicle.c g * F0)%vec V0 (d1 (err (x 0))); vector).
  apply len_plus_to; [|eapply Rle_trans; [apply len_flat|exact pushed_0]].
  rewrite (Rplus_comm (flat1 s)). apply len_minus_to; [|exact flat_0].
  eapply Rle_trans; [apply len_flat|exact moved_0].
Qed.
Lemma d4_0 : len (d4 (err (x 0))) <= most4.
Proof. eapply Rle_trans; [|exact er4_within]. apply (len_flat er4_0). Qed.

Local Notation asked0 := (stiff_ (gains v) * most4 + k12_ (gains v) * pushed).
Lemma gains_pos : 0 < stiff_ g /\ 0 < k12_ g.
Proof.
  destruct (positive _ _ _ _ F) as [[P1 P2 P3 P4 P5] _]. destruct C0 as [_ Kp]. split.
  - unfold stiff_. apply Rplus_lt_0_compat; [exact Kp|apply Rdiv_lt_0_compat; assumption].
  - unfold k12_. apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat|]; assumption.
Qed.
Lemma mu_0 : len (mu (x 0)) <= asked0.
Proof.
  destruct gains_pos as [G1 G2].
  set (u := lags_turn (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v)
    (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_turn v) 0).
  change (mu (x 0)) with (flat u). eapply Rle_trans; [apply len_flat|]. unfold u, lags_turn, nominal.
  rewrite (held_turn _ _ _ _ H).
  change (er3 (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v)
    (breeze v) (place v) (attitude v) (speeds_by v) (lifts_by v) 0) with (d3 (err (x 0))).
  change (er2 (gains v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v) (place v) (attitude v)
    (speeds_by v) 0) with (d2 (err (x 0))).
  rewrite d3_is.
  match goal with |- len ?e <= _ => replace e with (stiff_ g * er4_0 + k12_ g * flat (/ Vehicle.c g * F0))%vec
    by (generalize (/ Vehicle.c g * F0)%vec (d2 (err (x 0))) er4_0; vector) end.
  apply len_plus_to; (apply len_scaled; [rewrite Rabs_right; lra|]); [exact er4_within|].
  eapply Rle_trans; [apply len_flat|exact pushed_0].
Qed.
Lemma lift_0 : len (lift (x 0)) <= kappa_ g * (off_by s + moved + pushed).
Proof.
  destruct C0 as [_ Kp]. change (lift (x 0)) with (up (V 0 0 (sinking (x 0)))). rewrite len_up. cbn [pz].
  change (sinking (x 0)) with (set_rise v 0 / Vehicle.c g - kappa_ g * pz (d3 (err (x 0)))).
  rewrite (held_rise _ _ _ _ H). replace (0 / Vehicle.c g - kappa_ g * pz (d3 (err (x 0))))
    with (- (kappa_ g * pz (d3 (err (x 0))))) by (unfold Rdiv; ring).
  rewrite Rabs_Ropp, Rabs_mult, (Rabs_right (kappa_ g)) by lra. apply Rmult_le_compat_l; [lra|].
  eapply Rle_trans; [apply pz_len|exact d3_0].
Qed.

(** The memory of how it moved before. *)
Local Notation flows := ((Q2R (middle c) + Q2R (reach c)) * speed0 s).
Lemma memory_0 : memory (keeps b) (latest b) (pace K) flown again 0
  <= keeps b * (latest b * flows * (latest b * flows)) / 2.
Proof.
  pose proof pos_latest as L0. destruct (kept_pos v b c F Kept) as [M0 P0].
  destruct (ball_is _ _ _ _ F) as [J0 R0]. destruct (start_sizes _ _ _ _ _ Bs) as [_ [_ [S3 _]]].
  set (k := flows). assert (K0 : 0 <= k) by (apply Rmult_le_pos; lra).
  assert (Fl : forall z, - latest b <= z <= 0 -> flow_of v z · flow_of v z <= k * k).
  { intros z Z. apply at_most_len. rewrite (flow_turned v b c until Mo) by lra.
    rewrite len_back by (apply (is_whole _ _ _ _ Mo); lra).
    eapply Rle_trans; [eapply slope_within; [eassumption..|apply (held_inside _ _ _ _ H); lra]|].
    unfold way_of. rewrite len_turned by (apply (is_whole _ _ _ _ Mo); lra).
    apply Rmult_le_compat_l; [lra|apply (held_speed _ _ _ _ H); lra]. }
  assert (Grow : forall z, - latest b <= z <= 0 -> flown 0 + k * k * z <= flown z).
  { intros z Z. assert (Q : flown 0 - k * k * 0 <= flown z - k * k * z); [|lra].
    apply (falling (fun y => flown y - k * k * y) (fun y => exp (pace K * y) * (flow_of v y · flow_of v y) - k * k * 1));
      [lra|]. intros y Y. split.
    - apply slope_minus; [apply In; lra|]. apply slope_scale, derivable_pt_lim_id.
    - pose proof (Fl y ltac:(lra)) as Q. pose proof (square_pos (flow_of v y)) as Q0.
      assert (E : exp (pace K * y) <= 1).
      { rewrite <- exp_0, <- (Rmult_0_r (pace K)). apply exp_grows; lra. }
      pose proof (Rmult_le_compat_r _ _ _ Q0 E). lra. }
  assert (Q : again (- latest b) - (flown 0 * - latest b + k * k * (- latest b * - latest b) / 2)
    <= again 0 - (flown 0 * 0 + k * k * (0 * 0) / 2)).
  { assert (N : -1 * (again 0 - (flown 0 * 0 + k * k * (0 * 0) / 2))
      <= -1 * (again (- latest b) - (flown 0 * - latest b + k * k * (- latest b * - latest b) / 2))); [|lra].
    apply (falling (fun y => -1 * (again y - (flown 0 * y + k * k * (y * y) / 2)))
      (fun y => -1 * (flown y - (flown 0 * 1 + / 2 * (k * k * (1 * y + y * 1)))))); [lra|].
    intros y Y. split; [|pose proof (Grow y Y); lra].
    apply slope_scale, slope_minus; [apply In; lra|]. apply slope_plus.
    - apply slope_scale, derivable_pt_lim_id.
    - apply (slope_ext (fun y => / 2 * (k * k * (y * y)))); [intros; unfold Rdiv; ring|].
      apply slope_scale, slope_scale, (slope_mult (fun y => y) (fun y => y)); apply derivable_pt_lim_id. }
  unfold memory. rewrite Rmult_0_r, exp_0, Rminus_0_l.
  unfold Rdiv. rewrite Rmult_assoc. apply Rmult_le_compat_l; [exact M0|]. lra.
Qed.

Lemma start_psi : psi v b c flown again 0 <= start_of b.
Proof.
  pose proof (psi_is _ _ _ _ _ Bs) as P. cbv zeta in P. unfold psi. pose proof memory_0 as Me.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 [V5 V6]]]]. destruct (lag_within _ _ _ _ Mo) as [L1 L2].
  unfold energy. change (tau (corner_of v 0)) with (behind v).
  pose proof (at_most_len _ _ d1_0) as Q1.
  pose proof (product_below _ _ _ _ (Rlt_le _ _ V2) (at_most_len _ _ d2_0)) as Q2.
  pose proof (product_below _ _ _ _ (Rlt_le _ _ V3) (at_most_len _ _ d3_0)) as Q3.
  pose proof (product_below _ _ _ _ (Rlt_le _ _ V4) (at_most_len _ _ d4_0)) as Q4.
  pose proof (product_below _ _ _ _ V5 (at_most_len _ _ mu_0)) as Q5.
  pose proof (product_below _ _ _ _ V6 (at_most_len _ _ lift_0)) as Q6.
  pose proof (Rmult_le_pos _ _ V5 (square_pos (mu (x 0)))). pose proof (Rmult_le_pos _ _ V6 (square_pos (lift (x 0)))).
  assert (Q : behind v * (a5 K * (mu (x 0) · mu (x 0)) + a6 K * (lift (x 0) · lift (x 0)))
    <= Q2R (lag_most c) * (a5 K * (asked0 * asked0)
       + a6 K * (kappa_ g * (off_by s + moved + pushed) * (kappa_ g * (off_by s + moved + pushed))))).
  { apply Rmult_le_compat; lra. }
  lra.
Qed.

(** From all states of a start a motion begins as [vehicle_stays] has it. *)
Theorem start_begins : begins v b c inside flown again.
Proof.
  destruct (bounds_are _ _ _ _ F) as [_ [S0 [_ [_ [_ [_ [M0 _]]]]]]]. destruct C0 as [C Kp].
  constructor.
  - apply (held_up _ _ _ _ H).
  - exact start_psi.
  - rewrite (held_rise _ _ _ _ H), Rabs_R0. apply Rmult_le_pos; [left; apply Rmult_lt_0_compat; assumption|lra].
  - apply (held_inside _ _ _ _ H).
  - intros t T. eapply Rle_trans; [apply (held_speed _ _ _ _ H); exact T|apply (speed0_is _ _ _ _ _ Bs)].
Qed.
End Start.

(** * When the vehicle is near *)

(** e^y is above a part of its series. *)
Lemma series_below : forall y, 0 <= y ->
  1 + y + y * y / 2 + y * y * y / 6 + y * y * y * y / 24 + y * y * y * y * y / 120 <= exp y.
Proof.
  intros y Y. set (f := fun z => (1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24 + z * z * z * z * z / 120)).
  assert (Q : f y * exp (-1 * y) <= f 0 * exp (-1 * 0)).
  { apply (falling (fun z => f z * exp (-1 * z))
      (fun z => (1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24) * exp (-1 * z) + f z * (-1 * exp (-1 * z)))
      0 y Y). intros z Z. split.
    - apply (slope_mult f (fun z => exp (-1 * z))); [|apply slope_exp]. unfold f.
      assert (I : slope (fun z => z) z 1) by apply derivable_pt_lim_id.
      pose proof (slope_mult _ _ _ _ _ I I) as I2. pose proof (slope_mult _ _ _ _ _ I2 I) as I3.
      pose proof (slope_mult _ _ _ _ _ I3 I) as I4. pose proof (slope_mult _ _ _ _ _ I4 I) as I5. cbv beta in *.
      eapply slope_is.
      + apply (slope_ext (fun z => 1 + z + / 2 * (z * z) + / 6 * (z * z * z) + / 24 * (z * z * z * z)
          + / 120 * (z * z * z * z * z))); [intros; unfold Rdiv; ring|].
        repeat apply slope_plus; [apply slope_const|exact I| | | |]; apply slope_scale; eassumption.
      + cbv beta. field.
    - pose proof (exp_pos (-1 * z)) as E. unfold f.
      assert (0 <= z * z * z * z * z) by (repeat apply Rmult_le_pos; lra).
      assert (0 <= z * z * z * z * z / 120 * exp (-1 * z)) by (apply Rmult_le_pos; lra). lra. }
  rewrite Rmult_0_r, exp_0 in Q. unfold f in Q at 2.
  assert (E : exp (-1 * y) * exp y = 1) by (rewrite <- exp_plus; replace (-1 * y + y) with 0 by ring; apply exp_0).
  pose proof (exp_pos y) as P. pose proof (Rmult_le_compat_r _ _ _ (Rlt_le _ _ P) Q) as R.
  rewrite Rmult_assoc, E in R. unfold f in R. lra.
Qed.

(** From a time on: how near what a level camera sees then is, the time (s), a 64th of r times the time, and
    bounds of e to that, to twice, ..., to 64 times that. *)
Record settling := Settling { near_off : Q; after : Q; sixtyfourth : Q; first_power : Q; powers : list Q }.

Fixpoint squared (a : Q) (l : list Q) : bool :=
  match l with [] => Qle_bool 0 a | e :: l => Qle_bool 0 a && Qle_bool e (a * a) && squared e l end.
Lemma last_of : forall (l : list Q) e a, last (e :: l) a = last l e.
Proof.
  induction l as [|f l IH]; intros e a; [reflexivity|].
  change (last (f :: l) a = last (f :: l) e). rewrite !IH. reflexivity.
Qed.
Lemma squared_below : forall l a x, squared a l = true -> Q2R a <= exp x ->
  0 <= Q2R (last l a) <= exp (x * 2 ^ length l).
Proof.
  induction l as [|e l IH]; intros a x S L; cbn [squared] in S.
  - apply Qle_bool_iff, Qle_Rle in S. rewrite Q2R_zero in S. cbn [last length pow]. rewrite Rmult_1_r. lra.
  - apply andb_prop in S. destruct S as [S S2]. apply andb_prop in S. destruct S as [S0 S1].
    apply Qle_bool_iff, Qle_Rle in S0. rewrite Q2R_zero in S0. apply Qle_bool_iff, Qle_Rle in S1. rewrite Q2R_mult in S1.
    assert (E : Q2R e <= exp (2 * x)).
    { eapply Rle_trans; [exact S1|]. replace (2 * x) with (x + x) by ring. rewrite exp_plus.
      apply Rmult_le_compat; assumption. }
    specialize (IH e (2 * x) S2 E). replace (last (e :: l) a) with (last l e).
    + replace (x * 2 ^ length (e :: l)) with (2 * x * 2 ^ length l) by (cbn [length pow]; ring). exact IH.
    + symmetry. apply last_of.
Qed.

Definition settled_ok (b : limits Q) (c : matrices) (z : settling) : bool :=
  let y := sixtyfourth z in
  Qle_bool 0 y && Qle_bool 0 (near_off z) && Qle_bool 0 (after z) && Qle_bool (64 * y) (pace (its_constants c) * after z)
  && Qle_bool (first_power z)
    (1 + y + y * y * (1 # 2) + y * y * y * (1 # 6) + y * y * y * y * (1 # 24) + y * y * y * y * y * (1 # 120))
  && squared (first_power z) (powers z) && (length (powers z) =? 6)%nat
  && Qle_bool (2 * start_of b) (near_off z * near_off z * last (powers z) (first_power z)).

Lemma settled_sound : forall b c z, settled_ok b c z = true ->
  let r := pace (real_constants (its_constants c)) in
  0 <= Q2R (near_off z) /\ 0 <= Q2R (after z) /\
  2 * Q2R (start_of b) * exp (- r * Q2R (after z)) <= Q2R (near_off z) * Q2R (near_off z).
Proof.
  intros b c z O r. unfold settled_ok in O.
  do 7 (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  apply Nat.eqb_eq in O1.
  repeat match goal with H : Qle_bool _ _ = true |- _ => apply Qle_bool_iff, Qle_Rle in H end.
  rewrite Q2R_zero in *. set (y := Q2R (sixtyfourth z)) in *.
  assert (Two : Q2R 2 = 2) by (unfold Q2R; simpl; field). assert (Many : Q2R 64 = 64) by (unfold Q2R; simpl; field).
  assert (H2 : Q2R (1 # 2) = / 2) by (unfold Q2R; simpl; field). assert (H6 : Q2R (1 # 6) = / 6) by (unfold Q2R; simpl; field).
  assert (H24 : Q2R (1 # 24) = / 24) by (unfold Q2R; simpl; field).
  assert (H120 : Q2R (1 # 120) = / 120) by (unfold Q2R; simpl; field).
  repeat rewrite ?Q2R_plus, ?Q2R_mult, ?Q2R_one, ?Two, ?Many, ?H2, ?H6, ?H24, ?H120 in O3.
  repeat rewrite ?Q2R_mult, ?Many in O4. repeat rewrite ?Q2R_mult, ?Two in O0. fold y in O3, O4.
  change (Q2R (pace (its_constants c))) with r in O4.
  split; [assumption|]. split; [assumption|].
  assert (L : Q2R (first_power z) <= exp y).
  { eapply Rle_trans; [exact O3|]. eapply Rle_trans; [|apply series_below; exact O]. unfold Rdiv. lra. }
  destruct (squared_below _ _ _ O2 L) as [P0 P]. rewrite O1 in P.
  assert (P' : Q2R (last (powers z) (first_power z)) <= exp (r * Q2R (after z))).
  { eapply Rle_trans; [exact P|]. replace (y * 2 ^ 6) with (64 * y) by ring.
    destruct O4 as [O4|O4]; [left; apply exp_increasing; exact O4|right; f_equal; exact O4]. }
  pose proof (exp_pos (- r * Q2R (after z))) as E.
  assert (E1 : exp (r * Q2R (after z)) * exp (- r * Q2R (after z)) = 1).
  { rewrite <- exp_plus. replace (r * Q2R (after z) + - r * Q2R (after z)) with 0 by ring. apply exp_0. }
  apply Rle_trans with (Q2R (near_off z) * Q2R (near_off z) * exp (r * Q2R (after z)) * exp (- r * Q2R (after z))).
  - apply Rmult_le_compat_r; [lra|]. eapply Rle_trans; [exact O0|]. apply Rmult_le_compat_l; [|exact P'].
    apply Rmult_le_pos; assumption.
  - rewrite Rmult_assoc, E1. lra.
Qed.

(** * The decision about a start *)

Definition real_start (s : start Q) : start R :=
  Start (Q2R (off_by s)) (Q2R (level_off s)) (Q2R (speed0 s)) (Q2R (force0 s)) (Q2R (rate0 s)) (Q2R (cosine s))
    (Q2R (lean s)) (Q2R (flat1 s)) (Q2R (turn0 s)).

Section Decision.
Variables (n : setting) (b : limits Q) (c : matrices) (s : start Q).
Local Notation k := (its_constants c).
Local Notation m := (m_of n).
Let stiffQ := (k1_of n * k1_of n * k2_of n / m)%Q.
Let kapQ := ((k1_of n * k2_of n + k3_of n) / m)%Q.
Let W := (m * g_of n)%Q.
Let sine := (force0 s + m * windy b)%Q.

Definition start_sizes_ok : list Q :=
  [off_by s; level_off s; speed0 s; force0 s; rate0 s; cosine s; lean s; flat1 s; turn0 s].
Definition start_psi_of : Q :=
  let moved := (m / k1_of n * speed0 s)%Q in let pushed := (/ stiffQ * force0 s)%Q in
  let e2 := (off_by s + moved)%Q in let e3 := (e2 + pushed)%Q in
  let e4 := (flat1 s + moved + pushed + turn0 s)%Q in
  let asked := (stiff k * e4 + k12 k * pushed)%Q in
  let flows := ((middle c + reach c) * speed0 s)%Q in
  (off_by s * off_by s + v2 k * (e2 * e2) + v3 k * (e3 * e3) + v4 k * (e4 * e4)
    + lag_most c * (a5 k * (asked * asked) + a6 k * (kap k * e3 * (kap k * e3)))
    + keeps b * (latest b * flows * (latest b * flows)))%Q.
Definition start_ok : bool :=
  forallb (Qle_bool 0) start_sizes_ok && above sine W
  && Qle_bool (cosine s * cosine s * (W * W) + sine * sine) (W * W)
  && Qle_bool (2 * (sine * sine)) (lean s * lean s * (1 + cosine s) * (W * W))
  && (Qle_bool (off_by s) (flat1 s) || Qle_bool (level_off s + lean s * off_by s) (flat1 s))
  && Qle_bool ((W + force0 s) * rate0 s) (stiffQ * kapQ * turn0 s)
  && Qle_bool (speed0 s) (k1_of n / m * fast b) && Qle_bool start_psi_of (2 * start_of b).

Theorem start_follows : limits_ok n b c = true -> start_ok = true ->
  begun (gains_in n) (Q2R (g_of n)) (real_limits b) c (real_start s).
Proof.
  intros L O. pose proof (limits_follow n b c L) as F. unfold start_ok in O.
  do 7 (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  repeat match goal with H : Qle_bool _ _ = true |- _ => apply Qle_bool_iff, Qle_Rle in H end.
  apply above_correct in O6.
  assert (Two : Q2R 2 = 2) by (unfold Q2R; simpl; field).
  destruct (positive _ _ _ _ F) as [[P1 P2 P3 P4 P5] Pg]. cbn [gains_in mass k1 k2 k3 k4] in P1, P2, P3, P4, P5.
  assert (NZ : forall q, 0 < Q2R q -> Q2R (/ q) = / Q2R q).
  { intros q Pq. apply Q2R_inv. intro X. apply Qeq_eqR in X. rewrite Q2R_zero in X. lra. }
  pose proof (NZ _ P1) as I1. pose proof (NZ _ P2) as I2.
  assert (KQ : Q2R kapQ = kappa_ (gains_in n)).
  { unfold kapQ, Qdiv. rewrite Q2R_mult, Q2R_plus, Q2R_mult, I1. reflexivity. }
  assert (CQ : Q2R stiffQ = Vehicle.c (gains_in n)).
  { unfold stiffQ, Qdiv. rewrite !Q2R_mult, I1. reflexivity. }
  assert (C0 : 0 < Q2R stiffQ).
  { rewrite CQ. apply c_is_pos, (positive _ _ _ _ F). }
  pose proof (NZ _ C0) as IC. rewrite CQ in IC.
  destruct (same _ _ _ _ F) as [S1 [S2 [S3 S4]]]. cbn [real_constants k12 kap stiff speed] in S1, S2, S3, S4.
  assert (Z : forall a, List.In a start_sizes_ok -> 0 <= Q2R a).
  { intros a H. rewrite forallb_forall in O. specialize (O a H). apply Qle_bool_iff, Qle_Rle in O.
    rewrite Q2R_zero in O. exact O. }
  unfold start_sizes_ok in Z.
  assert (M1 : Q2R (m / k1_of n) = mass (gains_in n) / k1 (gains_in n)).
  { unfold Qdiv. rewrite Q2R_mult, I2. reflexivity. }
  assert (M2 : Q2R (k1_of n / m) = k1 (gains_in n) / mass (gains_in n)).
  { unfold Qdiv. rewrite Q2R_mult, I1. reflexivity. }
  unfold start_psi_of in O0. cbv zeta in O0.
  unfold sine, W in *. clearbody kapQ stiffQ.
  set (mk := (m / k1_of n)%Q) in *. set (km := (k1_of n / m)%Q) in *. clearbody mk km.
  constructor.
  - cbn [real_start off_by level_off speed0 force0 rate0 cosine lean flat1 turn0].
    repeat split; apply Z; cbn; tauto.
  - repeat rewrite ?Q2R_plus, ?Q2R_mult in O6. exact O6.
  - repeat rewrite ?Q2R_plus, ?Q2R_mult in O5. exact O5.
  - repeat rewrite ?Q2R_plus, ?Q2R_mult, ?Two, ?Q2R_one in O4. exact O4.
  - apply orb_prop in O3. destruct O3 as [A|A]; apply Qle_bool_iff, Qle_Rle in A; [left; exact A|right].
    rewrite Q2R_plus, Q2R_mult in A. exact A.
  - repeat rewrite ?Q2R_plus, ?Q2R_mult, ?CQ, ?KQ in O2. exact O2.
  - rewrite Q2R_mult, M2 in O1. exact O1.
  - repeat rewrite ?Q2R_plus, ?Q2R_mult, ?Two, ?M1, ?IC, ?S1, ?S2, ?S3 in O0. exact O0.
Qed.
End Decision.

(** ** Theorem 5, from a start *)

(** From every state of a start, and with every vehicle within tolerances: Ψ(t) <= ℓ0 e^(-rt), no motion leaves the
    domain, and from a time on what a level camera sees is as near to what is wanted as is said. *)
Theorem start_arrives : forall v n b c s z until inside flown again,
  matrices_ok c = true -> memory_ok (keeps b) (latest b) c = true -> limits_ok n b c = true ->
  start_ok n b c s = true -> settled_ok b c z = true ->
  gains v = gains_in n -> pull_down v = Q2R (g_of n) ->
  let l := real_limits b in
  domain v c (far l) inside -> motion v l c until -> integrals v l c until flown again ->
  held v l inside (real_start s) ->
  forall t, 0 <= t < until ->
  let away := len (from v (place v t) - wanted_height v * e3)%vec in
  let most := start_of l * exp (- pace (real_constants (its_constants c)) * t) in
  psi v l c flown again t <= most /\ inside (place v t) /\ away * away <= 2 * most /\
  (Q2R (after z) <= t -> away <= Q2R (near_off z)) /\ 0 < pz (below (attitude v) t).
Proof.
  intros v n b c s z until inside flown again M O Ok So Zo Eg Ep l D Mo Ig Hd t T away most.
  assert (F : follows (gains v) (pull_down v) l c) by (rewrite Eg, Ep; apply limits_follow; exact Ok).
  assert (Kept : exists MQ TQ, memory_ok MQ TQ c = true /\ keeps l = Q2R MQ /\ latest l = Q2R TQ)
    by (exists (keeps b), (latest b); auto).
  assert (Bs : begun (gains v) (pull_down v) l c (real_start s)) by (rewrite Eg, Ep; apply start_follows; assumption).
  assert (Bg : begins v l c inside flown again) by (eapply start_begins; try eassumption; lra).
  destruct (vehicle_stays v n b c until inside flown again M O Ok Eg Ep D Mo Ig Bg t T)
    as [A1 [A2 [A3 [A4 _]]]]. fold l in A1, A3. fold away in A3.
  pose proof (exp_pos (- pace (real_constants (its_constants c)) * t)) as E.
  assert (Ps : psi v l c flown again t <= most).
  { eapply Rle_trans; [exact A1|]. apply Rmult_le_compat_r; [lra|]. apply (low_at_first _ _ _ _ _ _ Bg). }
  split; [exact Ps|]. split; [exact A2|]. split; [lra|]. split; [|exact A4].
  intros Af. destruct (settled_sound b c z Zo) as [Z1 [Z2 Z3]]. cbv zeta in Z3.
  apply below_square; [exact Z1|]. eapply Rle_trans; [|exact Z3]. apply Rle_trans with (2 * most); [lra|].
  unfold most. rewrite <- Rmult_assoc. apply Rmult_le_compat_l.
  - destruct (levels _ _ _ _ F) as [[S0 _] _]. change (start_of l) with (Q2R (start_of b)) in S0. lra.
  - destruct (kept_pos v l c F Kept) as [_ P0].
    rewrite <- !Ropp_mult_distr_l, !Ropp_mult_distr_r. apply exp_grows; lra.
Qed.
