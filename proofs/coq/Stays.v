(** Theorem 5: no motion of a vehicle within tolerances leaves the level, and so what the inequality supposes
    holds all the way. It is about motions from rigid body, camera and law, see [Vehicle], with an image that is
    late, rotors that lag, wind and a goal that is fixed to the vertical.

    There is no first time at which something that is supposed fails: as long as nothing has failed, Ψ is below
    what it was at the start, which is below the level, and all that is supposed follows from the level. *)

Require Import QArith Qreals Reals List Bool Lra.
From Hoverproof Require Import Forms Space Calculus Loop Image Body Gains Tolerant Late Vehicle Length.
Import ListNotations.
Open Scope R_scope.

(** * A step to any time *)

Lemma near_by : forall f t d e, slope f t d -> 0 < e ->
  exists a, 0 < a /\ forall s, Rabs (s - t) < a -> Rabs (f s - f t) < e.
Proof.
  intros f t d e S P.
  assert (C : continuity_pt f t) by (apply derivable_continuous_pt; exists d; exact S).
  destruct (C e P) as [a [A H]]. exists a. split; [exact A|]. intros s L.
  destruct (Req_dec t s) as [<- |N]; [rewrite Rminus_diag_eq, Rabs_R0; auto|].
  apply (H s). split; [split; [exact I|exact N]|exact L].
Qed.

(** What holds at 0, at each time before which it holds, and a while beyond, holds always. *)
Lemma goes_on : forall (P : R -> Prop) b, P 0 ->
  (forall t, 0 < t < b -> (forall s, 0 <= s < t -> P s) -> P t) ->
  (forall t, 0 <= t < b -> (forall s, 0 <= s <= t -> P s) ->
    exists e, 0 < e /\ forall s, t < s < t + e -> s < b -> P s) ->
  forall t, 0 <= t < b -> P t.
Proof.
  intros P b P0 Closed Open t1 T1. apply Classical_Prop.NNPP. intros N.
  set (E := fun s => 0 <= s <= t1 /\ forall x, 0 <= x <= s -> P x).
  assert (B : Raxioms.bound E) by (exists t1; intros s [H _]; lra).
  assert (E0 : E 0) by (split; [lra|]; intros x X; replace x with 0 by lra; exact P0).
  destruct (completeness E B (ex_intro _ 0 E0)) as [m [Up Least]].
  assert (M0 : 0 <= m) by (apply Up; exact E0).
  assert (M1 : m <= t1) by (apply Least; intros s [H _]; lra).
  assert (Before : forall x, 0 <= x < m -> P x).
  { intros x X. apply Classical_Prop.NNPP. intros F. assert (m <= x); [|lra].
    apply Least. intros s [S G]. destruct (Rle_or_lt s x) as [L|L]; [exact L|].
    exfalso. apply F, G. lra. }
  assert (At : P m).
  { destruct M0 as [M0| <-]; [|exact P0]. apply Closed; [lra|exact Before]. }
  assert (Until : forall x, 0 <= x <= m -> P x).
  { intros x [X1 [X2| ->]]; [apply Before; lra|exact At]. }
  destruct (Open m ltac:(lra) Until) as [e [Pe G]].
  destruct (Rle_or_lt t1 m) as [L|L]; [apply N, Until; lra|].
  set (s := Rmin t1 (m + e / 2)).
  assert (S1 : s <= t1) by apply Rmin_l. assert (S2 : s <= m + e / 2) by apply Rmin_r.
  assert (S3 : m < s) by (apply Rmin_glb_lt; lra).
  assert (Es : E s).
  { split; [lra|]. intros x X. destruct (Rle_or_lt x m) as [L2|L2]; [apply Until; lra|apply G; lra]. }
  pose proof (Up s Es). lra.
Qed.

(** * What there is *)

(** A vehicle and its flight, as functions of time: see the section of [Vehicle]. [age] is how old the image is
    that is used; [rolls_by] the angular acceleration. *)
Record craft := Craft {
  gains : loop; pull_down : R; wanted_height : R; behind : R; sees_by : feature; marks : points; counted : R;
  breeze : vec; place : R -> vec; attitude : R -> rotation; speeds_by : R -> vec; spins_by : R -> vec;
  lifts_by : R -> R; set_rise : R -> R; set_turn : R -> vec; rolls_by : R -> vec; efficacy : R -> R;
  torque_wrong : R -> vec -> vec; gyro_known : R -> vec -> vec; gyro_true : R -> vec -> vec; age : R -> R }.

(** What a level camera sees from a place, and how that changes. *)
Definition from (v : craft) (p : vec) : vec := feature_of (sees_by v) (counted v) (centroid (marks v) level p).
Definition slope_from (v : craft) (p : vec) : vec -> vec :=
  feature_slope (sees_by v) (counted v) (centroid (marks v) level p) (image_slope (marks v) level p).
Definition seen_from (v : craft) (p : vec) : Prop :=
  (forall k q, In (k, q) (marks v) -> off q p) /\
  featured (sees_by v) (counted v) (centroid (marks v) level p).
Definition way_of (v : craft) (t : R) : vec := turned (attitude v t) (speeds_by v t).
(** The feature that is used, turned to now, less the one that there is. *)
Definition stale_by (v : craft) (t : R) : vec :=
  back (attitude v t) (from v (place v (t - age v t)) - from v (place v t))%vec.

Definition moment_of (v : craft) : R -> moment :=
  now (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v) (breeze v) (place v)
    (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_rise v) (set_turn v) (stale_by v).
Definition corner_of (v : craft) : R -> corner R :=
  at_now (gains v) (pull_down v) (wanted_height v) (behind v) (sees_by v) To_vertical (marks v) (counted v)
    (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (efficacy v) (stale_by v).
Definition arm_of (v : craft) : R -> R :=
  arm (gains v) (wanted_height v) To_vertical (breeze v) (attitude v) (lifts_by v).

(** The tolerances: of the thrust, of the torque, of the gyroscopic part, the wind (m/s²), the yaw rate (1/s),
    the age of an image (s); the weight of the memory; the level that the bounds are for, and the one that the
    start is within; and these bounds: of |δ3 - δ2|, |δ3|, |ζ|, |δ1 + δ2|, of the lever from below (N), of h
    (1/s), |n|, |Ua|/Dc, |p3|; and how far off what a level camera sees is wherever the domain ends. *)
Record limits (A : Type) := Limits {
  thrust_off : A; torque_off : A; gyroscopic : A; windy : A; yawing : A; latest : A; keeps : A; level_of : A;
  start_of : A; spread : A; sink : A; turn_most : A; fast : A; lever_least : A; quick : A; missed : A;
  sinks_most : A; cross_most : A; far : A }.
Arguments thrust_off {A}. Arguments torque_off {A}. Arguments gyroscopic {A}. Arguments windy {A}.
Arguments yawing {A}. Arguments latest {A}. Arguments keeps {A}. Arguments level_of {A}. Arguments start_of {A}.
Arguments spread {A}. Arguments sink {A}. Arguments turn_most {A}. Arguments fast {A}. Arguments lever_least {A}.
Arguments quick {A}. Arguments missed {A}. Arguments sinks_most {A}. Arguments cross_most {A}. Arguments far {A}.
Arguments Limits {A}.

(** That the numbers of a certificate follow from each other. *)
Record follows (g : loop) (grav : R) (b : limits R) (c : matrices) : Prop := {
  positive : positive_gains g /\ 0 < grav;
  same : let k := real_constants (its_constants c) in
    k12 k = k12_ g /\ kap k = kappa_ g /\ stiff k = stiff_ g /\ speed k = k1 g / mass g;
  weights_positive : let k := real_constants (its_constants c) in
    0 < v2 k /\ 0 < v3 k /\ 0 < v4 k /\ 0 <= a5 k /\ 0 <= a6 k;
  ball_is : 0 <= Q2R (middle c) /\ 0 <= Q2R (reach c);
  sizes : 0 <= thrust_off b /\ 0 <= torque_off b /\ 0 <= gyroscopic b /\ 0 <= windy b /\ 0 <= yawing b /\
    0 < latest b /\ 0 <= keeps b;
  levels : 0 <= start_of b < level_of b /\ 0 <= far b /\ 2 * start_of b < far b * far b;
  bounds_are : 0 <= spread b /\ 0 <= sink b /\ 0 <= turn_most b /\ 0 <= fast b /\ 0 < lever_least b /\
    0 <= quick b /\ 0 <= missed b /\ 0 <= sinks_most b /\ 0 <= cross_most b;
  spread_is : let k := real_constants (its_constants c) in
    2 * level_of b * (/ v3 k + / v2 k) <= spread b * spread b;
  sink_is : let k := real_constants (its_constants c) in 2 * level_of b * / v3 k <= sink b * sink b;
  turn_is : let k := real_constants (its_constants c) in
    2 * level_of b * (/ v4 k + / v3 k) <= turn_most b * turn_most b;
  fast_is : let k := real_constants (its_constants c) in
    2 * level_of b * (/ 1 + / v2 k) <= fast b * fast b;
  lever_is : let left := mass g * grav - Vehicle.c g * spread b in
    0 <= left /\ lever_least b * lever_least b + mass g * windy b * (mass g * windy b) <= left * left;
  quick_is : Vehicle.c g * kappa_ g <= quick b * lever_least b;
  missed_is : latest b * ((Q2R (middle c) + Q2R (reach c)) * (k1 g / mass g * fast b)) <= missed b;
  sinks_are : quick b * (sink b + missed b) <= sinks_most b;
  cross_is : quick b * turn_most b * (mass g * windy b) <= cross_most b * lever_least b;
  pi_is : 2 * sinks_most b + cross_most b <= Q2R (pi_most c);
  chi_is : Q2R (fst (chis c)) * lever_least b <= lever_least b - mass g * windy b /\
    lever_least b + mass g * windy b <= Q2R (snd (chis c)) * lever_least b /\ Q2R (fst (chis c)) <= 1 <= Q2R (snd (chis c));
  drag_is : Q2R (fst (drags c)) <= 0 <= Q2R (snd (drags c));
  gain_is : Q2R (fst (gains_of c)) <= 1 - thrust_off b /\ 1 + thrust_off b <= Q2R (snd (gains_of c));
  radii_are : exists r1 r2 r3 r4 r5 r6 r7 r8, map Q2R (radii_of c) = [r1; r2; r3; r4; r5; r6; r7; r8] /\
    let lag := Q2R (lag_most c) in
    torque_off b <= r1 /\
    quick b * missed b + thrust_off b * cross_most b / 2 + 2 * (1 + thrust_off b) * sinks_most b
      + yawing b * ((1 + torque_off b) * gyroscopic b + torque_off b) <= r2 /\
    yawing b <= r3 /\ yawing b * gyroscopic b + lag * k12_ g * (quick b * spread b) <= r4 /\ yawing b <= r5 /\
    lag * k12_ g * yawing b <= r6 /\ lag * kappa_ g * (quick b * sink b) <= r7 /\
    lag * ((1 + thrust_off b) * sinks_most b + cross_most b) <= r8 }.

(** The domain: a closed set of places from which the target is seen and J is in its ball; and near it, but not
    in it, is nothing but places from where what a level camera sees is farther off than [d]. *)
Record domain (v : craft) (c : matrices) (d : R) (inside : vec -> Prop) : Prop := {
  closed : forall p, (forall e, 0 < e -> exists q, inside q /\ len (q - p)%vec < e) -> inside p;
  seen_inside : forall p, inside p -> seen_from v p /\ near (Q2R (middle c)) (Q2R (reach c)) (slope_from v p);
  ends_beyond : forall p, inside p -> exists e, 0 < e /\ forall q, len (q - p)%vec < e ->
    inside q \/ d < len (from v q - wanted_height v * e3)%vec }.

(** A motion of a vehicle within tolerances up to a time, and how it moved in the time of an image before 0. *)
Record motion (v : craft) (b : limits R) (c : matrices) (until : R) : Prop := {
  is_whole : forall t, - latest b <= t < until -> orthonormal (attitude v t);
  is_moving : forall t, - latest b <= t < until -> vslope (place v) t (way_of v t);
  is_turning : forall t, 0 <= t < until -> turns (attitude v) (spins_by v) t;
  is_pulled : forall t, 0 <= t < until -> vslope (speeds_by v) t
    (- 1 * (spins_by v t × speeds_by v t)
     + / mass (gains v) * pull (gains v) (pull_down v) (breeze v) (attitude v) (lifts_by v) t)%vec;
  is_lifted : forall t, 0 <= t < until -> slope (lifts_by v) t (efficacy v t * set_rise v t);
  is_rolled : forall t, 0 <= t < until -> vslope (spins_by v) t (rolls_by v t);
  by_torque : forall t, 0 <= t < until -> (e3 × rolls_by v t = set_turn v t + torque_wrong v t (set_turn v t)
    - pz (spins_by v t) * gyro_true v t (e3 × spins_by v t))%vec;
  turn_follows : forall t, 0 <= t < until -> vslope (set_turn v) t
    (/ behind v * (/ per (gains v) (wanted_height v) To_vertical (breeze v) (attitude v) (lifts_by v) t
       * commanded (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v) (breeze v)
           (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (stale_by v) t
     + pz (spins_by v t) * gyro_known v t (e3 × spins_by v t) - set_turn v t))%vec;
  lift_follows : forall t, 0 <= t < until -> slope (set_rise v) t
    (/ behind v * (command (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v) (counted v)
       (breeze v) (place v) (attitude v) (speeds_by v) (lifts_by v) (stale_by v) t - set_rise v t));
  flat_turn : forall t, pz (set_turn v t) = 0;
  are_linear : forall t, linear (torque_wrong v t) /\ linear (gyro_true v t) /\ linear (gyro_known v t);
  (* the tolerances *)
  lag_within : 0 < behind v <= Q2R (lag_most c);
  wind_within : len (breeze v) <= windy b;
  thrust_within : forall t, 0 <= t < until -> Rabs (efficacy v t - 1) <= thrust_off b;
  torque_within : forall t u, len (torque_wrong v t u) <= torque_off b * len u;
  known_within : forall t u, len (gyro_known v t u) <= gyroscopic b * len u;
  true_within : forall t u,
    len (gyro_true v t u) <= ((1 + torque_off b) * gyroscopic b + torque_off b) * len u;
  yaw_within : forall t, 0 <= t < until -> Rabs (pz (spins_by v t)) <= yawing b;
  age_within : forall t, 0 <= t < until -> 0 <= age v t <= latest b }.

(** y = J V, and two integrals of e^(r x) |y|², for the memory in Ψ. *)
Definition flow_of (v : craft) (t : R) : vec := moving (moment_of v t).
Definition integrals (v : craft) (b : limits R) (c : matrices) (until : R) (flown again : R -> R) : Prop :=
  forall t, - latest b <= t < until ->
    slope flown t (exp (pace (real_constants (its_constants c)) * t) * (flow_of v t · flow_of v t)) /\
    slope again t (flown t).
Definition psi (v : craft) (b : limits R) (c : matrices) (flown again : R -> R) (t : R) : R :=
  energy (real_constants (its_constants c)) (corner_of v t) (moment_of v t)
  + memory (keeps b) (latest b) (pace (real_constants (its_constants c))) flown again t.

(** A start: upright, Ψ as the certificate has it, what is set of the thrust's rate within bounds; and in the
    time of an image before, in the domain and no faster than the level allows. *)
Record begins (v : craft) (b : limits R) (c : matrices) (inside : vec -> Prop) (flown again : R -> R) : Prop := {
  upright_at_first : 0 < lifts_by v 0;
  low_at_first : psi v b c flown again 0 <= start_of b;
  calm_at_first : Rabs (set_rise v 0) <= Vehicle.c (gains v) * kappa_ (gains v) * (sink b + missed b);
  inside_before : forall t, - latest b <= t <= 0 -> inside (place v t);
  slow_before : forall t, - latest b <= t <= 0 -> len (speeds_by v t) <= k1 (gains v) / mass (gains v) * fast b }.

Section Stays.

Variables (v : craft) (b : limits R) (c : matrices) (until : R) (inside : vec -> Prop) (flown again : R -> R).
Hypothesis M : matrices_ok c = true.
Hypothesis F : follows (gains v) (pull_down v) b c.
Hypothesis Kept : exists MQ TQ, memory_ok MQ TQ c = true /\ keeps b = Q2R MQ /\ latest b = Q2R TQ.
Hypothesis D : domain v c (far b) inside.
Hypothesis Mo : motion v b c until.
Hypothesis In : integrals v b c until flown again.
Hypothesis B : begins v b c inside flown again.

Local Notation K := (real_constants (its_constants c)).
Local Notation g := (gains v).
Local Notation C := (Vehicle.c (gains v)).
Local Notation x := (moment_of v).
Local Notation p := (corner_of v).
Local Notation h t := (Vehicle.c (gains v) * kappa_ (gains v) / arm_of v t).

Lemma C_pos : 0 < C.
Proof. apply c_is_pos, (positive _ _ _ _ F). Qed.
Lemma kap_pos : 0 < kappa_ g.
Proof. apply kappa_pos, (positive _ _ _ _ F). Qed.
Lemma mass_is : 0 < mass g /\ 0 < k1 g.
Proof. destruct (positive _ _ _ _ F) as [[A1 A2 A3 A4 A5] _]. split; assumption. Qed.

(** What holds along the way: the energy is within the level, the lever is positive, the place is inside. *)
Definition good (t : R) : Prop := energy K (p t) (x t) <= level_of b /\ 0 < arm_of v t /\ inside (place v t).

(** ** What follows at a moment *)

Lemma late_pos : 0 < latest b.
Proof. destruct (sizes _ _ _ _ F) as [_ [_ [_ [_ [_ [L _]]]]]]. exact L. Qed.

Section Low.
Variable t : R.
Hypothesis G : energy K (p t) (x t) <= level_of b.

Lemma parts_within : let l := 2 * level_of b in
  d1 (err (x t)) · d1 (err (x t)) + v2 K * (d2 (err (x t)) · d2 (err (x t))) + v3 K * (d3 (err (x t)) · d3 (err (x t)))
  + v4 K * (d4 (err (x t)) · d4 (err (x t))) <= l.
Proof.
  pose proof G as E. unfold energy in E. destruct (weights_positive _ _ _ _ F) as [_ [_ [_ [A5 A6]]]].
  destruct (lag_within _ _ _ _ Mo) as [L _].
  change (tau (p t)) with (behind v) in E.
  pose proof (Rmult_le_pos _ _ A5 (square_pos (mu (x t)))). pose proof (Rmult_le_pos _ _ A6 (square_pos (lift (x t)))).
  assert (0 <= behind v * (a5 K * (mu (x t) · mu (x t)) + a6 K * (lift (x t) · lift (x t))))
    by (apply Rmult_le_pos; lra). cbv zeta. lra.
Qed.
Lemma each_part : let l := 2 * level_of b in
  0 <= d1 (err (x t)) · d1 (err (x t)) /\ 0 <= v2 K * (d2 (err (x t)) · d2 (err (x t))) /\
  0 <= v3 K * (d3 (err (x t)) · d3 (err (x t))) /\ 0 <= v4 K * (d4 (err (x t)) · d4 (err (x t))).
Proof.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 _]]].
  repeat split; first [apply square_pos | apply Rmult_le_pos; [lra|apply square_pos]].
Qed.

Lemma sink_within : len (d3 (err (x t))) <= sink b.
Proof.
  pose proof parts_within. pose proof each_part. cbv zeta in *.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 _]]]. destruct (bounds_are _ _ _ _ F) as [? [? ?]].
  apply (len_of _ (v3 K) (2 * level_of b)); try assumption; [lra|apply (sink_is _ _ _ _ F)].
Qed.
Lemma spread_within : len (d3 (err (x t)) - d2 (err (x t)))%vec <= spread b.
Proof.
  pose proof parts_within. pose proof each_part. cbv zeta in *.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 _]]]. destruct (bounds_are _ _ _ _ F) as [? [? ?]].
  apply (len_sum _ _ (v3 K) (v2 K) (2 * level_of b)); try assumption; [lra|apply (spread_is _ _ _ _ F)].
Qed.
Lemma turn_within : len (twist (x t)) <= turn_most b.
Proof.
  pose proof parts_within. pose proof each_part. cbv zeta in *.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 _]]]. destruct (bounds_are _ _ _ _ F) as [? [? [? ?]]].
  apply (len_sum _ _ (v4 K) (v3 K) (2 * level_of b)); try assumption; [|apply (turn_is _ _ _ _ F)].
  assert (flat (d3 (err (x t))) · flat (d3 (err (x t))) <= d3 (err (x t)) · d3 (err (x t)))
    by (rewrite <- !len_square; apply squares_below; [apply len_pos|apply len_flat]).
  assert (v3 K * (flat (d3 (err (x t))) · flat (d3 (err (x t)))) <= v3 K * (d3 (err (x t)) · d3 (err (x t))))
    by (apply Rmult_le_compat_l; lra). lra.
Qed.
Lemma fast_within : len (flow (err (x t))) <= fast b.
Proof.
  pose proof parts_within. pose proof each_part. cbv zeta in *.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 _]]]. destruct (bounds_are _ _ _ _ F) as [? [? [? [? ?]]]].
  replace (flow (err (x t))) with (d1 (err (x t)) - (-1 * d2 (err (x t))))%vec by (unfold flow; vector).
  apply (len_sum _ _ 1 (v2 K) (2 * level_of b)); try assumption; [lra| |apply (fast_is _ _ _ _ F)].
  replace ((-1 * d2 (err (x t)))%vec · (-1 * d2 (err (x t)))) with (d2 (err (x t)) · d2 (err (x t))) by number.
  lra.
Qed.

(** V = (k1/m) (δ1 + δ2). *)
Lemma speed_is : velocity K (x t) = speeds_by v t.
Proof.
  destruct mass_is as [A1 A2]. destruct (same _ _ _ _ F) as [_ [_ [_ S]]]. 
  unfold velocity. rewrite S. unfold flow, x, moment_of, now. cbn [err d1 d2]. unfold er2.
  generalize (er1 (wanted_height v) (sees_by v) To_vertical (marks v) (counted v) (place v) (attitude v) t).
 intros. apply vec_eq; components; field; lra.
Qed.
Lemma speed_within : len (speeds_by v t) <= k1 g / mass g * fast b.
Proof.
  destruct mass_is as [A1 A2]. destruct (same _ _ _ _ F) as [_ [_ [_ S]]]. 
  rewrite <- speed_is. unfold velocity. rewrite S. apply len_scaled; [|apply fast_within].
  rewrite Rabs_right; [lra|]. apply Rle_ge, Rlt_le, Rdiv_lt_0_compat; assumption.
Qed.

(** The force and the lever. *)
Lemma force_is : pull g (pull_down v) (breeze v) (attitude v) (lifts_by v) t
  = (C * (d3 (err (x t)) - d2 (err (x t))))%vec.
Proof. apply pull_is, (positive _ _ _ _ F). Qed.
Lemma force_within : len (pull g (pull_down v) (breeze v) (attitude v) (lifts_by v) t) <= C * spread b.
Proof. rewrite force_is. apply len_scaled; [|apply spread_within]. pose proof C_pos. rewrite Rabs_right; lra. Qed.
End Low.

Section At.
Variable t : R.
Hypothesis T : 0 <= t < until.
Lemma T' : - latest b <= t < until.
Proof. pose proof late_pos. lra. Qed.
Let O := is_whole _ _ _ _ Mo t T'.
Local Notation w := (blown (gains v) (breeze v) (attitude v) t).
Lemma blown_within : len w <= mass g * windy b.
Proof.
  destruct mass_is as [A1 _]. unfold blown. apply len_scaled.
  - rewrite Rabs_right; lra.
  - rewrite len_back by exact O. apply (wind_within _ _ _ _ Mo).
Qed.
Lemma arm_is : arm_of v t = lifts_by v t - pz w.
Proof. unfold arm_of, arm, s3g. ring. Qed.
Lemma below_unit : len (below (attitude v) t) = 1.
Proof.
  unfold below. rewrite len_back by exact O. unfold len. replace (e3 · e3) with 1 by number. apply sqrt_1.
Qed.

(** |F| and the wind are below the weight; so it is one whether the thrust is positive or the lever. *)
Lemma upright_enough : energy K (p t) (x t) <= level_of b ->
  0 < lifts_by v t \/ 0 < arm_of v t ->
  0 < pz (below (attitude v) t) /\ 0 < arm_of v t.
Proof.
  intros Low Up. destruct (lever_is _ _ _ _ F) as [L1 L2]. set (W := mass g * pull_down v) in *.
  destruct mass_is as [A1 _], (positive _ _ _ _ F) as [_ Gr], (bounds_are _ _ _ _ F) as [_ [_ [_ [_ [L0 _]]]]].
  destruct (sizes _ _ _ _ F) as [_ [_ [_ [Z4 _]]]].
  assert (W0 : 0 < W) by (apply Rmult_lt_0_compat; assumption).
  set (push := mass g * windy b) in *. assert (P0 : 0 <= push) by (apply Rmult_le_pos; lra).
  assert (PL : push < W - C * spread b).
  { destruct (Rle_or_lt (W - C * spread b) push) as [H|H]; [|exact H].
    pose proof (squares_below _ _ L1 H). pose proof (Rmult_lt_0_compat _ _ L0 L0). lra. }
  set (f := pull g (pull_down v) (breeze v) (attitude v) (lifts_by v) t).
  assert (Ff : len f <= C * spread b) by (apply force_within; exact Low).
  pose proof blown_within as Ww. fold push in Ww.
  set (r := below (attitude v) t). assert (R1 : len r = 1) by exact below_unit.
  assert (RR : r · r = 1) by (rewrite <- len_square, R1; ring).
  assert (Fe : f = ((- lifts_by v t) * e3 + W * r + w)%vec) by reflexivity.
  assert (Key : (W * pz r) * (W * pz r) <= (W * pz r - arm_of v t) * (W * pz r - arm_of v t) -> False).
  { intros S. rewrite arm_is in S. set (B' := (W * r + flat w)%vec).
    assert (LB : W - push <= len B').
    { pose proof (len_minus B' (flat w)) as Q. replace (B' - flat w)%vec with (W * r)%vec in Q by (unfold B'; vector).
      rewrite len_scale, R1, Rabs_right in Q by lra. pose proof (len_flat w). lra. }
    assert (E : f · f = B' · B' - (W * pz r) * (W * pz r)
      + (W * pz r - (lifts_by v t - pz w)) * (W * pz r - (lifts_by v t - pz w))).
    { rewrite Fe. unfold B'. generalize w r. number. }
    assert (LF : len B' <= len f) by (apply below_square; [apply len_pos|rewrite !len_square; lra]). lra. }
  destruct Up as [Up|Up].
  - (* A = m g ρ - T e3 *)
    assert (A : len (f - w)%vec <= C * spread b + push) by (apply len_minus_to; assumption).
    assert (Rz : 0 < pz r).
    { pose proof (at_most_len _ _ A) as S. assert (E : (f - w)%vec · (f - w)
        = W * W * (r · r) - 2 * (lifts_by v t * W) * pz r + lifts_by v t * lifts_by v t).
      { rewrite Fe. generalize w r. number. }
      rewrite E, RR in S. pose proof (len_pos (f - w)%vec).
      assert (Q : (C * spread b + push) * (C * spread b + push) <= W * W) by (apply squares_below; lra).
      pose proof (Rmult_lt_0_compat _ _ Up Up). pose proof (Rmult_lt_0_compat _ _ Up W0) as TW.
      destruct (Rle_or_lt (pz r) 0) as [N|N]; [|exact N].
      assert (0 <= lifts_by v t * W * (- pz r)) by (apply Rmult_le_pos; lra). lra. }
    split; [exact Rz|]. destruct (Rle_or_lt (arm_of v t) 0) as [N|N]; [|exact N]. exfalso. apply Key.
    pose proof (Rmult_lt_0_compat _ _ W0 Rz). apply squares_below; lra.
  - split; [|exact Up]. destruct (Rle_or_lt (pz r) 0) as [N|N]; [|exact N]. exfalso. apply Key.
    assert (0 <= W * - pz r) by (apply Rmult_le_pos; lra).
    pose proof (squares_below (- (W * pz r)) (- (W * pz r - arm_of v t)) ltac:(lra) ltac:(lra)). lra.
Qed.

Hypothesis G : good t.
Lemma arm_at_least : lever_least b <= arm_of v t.
Proof.
  destruct (lever_is _ _ _ _ F) as [L1 L2].  set (left := mass g * pull_down v - C * spread b) in *.
  destruct (bounds_are _ _ _ _ F) as [_ [_ [_ [_ [L0 _]]]]]. destruct G as [_ [P _]].
  apply below_square; [lra|].
  set (f := pull g (pull_down v) (breeze v) (attitude v) (lifts_by v) t).
  set (r := ((mass g * pull_down v) * below (attitude v) t)%vec).
  (* |F - m g ρ|² = T_c² + |P w|² *)
  assert (E : (f - r)%vec · (f - r) = arm_of v t * arm_of v t + flat w · flat w).
  { rewrite arm_is. unfold f, pull, r. generalize (below (attitude v) t) (blown g (breeze v) (attitude v) t).
    number. }
  assert (W : flat w · flat w <= mass g * windy b * (mass g * windy b)).
  { apply at_most_len. eapply Rle_trans; [apply len_flat|exact blown_within]. }
  assert (N : left <= len (f - r)%vec).
  { assert (R1 : len r = mass g * pull_down v).
    { unfold r. rewrite len_scale, below_unit. destruct mass_is, (positive _ _ _ _ F) as [_ Gr].
      rewrite Rabs_right; [ring|]. apply Rle_ge, Rmult_le_pos; lra. }
    assert (R2 : len f <= C * spread b).
    { apply force_within, G. }
    pose proof (len_minus f (f - r)%vec) as Q. replace (f - (f - r))%vec with r in Q by vector.
    unfold left. lra. }
  pose proof (squares_below _ _ L1 N) as S. rewrite len_square, E in S. lra.
Qed.
Lemma arm_pos : 0 < arm_of v t.
Proof. apply G. Qed.
Lemma h_within : 0 < h t <= quick b.
Proof.
  pose proof C_pos. pose proof kap_pos. pose proof arm_pos. pose proof arm_at_least as L.
  destruct (bounds_are _ _ _ _ F) as [_ [_ [_ [_ [L0 [Q0 _]]]]]].
  assert (CK : 0 < C * kappa_ g) by (apply Rmult_lt_0_compat; assumption). split.
  - apply Rdiv_lt_0_compat; assumption.
  - apply Rmult_le_reg_r with (arm_of v t); [assumption|].
    replace (C * kappa_ g / arm_of v t * arm_of v t) with (C * kappa_ g) by (field; lra).
    eapply Rle_trans; [apply (quick_is _ _ _ _ F)|]. apply Rmult_le_compat_l; assumption.
Qed.
Lemma sees_now : seen_from v (place v t) /\ near (Q2R (middle c)) (Q2R (reach c)) (slope_from v (place v t)).
Proof. apply (seen_inside _ _ _ _ D), G. Qed.
End At.

(** ** What follows of the way up to a moment *)

Lemma feature_moves : forall s, - latest b <= s < until -> inside (place v s) ->
  vslope (fun z => from v (place v z)) s (-1 * slope_from v (place v s) (way_of v s))%vec.
Proof.
  intros s S Ins. destruct (seen_inside _ _ _ _ D _ Ins) as [[Off Feat] _].
  eapply vslope_is.
  - apply (slope_feature (sees_by v) (counted v) (marks v) (fun _ => level) (place v) (way_of v) (fun _ => zero)).
    + apply level_orthonormal.
    + unfold turns, level. cbn [bx by_ bz].
      repeat split; (eapply slope_is; [apply slope_const|]); components; ring.
    + eapply vslope_is; [apply (is_moving _ _ _ _ Mo s S)|]. unfold level. generalize (way_of v s). intros.
      apply vec_eq; components; ring.
    + exact Off.
    + exact Feat.
  - fold (slope_from v (place v s)). generalize (slope_from v (place v s) (way_of v s)). intros. vector.
Qed.

(** y, in the axes of the body, is what a level camera would see change, turned. *)
Lemma flow_turned : forall s, - latest b <= s < until ->
  flow_of v s = back (attitude v s) (slope_from v (place v s) (way_of v s)).
Proof.
  intros s S. unfold flow_of, moment_of, now. cbn [moving]. unfold Jof.
  apply feature_slope_turned, (is_whole _ _ _ _ Mo s S).
Qed.

Lemma linear_slope : forall q, linear (slope_from v q).
Proof. intros. apply feature_linear, image_linear. Qed.
(** |J u| <= (j + rho) |u|. *)
Lemma slope_within : forall s u, inside (place v s) ->
  len (slope_from v (place v s) u) <= (Q2R (middle c) + Q2R (reach c)) * len u.
Proof.
  intros s u Ins. destruct (seen_inside _ _ _ _ D _ Ins) as [_ [_ N]]. specialize (N u).
  destruct (ball_is _ _ _ _ F) as [J0 R0].
  assert (L : len (slope_from v (place v s) u - Q2R (middle c) * u)%vec <= Q2R (reach c) * len u).
  { apply len_at_most; [apply Rmult_le_pos; [exact R0|apply len_pos]|].
    replace (Q2R (reach c) * len u * (Q2R (reach c) * len u))
      with (Q2R (reach c) * Q2R (reach c) * (len u * len u)) by ring. rewrite len_square. exact N. }
  replace (slope_from v (place v s) u)
    with ((slope_from v (place v s) u - Q2R (middle c) * u) + Q2R (middle c) * u)%vec by vector.
  eapply Rle_trans; [apply len_plus|]. rewrite len_scale, (Rabs_right (Q2R (middle c))) by lra. lra.
Qed.

Local Notation asked_lift s := (command (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v)
  (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (lifts_by v) (stale_by v) s).

Section Way.
Variable t : R.
Hypothesis T : 0 <= t < until.
Hypothesis G : forall s, 0 <= s <= t -> good s.

Lemma inside_on : forall s, - latest b <= s <= t -> inside (place v s).
Proof.
  intros s S. destruct (Rle_or_lt s 0) as [L|L]; [apply (inside_before _ _ _ _ _ _ B); lra|].
  apply (G s). lra.
Qed.
Lemma slow_on : forall s, - latest b <= s <= t -> len (speeds_by v s) <= k1 g / mass g * fast b.
Proof.
  intros s S. destruct (Rle_or_lt s 0) as [L|L]; [apply (slow_before _ _ _ _ _ _ B); lra|].
  apply speed_within, (G s). lra.
Qed.
Definition flow_most : R := (Q2R (middle c) + Q2R (reach c)) * (k1 g / mass g * fast b).
Lemma flow_most_pos : 0 <= flow_most.
Proof.
  destruct (ball_is _ _ _ _ F), mass_is, (bounds_are _ _ _ _ F) as [_ [_ [_ [? _]]]].
  apply Rmult_le_pos; [lra|]. apply Rmult_le_pos; [|assumption]. left. apply Rdiv_lt_0_compat; assumption.
Qed.
Lemma flow_on : forall s, - latest b <= s <= t -> len (slope_from v (place v s) (way_of v s)) <= flow_most.
Proof.
  intros s S. eapply Rle_trans; [apply slope_within, inside_on, S|]. unfold flow_most.
  destruct (ball_is _ _ _ _ F). apply Rmult_le_compat_l; [lra|]. unfold way_of.
  rewrite len_turned by (apply (is_whole _ _ _ _ Mo); lra). apply slow_on, S.
Qed.
Lemma stale_within : len (stale_by v t) <= missed b.
Proof.
  unfold stale_by. rewrite len_back by (apply (is_whole _ _ _ _ Mo); destruct (age_within _ _ _ _ Mo t T); lra).
  destruct (age_within _ _ _ _ Mo t T) as [A1 A2]. destruct (sizes _ _ _ _ F) as [_ [_ [_ [_ [_ [L0 _]]]]]].
  pose proof (moved_at_most (fun z => from v (place v z)) (fun z => -1 * slope_from v (place v z) (way_of v z))%vec
    (t - age v t) t flow_most ltac:(lra) flow_most_pos) as Q.
  assert (Q' : len (from v (place v t) - from v (place v (t - age v t)))%vec <= flow_most * (t - (t - age v t))).
  { apply Q. intros s S. split.
    - apply feature_moves; [lra|]. apply inside_on. lra.
    - rewrite len_scale, Rabs_left by lra. pose proof (flow_on s ltac:(lra)). lra. }
  replace (from v (place v (t - age v t)) - from v (place v t))%vec
    with (-1 * (from v (place v t) - from v (place v (t - age v t))))%vec by vector.
  rewrite len_scale, Rabs_left by lra. eapply Rle_trans; [|apply (missed_is _ _ _ _ F)]. fold flow_most.
  pose proof (Rmult_le_compat_r _ _ _ flow_most_pos A2). lra.
Qed.

Lemma good_now : good t. Proof. apply G. lra. Qed.

(** What is commanded of the thrust. *)
Lemma asked_within : Rabs (asked_lift t) <= C * kappa_ g * (sink b + missed b).
Proof.
  pose proof C_pos. pose proof kap_pos. unfold command. rewrite !Rabs_mult, (Rabs_right C), (Rabs_right (kappa_ g)) by lra.
  apply Rmult_le_compat_l; [left; apply Rmult_lt_0_compat; assumption|].
  eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_Ropp. apply Rplus_le_compat.
  - eapply Rle_trans; [apply pz_len|]. exact (sink_within t (proj1 good_now)).
  - eapply Rle_trans; [apply pz_len|]. exact stale_within.
Qed.
(** ** The pushes and the parameters *)

Hypothesis Calm : Rabs (set_rise v t) <= C * kappa_ g * (sink b + missed b).

Local Notation z := (twist (x t)).
Lemma per_h : per g (wanted_height v) To_vertical (breeze v) (attitude v) (lifts_by v) t = / h t.
Proof.
  pose proof C_pos. pose proof kap_pos. pose proof (arm_pos t good_now).
  unfold per. fold (arm_of v t). field. lra.
Qed.
Lemma twist_now : z = (/ h t * (e3 × spins_by v t))%vec.
Proof. rewrite <- per_h. apply twist_is. Qed.
Lemma zeta_now : zeta g (wanted_height v) To_vertical (breeze v) (attitude v) (spins_by v) (lifts_by v) t = z.
Proof. symmetry. apply twist_is. Qed.
Lemma turned_up : forall u, pz (spins_by v t × u)%vec = h t * (z · u).
Proof.
  intros u. rewrite twist_now. destruct (h_within t T good_now) as [H _].
  assert (N : h t <> 0) by lra. revert N. generalize (h t) (spins_by v t). intros a o N. components. field. exact N.
Qed.
Lemma h_dot : forall u e, len u <= e -> Rabs (h t * (z · u)) <= quick b * e * len z.
Proof.
  intros u e U. destruct (h_within t T good_now) as [H1 H2].
  rewrite Rabs_mult, (Rabs_right (h t)) by lra.
  assert (Z : Rabs (z · u) <= len z * len u).
  { apply Rabs_le. split; [|apply dot_at_most].
    pose proof (dot_at_most (-1 * z)%vec u) as Q. rewrite len_scale, Rabs_left in Q by lra.
    replace ((-1 * z)%vec · u) with (- (z · u)) in Q by number. lra. }
  pose proof (len_pos z). pose proof (len_pos u).
  assert (Z2 : len z * len u <= len z * e) by (apply Rmult_le_compat_l; assumption).
  replace (quick b * e * len z) with (quick b * (len z * e)) by ring.
  apply Rmult_le_compat; [lra|apply Rabs_pos|exact H2|lra].
Qed.

Local Notation sways := (sway (gains v) (wanted_height v) To_vertical (breeze v) (attitude v) (spins_by v)
  (lifts_by v) t).
Lemma sway_within : Rabs sways <= cross_most b.
Proof.
  unfold sway. fold (arm_of v t). rewrite turned_up. pose proof (arm_pos t good_now) as A.
  pose proof (arm_at_least t T good_now) as L. destruct (bounds_are _ _ _ _ F) as [_ [_ [_ [_ [L0 [Q0 [_ [_ C0]]]]]]]].
  unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ arm_of v t)) by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; exact A).
  apply Rmult_le_reg_r with (arm_of v t); [exact A|]. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
  eapply Rle_trans; [apply (h_dot _ _ (blown_within t T))|].
  apply Rle_trans with (cross_most b * lever_least b); [|apply Rmult_le_compat_l; assumption].
  eapply Rle_trans; [|apply (cross_is _ _ _ _ F)].
  replace (quick b * turn_most b * (mass g * windy b)) with (quick b * (mass g * windy b) * turn_most b) by ring.
  apply Rmult_le_compat_l; [|apply (turn_within t (proj1 good_now))].
  destruct mass_is, (sizes _ _ _ _ F) as [_ [_ [_ [? _]]]]. apply Rmult_le_pos; [exact Q0|]. apply Rmult_le_pos; lra.
Qed.

Lemma over_arm : forall a, Rabs a <= C * kappa_ g * (sink b + missed b) -> Rabs (a / arm_of v t) <= sinks_most b.
Proof.
  intros a H. pose proof (arm_pos t good_now) as A. destruct (h_within t T good_now) as [H1 H2].
  destruct (bounds_are _ _ _ _ F) as [_ [S0 [_ [_ [L0 [Q0 [M0 _]]]]]]].
  unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ arm_of v t)) by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; exact A).
  eapply Rle_trans; [|apply (sinks_are _ _ _ _ F)].
  apply Rle_trans with (h t * (sink b + missed b)); [|apply Rmult_le_compat_r; lra].
  replace (h t * (sink b + missed b)) with (C * kappa_ g * (sink b + missed b) * / arm_of v t) by (field; lra).
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; exact A|exact H].
Qed.
Lemma pi_within : Rabs (pi (p t)) <= 2 * sinks_most b + cross_most b.
Proof.
  change (pi (p t)) with (2 * (asked_lift t / arm_of v t) + sways).
  eapply Rle_trans; [apply Rabs_triang|]. apply Rplus_le_compat; [|apply sway_within].
  rewrite Rabs_mult, (Rabs_right 2) by lra. apply Rmult_le_compat_l; [lra|]. apply over_arm, asked_within.
Qed.

Lemma between_abs : forall a e, Rabs a <= e -> - e <= a <= e.
Proof. intros a e H. pose proof (Rle_abs a). pose proof (Rle_abs (- a)) as N. rewrite Rabs_Ropp in N. lra. Qed.
Lemma corner_within : within (fst (chis c)) (snd (chis c)) (chi (p t)) /\
  within (fst (drags c)) (snd (drags c)) (drag (p t)) /\
  within (fst (gains_of c)) (snd (gains_of c)) (gain (p t)) /\ within (Qopp (pi_most c)) (pi_most c) (pi (p t)).
Proof.
  unfold within. split; [|split; [|split]].
  - change (chi (p t)) with ((lifts_by v t - C * 0) / arm_of v t).
    pose proof (arm_is t) as A. pose proof (arm_pos t good_now) as P. pose proof (arm_at_least t T good_now) as L.
    destruct (bounds_are _ _ _ _ F) as [_ [_ [_ [_ [L0 _]]]]].
    pose proof (between_abs _ _ (Rle_trans _ _ _ (pz_len _) (blown_within t T))) as W.
    destruct (chi_is _ _ _ _ F) as [X1 [X2 [X3 X4]]].
    assert (E1 : Q2R (fst (chis c)) * arm_of v t <= arm_of v t - mass g * windy b).
    { assert (0 <= (1 - Q2R (fst (chis c))) * (arm_of v t - lever_least b)) by (apply Rmult_le_pos; lra). lra. }
    assert (E2 : arm_of v t + mass g * windy b <= Q2R (snd (chis c)) * arm_of v t).
    { assert (0 <= (Q2R (snd (chis c)) - 1) * (arm_of v t - lever_least b)) by (apply Rmult_le_pos; lra). lra. }
    split; apply Rmult_le_reg_r with (arm_of v t); try exact P;
      replace ((lifts_by v t - C * 0) / arm_of v t * arm_of v t) with (lifts_by v t) by (field; lra); lra.
  - change (drag (p t)) with (0 / per g (wanted_height v) To_vertical (breeze v) (attitude v) (lifts_by v) t).
    unfold Rdiv. rewrite Rmult_0_l. apply (drag_is _ _ _ _ F).
  - change (gain (p t)) with (efficacy v t). pose proof (between_abs _ _ (thrust_within _ _ _ _ Mo t T)).
    destruct (gain_is _ _ _ _ F). lra.
  - rewrite Q2R_opp. pose proof (between_abs _ _ pi_within). pose proof (pi_is _ _ _ _ F). lra.
Qed.

Lemma ball_now : in_ball (Q2R (middle c)) (Q2R (reach c)) K (x t).
Proof.
  unfold in_ball. rewrite speed_is. fold (flow_of v t).
  assert (O : orthonormal (attitude v t)) by (apply (is_whole _ _ _ _ Mo); pose proof late_pos; lra).
  rewrite flow_turned by (pose proof late_pos; lra).
  destruct (sees_now t good_now) as [_ [_ N]]. specialize (N (way_of v t)).
  assert (E : speeds_by v t = back (attitude v t) (way_of v t)).
  { unfold way_of. rewrite back_turned by exact O. reflexivity. }
  rewrite E, <- back_scale, <- back_minus, !back_square by exact O. exact N.
Qed.

Lemma bounded_by : forall r k gg u, 0 <= k -> k <= r -> len gg <= k * len u ->
  0 <= r /\ gg · gg <= r * r * (u · u).
Proof.
  intros r k gg u K0 KR L. split; [lra|].
  replace (r * r * (u · u)) with (r * len u * (r * len u)) by (rewrite <- (len_square u); ring).
  apply at_most_len. eapply Rle_trans; [exact L|]. apply Rmult_le_compat_r; [apply len_pos|exact KR].
Qed.

Local Notation all_pushes := (pushes (gains v) (pull_down v) (wanted_height v) (behind v) (sees_by v) To_vertical
  (marks v) (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_rise v)
  (set_turn v) (efficacy v) (torque_wrong v) (gyro_known v) (gyro_true v) (stale_by v) t K).

Lemma pushes_within : bounded (map Q2R (radii_of c)) all_pushes (rights K (x t)).
Proof.
  destruct (radii_are _ _ _ _ F) as [r1 [r2 [r3 [r4 [r5 [r6 [r7 [r8 [-> R]]]]]]]]]. cbv zeta in R.
  destruct R as [R1 [R2 [R3 [R4 [R5 [R6 [R7 R8]]]]]]].
  destruct (sizes _ _ _ _ F) as [Z1 [Z2 [Z3 [Z4 [Z5 [Z6 Z7]]]]]].
  destruct (bounds_are _ _ _ _ F) as [B1 [B2 [B3 [B4 [B5 [B6 [B7 [B8 B9]]]]]]]].
  destruct (lag_within _ _ _ _ Mo) as [L1 L2]. pose proof kap_pos as KP.
  destruct (positive _ _ _ _ F) as [[P1 P2 P3 P4 P5] _].
  assert (K12 : 0 < k12_ g).
  { unfold k12_. apply Rdiv_lt_0_compat; [|exact P1]. apply Rmult_lt_0_compat; assumption. }
  pose proof (yaw_within _ _ _ _ Mo t T) as Yaw. pose proof (sink_within t (proj1 good_now)) as Sk.
  pose proof (spread_within t (proj1 good_now)) as Sp. pose proof stale_within as St.
  pose proof (len_pos z) as Lz. pose proof sway_within as Sw.
  pose proof (thrust_within _ _ _ _ Mo t T) as Ef.
  assert (Ez : forall u, len (pz (spins_by v t) * (e3 × flat u))%vec <= yawing b * len (flat u)).
  { intros u. apply len_scaled; [exact Yaw|]. rewrite len_quarter, flat_flat. lra. }
  assert (QS : 0 <= quick b * spread b) by (apply Rmult_le_pos; assumption).
  assert (QK : 0 <= quick b * sink b) by (apply Rmult_le_pos; assumption).
  assert (QM : 0 <= quick b * missed b) by (apply Rmult_le_pos; assumption).
  (* what there is of drift *)
  set (a := set_rise v t / arm_of v t). set (u := asked_lift t / arm_of v t).
  assert (A : Rabs a <= sinks_most b) by (apply over_arm, Calm).
  assert (U : Rabs u <= sinks_most b) by (apply over_arm, asked_within).
  assert (Eff : Rabs (efficacy v t) <= 1 + thrust_off b).
  { replace (efficacy v t) with ((efficacy v t - 1) + 1) by ring. eapply Rle_trans; [apply Rabs_triang|].
    rewrite Rabs_R1. lra. }
  assert (Along : forall y e, len y <= e -> Rabs (h t * pz y) <= quick b * e).
  { intros y e Y. destruct (h_within t T good_now) as [H1 H2]. rewrite Rabs_mult, (Rabs_right (h t)) by lra.
    apply Rmult_le_compat; [lra|apply Rabs_pos|exact H2|]. eapply Rle_trans; [apply pz_len|exact Y]. }
  pose proof (Along _ _ St) as Hn.
  assert (Dr : Rabs (efficacy v t * a + sways) <= (1 + thrust_off b) * sinks_most b + cross_most b).
  { eapply Rle_trans; [apply Rabs_triang|]. apply Rplus_le_compat; [|exact Sw]. rewrite Rabs_mult.
    apply Rmult_le_compat; auto using Rabs_pos. }
  assert (Di : forall q, q / / h t = h t * q) by (intros; unfold Rdiv at 1; rewrite Rinv_inv; ring).
  assert (Ea : efficacy v t * set_rise v t / arm_of v t = efficacy v t * a) by (unfold a, Rdiv; ring).
  unfold pushes, rights. cbn [bounded].
  assert (Known : forall r k gg uu (rest : Prop), 0 <= k -> k <= r -> len gg <= k * len uu -> rest ->
    0 <= r /\ gg · gg <= r * r * (uu · uu) /\ rest).
  { intros r k gg uu rest X1 X2 X3 X4. destruct (bounded_by r k gg uu X1 X2 X3). auto. }
  apply Known with (k := torque_off b); [exact Z2|exact R1|apply (torque_within _ _ _ _ Mo)|].
  apply Known with (2 := R2).
  { repeat apply Rplus_le_le_0_compat; try assumption.
    - apply Rmult_le_pos; [|lra]. apply Rmult_le_pos; lra.
    - apply Rmult_le_pos; [|assumption]. apply Rmult_le_pos; lra.
    - apply Rmult_le_pos; [assumption|]. apply Rplus_le_le_0_compat; [|assumption]. apply Rmult_le_pos; lra. }
  { unfold by_twist, drift, pi_. rewrite per_h, zeta_now. fold (arm_of v t). rewrite Ea. fold u.
    assert (Uu : u = h t * (pz (d3 (err (x t))) - pz (stale_by v t))).
    { unfold u, command. fold C. change (er3 g (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v)
        (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (lifts_by v) t) with (d3 (err (x t))).
      field. pose proof (arm_pos t good_now). lra. }
    change (er3 g (pull_down v) (wanted_height v) (sees_by v) To_vertical (marks v)
        (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (lifts_by v) t) with (d3 (err (x t))).
    rewrite Rmult_plus_distr_r. apply len_minus_to; [|].
    - apply len_scaled; [|apply Rle_refl].
      assert (H0 : h t <> 0) by (destruct (h_within t T good_now); lra).
      replace (efficacy v t * a + sways + pz (d3 (err (x t))) / / h t - (efficacy v t - 1) * (2 * u + sways) / 2
        - (2 * u + sways)) with (efficacy v t * (a - u) + h t * pz (stale_by v t) - (efficacy v t - 1) * (sways / 2)).
      + assert (S1 : Rabs (efficacy v t * (a - u)) <= (1 + thrust_off b) * (2 * sinks_most b)).
        { rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. apply Rabs_le.
          pose proof (between_abs _ _ A). pose proof (between_abs _ _ U). lra. }
        assert (S3 : Rabs ((efficacy v t - 1) * (sways / 2)) <= thrust_off b * (cross_most b / 2)).
        { rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. apply Rabs_le.
          pose proof (between_abs _ _ Sw). lra. }
        pose proof (between_abs _ _ S1). pose proof (between_abs _ _ Hn). pose proof (between_abs _ _ S3).
        apply Rabs_le. lra.
      + rewrite Di. lra.
    - rewrite Rmult_assoc. apply len_scaled; [exact Yaw|]. apply (true_within _ _ _ _ Mo). }
  apply Known with (k := yawing b); [exact Z5|exact R3| |].
  { unfold by_yaw. replace (- pz (spins_by v t))%R with ((-1) * pz (spins_by v t))%R by ring.
    rewrite <- scale_scale, len_scale, Rabs_left by lra.
    replace (- (-1)) with 1 by ring. rewrite Rmult_1_l. apply Ez. }
  apply Known with (2 := R4).
  { apply Rplus_le_le_0_compat; [apply Rmult_le_pos; assumption|]. apply Rmult_le_pos; [apply Rmult_le_pos; lra|exact QS]. }
  { unfold by_gyro. rewrite per_h, zeta_now. rewrite Rmult_plus_distr_r. apply len_plus_to.
    - rewrite Rmult_assoc. apply len_scaled; [exact Yaw|apply (known_within _ _ _ _ Mo)].
    - apply len_scaled; [|apply Rle_refl]. rewrite Di, Rabs_mult.
      apply Rmult_le_compat; [apply Rabs_pos|apply Rabs_pos| |].
      + rewrite Rabs_mult, (Rabs_right (behind v)), (Rabs_right (k12_ g)) by lra. apply Rmult_le_compat_r; lra.
      + apply Along. exact Sp. }
  apply Known with (k := yawing b); [exact Z5|exact R5|unfold by_missed; apply Ez|].
  apply Known with (2 := R6).
  { apply Rmult_le_pos; [apply Rmult_le_pos; lra|exact Z5]. }
  { unfold by_strain. apply len_scaled; [|rewrite len_quarter, flat_flat; apply Rle_refl].
    rewrite Rabs_Ropp, !Rabs_mult, (Rabs_right (behind v)), (Rabs_right (k12_ g)) by lra.
    apply Rmult_le_compat; [apply Rmult_le_pos; lra|apply Rabs_pos| |exact Yaw]. apply Rmult_le_compat_r; lra. }
  apply Known with (2 := R7).
  { apply Rmult_le_pos; [apply Rmult_le_pos; lra|exact QK]. }
  { unfold by_sink. rewrite Rmult_assoc. apply len_scaled.
    - rewrite Rabs_mult, (Rabs_right (behind v)), (Rabs_right (kappa_ g)) by lra. apply Rmult_le_compat_r; lra.
    - rewrite len_up, turned_up. apply h_dot. exact Sk. }
  apply Known with (2 := R8).
  { apply Rmult_le_pos; [lra|]. apply Rplus_le_le_0_compat; [|exact B9]. apply Rmult_le_pos; lra. }
  { unfold by_drift, drift. fold (arm_of v t). rewrite Ea. apply len_scaled; [|apply Rle_refl].
    rewrite Rabs_mult, (Rabs_right (behind v)) by lra.
    apply Rmult_le_compat; [lra|apply Rabs_pos|exact L2|exact Dr]. }
  exact I.
Qed.
End Way.

(** ** Along the way *)

(** What is set of the thrust's rate lags behind what is commanded, so it is within the same bounds. *)
Lemma calm_on : forall t, 0 <= t < until -> (forall s, 0 <= s <= t -> good s) ->
  Rabs (set_rise v t) <= C * kappa_ g * (sink b + missed b).
Proof.
  intros t T G. set (e := C * kappa_ g * (sink b + missed b)).
  destruct (lag_within _ _ _ _ Mo) as [L _]. pose proof (between_abs _ _ (calm_at_first _ _ _ _ _ _ B)) as [S1 S2].
  fold e in S1, S2. pose proof (Rinv_0_lt_compat _ L) as L'.
  assert (A : forall s, 0 <= s <= t -> - e <= asked_lift s <= e).
  { intros s S. apply between_abs, asked_within; [lra|]. intros. apply G. lra. }
  assert (Up : set_rise v t - e <= (set_rise v 0 - e) * exp (- / behind v * t)).
  { apply (decays (fun s => set_rise v s - e) (fun s => / behind v * (asked_lift s - set_rise v s) - 0)); [lra|].
    intros s S. split; [apply slope_minus; [apply (lift_follows _ _ _ _ Mo); lra|apply slope_const]|].
    pose proof (A s S) as [_ A2]. pose proof (Rmult_le_compat_l _ _ _ (Rlt_le _ _ L') A2). lra. }
  assert (Dn : -1 * set_rise v t - e <= (-1 * set_rise v 0 - e) * exp (- / behind v * t)).
  { apply (decays (fun s => -1 * set_rise v s - e)
      (fun s => -1 * (/ behind v * (asked_lift s - set_rise v s)) - 0)); [lra|].
    intros s S. split.
    - apply slope_minus; [apply slope_scale, (lift_follows _ _ _ _ Mo); lra|apply slope_const].
    - pose proof (A s S) as [A1 _]. pose proof (Rmult_le_compat_l _ _ _ (Rlt_le _ _ L') A1). lra. }
  pose proof (exp_pos (- / behind v * t)) as X.
  assert (0 <= (e - set_rise v 0) * exp (- / behind v * t)) by (apply Rmult_le_pos; lra).
  assert (0 <= (set_rise v 0 + e) * exp (- / behind v * t)) by (apply Rmult_le_pos; lra).
  apply Rabs_le. lra.
Qed.

Local Notation push4_of s := (push4 (gains v) (pull_down v) (wanted_height v) (sees_by v) To_vertical
  (marks v) (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_rise v)
  (set_turn v) (efficacy v) (torque_wrong v) (gyro_true v) (stale_by v) s K).
Local Notation push5_of s := (push5 (gains v) (pull_down v) (wanted_height v) (behind v) (sees_by v) To_vertical
  (marks v) (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_rise v)
  (set_turn v) (efficacy v) (torque_wrong v) (gyro_known v) (gyro_true v) (stale_by v) s K).
Local Notation push6_of s := (by_sink (gains v) (pull_down v) (wanted_height v) (behind v) (sees_by v) To_vertical
  (marks v) (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) s).
Local Notation pushes_of s := (pushes (gains v) (pull_down v) (wanted_height v) (behind v) (sees_by v) To_vertical
  (marks v) (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_rise v)
  (set_turn v) (efficacy v) (torque_wrong v) (gyro_known v) (gyro_true v) (stale_by v) s K).

(** Where the place is inside and the lever positive, the errors obey their equations. *)
Lemma obeys_at : forall t, 0 <= t < until -> 0 < arm_of v t -> inside (place v t) ->
  vslope (fun s => d1 (err (x s))) t (- 1 * (spins_by v t × d1 (err (x t))) + go1 (p t) (x t))%vec /\
  vslope (fun s => d2 (err (x s))) t (- 1 * (spins_by v t × d2 (err (x t))) + go2 K (p t) (x t))%vec /\
  vslope (fun s => d3 (err (x s))) t (- 1 * (spins_by v t × d3 (err (x t))) + go3 K (p t) (x t))%vec /\
  vslope (fun s => d4 (err (x s))) t (go4 K (p t) (x t) + push4_of t)%vec /\
  vslope (fun s => mu (x s)) t (/ behind v * (lag_turn K (p t) (x t) + push5_of t))%vec /\
  vslope (fun s => lift (x s)) t (/ behind v * (lag_lift K (p t) (x t) + push6_of t))%vec /\
  v4 K * (d4 (err (x t)) · push4_of t) + a5 K * (mu (x t) · push5_of t) + a6 K * (lift (x t) · push6_of t)
  = sum (lefts K (p t) (x t)) (pushes_of t).
Proof.
  intros t T A Ins. pose proof late_pos as L0.
  destruct (seen_inside _ _ _ _ D _ Ins) as [[Off Feat] _]. destruct (same _ _ _ _ F) as [K1 [K2 [K3 _]]].
  destruct (lag_within _ _ _ _ Mo) as [L _]. destruct (are_linear _ _ _ _ Mo t) as [L1 [L2 L3]].
  assert (O : orthonormal (attitude v t)) by (apply (is_whole _ _ _ _ Mo); lra).
  apply (vehicle_obeys (gains v) (pull_down v) (wanted_height v) (behind v) (sees_by v) To_vertical
    (marks v) (counted v) (breeze v) (place v) (attitude v) (speeds_by v) (spins_by v) (lifts_by v) (set_rise v)
    (set_turn v) (efficacy v) (torque_wrong v) (gyro_known v) (gyro_true v) (stale_by v) t) with (accel := rolls_by v t);
    try assumption.
  - apply (positive _ _ _ _ F).
  - apply featured_turned; assumption.
  - apply Rgt_not_eq, A.
  - apply (is_moving _ _ _ _ Mo). lra.
  - apply (is_turning _ _ _ _ Mo t T).
  - apply (is_pulled _ _ _ _ Mo t T).
  - apply (is_lifted _ _ _ _ Mo t T).
  - apply (is_rolled _ _ _ _ Mo t T).
  - apply (by_torque _ _ _ _ Mo t T).
  - apply (turn_follows _ _ _ _ Mo t T).
  - apply (lift_follows _ _ _ _ Mo t T).
  - apply (flat_turn _ _ _ _ Mo).
  - auto.
Qed.

Lemma energy_moves : forall t, 0 <= t < until -> 0 < arm_of v t -> inside (place v t) ->
  exists d, slope (fun s => energy K (p s) (x s)) t d.
Proof.
  intros t T A Ins. destruct (obeys_at t T A Ins) as [S1 [S2 [S3 [S4 [S5 [S6 _]]]]]].
  eexists. apply (slope_ext (fun s => / 2 * (d1 (err (x s)) · d1 (err (x s)) + v2 K * (d2 (err (x s)) · d2 (err (x s)))
    + v3 K * (d3 (err (x s)) · d3 (err (x s))) + v4 K * (d4 (err (x s)) · d4 (err (x s)))
    + behind v * (a5 K * (mu (x s) · mu (x s)) + a6 K * (lift (x s) · lift (x s)))))).
  { intros s. unfold energy. change (tau (p s)) with (behind v). unfold Rdiv. ring. }
  apply slope_scale. apply slope_plus; [apply slope_plus; [apply slope_plus; [apply slope_plus|]|]|].
  - eapply slope_dot; eassumption.
  - apply slope_scale. eapply slope_dot; eassumption.
  - apply slope_scale. eapply slope_dot; eassumption.
  - apply slope_scale. eapply slope_dot; eassumption.
  - apply slope_scale, slope_plus; apply slope_scale; eapply slope_dot; eassumption.
Qed.

Lemma kept_pos : 0 <= keeps b /\ 0 <= pace K.
Proof.
  destruct (sizes _ _ _ _ F) as [_ [_ [_ [_ [_ [_ S]]]]]]. split; [exact S|].
  destruct Kept as [MQ [TQ [O _]]]. unfold memory_ok in O.
  repeat (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  apply Qle_bool_iff, Qle_Rle in O3. rewrite Q2R_zero in O3. exact O3.
Qed.
Lemma flown_grows : forall a e, - latest b <= a <= e -> e < until -> flown a <= flown e.
Proof.
  intros a e A E. assert (-1 * flown e <= -1 * flown a); [|lra].
  apply (falling (fun s => -1 * flown s) (fun s => -1 * (exp (pace K * s) * (flow_of v s · flow_of v s)))); [lra|].
  intros s S. split; [apply slope_scale; apply In; lra|].
  pose proof (exp_pos (pace K * s)) as X. pose proof (Rmult_le_pos _ _ (Rlt_le _ _ X) (square_pos (flow_of v s))). lra.
Qed.
Lemma energy_below_psi : forall t, 0 <= t < until -> energy K (p t) (x t) <= psi v b c flown again t.
Proof.
  intros t T. pose proof late_pos as L0. destruct kept_pos. unfold psi.
  assert (0 <= memory (keeps b) (latest b) (pace K) flown again t); [|lra].
  apply memory_not_below; [assumption|lra| |].
  - intros s S. apply In. lra.
  - intros s S. apply flown_grows; lra.
Qed.

(** As long as all is good, Ψ falls. *)
Lemma falls_on : forall t, 0 <= t < until -> (forall s, 0 <= s <= t -> good s) ->
  psi v b c flown again t <= psi v b c flown again 0 * exp (- pace K * t).
Proof.
  intros t T G. pose proof late_pos as L0.
  apply (tolerant_falls c (keeps b) (latest b) (behind v) t x p (fun s => pushes_of s) (spins_by v)
    (fun s => push4_of s) (fun s => push5_of s) (fun s => push6_of s) flown again M); [| |lra].
  - assert (W : forall s, 0 <= s <= t -> 0 <= s < until /\ (forall y, 0 <= y <= s -> good y) /\ 0 < arm_of v s /\
      inside (place v s)).
    { intros s S. split; [lra|]. split; [intros; apply G; lra|]. apply (G s S). }
    constructor; try (intros s S; destruct (W s S) as [W1 [W2 [W3 W4]]];
      pose proof (obeys_at s W1 W3 W4) as [S1 [S2 [S3 [S4 [S5 [S6 S7]]]]]]; assumption).
    + intros s S. destruct (W s S) as [W1 [W2 _]]. apply pushes_within; [exact W1|exact W2|].
      apply calm_on; assumption.
    + intros s S. destruct (W s S) as [W1 [W2 _]]. apply ball_now; assumption.
    + intros s S. destruct (W s S) as [W1 [W2 _]]. apply corner_within; assumption.
    + reflexivity.
    + apply (lag_within _ _ _ _ Mo).
  - destruct Kept as [MQ [TQ [O [EM ET]]]]. destruct kept_pos as [M0 P0]. split; [exact M0|]. split.
    { unfold memory_ok in O. repeat (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
      apply Qle_bool_iff, Qle_Rle in O1. rewrite Q2R_mult in O1. rewrite EM, ET. exact O1. }
    intros s S. split; [|split; [|split]].
    + apply In. lra.
    + apply In. lra.
    + apply In. lra.
    + pose proof (late_remembers MQ TQ c (fun z => from v (place v z))
        (fun z => -1 * slope_from v (place v z) (way_of v z))%vec flown (age v s) s (stale (x s)) O) as R.
      cbv zeta in R. rewrite EM, ET. apply R.
      * rewrite <- ET. apply (age_within _ _ _ _ Mo). lra.
      * change (stale (x s)) with (stale_by v s). unfold stale_by. rewrite back_square; [reflexivity|].
        apply (is_whole _ _ _ _ Mo). lra.
      * intros y Y. apply feature_moves; [lra|]. rewrite <- ET in Y. apply (inside_on s); [|lra].
        intros; apply G; lra.
      * intros y Y. rewrite <- ET in Y. eapply slope_is; [apply In; lra|]. f_equal.
        rewrite flow_turned by lra. rewrite back_square by (apply (is_whole _ _ _ _ Mo); lra). number.
Qed.

(** What a level camera sees is off what is wanted by |δ1|. *)
Lemma first_part : forall t, orthonormal (attitude v t) ->
  (from v (place v t) - wanted_height v * e3)%vec · (from v (place v t) - wanted_height v * e3)
  <= 2 * energy K (p t) (x t).
Proof.
  intros t O.
  assert (E1 : len (from v (place v t) - wanted_height v * e3)%vec = len (d1 (err (x t)))).
  { change (d1 (err (x t))) with (er1 (wanted_height v) (sees_by v) To_vertical (marks v) (counted v) (place v)
      (attitude v) t). unfold er1, sight, wants, below. rewrite feature_turned by exact O.
    rewrite <- back_scale, <- back_minus, len_back by exact O. reflexivity. }
  rewrite <- !len_square, E1, len_square.
  destruct (weights_positive _ _ _ _ F) as [V2 [V3 [V4 [V5 V6]]]]. destruct (lag_within _ _ _ _ Mo) as [L _].
  unfold energy. change (tau (p t)) with (behind v).
  pose proof (Rmult_le_pos _ _ (Rlt_le _ _ V2) (square_pos (d2 (err (x t))))).
  pose proof (Rmult_le_pos _ _ (Rlt_le _ _ V3) (square_pos (d3 (err (x t))))).
  pose proof (Rmult_le_pos _ _ (Rlt_le _ _ V4) (square_pos (d4 (err (x t))))).
  pose proof (Rmult_le_pos _ _ V5 (square_pos (mu (x t)))). pose proof (Rmult_le_pos _ _ V6 (square_pos (lift (x t)))).
  assert (0 <= behind v * (a5 K * (mu (x t) · mu (x t)) + a6 K * (lift (x t) · lift (x t))))
    by (apply Rmult_le_pos; lra). lra.
Qed.

(** No motion leaves: all is good at all times. *)
Lemma all_good : 0 < until -> forall t, 0 <= t < until -> good t.
Proof.
  intros U. destruct (levels _ _ _ _ F) as [[S0 S1] [Fa0 Fa1]]. pose proof late_pos as L0.
  pose proof (low_at_first _ _ _ _ _ _ B) as Low.
  assert (Arm : forall t, 0 <= t < until -> exists d, slope (arm_of v) t d).
  { intros t T. eexists. apply (slope_ext (fun s => lifts_by v s - pz (blown (gains v) (breeze v) (attitude v) s))).
    - intros s. symmetry. apply arm_is.
    - apply slope_minus; [apply (is_lifted _ _ _ _ Mo t T)|].
      apply (slope_blown (gains v) (breeze v) (attitude v) (spins_by v) t (is_turning _ _ _ _ Mo t T)). }
  assert (Near : forall t e, 0 <= t < until -> 0 < e -> exists a, 0 < a /\ forall s, Rabs (s - t) < a ->
    len (place v s - place v t)%vec < e).
  { intros t e T E. pose proof (is_moving _ _ _ _ Mo t ltac:(lra)) as [X [Y Z]].
    destruct (near_by _ _ _ (e / 3) X ltac:(lra)) as [a1 [A1 H1]].
    destruct (near_by _ _ _ (e / 3) Y ltac:(lra)) as [a2 [A2 H2]].
    destruct (near_by _ _ _ (e / 3) Z ltac:(lra)) as [a3 [A3 H3]].
    exists (Rmin a1 (Rmin a2 a3)). split; [repeat apply Rmin_pos; assumption|].
    intros s S.
    pose proof (Rmin_l a1 (Rmin a2 a3)). pose proof (Rmin_r a1 (Rmin a2 a3)).
    pose proof (Rmin_l a2 a3). pose proof (Rmin_r a2 a3).
    specialize (H1 s ltac:(lra)). specialize (H2 s ltac:(lra)). specialize (H3 s ltac:(lra)). cbv beta in *.
    set (q := (place v s - place v t)%vec).
    assert (Q1 : Rabs (px q) < e / 3).
    { replace (px q) with (px (place v s) - px (place v t)) by (unfold q; components; ring). exact H1. }
    assert (Q2 : Rabs (py q) < e / 3).
    { replace (py q) with (py (place v s) - py (place v t)) by (unfold q; components; ring). exact H2. }
    assert (Q3 : Rabs (pz q) < e / 3).
    { replace (pz q) with (pz (place v s) - pz (place v t)) by (unfold q; components; ring). exact H3. }
    clearbody q. replace q with (px q * V 1 0 0 + py q * V 0 1 0 + pz q * V 0 0 1)%vec
      by (destruct q; apply vec_eq; components; ring).
    assert (One : len (V 1 0 0) = 1 /\ len (V 0 1 0) = 1 /\ len (V 0 0 1) = 1).
    { unfold len. replace (V 1 0 0 · V 1 0 0) with 1 by number. replace (V 0 1 0 · V 0 1 0) with 1 by number.
      replace (V 0 0 1 · V 0 0 1) with 1 by number. repeat split; apply sqrt_1. }
    destruct One as [O1 [O2 O3]].
    eapply Rle_lt_trans; [apply len_plus|]. rewrite len_scale, O3.
    pose proof (len_plus (px q * V 1 0 0) (py q * V 0 1 0)) as P. rewrite !len_scale, O1, O2 in P. lra. }
  apply goes_on.
  - (* at first *)
    assert (E0 : energy K (p 0) (x 0) <= level_of b) by (pose proof (energy_below_psi 0 ltac:(lra)); lra).
    split; [exact E0|split; [|apply (inside_before _ _ _ _ _ _ B); lra]].
    apply (upright_enough 0 ltac:(lra) E0). left. apply (upright_at_first _ _ _ _ _ _ B).
  - (* at each time before which all is good *)
    intros t T Gs.
    assert (Ins : inside (place v t)).
    { apply (closed _ _ _ _ D). intros e E. destruct (Near t e ltac:(lra) E) as [a [A H]].
      set (s := Rmax 0 (t - a / 2)). exists (place v s).
      assert (X1 : 0 <= s) by apply Rmax_l. assert (X2 : t - a / 2 <= s) by apply Rmax_r.
      assert (X3 : s < t) by (apply Rmax_lub_lt; lra).
      split; [apply (Gs s); lra|]. apply H. rewrite Rabs_left; lra. }
    assert (A : lever_least b <= arm_of v t).
    { destruct (Rle_or_lt (lever_least b) (arm_of v t)) as [L|L]; [exact L|]. exfalso.
      destruct (Arm t ltac:(lra)) as [d Sl].
      destruct (near_by _ _ _ (lever_least b - arm_of v t) Sl ltac:(lra)) as [a [A H]].
      set (s := Rmax 0 (t - a / 2)).
      assert (X1 : 0 <= s) by apply Rmax_l. assert (X2 : t - a / 2 <= s) by apply Rmax_r.
      assert (X3 : s < t) by (apply Rmax_lub_lt; lra).
      pose proof (arm_at_least s ltac:(lra) (Gs s ltac:(lra))).
      pose proof (H s ltac:(rewrite Rabs_left; lra)) as N. rewrite Rabs_right in N by lra. lra. }
    assert (A0 : 0 < arm_of v t).
    { destruct (bounds_are _ _ _ _ F) as [_ [_ [_ [_ [L _]]]]]. lra. }
    split; [|split; [exact A0|exact Ins]].
    destruct (Rle_or_lt (energy K (p t) (x t)) (level_of b)) as [L|L]; [exact L|]. exfalso.
    destruct (energy_moves t ltac:(lra) A0 Ins) as [d Sl].
    destruct (near_by _ _ _ (energy K (p t) (x t) - level_of b) Sl ltac:(lra)) as [a [Pa H]].
    set (s := Rmax 0 (t - a / 2)).
    assert (X1 : 0 <= s) by apply Rmax_l. assert (X2 : t - a / 2 <= s) by apply Rmax_r.
    assert (X3 : s < t) by (apply Rmax_lub_lt; lra).
    destruct (Gs s ltac:(lra)) as [Ge _].
    pose proof (H s ltac:(rewrite Rabs_left; lra)) as N. rewrite Rabs_left in N by lra. lra.
  - (* and a while beyond *)
    intros t T Gs. destruct (Gs t ltac:(lra)) as [G1 [G2 G3]].
    assert (Ps : energy K (p t) (x t) <= start_of b).
    { eapply Rle_trans; [apply energy_below_psi; lra|]. eapply Rle_trans; [apply falls_on; [lra|exact Gs]|].
      destruct kept_pos as [_ P0].
      assert (E1 : exp (- pace K * t) <= 1).
      { rewrite <- exp_0. destruct (Req_dec (- pace K * t) 0) as [-> |N]; [apply Rle_refl|]. left. apply exp_increasing.
        assert (0 <= pace K * t) by (apply Rmult_le_pos; lra). lra. }
      pose proof (exp_pos (- pace K * t)) as E0.
      assert (0 <= (start_of b - psi v b c flown again 0) * exp (- pace K * t)) by (apply Rmult_le_pos; lra).
      assert (0 <= start_of b * (1 - exp (- pace K * t))) by (apply Rmult_le_pos; lra). lra. }
    destruct (energy_moves t T G2 G3) as [d Sl].
    set (room := Rmin (level_of b - start_of b) (far b * far b / 2 - start_of b)).
    assert (R0 : 0 < room) by (apply Rmin_pos; lra).
    assert (R1 : room <= level_of b - start_of b) by apply Rmin_l.
    assert (R2 : room <= far b * far b / 2 - start_of b) by apply Rmin_r.
    destruct (near_by _ _ _ room Sl R0) as [a1 [A1 H1]].
    destruct (Arm t T) as [da Sl2]. destruct (near_by _ _ _ (arm_of v t) Sl2 G2) as [a2 [A2 H2]].
    destruct (ends_beyond _ _ _ _ D _ G3) as [e [E0 He]]. destruct (Near t e T E0) as [a3 [A3 H3]].
    exists (Rmin a1 (Rmin a2 a3)). split; [repeat apply Rmin_pos; assumption|].
    intros s S Su. pose proof (Rmin_l a1 (Rmin a2 a3)). pose proof (Rmin_r a1 (Rmin a2 a3)).
    pose proof (Rmin_l a2 a3). pose proof (Rmin_r a2 a3).
    assert (Ds : Rabs (s - t) = s - t) by (apply Rabs_right; lra).
    specialize (H1 s ltac:(lra)). specialize (H2 s ltac:(lra)). specialize (H3 s ltac:(lra)).
    assert (E2 : energy K (p s) (x s) < start_of b + room) by (pose proof (Rle_abs (energy K (p s) (x s) - energy K (p t) (x t))); lra).
    split; [lra|]. split.
    { pose proof (between_abs _ _ (Rlt_le _ _ H2)). destruct (Rle_or_lt (arm_of v s) 0) as [L|L]; [|exact L].
      rewrite Rabs_left in H2 by lra. lra. }
    destruct (He (place v s) H3) as [Ins|Out]; [exact Ins|]. exfalso.
    (* what a level camera sees is within, by δ1 *)
    assert (O : orthonormal (attitude v s)) by (apply (is_whole _ _ _ _ Mo); lra).
    pose proof (first_part s O) as E3.
    pose proof (Rmult_le_0_lt_compat _ _ _ _ Fa0 Fa0 Out Out) as Q. rewrite len_square in Q. lra.
Qed.

End Stays.

(** * The decision *)

(** Mass, gains and gravity of the mission. *)
Record setting := Setting { m_of : Q; k1_of : Q; k2_of : Q; k3_of : Q; k4_of : Q; g_of : Q }.
Definition gains_in (n : setting) : loop :=
  Loop (Q2R (m_of n)) (Q2R (k1_of n)) (Q2R (k2_of n)) (Q2R (k3_of n)) (Q2R (k4_of n)).
Definition real_limits (b : limits Q) : limits R :=
  Limits (Q2R (thrust_off b)) (Q2R (torque_off b)) (Q2R (gyroscopic b)) (Q2R (windy b)) (Q2R (yawing b))
    (Q2R (latest b)) (Q2R (keeps b)) (Q2R (level_of b)) (Q2R (start_of b)) (Q2R (spread b)) (Q2R (sink b))
    (Q2R (turn_most b)) (Q2R (fast b)) (Q2R (lever_least b)) (Q2R (quick b)) (Q2R (missed b)) (Q2R (sinks_most b))
    (Q2R (cross_most b)) (Q2R (far b)).

Section Decision.
Variables (n : setting) (b : limits Q) (c : matrices).
Local Notation k := (its_constants c).
Local Notation m := (m_of n).
Let stiffQ := (k1_of n * k1_of n * k2_of n / m)%Q.
Let kapQ := ((k1_of n * k2_of n + k3_of n) / m)%Q.
Let k12Q := (k1_of n * k2_of n / m)%Q.
Let push := (m * windy b)%Q.
Let twice := (2 * level_of b)%Q.
Let more := (1 + thrust_off b)%Q.

(** What is to be above 0, what at least 0, what equal, and what at most what. *)
Definition above_zero : list Q :=
  [m; k1_of n; k2_of n; k3_of n; k4_of n; g_of n; v2 k; v3 k; v4 k; latest b; lever_least b;
   level_of b - start_of b; far b * far b - 2 * start_of b]%Q.
Definition at_least_zero : list Q :=
  [a5 k; a6 k; middle c; reach c; thrust_off b; torque_off b; gyroscopic b; windy b; yawing b; keeps b; start_of b;
   far b; spread b; sink b; turn_most b; fast b; quick b; missed b; sinks_most b; cross_most b;
   m * g_of n - stiffQ * spread b]%Q.
Definition equals : list (Q * Q) :=
  [(k12 k, k12Q); (kap k, kapQ); (stiff k, kapQ + k4_of n / m); (speed k, k1_of n / m)]%Q.
Definition orders : list (Q * Q) :=
  let left := (m * g_of n - stiffQ * spread b)%Q in
  [(twice * (/ v3 k + / v2 k), spread b * spread b); (twice * / v3 k, sink b * sink b);
   (twice * (/ v4 k + / v3 k), turn_most b * turn_most b); (twice * (/ 1 + / v2 k), fast b * fast b);
   (lever_least b * lever_least b + push * push, left * left);
   (stiffQ * kapQ, quick b * lever_least b);
   (latest b * ((middle c + reach c) * (k1_of n / m * fast b)), missed b);
   (quick b * (sink b + missed b), sinks_most b);
   (quick b * turn_most b * push, cross_most b * lever_least b);
   (2 * sinks_most b + cross_most b, pi_most c);
   (fst (chis c) * lever_least b, lever_least b - push); (lever_least b + push, snd (chis c) * lever_least b);
   (fst (chis c), 1); (1, snd (chis c)); (fst (drags c), 0); (0, snd (drags c));
   (fst (gains_of c), 1 - thrust_off b); (more, snd (gains_of c))]%Q.
Definition radii_follow : list (Q * Q) :=
  let lag := lag_most c in
  combine
    [torque_off b;
     quick b * missed b + thrust_off b * cross_most b * (1 # 2) + 2 * more * sinks_most b
       + yawing b * ((1 + torque_off b) * gyroscopic b + torque_off b);
     yawing b; yawing b * gyroscopic b + lag * k12Q * (quick b * spread b); yawing b; lag * k12Q * yawing b;
     lag * kapQ * (quick b * sink b); lag * (more * sinks_most b + cross_most b)]%Q (radii_of c).
Definition limits_ok : bool :=
  forallb (above 0) above_zero && forallb (Qle_bool 0) at_least_zero
  && forallb (fun e => Qeq_bool (fst e) (snd e)) equals && forallb (fun e => Qle_bool (fst e) (snd e)) orders
  && forallb (fun e => Qle_bool (fst e) (snd e)) radii_follow && (length (radii_of c) =? 8)%nat.

Lemma ordered : forall (l : list (Q * Q)) a e, forallb (fun e => Qle_bool (fst e) (snd e)) l = true -> In (a, e) l ->
  Q2R a <= Q2R e.
Proof. intros l a e H I. rewrite forallb_forall in H. apply Qle_Rle, Qle_bool_iff, (H (a, e) I). Qed.

Theorem limits_follow : limits_ok = true -> follows (gains_in n) (Q2R (g_of n)) (real_limits b) c.
Proof.
  intros O. unfold limits_ok in O. do 5 (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  apply Nat.eqb_eq in O0.
  assert (Two : Q2R 2 = 2) by (unfold Q2R; simpl; field).
  assert (Half : Q2R (1 # 2) = / 2) by (unfold Q2R; simpl; field).
  assert (P : forall a, In a above_zero -> 0 < Q2R a).
  { intros a H. rewrite forallb_forall in O. specialize (O a H). apply above_correct in O. rewrite Q2R_zero in O. exact O. }
  assert (Z : forall a, In a at_least_zero -> 0 <= Q2R a).
  { intros a H. rewrite forallb_forall in O4. specialize (O4 a H). apply Qle_bool_iff, Qle_Rle in O4.
    rewrite Q2R_zero in O4. exact O4. }
  assert (E : forall a e, In (a, e) equals -> Q2R a = Q2R e).
  { intros a e H. rewrite forallb_forall in O3. apply Qeq_eqR, Qeq_bool_iff, (O3 (a, e) H). }
  pose proof (fun a e => ordered _ a e O2) as L. clear O O4 O3 O2.
  unfold above_zero in P. unfold at_least_zero in Z. unfold equals in E. unfold orders in L.
  assert (Pm : 0 < Q2R m) by (apply P; cbn; tauto).
  assert (P2 : 0 < Q2R (v2 k)) by (apply P; cbn; tauto). assert (P3 : 0 < Q2R (v3 k)) by (apply P; cbn; tauto).
  assert (P4 : 0 < Q2R (v4 k)) by (apply P; cbn; tauto).
  assert (NZ : forall q, 0 < Q2R q -> Q2R (/ q) = / Q2R q).
  { intros q Pq. apply Q2R_inv. intro X. apply Qeq_eqR in X. rewrite Q2R_zero in X. lra. }
  pose proof (NZ _ Pm) as I1. pose proof (NZ _ P2) as I2. pose proof (NZ _ P3) as I3. pose proof (NZ _ P4) as I4.
  assert (One : Q2R (/ 1) = / 1) by (unfold Q2R; simpl; field).
  assert (KQ : Q2R kapQ = kappa_ (gains_in n)).
  { unfold kapQ, Qdiv. rewrite Q2R_mult, Q2R_plus, Q2R_mult, I1. reflexivity. }
  assert (K12 : Q2R k12Q = k12_ (gains_in n)).
  { unfold k12Q, Qdiv. rewrite !Q2R_mult, I1. reflexivity. }
  assert (CQ : Q2R stiffQ = Vehicle.c (gains_in n)).
  { unfold stiffQ, Qdiv. rewrite !Q2R_mult, I1. reflexivity. }
  assert (K1 : Q2R (k1_of n / m) = k1 (gains_in n) / mass (gains_in n)).
  { unfold Qdiv. rewrite Q2R_mult, I1. reflexivity. }
  assert (K4 : Q2R (k4_of n / m) = k4 (gains_in n) / mass (gains_in n)).
  { unfold Qdiv. rewrite Q2R_mult, I1. reflexivity. }
  clearbody kapQ k12Q stiffQ. revert KQ K12 CQ K1 K4. set (KK := (k1_of n / m)%Q) in *. set (K4Q := (k4_of n / m)%Q) in *.
  clearbody KK K4Q. intros.
  constructor.
  - split; [split|]; apply P; cbn; tauto.
  - cbn [real_constants k12 kap stiff speed].
    rewrite (E (k12 k) k12Q), (E (kap k) kapQ), (E (stiff k) (kapQ + K4Q)%Q), (E (speed k) KK) by (cbn; tauto).
    rewrite Q2R_plus, KQ, K12, K1, K4. repeat split.
  - cbn [real_constants v2 v3 v4 a5 a6]. repeat split; first [apply P; cbn; tauto | apply Z; cbn; tauto].
  - split; apply Z; cbn; tauto.
  - cbn [real_limits thrust_off torque_off gyroscopic windy yawing latest keeps].
    repeat split; first [apply P; cbn; tauto | apply Z; cbn; tauto].
  - cbn [real_limits start_of level_of far].
    pose proof (P (level_of b - start_of b)%Q ltac:(cbn; tauto)) as A1. rewrite Q2R_minus in A1.
    pose proof (P (far b * far b - 2 * start_of b)%Q ltac:(cbn; tauto)) as A2.
    rewrite Q2R_minus, !Q2R_mult, Two in A2.
    pose proof (Z (start_of b) ltac:(cbn; tauto)). pose proof (Z (far b) ltac:(cbn; tauto)). lra.
  - cbn [real_limits spread sink turn_most fast lever_least quick missed sinks_most cross_most].
    repeat split; first [apply P; cbn; tauto | apply Z; cbn; tauto].
  - pose proof (L (twice * (/ v3 k + / v2 k)) (spread b * spread b) ltac:(cbn; tauto))%Q as A.
    unfold twice in A. rewrite !Q2R_mult, Q2R_plus, I2, I3, Two in A. exact A.
  - pose proof (L (twice * / v3 k) (sink b * sink b) ltac:(cbn; tauto))%Q as A.
    unfold twice in A. rewrite !Q2R_mult, I3, Two in A. exact A.
  - pose proof (L (twice * (/ v4 k + / v3 k)) (turn_most b * turn_most b) ltac:(cbn; tauto))%Q as A.
    unfold twice in A. rewrite !Q2R_mult, Q2R_plus, I4, I3, Two in A. exact A.
  - pose proof (L (twice * (/ 1 + / v2 k)) (fast b * fast b) ltac:(cbn; tauto))%Q as A.
    unfold twice in A. rewrite !Q2R_mult, Q2R_plus, One, I2, Two in A. exact A.
  - pose proof (Z (m * g_of n - stiffQ * spread b)%Q ltac:(cbn; tauto)) as A1.
    pose proof (L (lever_least b * lever_least b + push * push)
      ((m * g_of n - stiffQ * spread b) * (m * g_of n - stiffQ * spread b)) ltac:(cbn; tauto))%Q as A.
    rewrite Q2R_minus, !Q2R_mult, CQ in A1.
    unfold push in A. rewrite Q2R_plus, !Q2R_mult, Q2R_minus, !Q2R_mult, CQ in A. split; assumption.
  - pose proof (L (stiffQ * kapQ) (quick b * lever_least b) ltac:(cbn; tauto))%Q as A.
    rewrite !Q2R_mult, CQ, KQ in A. exact A.
  - pose proof (L (latest b * ((middle c + reach c) * (KK * fast b))) (missed b) ltac:(cbn; tauto))%Q as A.
    rewrite !Q2R_mult, Q2R_plus, K1 in A. exact A.
  - pose proof (L (quick b * (sink b + missed b)) (sinks_most b) ltac:(cbn; tauto))%Q as A.
    rewrite !Q2R_mult, Q2R_plus in A. exact A.
  - pose proof (L (quick b * turn_most b * push) (cross_most b * lever_least b) ltac:(cbn; tauto))%Q as A.
    unfold push in A. rewrite !Q2R_mult in A. exact A.
  - pose proof (L (2 * sinks_most b + cross_most b) (pi_most c) ltac:(cbn; tauto))%Q as A.
    rewrite Q2R_plus, Q2R_mult, Two in A. exact A.
  - pose proof (L (fst (chis c) * lever_least b) (lever_least b - push) ltac:(cbn; tauto))%Q as A1.
    pose proof (L (lever_least b + push) (snd (chis c) * lever_least b) ltac:(cbn; tauto))%Q as A2.
    pose proof (L (fst (chis c)) 1 ltac:(cbn; tauto))%Q as A3. pose proof (L 1 (snd (chis c)) ltac:(cbn; tauto))%Q as A4.
    unfold push in A1, A2. rewrite Q2R_minus, !Q2R_mult in A1. rewrite Q2R_plus, !Q2R_mult in A2.
    rewrite Q2R_one in A3, A4.
    cbn [real_limits lever_least windy gains_in mass]. lra.
  - pose proof (L (fst (drags c)) 0 ltac:(cbn; tauto))%Q as A3. pose proof (L 0 (snd (drags c)) ltac:(cbn; tauto))%Q as A4.
    rewrite Q2R_zero in A3, A4. split; assumption.
  - pose proof (L (fst (gains_of c)) (1 - thrust_off b) ltac:(cbn; tauto))%Q as A3.
    pose proof (L more (snd (gains_of c)) ltac:(cbn; tauto))%Q as A4. unfold more in A4.
    rewrite Q2R_minus, Q2R_one in A3. rewrite Q2R_plus, Q2R_one in A4. split; assumption.
  - pose proof (fun a e => ordered _ a e O1) as R. unfold radii_follow in R. clear - R O0 KQ K12 Two Half.
    destruct (radii_of c) as [|r1 [|r2 [|r3 [|r4 [|r5 [|r6 [|r7 [|r8 [|r9 l]]]]]]]]]; try discriminate O0.
    exists (Q2R r1), (Q2R r2), (Q2R r3), (Q2R r4), (Q2R r5), (Q2R r6), (Q2R r7), (Q2R r8).
    split; [reflexivity|]. cbv zeta. cbn [combine] in R. unfold more in R.
    match type of R with forall a e, In _ ?l -> _ => set (all := l) in R end.
    assert (Each : forall i a e, nth_error all i = Some (a, e) -> Q2R a <= Q2R e)
      by (intros i a e Hi; exact (R a e (nth_error_In _ i Hi))). clear R.
    pose proof (Each 0%nat _ _ eq_refl) as R1. pose proof (Each 1%nat _ _ eq_refl) as R2.
    pose proof (Each 2%nat _ _ eq_refl) as R3. pose proof (Each 3%nat _ _ eq_refl) as R4.
    pose proof (Each 4%nat _ _ eq_refl) as R5. pose proof (Each 5%nat _ _ eq_refl) as R6.
    pose proof (Each 6%nat _ _ eq_refl) as R7. pose proof (Each 7%nat _ _ eq_refl) as R8. clear Each.
    repeat rewrite ?Q2R_plus, ?Q2R_mult, ?Q2R_one, ?Two, ?Half, ?KQ, ?K12 in *.
    cbn [real_limits thrust_off torque_off gyroscopic yawing spread sink quick missed sinks_most cross_most].
    unfold Rdiv. repeat split; assumption.
Qed.
End Decision.

(** ** Theorem 5 *)

(** Every motion of every vehicle within tolerances that begins as the certificate says stays in the domain and
    within the bounds, and Ψ falls at its rate, as long as the motion goes on. *)
Theorem vehicle_stays : forall v n b c until inside flown again,
  matrices_ok c = true -> memory_ok (keeps b) (latest b) c = true -> limits_ok n b c = true ->
  gains v = gains_in n -> pull_down v = Q2R (g_of n) ->
  let l := real_limits b in
  domain v c (far l) inside -> motion v l c until -> integrals v l c until flown again ->
  begins v l c inside flown again ->
  forall t, 0 <= t < until ->
  let now := psi v l c flown again t in
  now <= psi v l c flown again 0 * exp (- pace (real_constants (its_constants c)) * t) /\
  inside (place v t) /\
  len (from v (place v t) - wanted_height v * e3)%vec * len (from v (place v t) - wanted_height v * e3)%vec <= 2 * now /\
  0 < pz (below (attitude v) t) /\ lever_least l <= arm_of v t /\
  len (speeds_by v t) <= k1 (gains v) / mass (gains v) * fast l /\
  len (stale_by v t) <= missed l /\
  Rabs (set_rise v t) <= Vehicle.c (gains v) * kappa_ (gains v) * (sink l + missed l).
Proof.
  intros v n b c until inside flown again M O Ok Eg Ep l D Mo Ig Bg t T now.
  assert (F : follows (gains v) (pull_down v) l c) by (rewrite Eg, Ep; apply limits_follow; exact Ok).
  assert (Kept : exists MQ TQ, memory_ok MQ TQ c = true /\ keeps l = Q2R MQ /\ latest l = Q2R TQ)
    by (exists (keeps b), (latest b); auto).
  assert (G : forall s, 0 <= s <= t -> good v l c inside s).
  { intros s S. apply (all_good v l c until inside flown again M F Kept D Mo Ig Bg); lra. }
  assert (Gt : good v l c inside t) by (apply G; lra).
  split; [|split; [apply Gt|split; [|split; [|split; [|split; [|split]]]]]].
  - apply (falls_on v l c until inside flown again M F Kept D Mo Ig Bg); assumption.
  - pose proof (energy_below_psi v l c until flown again F Kept Ig t T) as Below. fold now in Below.
    assert (L0 : 0 < latest l) by apply (sizes _ _ _ _ F).
    assert (O2 : orthonormal (attitude v t)) by (apply (is_whole _ _ _ _ Mo); lra).
    rewrite len_square. eapply Rle_trans; [apply (first_part v l c until F Mo t O2)|]. lra.
  - destruct Gt as [G1 [G2 _]]. apply (upright_enough v l c until F Mo t T G1). right. exact G2.
  - eapply arm_at_least; eassumption.
  - eapply speed_within; [eassumption..|]. apply Gt.
  - eapply stale_within; eassumption.
  - eapply calm_on; eassumption.
Qed.
