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
    fast as exp(-r t), r = 2 margin/m, while Q and T are admitted, if the yaw rate is zero at the start. *)
Theorem lyapunov_decays : forall c m until,
  certificate_ok c = true ->
  of m = loop_of (its c) ->
  inside c (wanted m) ->
  closed_loop m until -> 0 <= until ->
  pz (omega m 0) = 0 ->
  (forall t, 0 <= t <= until ->
    admitted c (Qat m t) /\ within (thrust_low c) (thrust_high c) (thrust m t)) ->
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
    (fun t => - (/ mass (of m)) * fall (of m) (weights_of (its c)) (Qat m t)
      (factor (of m) (thrust m t) (pz (wanted m))) (wanted m) (omega m t) (state m t))); [exact U|].
  intros t T. destruct (errors_obey m until L G Y t T) as [S1 [S2 [S3 S4]]].
  destruct (A t T) as [Ad Th]. split.
  - unfold lyapunov. eapply slope_is.
    + eapply slope_ext; [|apply (slope_scale (/ 2)); eapply slope_squares; [|exact S1|exact S2|exact S3|exact S4]; lra].
      intros s. cbv beta. apply Rmult_comm.
    + field. lra.
  - pose proof (gains_sound_weakly c C (Qat m t) (thrust m t) (wanted m) (omega m t) (state m t) Ad Th I) as B.
    rewrite <- E in B. cbv zeta in B. unfold lyapunov.
    apply Rmult_le_reg_l with (mass (of m)); [exact M|].
    replace (mass (of m) * (- / mass (of m) * fall (of m) (weights_of (its c)) (Qat m t)
        (factor (of m) (thrust m t) (pz (wanted m))) (wanted m) (omega m t) (state m t)))
      with (- fall (of m) (weights_of (its c)) (Qat m t)
        (factor (of m) (thrust m t) (pz (wanted m))) (wanted m) (omega m t) (state m t)) by (field; lra).
    replace (mass (of m) * (- (2 * Q2R (margin c) / mass (of m)) * (squares (weights_of (its c)) (state m t) / 2)))
      with (- (Q2R (margin c) * squares (weights_of (its c)) (state m t))) by (field; lra).
    lra.
Qed.
