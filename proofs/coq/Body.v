(** The vehicle and its controller, and that the errors then obey the equations of [Loop].

    World axes have z down; V, Ω, forces and all errors are in body axes. Equations 2 to 4 of the paper for
    the body; the controller is the one that `hoverproof derive` solves for. *)

Require Import Reals List Lra.
From Hoverproof Require Import Space Calculus Loop Image.
Open Scope R_scope.

(** Third component of a vector, as one. *)
Definition upright (u : vec) : vec := V 0 0 (pz u).

Ltac components ::=
  unfold minus, dot; cbn [plus scale cross flat zero e3 px py pz bx by_ bz turned back upright].

(** The choices of a law: its feature, and where its goal is fixed, in the image or to the vertical. (How
    it knows the force is a third one; see [accelerometer_ideal].) *)
Inductive fixing := In_image | To_vertical.

(** What there is: gains, gravity g, the choices, the wanted feature s*, the target points and the sum n of
    how much each counts; and as functions of time position, rotation, velocity, body rates, thrust, and the
    third component of the angular acceleration, which is free: a damper of the yaw rate, or a heading. *)
Record flight := Flight {
  of : loop; gravity : R; sees_as : feature; goal_is : fixing; wanted : vec; target : points; total : R;
  xi : R -> vec; rot : R -> rotation; vel : R -> vec; omega : R -> vec; thrust : R -> R;
  yaw_rate' : R -> R }.

Definition rho (m : flight) (t : R) : vec := back (rot m t) e3.
Definition force (m : flight) (t : R) : vec :=
  ((- thrust m t) * e3 + (mass (of m) * gravity m) * rho m t)%vec.
Definition centroid_at (m : flight) (t : R) : vec := centroid (target m) (rot m t) (xi m t).
Definition seen (m : flight) (t : R) : vec := feature_of (sees_as m) (total m) (centroid_at m t).
(** J, which is Q where the feature is the centroid. *)
Definition Jat (m : flight) (t : R) : vec -> vec :=
  feature_slope (sees_as m) (total m) (centroid_at m t) (image_slope (target m) (rot m t) (xi m t)).

(** What turns with the image: of a goal fixed to the vertical, nothing. *)
Definition fixed (m : flight) : vec :=
  match goal_is m with In_image => wanted m | To_vertical => zero end.
(** What is wanted at a time. *)
Definition reference (m : flight) (t : R) : vec :=
  match goal_is m with In_image => wanted m | To_vertical => (pz (wanted m) * rho m t)%vec end.

(** The errors δ1, ..., δ4. *)
Definition delta1 (m : flight) (t : R) : vec := (seen m t - reference m t)%vec.
Definition delta2 (m : flight) (t : R) : vec :=
  ((mass (of m) / k1 (of m)) * vel m t - delta1 m t)%vec.
Definition delta3 (m : flight) (t : R) : vec :=
  (/ stiffness (of m) * force m t + delta2 m t)%vec.
Definition lever (m : flight) (t : R) : vec :=
  ((thrust m t * e3 - stiffness (of m) * fixed m) × omega m t)%vec.
Definition kappa (g : loop) : R := mass g / (stiffness g * (k1 g * k2 g + k3 g)).
Definition delta4 (m : flight) (t : R) : vec :=
  (kappa (of m) * flat (lever m t) + flat (delta3 m t))%vec.
Definition state (m : flight) (t : R) : errors :=
  Errors (delta1 m t) (delta2 m t) (delta3 m t) (px (delta4 m t)) (py (delta4 m t)).

(** The controller: the rate of thrust and the angular acceleration that it commands, from the image,
    the velocity, the vertical, the body rates and the thrust alone. There is no Q in it. *)
Definition command_thrust (m : flight) (t : R) : R :=
  let g := of m in
  pz (lever m t) + stiffness g / mass g * (k1 g * k2 g + k3 g) * pz (delta3 m t).
Definition command_turn (m : flight) (t : R) : vec :=
  let g := of m in
  (/ (mass g * kappa g * (thrust m t - stiffness g * pz (fixed m)))
   * ((- (k1 g * k2 g + k3 g)) * flat (delta3 m t) - k4 g * delta4 m t
      - (mass g * kappa g * command_thrust m t) * (e3 × omega m t)
      + mass g * flat (omega m t × delta3 m t) + (k1 g * k2 g) * flat (delta2 m t)
      - (k1 g * k2 g + k3 g) * delta4 m t + k3 g * flat (delta3 m t)))%vec.
(** e3 × Ω' is [command_turn]. *)
Definition command_rates (m : flight) (t : R) : vec :=
  V (py (command_turn m t)) (- px (command_turn m t)) (yaw_rate' m t).

(** A motion of the closed loop on [0, until]. *)
Record closed_loop (m : flight) (until : R) : Prop := {
  whole : forall t, 0 <= t <= until -> orthonormal (rot m t);
  sees : forall t, 0 <= t <= until -> forall k p, In (k, p) (target m) -> off p (xi m t);
  features : forall t, 0 <= t <= until -> featured (sees_as m) (total m) (centroid_at m t);
  regular : forall t, 0 <= t <= until -> thrust m t <> stiffness (of m) * pz (fixed m);
  moves : forall t, 0 <= t <= until -> vslope (xi m) t (turned (rot m t) (vel m t));
  spins : forall t, 0 <= t <= until -> turns (rot m) (omega m) t;
  speeds : forall t, 0 <= t <= until ->
    vslope (vel m) t (- 1 * (omega m t × vel m t) + / mass (of m) * force m t)%vec;
  pushes : forall t, 0 <= t <= until -> slope (thrust m) t (command_thrust m t);
  rolls : forall t, 0 <= t <= until -> vslope (omega m) t (command_rates m t) }.

Record positive_gains (g : loop) : Prop := {
  mass_pos : 0 < mass g; k1_pos : 0 < k1 g; k2_pos : 0 < k2 g; k3_pos : 0 < k3 g; k4_pos : 0 < k4 g }.

(** The torque of a body with moments of inertia I that gives an angular acceleration a, and that it does:
    I Ω' = -Ω × I Ω + Γ. *)
Definition inertia (i : vec) (u : vec) : vec := V (px i * px u) (py i * py u) (pz i * pz u).
Definition torque (i om a : vec) : vec := (om × inertia i om + inertia i a)%vec.
Lemma torque_gives : forall i om a d, 0 < px i -> 0 < py i -> 0 < pz i ->
  inertia i d = (torque i om a - om × inertia i om)%vec -> d = a.
Proof.
  intros [i j k] om [a b c] [d e f] I J K H. unfold torque in H. simpl in *.
  set (g := (om × inertia (V i j k) om)%vec) in *. clearbody g. destruct g as [x y z].
  unfold inertia, minus, plus, scale in H. simpl in H. injection H as H1 H2 H3.
  apply vec_eq; simpl.
  - apply Rmult_eq_reg_l with i; lra.
  - apply Rmult_eq_reg_l with j; lra.
  - apply Rmult_eq_reg_l with k; lra.
Qed.

(** A law that measures the force takes m (a + g ρ) and -m a3 in place of F and T, a = V' + Ω × V - g ρ what
    an accelerometer measures. With one that is ideal they are the same, so all below is about both laws. *)
Theorem accelerometer_ideal : forall m t accelerometer,
  mass (of m) <> 0 ->
  vslope (vel m) t (- 1 * (omega m t × vel m t) + / mass (of m) * force m t)%vec ->
  (forall dv, vslope (vel m) t dv ->
    accelerometer = (dv + omega m t × vel m t - gravity m * rho m t)%vec) ->
  (mass (of m) * (accelerometer + gravity m * rho m t))%vec = force m t /\
  - mass (of m) * pz accelerometer = thrust m t.
Proof.
  intros m t a M S A. rewrite (A _ S). split.
  - generalize (force m t) (rho m t) (vel m t) (omega m t). intros. apply vec_eq; components; field; exact M.
  - unfold force. generalize (rho m t) (vel m t) (omega m t). intros. components. field. exact M.
Qed.

(** A yaw rate that is damped, with none at the start: none at any time. *)
Definition damped (m : flight) (until : R) : Prop :=
  exists k, forall t, 0 <= t <= until -> yaw_rate' m t = - k * pz (omega m t).
Lemma no_yaw : forall m until, closed_loop m until -> damped m until -> pz (omega m 0) = 0 ->
  forall t, 0 <= t <= until -> pz (omega m t) = 0 /\ yaw_rate' m t = 0.
Proof.
  intros m until L [k D] Z0 t T.
  assert (E : pz (omega m t) * exp (k * t) = pz (omega m 0) * exp (k * 0)).
  { apply (still (fun s => pz (omega m s) * exp (k * s)) 0 t); [lra|].
    intros s S. destruct (rolls m until L s ltac:(lra)) as [_ [_ Z]]. cbn [command_rates pz] in Z.
    rewrite D in Z by lra. eapply slope_is.
    - apply (slope_mult (fun u => pz (omega m u)) (fun u => exp (k * u)));
        [exact Z|apply slope_exp].
    - cbv beta. ring. }
  rewrite Z0 in E. pose proof (exp_pos (k * t)) as P.
  assert (Y : pz (omega m t) = 0) by (apply Rmult_eq_reg_r with (exp (k * t)); lra).
  split; [exact Y|]. rewrite D, Y by lra. ring.
Qed.

(** What is fixed in the image is straight below, or there is no yaw. *)
Definition axial_or_still (m : flight) (t : R) : Prop :=
  (px (fixed m) = 0 /\ py (fixed m) = 0) \/ (pz (omega m t) = 0 /\ yaw_rate' m t = 0).

Section Errors_obey.

Variables (m : flight) (until : R).
Hypothesis L : closed_loop m until.
Hypothesis G : positive_gains (of m).

Variable t : R.
Hypothesis T : 0 <= t <= until.
Hypothesis Y : axial_or_still m t.

Let g := of m.
Let c := stiffness g.
Let K := k1 g * k2 g + k3 g.
Let x := state m t.
Let om := omega m t.
Let f := factor g (thrust m t) (pz (fixed m)).

Lemma c_pos : 0 < c.
Proof.
  destruct G. unfold c, stiffness, Rdiv. fold g in mass_pos0, k1_pos0, k2_pos0.
  apply Rmult_lt_0_compat; [|apply Rinv_0_lt_compat; assumption].
  apply Rmult_lt_0_compat; [|assumption]. apply Rmult_lt_0_compat; assumption.
Qed.
Lemma K_pos : 0 < K.
Proof.
  destruct G. unfold K. fold g in k1_pos0, k2_pos0, k3_pos0.
  apply Rplus_lt_0_compat; [apply Rmult_lt_0_compat|]; assumption.
Qed.

Lemma slope_rho : vslope (rho m) t (- 1 * (om × rho m t))%vec.
Proof.
  eapply vslope_is.
  - apply (slope_back (rot m) (omega m) (fun _ => e3)); [apply (spins m until L t T)|].
    apply (vslope_const e3).
  - unfold rho, back. fold om. vector.
Qed.

(** F' = -Ω × F - U e3 - T Ω × e3 *)
Lemma slope_force : vslope (force m) t
  (- 1 * (om × force m t) - command_thrust m t * e3 - thrust m t * (om × e3))%vec.
Proof.
  eapply vslope_is.
  - apply (vslope_plus (fun s => ((- thrust m s) * e3)%vec)
      (fun s => ((mass g * gravity m) * rho m s)%vec)).
    + apply (vslope_times (fun s => - thrust m s) (fun _ => e3) t (- command_thrust m t) zero).
      * eapply slope_is; [eapply slope_ext; [|apply (slope_scale (-1)), (pushes m until L t T)]|].
        -- intros s. simpl. ring.
        -- ring.
      * apply (vslope_const e3).
    + apply vslope_scale, slope_rho.
  - unfold force. fold g. generalize (rho m t) as r. intros r. vector.
Qed.

(** -m Ω × q* is what A (δ4 - δ3) is there for. *)
Lemma turn_is : (k1 g * f * turn (fixed m) x)%vec = ((- mass g) * (om × fixed m))%vec.
Proof.
  destruct G as [M1 M2 M3 M4 M5]. fold g in M1, M2, M3, M4, M5.
  pose proof Y as Y'. unfold axial_or_still in Y'. pose proof c_pos as C. pose proof K_pos as KP.
  pose proof (regular m until L t T) as N. fold g c in N.
  assert (E : (d4 x - d3 x)%vec = (kappa g * flat (lever m t) - upright (delta3 m t))%vec).
  { unfold x, d4. cbn [state d3 d4x d4y]. unfold delta4. fold g. unfold upright. vector. }
  unfold turn. rewrite E.
  assert (Lv : flat (lever m t) = ((thrust m t - c * pz (fixed m)) * (e3 × om))%vec).
  { unfold lever. fold g c om. fold om in Y'. revert Y'. generalize om (fixed m) (thrust m t) (yaw_rate' m t).
    intros [ox oy oz] [qx qy qz] th yaw Y'. simpl in Y'.
    destruct Y' as [[-> ->]|[-> _]]; vector. }
  rewrite Lv.
  assert (F : k1 g * f * (kappa g * (thrust m t - c * pz (fixed m))) = mass g).
  { unfold f, factor, kappa. fold c. fold K. unfold c, stiffness.
    assert (thrust m t - k1 g * k1 g * k2 g / mass g * pz (fixed m) <> 0).
    { intro Z. apply N. unfold c, stiffness. lra. }
    assert (mass g * thrust m t - k1 g * k1 g * k2 g * pz (fixed m) <> 0).
    { intro Z. apply H. apply Rmult_eq_reg_l with (mass g); [|lra].
      rewrite Rmult_0_r, <- Z. field. apart. }
    field. repeat split; try lra; assumption. }
  set (a := kappa g * (thrust m t - c * pz (fixed m))) in *.
  replace (kappa g * ((thrust m t - c * pz (fixed m)) * (e3 × om)))%vec with (a * (e3 × om))%vec
    by (unfold a; vector).
  fold om in Y'. clearbody a. set (h := k1 g * f) in *. clearbody h. rewrite <- F.
  generalize (delta3 m t). clear - Y'. revert Y'. generalize om (fixed m) (yaw_rate' m t).
  intros [ox oy oz] [qx qy qz] yaw Y' [dx dy dz]. simpl in Y'. unfold upright.
  destruct Y' as [[-> ->]|[-> _]]; vector.
Qed.

(** What is wanted moves as -Ω × it but for what is fixed in the image. *)
Lemma slope_reference : vslope (reference m) t (- 1 * (om × reference m t) + om × fixed m)%vec.
Proof.
  unfold reference, fixed. destruct (goal_is m).
  - eapply vslope_is; [apply (vslope_const (wanted m))|vector].
  - eapply vslope_is; [apply vslope_scale, slope_rho|]. fold om. vector.
Qed.

Lemma slope_delta1 : vslope (delta1 m) t (/ mass g * rate1 g (Jat m t) f (fixed m) om x)%vec.
Proof.
  eapply vslope_is.
  - apply (vslope_minus (seen m) (reference m)); [|apply slope_reference].
    apply (slope_feature (sees_as m) (total m) (target m) (rot m) (xi m) (vel m) (omega m)).
    + apply (whole m until L t T).
    + apply (spins m until L t T).
    + apply (moves m until L t T).
    + apply (sees m until L t T).
    + apply (features m until L t T).
  - fold (centroid_at m t). fold (seen m t). fold (Jat m t). fold om.
    destruct G as [M1 M2 M3 M4 M5]. fold g in M1, M2, M3, M4, M5.
    assert (Fl : flow x = ((mass g / k1 g) * vel m t)%vec).
    { unfold flow, x. cbn [state d1 d2]. unfold delta2. fold g. vector. }
    assert (Fq : Jat m t (flow x) = ((mass g / k1 g) * Jat m t (vel m t))%vec).
    { rewrite Fl. apply feature_linear, image_linear. }
    pose proof turn_is as Tu.
    unfold rate1. rewrite Tu, Fq. cbn [x state d1]. unfold delta1.
    generalize (seen m t) (reference m t) (fixed m) (Jat m t (vel m t)) om. intros.
    apply vec_eq; components; field; apart.
Qed.

(** m δ2' *)
Lemma slope_delta2 : vslope (delta2 m) t (/ mass g * rate2 g (Jat m t) f (fixed m) om x)%vec.
Proof.
  destruct G as [M1 M2 M3 M4 M5]. fold g in M1, M2, M3, M4, M5. pose proof c_pos as C.
  eapply vslope_is.
  - apply (vslope_minus (fun s => ((mass g / k1 g) * vel m s)%vec) (delta1 m));
      [apply vslope_scale, (speeds m until L t T)|apply slope_delta1].
  - fold g om.
    (* F = c (δ3 - δ2), and (m/k1) c = k1 k2 *)
    assert (F : force m t = (c * (d3 x - d2 x))%vec).
    { cbn [x state d2 d3]. unfold delta3. fold g c. generalize (force m t) (delta2 m t). intros u v.
      apply vec_eq; components; field; apart. }
    assert (W : ((mass g / k1 g) * (- 1 * (om × vel m t)))%vec = (- 1 * (om × (d1 x + d2 x)))%vec).
    { cbn [x state d1 d2]. unfold delta2. fold g. vector. }
    replace ((mass g / k1 g) * (- 1 * (om × vel m t) + / mass g * force m t))%vec
      with (- 1 * (om × (d1 x + d2 x)) + (k1 g * k2 g / mass g) * (d3 x - d2 x))%vec.
    + unfold rate1, rate2. generalize (Jat m t (flow x)) (turn (fixed m) x) (d1 x) (d2 x) (d3 x).
      intros. apply vec_eq; components; field; apart.
    + rewrite <- W, F. unfold c, stiffness. generalize (om × vel m t)%vec (d3 x - d2 x)%vec. intros.
      apply vec_eq; components; field; apart.
Qed.

(** m δ3' *)
Lemma slope_delta3 : vslope (delta3 m) t (/ mass g * rate3 g (Jat m t) om x)%vec.
Proof.
  destruct G as [M1 M2 M3 M4 M5]. fold g in M1, M2, M3, M4, M5.
  pose proof c_pos as C. pose proof K_pos as KP.
  eapply vslope_is.
  - apply (vslope_plus (fun s => (/ c * force m s)%vec) (delta2 m));
      [apply vslope_scale, slope_force|apply slope_delta2].
  - fold g om.
    assert (F : force m t = (c * (d3 x - d2 x))%vec).
    { cbn [x state d2 d3]. unfold delta3. fold g c. generalize (force m t) (delta2 m t). intros u v.
      apply vec_eq; components; field; apart. }
    (* k1 f A (δ4 - δ3) = -m Ω × q*, as in the rate of δ1 *)
    assert (Tu : (k1 g * f * turn (fixed m) x)%vec = ((- mass g) * (om × fixed m))%vec) by apply turn_is.
    (* what is left of the force: ((T e3 - c q* ) × Ω - U e3) m/c = K (δ4 - P δ3) - K δ3z e3 *)
    assert (Lv : (lever m t - command_thrust m t * e3)%vec
      = ((c * K / mass g) * (d4 x - d3 x))%vec).
    { unfold command_thrust. fold g c K.
      assert (E : flat (lever m t) = ((c * K / mass g) * flat (d4 x - d3 x))%vec).
      { unfold x, d4. cbn [state d3 d4x d4y]. unfold delta4. fold g. unfold kappa. fold c K.
        generalize (lever m t) (delta3 m t). intros. apply vec_eq; components; field; apart. }
      cbn [x state d3] in *. revert E. unfold d4, x. cbn [state d4x d4y d3].
      generalize (lever m t) (delta3 m t) (delta4 m t). intros [lx ly lz] [a b e] [i j k] E.
      unfold flat, scale, minus, plus in E. simpl in E. injection E as E1 E2.
      apply vec_eq; components; [lra|lra|field; apart]. }
    unfold rate2, rate3. rewrite Tu, F.
    replace (thrust m t * (om × e3))%vec with (c * (om × fixed m) - lever m t)%vec
      by (unfold lever; fold g c om; vector).
    replace (command_thrust m t * e3)%vec
      with (lever m t - (c * K / mass g) * (d4 x - d3 x))%vec.
    + fold K. rewrite cross_scale, cross_minus.
      generalize (om × d3 x)%vec (om × d2 x)%vec (om × fixed m)%vec (lever m t) (Jat m t (flow x))
        (d2 x) (d3 x) (d4 x).
      unfold K. generalize (k1 g) (k2 g) (k3 g). clearbody c. clear - M1 C. generalize (mass g) M1.
      intros n N a1 a2 a3 O3 O2 Ow l y u v w. apply vec_eq; components; field; apart.
    + rewrite <- Lv. vector.
Qed.

(** m δ4' *)
Lemma slope_delta4 : vslope (delta4 m) t (/ mass g * rate4 g (Jat m t) x)%vec.
Proof.
  destruct G as [M1 M2 M3 M4 M5]. fold g in M1, M2, M3, M4, M5.
  pose proof c_pos as C. pose proof K_pos as KP. pose proof Y as Y'. unfold axial_or_still in Y'.
  fold om in Y'.
  pose proof (regular m until L t T) as N. fold g c in N.
  assert (KN : kappa g <> 0).
  { unfold kappa. fold c K. apply Rgt_not_eq. apply Rmult_lt_0_compat; [lra|].
    apply Rinv_0_lt_compat, Rmult_lt_0_compat; lra. }
  eapply vslope_is.
  - apply (vslope_plus (fun s => (kappa g * flat (lever m s))%vec) (fun s => flat (delta3 m s)));
      [|apply vslope_flat, slope_delta3].
    apply vslope_scale, vslope_flat.
    apply (vslope_cross (fun s => (thrust m s * e3 - c * fixed m)%vec) (omega m));
      [|apply (rolls m until L t T)].
    apply (vslope_minus (fun s => (thrust m s * e3)%vec) (fun _ => (c * fixed m)%vec));
      [|apply (vslope_const (c * fixed m)%vec)].
    apply (vslope_times (thrust m) (fun _ => e3)); [apply (pushes m until L t T)|].
    apply (vslope_const e3).
  - fold om.
    assert (E : (flat ((command_thrust m t * e3 + thrust m t * zero - zero) × om
        + (thrust m t * e3 - c * fixed m) × command_rates m t))%vec
      = (command_thrust m t * (e3 × om)
        + (thrust m t - c * pz (fixed m)) * flat (command_turn m t))%vec).
    { unfold command_rates. fold om. revert Y'.
      generalize om (command_turn m t) (command_thrust m t) (thrust m t) (fixed m) (yaw_rate' m t).
      intros [ox oy oz] [ax ay az] u th [qx qy qz] yaw Y'. simpl in Y'.
      destruct Y' as [[-> ->]|[-> ->]]; vector. }
    rewrite E. clear E.
    unfold command_turn. fold g c K om.
    set (a := thrust m t - c * pz (fixed m)) in *.
    assert (A : a <> 0) by (unfold a; lra).
    unfold rate3, rate4, x, d4. cbn [state d1 d2 d3 d4x d4y]. fold x K.
    assert (F4 : flat (delta4 m t) = delta4 m t) by (unfold delta4; vector).
    change (V (px (delta4 m t)) (py (delta4 m t)) 0) with (flat (delta4 m t)). rewrite F4.
    revert F4. generalize (delta4 m t) (delta3 m t) (delta2 m t) (Jat m t (flow x)) (command_thrust m t) om.
    clearbody a c. clear - M1 KN A. generalize (kappa g) KN. intros k KN' d4' d3' d2' y u o F4.
    (* the command, W/(m k a), times k a is W/m; and k u (e3 × Ω) is m k u (e3 × Ω)/m *)
    set (W := (_ - _ - _ + _ + _ - _ + _)%vec).
    replace (k * (u * (e3 × o) + a * flat (/ (mass g * k * a) * W)))%vec
      with (/ mass g * ((mass g * k * u) * (e3 × o) + flat W))%vec.
    2:{ rewrite flat_scale, !scale_plus, !scale_scale. generalize (flat W) (e3 × o)%vec. intros.
        f_equal; [f_equal; field; apart|]. f_equal. field. apart. }
    unfold W. clear W. unfold K.
    repeat rewrite ?flat_plus, ?flat_minus, ?flat_scale, ?flat_flat, ?flat_lever, ?F4.
    rewrite <- scale_plus. f_equal.
    generalize (flat (o × d3')) (e3 × o)%vec (flat y) (flat d2') (flat d3').
    generalize (k1 g) (k2 g) (k3 g) (k4 g) (mass g). clear. intros v5 v4 v3 v2 v1 a1 a2 a3 a4 n.
    apply vec_eq; components; ring.
Qed.

(** The errors of every motion, under each of the eight laws, obey the equations: for the law of the paper,
    eqs. 22 to 35, as corrected. *)
Theorem errors_obey :
  vslope (fun s => d1 (state m s)) t (/ mass g * rate1 g (Jat m t) f (fixed m) om x)%vec /\
  vslope (fun s => d2 (state m s)) t (/ mass g * rate2 g (Jat m t) f (fixed m) om x)%vec /\
  vslope (fun s => d3 (state m s)) t (/ mass g * rate3 g (Jat m t) om x)%vec /\
  vslope (fun s => d4 (state m s)) t (/ mass g * rate4 g (Jat m t) x)%vec.
Proof.
  split; [apply slope_delta1|]. split; [apply slope_delta2|]. split; [apply slope_delta3|].
  apply (vslope_ext (delta4 m)); [|apply slope_delta4].
  intros s. unfold d4, state, delta4. cbn [d4x d4y]. vector.
Qed.

End Errors_obey.
