(** A vehicle within tolerances, from rigid body and camera, and that its errors obey the equations of theorem 5.

    The law measures the force; its goal is straight below. The thrust that there is changes by an effect ς of
    what is set, what is set lags behind what is commanded, the torque is off by matrices γ and Gt, a steady wind
    blows, the feature that is used is another than the one now, and the yaw rate is what it is. *)

Require Import Reals List Lra.
From Hoverproof Require Import Space Calculus Loop Image Body Tolerant.
Import ListNotations.
Open Scope R_scope.

Ltac components ::=
  unfold minus, dot; cbn [plus scale cross flat zero e3 px py pz bx by_ bz turned back upright up].

Section Vehicle.

(** Gains; gravity; s3*; the lag (s); feature, goal, target; the wind, as an acceleration in world axes. *)
Variables (g : loop) (grav s3 lag : R) (kind : feature) (goal : fixing) (ps : points) (n : R) (wind : vec).
(** Functions of time: position, rotation, velocity, body rates; T (the thrust over the true mass, times m);
    what is set of its rate; the angular acceleration e3 × Ω' that is set, gyroscopic part and all; ς, γ; what
    of Ω3 e3 × Ω is made up for, and what there is; the feature used less the feature now. *)
Variables (xi : R -> vec) (rot : R -> rotation) (vel om : R -> vec) (thrust rise : R -> R) (turning : R -> vec).
Variables (effect : R -> R) (gam gc gt : R -> vec -> vec) (late : R -> vec).

Definition c := stiffness g.
Definition kappa_ := (k1 g * k2 g + k3 g) / mass g.
Definition k12_ := k1 g * k2 g / mass g.
Definition stiff_ := kappa_ + k4 g / mass g.

Definition below (t : R) : vec := back (rot t) e3.                                   (** ρ *)
Definition blown (t : R) : vec := (mass g * back (rot t) wind)%vec.                  (** w, N *)
Definition pull (t : R) : vec := ((- thrust t) * e3 + (mass g * grav) * below t + blown t)%vec.   (** F *)
Definition sight (t : R) : vec := feature_of kind n (centroid ps (rot t) (xi t)).
Definition Jof (t : R) : vec -> vec :=
  feature_slope kind n (centroid ps (rot t) (xi t)) (image_slope ps (rot t) (xi t)).
Definition s3g : R := match goal with In_image => s3 | To_vertical => 0 end.
Definition wants (t : R) : vec :=
  match goal with In_image => (s3 * e3)%vec | To_vertical => (s3 * below t)%vec end.

(** The errors. The thrust that is known is that of the accelerometer, T - w3. *)
Definition er1 (t : R) : vec := (sight t - wants t)%vec.
Definition er2 (t : R) : vec := ((mass g / k1 g) * vel t - er1 t)%vec.
Definition er3 (t : R) : vec := (/ c * pull t + er2 t)%vec.
Definition arm (t : R) : R := thrust t - pz (blown t) - c * s3g.                     (** D_c *)
Definition per (t : R) : R := arm t / (c * kappa_).                                  (** 1/h *)
Definition zeta (t : R) : vec := (per t * (e3 × om t))%vec.
Definition er4 (t : R) : vec := (zeta t + flat (er3 t))%vec.

(** What is commanded: the rate of the thrust, and e3 × Ω', over h. *)
Definition command (t : R) : R := c * kappa_ * (pz (er3 t) - pz (late t)).
Definition sway (t : R) : R := pz (om t × blown t)%vec / arm t.                      (** p3 *)
Definition pi_ (t : R) : R := 2 * (command t / arm t) + sway t.
Definition nominal (t : R) : vec := ((- stiff_) * er4 t - k12_ * flat (er3 t - er2 t))%vec.
Definition commanded (t : R) : vec :=
  (nominal t + stiff_ * flat (late t) - pi_ t * zeta t
   + pz (om t) * (e3 × flat (er3 t - late t)))%vec.

Definition lags_turn (t : R) : vec := (per t * turning t - nominal t)%vec.            (** μ *)
Definition lags_lift (t : R) : R := rise t / c - kappa_ * pz (er3 t).                 (** μT *)
Definition now (t : R) : moment :=
  Moment (Errors (er1 t) (er2 t) (er3 t) (px (er4 t)) (py (er4 t))) (Jof t (vel t)) (late t)
    (px (lags_turn t)) (py (lags_turn t)) (lags_lift t).
Definition at_now (t : R) : corner R :=
  Corner ((thrust t - c * s3g) / arm t) (s3g / per t) (effect t) lag (pi_ t).

Variable t : R.
Hypothesis Gains : positive_gains g.
Hypothesis Lag : 0 < lag.
Hypothesis Whole : orthonormal (rot t).
Hypothesis Off : forall k p, In (k, p) ps -> off p (xi t).
Hypothesis Featured : featured kind n (centroid ps (rot t) (xi t)).
Hypothesis Arm : arm t <> 0.
Hypothesis Moves : vslope xi t (turned (rot t) (vel t)).
Hypothesis Spins : turns rot om t.
Hypothesis Speeds : vslope vel t (- 1 * (om t × vel t) + / mass g * pull t)%vec.
Hypothesis Lifts : slope thrust t (effect t * rise t).

Lemma c_is_pos : 0 < c.
Proof.
  destruct Gains. unfold c, stiffness, Rdiv. apply Rmult_lt_0_compat; [|apply Rinv_0_lt_compat; assumption].
  apply Rmult_lt_0_compat; [|assumption]. apply Rmult_lt_0_compat; assumption.
Qed.
Lemma kappa_pos : 0 < kappa_.
Proof. unfold kappa_. destruct Gains. unfold Rdiv. apply Rmult_lt_0_compat; [|apply Rinv_0_lt_compat; assumption].
  apply Rplus_lt_0_compat; [apply Rmult_lt_0_compat|]; assumption.
Qed.
Lemma per_apart : per t <> 0.
Proof.
  pose proof c_is_pos. pose proof kappa_pos. unfold per, Rdiv.
  apply Rmult_integral_contrapositive_currified; [exact Arm|].
  apply Rinv_neq_0_compat, Rgt_not_eq, Rmult_lt_0_compat; assumption.
Qed.
Lemma er4_flat : flat (er4 t) = er4 t.
Proof. unfold er4, zeta. vector. Qed.
Lemma twist_is : twist (now t) = zeta t.
Proof.
  unfold twist, now, d4. cbn [err d4x d4y d3]. change (V (px (er4 t)) (py (er4 t)) 0) with (flat (er4 t)).
  rewrite er4_flat. unfold er4. vector.
Qed.

Lemma slope_below : vslope below t (- 1 * (om t × below t))%vec.
Proof.
  eapply vslope_is; [apply (slope_back rot om (fun _ => e3)); [exact Spins|apply (vslope_const e3)]|].
  unfold below, back. vector.
Qed.
Lemma slope_blown : vslope blown t (- 1 * (om t × blown t))%vec.
Proof.
  eapply vslope_is; [apply vslope_scale, (slope_back rot om (fun _ => wind)); [exact Spins|apply (vslope_const wind)]|].
  unfold blown, back. vector.
Qed.
Lemma slope_wants : vslope wants t (- 1 * (om t × wants t) + s3g * (om t × e3))%vec.
Proof.
  unfold wants, s3g. destruct goal.
  - eapply vslope_is; [apply (vslope_const (s3 * e3)%vec)|vector].
  - eapply vslope_is; [apply vslope_scale, slope_below|]. vector.
Qed.

(** δ1' = -Ω × δ1 - y + s3 h ζ *)
Lemma slope_er1 : vslope er1 t (- 1 * (om t × er1 t) + go1 (at_now t) (now t))%vec.
Proof.
  eapply vslope_is; [apply (vslope_minus sight wants); [|apply slope_wants];
    apply (slope_feature kind n ps rot xi vel om); assumption|].
  fold (sight t). fold (Jof t). unfold go1. rewrite twist_is. cbn [now moving at_now drag].
  unfold zeta. rewrite scale_scale. replace (s3g / per t * per t) with s3g by (field; apply per_apart).
  unfold er1. generalize (sight t) (wants t) (Jof t (vel t)) (om t). intros. vector.
Qed.

Lemma pull_is : pull t = (c * (er3 t - er2 t))%vec.
Proof.
  pose proof c_is_pos. unfold er3. generalize (pull t) (er2 t). intros. apply vec_eq; components; field; lra.
Qed.

(** δ2' *)
Lemma slope_er2 : forall k, k12 k = k12_ -> vslope er2 t (- 1 * (om t × er2 t) + go2 k (at_now t) (now t))%vec.
Proof.
  intros k K. eapply vslope_is; [apply (vslope_minus (fun s => ((mass g / k1 g) * vel s)%vec) er1);
    [apply vslope_scale; exact Speeds|apply slope_er1]|].
  unfold go1, go2. rewrite K, pull_is. unfold strain. cbn [now err d2 d3 moving].
  destruct Gains as [M1 M2 M3 M4 M5].
  generalize (twist (now t)) (drag (at_now t)) (Jof t (vel t)) (er3 t). intros z d y e.
  unfold er2, k12_, c, stiffness. generalize (er1 t) (vel t) (om t). intros.
  apply vec_eq; components; field; lra.
Qed.

(** δ3' *)
Lemma slope_er3 : forall k, k12 k = k12_ -> kap k = kappa_ ->
  vslope er3 t (- 1 * (om t × er3 t) + go3 k (at_now t) (now t))%vec.
Proof.
  intros k K1 K2.
  assert (P : vslope pull t (- 1 * (om t × pull t) + (thrust t) * (e3 × om t) - (effect t * rise t) * e3)%vec).
  { eapply vslope_is.
    - apply (vslope_plus (fun s => ((- thrust s) * e3 + (mass g * grav) * below s)%vec) blown); [|apply slope_blown].
      apply (vslope_plus (fun s => ((- thrust s) * e3)%vec) (fun s => ((mass g * grav) * below s)%vec)).
      + apply (vslope_times (fun s => - thrust s) (fun _ => e3) t (- (effect t * rise t)) zero).
        * eapply slope_is; [eapply slope_ext; [|apply (slope_scale (-1)); exact Lifts]|].
          -- intros s. cbv beta. ring.
          -- ring.
        * apply (vslope_const e3).
      + apply vslope_scale, slope_below.
    - unfold pull. generalize (below t) (blown t) (om t). intros. vector. }
  eapply vslope_is; [apply (vslope_plus (fun s => (/ c * pull s)%vec) er2);
    [apply vslope_scale; exact P|apply (slope_er2 k K1)]|].
  unfold go2, go3. rewrite twist_is, K1, K2. unfold strain, lift. cbn [now err d2 d3 moving at_now drag chi gain sinking].
  pose proof c_is_pos as C. pose proof kappa_pos as Kp. pose proof per_apart as Pe.
  assert (Z : ((thrust t) * (e3 × om t))%vec
    = ((c * (kappa_ * ((thrust t - c * s3g) / arm t) + s3g / per t)) * zeta t)%vec).
  { unfold zeta. rewrite scale_scale. f_equal. unfold per. field. repeat split; try lra; exact Arm. }
  rewrite Z. unfold lags_lift. unfold er3.
  generalize (zeta t) (kappa_ * ((thrust t - c * s3g) / arm t)) (s3g / per t) (er2 t) (Jof t (vel t)) (pull t) (om t).
  generalize k12_ (effect t) (rise t). generalize kappa_. clear - C. intros kp kk ef ri z a b e y f o.
  apply vec_eq; components; field; lra.
Qed.

(** ** The lever, and what lags *)

Variables (k : constants R) (accel : vec).
Hypothesis K1 : k12 k = k12_.
Hypothesis K2 : kap k = kappa_.
Hypothesis K3 : stiff k = stiff_.
(** The torque: what is set, off by γ, and the gyroscopic part that is not made up for; and the lag. *)
Hypothesis Rolls : vslope om t accel.
Hypothesis Torque : (e3 × accel = turning t + gam t (turning t) - pz (om t) * gt t (e3 × om t))%vec.
Hypothesis Turn_lags : vslope turning t
  (/ lag * (/ per t * commanded t + pz (om t) * gc t (e3 × om t) - turning t))%vec.
Hypothesis Lift_lags : slope rise t (/ lag * (command t - rise t)).
Hypothesis Level_turn : forall s, pz (turning s) = 0.
Hypothesis Linear : linear (gam t) /\ linear (gt t) /\ linear (gc t).
Hypothesis Level : forall u, flat (gam t u) = gam t u /\ flat (gt t u) = gt t u /\ flat (gc t u) = gc t u.

(** D_c'/D_c *)
Definition drift : R := effect t * rise t / arm t + sway t.
Lemma slope_per : slope per t (drift * per t).
Proof.
  unfold per. pose proof c_is_pos as C. pose proof kappa_pos as Kp.
  eapply slope_is.
  - apply (slope_ext (fun s => / (c * kappa_) * arm s)); [intros; unfold Rdiv; ring|]. apply slope_scale.
    unfold arm. apply (slope_minus (fun s => thrust s - pz (blown s)) (fun _ => c * s3g)
      t (effect t * rise t - pz (- 1 * (om t × blown t))%vec)); [|apply slope_const].
    apply (slope_minus thrust (fun s => pz (blown s))); [exact Lifts|apply slope_blown].
  - unfold drift, sway. generalize (om t × blown t)%vec. intros u. cbn [scale pz]. field.
    repeat split; first [exact Arm | lra].
Qed.

Lemma mu_is : mu (now t) = lags_turn t.
Proof.
  assert (Z : pz (lags_turn t) = 0).
  { unfold lags_turn, nominal. rewrite <- er4_flat. generalize (er4 t) (er3 t - er2 t)%vec. intros.
    components. rewrite Level_turn. ring. }
  unfold mu, now. cbn [behind_x behind_y]. apply vec_eq; try reflexivity. cbn [pz]. rewrite Z. reflexivity.
Qed.
Lemma d4_is : d4 (err (now t)) = er4 t.
Proof. unfold d4, now. cbn [err d4x d4y]. rewrite <- er4_flat at 3. reflexivity. Qed.
Lemma asked_is : asked k (now t) = (per t * turning t)%vec.
Proof.
  unfold asked. rewrite mu_is, d4_is, K1, K3. unfold strain. cbn [now err d2 d3].
  unfold lags_turn, nominal. generalize (er4 t) (flat (er3 t - er2 t)) (per t * turning t)%vec. intros. vector.
Qed.

(** What is known by bounds alone. *)
Definition by_turn : vec := gam t (asked k (now t)).
Definition by_twist : vec :=
  ((drift + pz (er3 t) / per t - (effect t - 1) * pi_ t / 2 - pi_ t) * zeta t
   - pz (om t) * gt t (zeta t))%vec.
Definition by_yaw : vec := ((- pz (om t)) * (e3 × flat (er3 t)))%vec.
Definition by_gyro : vec :=
  (pz (om t) * gc t (zeta t) + (lag * k12_ * (pz (er3 t - er2 t)%vec / per t)) * zeta t)%vec.
Definition by_missed : vec := (pz (om t) * (e3 × flat (er3 t - late t)))%vec.
Definition by_strain : vec := ((- (lag * k12_ * pz (om t))) * (e3 × flat (er3 t - er2 t)))%vec.
Definition by_sink : vec := ((lag * kappa_) * up (om t × er3 t))%vec.
Definition by_drift : vec := ((lag * drift) * asked k (now t))%vec.
Definition pushes : list vec :=
  [by_turn; by_twist; by_yaw; by_gyro; by_missed; by_strain; by_sink; by_drift].
Definition push4 : vec := (by_turn + by_twist + by_yaw)%vec.
Definition push5 : vec := (by_gyro + by_missed + by_strain + by_drift + (lag * stiff_) * push4)%vec.

(** δ4' *)
Lemma slope_er4 : vslope er4 t (go4 k (at_now t) (now t) + push4)%vec.
Proof.
  destruct Linear as [[_ LG] [[_ LT] _]].
  eapply vslope_is.
  - apply (vslope_plus zeta (fun s => flat (er3 s))); [|apply vslope_flat, (slope_er3 k K1 K2)].
    apply (vslope_times per (fun s => (e3 × om s)%vec)); [apply slope_per|].
    apply (vslope_cross (fun _ => e3) om); [apply (vslope_const e3)|exact Rolls].
  - replace (zero × om t + e3 × accel)%vec with (e3 × accel)%vec by (generalize accel (om t); vector).
    rewrite Torque. unfold push4, by_turn, by_twist, by_yaw. rewrite asked_is.
    unfold go4, go3. rewrite asked_is, twist_is, K1, K2. cbn [now moving err d3 at_now chi gain pi].
    assert (A1 : gam t (per t * turning t)%vec = (per t * gam t (turning t))%vec) by apply LG.
    assert (A2 : gt t (zeta t) = (per t * gt t (e3 × om t))%vec) by (unfold zeta; apply LT).
    rewrite A1, A2.
    assert (FL : flat (om t × er3 t)%vec = (pz (om t) * (e3 × flat (er3 t)) - (pz (er3 t) / per t) * zeta t)%vec).
    { unfold zeta. rewrite scale_scale. replace (pz (er3 t) / per t * per t) with (pz (er3 t)) by (field; apply per_apart).
      generalize (om t) (er3 t). vector. }
    assert (Zz : pz (zeta t) = 0) by (unfold zeta; components; ring).
    replace (drift * per t * (e3 × om t))%vec with (drift * zeta t)%vec by (unfold zeta; vector).
    rewrite flat_plus, (flat_scale (-1)), FL. pose proof per_apart as Pe.
    unfold lift. cbn [now sinking]. revert Zz Pe.
    generalize (zeta t) (gam t (turning t)) (gt t (e3 × om t)) (turning t) (er3 t) (Jof t (vel t)) (strain (now t)).
    generalize drift (per t) (pz (om t)) (lags_lift t) ((thrust t - c * s3g) / arm t) (pi_ t) (effect t) kappa_ k12_.
    clear. intros q p o l x pp ef ka kk z a b w e y u Zz Pe. destruct z as [zx zy zz]. cbn [pz] in Zz. subst zz.
    apply vec_eq; components; field; exact Pe.
Qed.

(** τ μ' *)
Lemma slope_lags_turn : vslope lags_turn t (/ lag * (lag_turn k (at_now t) (now t) + push5))%vec.
Proof.
  destruct Linear as [_ [_ [_ LC]]].
  eapply vslope_is.
  - apply (vslope_minus (fun s => (per s * turning s)%vec) nominal).
    + apply (vslope_times per turning); [apply slope_per|exact Turn_lags].
    + apply (vslope_minus (fun s => ((- stiff_) * er4 s)%vec) (fun s => (k12_ * flat (er3 s - er2 s))%vec)).
      * apply vslope_scale, slope_er4.
      * apply vslope_scale, vslope_flat, (vslope_minus er3 er2); [apply (slope_er3 k K1 K2)|apply (slope_er2 k K1)].
  - unfold lag_turn, push5, by_gyro, by_missed, by_strain, by_drift. rewrite mu_is, twist_is, asked_is, K1, K2, K3.
    unfold lags_turn, commanded, go3, go2. rewrite twist_is, K1, K2. cbn [now stale tau at_now pi chi drag gain].
    assert (A : gc t (zeta t) = (per t * gc t (e3 × om t))%vec) by (unfold zeta; apply LC).
    rewrite A. pose proof per_apart as Pe. assert (Zz : pz (zeta t) = 0) by (unfold zeta; components; ring).
    set (S := (er3 t - er2 t)%vec).
    assert (FL : flat (om t × er3 t - om t × er2 t)%vec = (pz (om t) * (e3 × flat S) - (pz S / per t) * zeta t)%vec).
    { unfold zeta, S. rewrite scale_scale. replace (pz (er3 t - er2 t)%vec / per t * per t) with (pz (er3 t - er2 t)%vec)
        by (field; apply per_apart). generalize (om t) (er3 t) (er2 t). vector. }
    assert (FD : forall a b y z u v r d,
      flat (- 1 * a + (y + z - v * (u)) - (- 1 * b + (y + d - r)))%vec
      = (- 1 * flat (a - b) + flat (z - v * u - d + r))%vec) by (intros; vector).
    unfold lift. cbn [moving err d3 sinking].
    revert Zz Pe FL. generalize (zeta t) (om t × er3 t)%vec (om t × er2 t)%vec. intros z o3 o2 Zz Pe FL.
    match goal with |- context [flat ?E] => match E with (_ - (- 1 * o2 + _))%vec =>
      replace (flat E) with (- 1 * flat (o3 - o2) + (kappa_ * ((thrust t - c * s3g) / arm t) + s3g / per t) * z)%vec end end.
    2:{ destruct z as [zx zy zz]. cbn [pz] in Zz. subst zz.
        generalize (strain (now t)) (Jof t (vel t)) (er3 t). intros. vector. }
    rewrite FL. unfold strain. cbn [now err d2 d3]. fold S.
    generalize (go4 k (at_now t) (now t)) push4 (nominal t) (turning t) (late t) (er3 t) S (gc t (e3 × om t)).
    generalize drift (per t) (pz (om t)) ((thrust t - c * s3g) / arm t) (pi_ t) kappa_ k12_ stiff_ Pe Lag.
    clear. intros q p o x pp ka kk st Pe Lag a b w u l e v y.
    apply vec_eq; components; field; split; try exact Pe; lra.
Qed.

(** τ μT' *)
Lemma slope_lags_lift : vslope (fun s => lift (now s)) t (/ lag * (lag_lift k (at_now t) (now t) + by_sink))%vec.
Proof.
  destruct (slope_er3 k K1 K2) as [_ [_ Z]].
  assert (Q : slope lags_lift t (/ c * (/ lag * (command t - rise t))
    - kappa_ * pz (- 1 * (om t × er3 t) + go3 k (at_now t) (now t))%vec)).
  { apply (slope_minus (fun s => rise s / c) (fun s => kappa_ * pz (er3 s))).
    - apply (slope_ext (fun s => / c * rise s)); [intros; unfold Rdiv; ring|]. apply slope_scale. exact Lift_lags.
    - apply slope_scale. exact Z. }
  pose proof c_is_pos as C.
  unfold lag_lift, by_sink. rewrite K2. unfold lift at 2. cbn [now stale sinking at_now tau].
  unfold lags_lift, command in *.
  revert Q. generalize (go3 k (at_now t) (now t)) (om t × er3 t)%vec. intros a b Q.
  split; [|split].
  - eapply slope_is; [apply (slope_const 0)|]. components. ring.
  - eapply slope_is; [apply (slope_const 0)|]. components. ring.
  - eapply slope_is; [exact Q|]. generalize (er3 t) (late t). intros. components. field. lra.
Qed.

(** What is known by bounds alone, as the theorem has it. *)
Lemma pushes_are :
  v4 k * (d4 (err (now t)) · push4) + a5 k * (mu (now t) · push5) + a6 k * (lift (now t) · by_sink)
  = sum (lefts k (at_now t) (now t)) pushes.
Proof.
  unfold lefts, pushes, ahead. cbn [sum at_now tau]. rewrite twist_is, d4_is, K3. unfold push5, push4.
  assert (A : er4 t · by_yaw = zeta t · by_yaw).
  { unfold er4, by_yaw. generalize (zeta t) (er3 t) (pz (om t)). number. }
  rewrite !dot_plus, A, !plus_dot, !scale_dot, !dot_scale, !dot_plus. ring.
Qed.

(** The loop of such a vehicle obeys the equations of theorem 5. *)
Theorem vehicle_obeys :
  vslope (fun s => d1 (err (now s))) t (- 1 * (om t × d1 (err (now t))) + go1 (at_now t) (now t))%vec /\
  vslope (fun s => d2 (err (now s))) t (- 1 * (om t × d2 (err (now t))) + go2 k (at_now t) (now t))%vec /\
  vslope (fun s => d3 (err (now s))) t (- 1 * (om t × d3 (err (now t))) + go3 k (at_now t) (now t))%vec /\
  vslope (fun s => d4 (err (now s))) t (go4 k (at_now t) (now t) + push4)%vec /\
  vslope (fun s => mu (now s)) t (/ lag * (lag_turn k (at_now t) (now t) + push5))%vec /\
  vslope (fun s => lift (now s)) t (/ lag * (lag_lift k (at_now t) (now t) + by_sink))%vec /\
  v4 k * (d4 (err (now t)) · push4) + a5 k * (mu (now t) · push5) + a6 k * (lift (now t) · by_sink)
  = sum (lefts k (at_now t) (now t)) pushes.
Proof.
  split; [exact slope_er1|]. split; [exact (slope_er2 k K1)|]. split; [exact (slope_er3 k K1 K2)|].
  split; [|split; [|split; [exact slope_lags_lift|exact pushes_are]]].
  - apply (vslope_ext er4); [|exact slope_er4]. intros s. unfold d4, now, er4, zeta. cbn [err d4x d4y]. vector.
  - apply (vslope_ext lags_turn); [|exact slope_lags_turn]. intros s.
    assert (Z : pz (lags_turn s) = 0).
    { unfold lags_turn, nominal, er4, zeta. components. rewrite Level_turn. ring. }
    unfold mu, now. cbn [behind_x behind_y]. apply vec_eq; try reflexivity. cbn [pz]. rewrite Z. reflexivity.
Qed.

End Vehicle.
