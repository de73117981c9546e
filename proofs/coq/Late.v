(** Theorem 5 along a motion: the Lyapunov function of a vehicle within tolerances, with the memory of an image
    that is late (Krasovskii), falls at its rate along every solution of the error equations.

    That its parameters and bounds are as the certificate says is what is supposed here, and proved in [Stays];
    that it obeys these equations is proved in [Vehicle]. *)

Require Import QArith Qreals Reals List Bool Lra.
From Hoverproof Require Import Forms Space Calculus Loop Gains Tolerant.
Import ListNotations.
Open Scope R_scope.

(** * What is late *)

Lemma exp_grows : forall r a b, 0 <= r -> a <= b -> exp (r * a) <= exp (r * b).
Proof.
  intros r a b R [L|E]; [|subst; lra]. destruct R as [R|R]; [|subst; rewrite !Rmult_0_l; lra].
  left. apply exp_increasing. apply Rmult_lt_compat_l; assumption.
Qed.

(** [flown] is the integral of e^(r x) |σ'(x)|². Where σ was at a time a, and is at a later time b:
    e^(r a) |σ(b) - σ(a)|²/(b - a) is at most what was flown in between. *)
Lemma way : forall (sigma dsigma : R -> vec) flown r a b, 0 <= r -> a < b ->
  (forall x, a <= x <= b -> vslope sigma x (dsigma x)) ->
  (forall x, a <= x <= b -> slope flown x (exp (r * x) * (dsigma x · dsigma x))) ->
  exp (r * a) * ((sigma b - sigma a)%vec · (sigma b - sigma a)) <= (b - a) * (flown b - flown a).
Proof.
  intros sigma dsigma flown r a b R AB S F.
  set (d := (sigma b - sigma a)%vec). set (l := / (b - a)). set (w := exp (r * a)).
  assert (W : 0 < w) by apply exp_pos.
  assert (H : w * (2 * l * (d · sigma b) - l * l * (d · d) * b) - flown b
    <= w * (2 * l * (d · sigma a) - l * l * (d · d) * a) - flown a).
  { apply (falling (fun x => w * (2 * l * (d · sigma x) - l * l * (d · d) * x) - flown x)
      (fun x => w * (2 * l * (zero · sigma x + d · dsigma x) - l * l * (d · d) * 1)
        - exp (r * x) * (dsigma x · dsigma x)) a b); [lra|].
    intros x X. split.
    - apply slope_minus; [|apply F; exact X]. apply slope_scale.
      apply slope_minus; [|apply slope_scale, derivable_pt_lim_id].
      apply slope_scale, (slope_dot (fun _ => d) sigma); [apply vslope_const|apply S; exact X].
    - pose proof (exp_grows r a x R ltac:(lra)) as E. fold w in E.
      pose proof (square_pos (dsigma x)) as Q. pose proof (square_pos (l * d - dsigma x)%vec) as P.
      replace ((l * d - dsigma x)%vec · (l * d - dsigma x)) with
        (l * l * (d · d) - 2 * l * (d · dsigma x) + dsigma x · dsigma x) in P by number.
      replace (zero · sigma x) with 0 by number.
      pose proof (Rmult_le_compat_r _ _ _ Q E) as E2.
      pose proof (Rmult_le_pos _ _ (Rlt_le _ _ W) P) as P2. lra. }
  assert (D : d · sigma b - d · sigma a = d · d) by (unfold d; number).
  assert (K : w * (l * (d · d)) <= flown b - flown a).
  { assert (LL : l * l * (b - a) = l) by (unfold l; field; lra).
    replace (w * (l * (d · d))) with (w * (2 * l * (d · d) - l * l * (b - a) * (d · d))) by (rewrite LL; ring).
    rewrite <- D at 1. lra. }
  replace (w * (d · d)) with ((b - a) * (w * (l * (d · d)))) by (unfold l; field; lra).
  apply Rmult_le_compat_l; lra.
Qed.

(** So an image of a feature σ that is some time, T at most, old, is off by n with M e^(-rT)/T |n|² at most
    what the memory gives back. *)
Lemma late_image : forall (sigma dsigma : R -> vec) flown r T old t, 0 <= r -> 0 < T -> 0 <= old <= T ->
  (forall x, t - T <= x <= t -> vslope sigma x (dsigma x)) ->
  (forall x, t - T <= x <= t -> slope flown x (exp (r * x) * (dsigma x · dsigma x))) ->
  exp (- r * T) / T * ((sigma (t - old)%R - sigma t)%vec · (sigma (t - old)%R - sigma t))
  <= exp (- r * t) * (flown t - flown (t - T)).
Proof.
  intros sigma dsigma flown r T old t R P O S F.
  set (n := (sigma (t - old)%R - sigma t)%vec).
  assert (Grows : forall x, t - T <= x <= t -> flown (t - T) <= flown x).
  { intros x X. pose proof (falling (fun s => -1 * flown s)
      (fun s => -1 * (exp (r * s) * (dsigma s · dsigma s))) (t - T) x ltac:(lra)) as G.
    assert (-1 * flown x <= -1 * flown (t - T)); [|lra]. apply G. intros s Hs. split.
    - apply slope_scale, F. lra.
    - pose proof (exp_pos (r * s)) as E. pose proof (square_pos (dsigma s)) as Q.
      pose proof (Rmult_le_pos _ _ (Rlt_le _ _ E) Q). lra. }
  assert (N : exp (r * (t - T)) * (n · n) <= T * (flown t - flown (t - T))).
  { destruct O as [[O|O] OT].
    - pose proof (way sigma dsigma flown r (t - old) t R ltac:(lra)
        ltac:(intros; apply S; lra) ltac:(intros; apply F; lra)) as W.
      replace ((sigma t - sigma (t - old)%R)%vec · (sigma t - sigma (t - old)%R)) with (n · n) in W
        by (unfold n; number).
      pose proof (exp_grows r (t - T) (t - old) R ltac:(lra)) as E.
      pose proof (Rmult_le_compat_r _ _ _ (square_pos n) E) as E2.
      pose proof (Grows (t - old) ltac:(lra)) as G1.
      pose proof (falling (fun s => -1 * flown s) (fun s => -1 * (exp (r * s) * (dsigma s · dsigma s)))
        (t - old) t ltac:(lra)) as G2.
      assert (-1 * flown t <= -1 * flown (t - old)) as G3.
      { apply G2. intros s Hs. split; [apply slope_scale, F; lra|].
        pose proof (exp_pos (r * s)) as E'. pose proof (square_pos (dsigma s)) as Q.
        pose proof (Rmult_le_pos _ _ (Rlt_le _ _ E') Q). lra. }
      assert (0 <= (T - old) * (flown t - flown (t - old))) by (apply Rmult_le_pos; lra).
      assert (0 <= T * (flown (t - old) - flown (t - T))) by (apply Rmult_le_pos; lra).
      lra.
    - assert (Z : n · n = 0) by (unfold n; rewrite <- O; replace (t - 0) with t by ring; number).
      rewrite Z, Rmult_0_r. pose proof (Grows t ltac:(lra)). apply Rmult_le_pos; lra. }
  apply Rmult_le_reg_l with (T * exp (r * t)); [apply Rmult_lt_0_compat; [exact P|apply exp_pos]|].
  replace (T * exp (r * t) * (exp (- r * T) / T * (n · n))) with ((exp (r * t) * exp (- r * T)) * (n · n))
    by (field; lra).
  replace (T * exp (r * t) * (exp (- r * t) * (flown t - flown (t - T))))
    with ((exp (r * t) * exp (- r * t)) * (T * (flown t - flown (t - T)))) by ring.
  rewrite <- !exp_plus. replace (r * t + - r * T) with (r * (t - T)) by ring.
  replace (r * t + - r * t) with 0 by ring. rewrite exp_0. lra.
Qed.

(** The memory M ∫ from -T to 0 ∫ from t+x to t of e^(r(z-t)) |y(z)|² dz dx, by [flown], the integral of
    e^(r z) |y|², and [again], the integral of that. *)
Definition memory (M T r : R) (flown again : R -> R) (t : R) : R :=
  M * (exp (- r * t) * (T * flown t - (again t - again (t - T)))).

Lemma slope_memory : forall M T r flown again t y2,
  slope flown t (exp (r * t) * y2) -> slope again t (flown t) -> slope again (t - T) (flown (t - T)) ->
  slope (memory M T r flown again) t
    (- r * memory M T r flown again t + M * T * y2 - M * (exp (- r * t) * (flown t - flown (t - T)))).
Proof.
  intros M T r flown again t y2 F A B. unfold memory.
  assert (B' : slope (fun s => again (s - T)) t (flown (t - T))).
  { eapply slope_is; [apply (derivable_pt_lim_comp (fun s => s - T) again t 1 (flown (t - T)));
      [|exact B]|ring].
    eapply slope_is; [apply slope_minus; [apply derivable_pt_lim_id|apply slope_const]|ring]. }
  eapply slope_is.
  - apply slope_scale, (slope_mult (fun s => exp (- r * s))); [apply slope_exp|].
    apply slope_minus; [apply slope_scale; exact F|apply slope_minus; [exact A|exact B']].
  - cbv beta. pose proof (exp_plus (- r * t) (r * t)) as E.
    replace (- r * t + r * t) with 0 in E by ring. rewrite exp_0 in E.
    replace (exp (- r * t) * (T * (exp (r * t) * y2) - (flown t - flown (t - T))))
      with ((exp (- r * t) * exp (r * t)) * T * y2 - exp (- r * t) * (flown t - flown (t - T))) by ring.
    rewrite <- E. ring.
Qed.

(** It is never below zero. *)
Lemma memory_not_below : forall M T r flown again t, 0 <= M -> 0 <= T ->
  (forall x, t - T <= x <= t -> slope again x (flown x)) ->
  (forall x, t - T <= x <= t -> flown x <= flown t) -> 0 <= memory M T r flown again t.
Proof.
  intros M T r flown again t P Q A G. unfold memory.
  assert (H : again t - flown t * t <= again (t - T) - flown t * (t - T)).
  { apply (falling (fun s => again s - flown t * s) (fun s => flown s - flown t * 1) (t - T) t); [lra|].
    intros s S. split.
    - apply slope_minus; [apply A; exact S|apply slope_scale, derivable_pt_lim_id].
    - specialize (G s S). lra. }
  pose proof (exp_pos (- r * t)) as E.
  repeat apply Rmult_le_pos; lra.
Qed.

(** * Solutions of the error equations *)

(** On [0, until], with the body rates Ω, a constant lag of the rotors, and what is known by bounds alone (the
    pushes h4, h5, h6 and the vectors of [bounded] that they amount to): *)
Record solution (c : matrices) (lag until : R) (m : R -> moment) (p : R -> corner R) (gs : R -> list vec)
  (om h4 h5 h6 : R -> vec) : Prop := {
  (* the errors, and what the rotors lag behind, obey their equations *)
  obeys1 : forall t, 0 <= t <= until ->
    vslope (fun s => d1 (err (m s))) t (- 1 * (om t × d1 (err (m t))) + go1 (p t) (m t))%vec;
  obeys2 : forall t, 0 <= t <= until ->
    vslope (fun s => d2 (err (m s))) t
      (- 1 * (om t × d2 (err (m t))) + go2 (real_constants (its_constants c)) (p t) (m t))%vec;
  obeys3 : forall t, 0 <= t <= until ->
    vslope (fun s => d3 (err (m s))) t
      (- 1 * (om t × d3 (err (m t))) + go3 (real_constants (its_constants c)) (p t) (m t))%vec;
  obeys4 : forall t, 0 <= t <= until ->
    vslope (fun s => d4 (err (m s))) t (go4 (real_constants (its_constants c)) (p t) (m t) + h4 t)%vec;
  obeys5 : forall t, 0 <= t <= until ->
    vslope (fun s => mu (m s)) t
      (/ lag * (lag_turn (real_constants (its_constants c)) (p t) (m t) + h5 t))%vec;
  obeys6 : forall t, 0 <= t <= until ->
    vslope (fun s => lift (m s)) t
      (/ lag * (lag_lift (real_constants (its_constants c)) (p t) (m t) + h6 t))%vec;
  (* the pushes are known by bounds *)
  pushed : forall t, 0 <= t <= until -> let k := real_constants (its_constants c) in
    v4 k * (d4 (err (m t)) · h4 t) + a5 k * (mu (m t) · h5 t) + a6 k * (lift (m t) · h6 t)
    = sum (lefts k (p t) (m t)) (gs t);
  by_bounds : forall t, 0 <= t <= until ->
    bounded (map Q2R (radii_of c)) (gs t) (rights (real_constants (its_constants c)) (m t));
  (* J is in its ball, and the parameters are between their ends *)
  in_its_ball : forall t, 0 <= t <= until ->
    in_ball (Q2R (middle c)) (Q2R (reach c)) (real_constants (its_constants c)) (m t);
  between_ends : forall t, 0 <= t <= until ->
    within (fst (chis c)) (snd (chis c)) (chi (p t)) /\ within (fst (drags c)) (snd (drags c)) (drag (p t)) /\
    within (fst (gains_of c)) (snd (gains_of c)) (gain (p t)) /\
    within (Qopp (pi_most c)) (pi_most c) (pi (p t));
  one_lag : forall t, 0 <= t <= until -> tau (p t) = lag;
  lags : 0 < lag <= Q2R (lag_most c) }.

(** What the memory loses and gives back; [flown] and [again] are two integrals, see [memory]. *)
Definition remembers (c : matrices) (M T until : R) (m : R -> moment) (flown again : R -> R) : Prop :=
  let k := real_constants (its_constants c) in
  0 <= M /\ M * T <= spent k /\
  forall t, 0 <= t <= until ->
    slope flown t (exp (pace k * t) * (moving (m t) · moving (m t))) /\
    slope again t (flown t) /\ slope again (t - T) (flown (t - T)) /\
    regained k * (stale (m t) · stale (m t)) <= M * (exp (- pace k * t) * (flown t - flown (t - T))).

(** A bound of e^(-x) from below: (1 - x/64)^64. *)
Definition fades (x : Q) : Q :=
  let s := fun a : Q => Qred (a * a) in s (s (s (s (s (s (1 - x / 64)%Q))))).
Lemma fades_below : forall x, 0 <= Q2R (1 - x / 64) -> Q2R (fades x) <= exp (- Q2R x).
Proof.
  intros x P.
  assert (S : forall a y, 0 <= Q2R a <= exp y -> 0 <= Q2R (Qred (a * a)) <= exp (y + y)).
  { intros a y [A B]. rewrite (Qeq_eqR _ _ (Qred_correct _)), Q2R_mult, exp_plus. split.
    - apply Rmult_le_pos; exact A.
    - apply Rmult_le_compat; assumption. }
  assert (E : 0 <= Q2R (1 - x / 64) <= exp (- Q2R x / 64)).
  { split; [exact P|]. replace (Q2R (1 - x / 64)) with (1 + - Q2R x / 64).
    - apply exp_ineq1_le.
    - unfold Qdiv. rewrite Q2R_minus, Q2R_mult. unfold Q2R. simpl. field. apply not_0_IZR. discriminate. }
  do 6 apply S in E. destruct E as [_ E]. eapply Rle_trans; [exact E|]. right. f_equal. field.
Qed.

(** That the numbers of a certificate belong to a memory M of an image that is T old at most. *)
Definition memory_ok (M T : Q) (c : matrices) : bool :=
  let k := its_constants c in
  above 0 T && Qle_bool 0 M && Qle_bool 0 (pace k) && Qle_bool 0 (1 - pace k * T / 64)
  && Qle_bool (M * T) (spent k) && Qle_bool (regained k * T) (M * fades (pace k * T)).

(** Krasovskii's step: a moment whose n is of a feature σ that is at most T old, and whose y is as long as σ',
    has what [remembers] asks of it. *)
Theorem late_remembers : forall M T c (sigma dsigma : R -> vec) flown old t n,
  memory_ok M T c = true -> let r := pace (real_constants (its_constants c)) in
  0 <= old <= Q2R T -> n · n = (sigma (t - old)%R - sigma t)%vec · (sigma (t - old)%R - sigma t) ->
  (forall x, t - Q2R T <= x <= t -> vslope sigma x (dsigma x)) ->
  (forall x, t - Q2R T <= x <= t -> slope flown x (exp (r * x) * (dsigma x · dsigma x))) ->
  regained (real_constants (its_constants c)) * (n · n)
    <= Q2R M * (exp (- r * t) * (flown t - flown (t - Q2R T))).
Proof.
  intros M T c sigma dsigma flown old t n O r P N S F. unfold memory_ok in O.
  repeat (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  apply above_correct in O. rewrite Q2R_zero in O.
  repeat match goal with H : Qle_bool _ _ = true |- _ => apply Qle_bool_iff, Qle_Rle in H end.
  rewrite Q2R_zero in O4, O3, O2. rewrite !Q2R_mult in O0.
  pose proof (fades_below _ O2) as E. rewrite Q2R_mult in E.
  change (Q2R (pace (its_constants c))) with r in *.
  change (Q2R (regained (its_constants c))) with (regained (real_constants (its_constants c))) in *.
  pose proof (late_image sigma dsigma flown r (Q2R T) old t O3 O P S F) as L. rewrite <- N in L.
  pose proof (Rmult_le_compat_l _ _ _ O4 L) as L'.
  eapply Rle_trans; [|exact L']. rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [apply square_pos|].
  apply Rmult_le_reg_r with (Q2R T); [exact O|]. eapply Rle_trans; [exact O0|].
  replace (Q2R M * (exp (- r * Q2R T) / Q2R T) * Q2R T) with (Q2R M * exp (- (r * Q2R T))).
  - apply Rmult_le_compat_l; assumption.
  - replace (- r * Q2R T) with (- (r * Q2R T)) by ring. field. lra.
Qed.

Lemma still_moment : forall k p x gs, ~ nonzero (parts x) ->
  energy k p x = 0 /\ energy' k p x gs = 0 /\ moving x · moving x = 0 /\ stale x · stale x = 0.
Proof.
  intros k p x gs N. destruct (zero_or_not (parts x)) as [Z|Z]; [contradiction|].
  assert (E : x = Moment (Errors zero zero zero 0 0) zero zero 0 0 0).
  { destruct x as [[[a b c] [d e f] [g h i] j l] [n o q] [r s t] u v w]. cbn in Z.
    rewrite (Z a), (Z b), (Z c), (Z d), (Z e), (Z f), (Z g), (Z h), (Z i), (Z j), (Z l), (Z n), (Z o), (Z q),
      (Z r), (Z s), (Z t), (Z u), (Z v), (Z w) by tauto. reflexivity. }
  rewrite E. cbn [moving stale]. split; [|split; [|split; number]].
  - unfold energy, d4, mu, lift, Rdiv. cbn [err d1 d2 d3 d4x d4y behind_x behind_y sinking]. number.
  - assert (S : forall us, (forall u, In u us -> u = zero) -> sum us gs = 0).
    { clear. intros us. revert gs. induction us as [|u us IH]; intros [|g gs] H; cbn [sum]; try reflexivity.
      rewrite (H u) by (left; reflexivity). rewrite IH by (intros; apply H; right; assumption). number. }
    unfold energy'. rewrite S.
    + unfold d4, mu, lift. cbn [err d1 d2 d3 d4x d4y behind_x behind_y sinking].
      assert (Z0 : forall u, zero · u = 0) by number. fold zero. rewrite !Z0. ring.
    + intros u I. unfold lefts, ahead, twist, mu, lift, d4 in I.
      cbn [In err d1 d2 d3 d4x d4y behind_x behind_y sinking] in I.
      repeat (destruct I as [<-|I]; [vector|]). destruct I.
Qed.

(** ** Theorem 5 along a solution, with an image that is late *)

(** Ψ = E + memory falls at least as fast as e^(-rt), along every solution. *)
Theorem tolerant_falls : forall c M T lag until m p gs om h4 h5 h6 flown again,
  matrices_ok c = true -> solution c lag until m p gs om h4 h5 h6 ->
  remembers c M T until m flown again -> 0 <= until ->
  let k := real_constants (its_constants c) in
  let psi := fun t => energy k (p t) (m t) + memory M T (pace k) flown again t in
  psi until <= psi 0 * exp (- pace k * until).
Proof.
  intros c M T lag until m p gs om h4 h5 h6 flown again O S [M0 [Sp L]] U k psi.
  fold k in Sp, L. pose proof (lags _ _ _ _ _ _ _ _ _ _ S) as [G0 G1].
  set (en := fun t => (d1 (err (m t)) · d1 (err (m t)) + v2 k * (d2 (err (m t)) · d2 (err (m t)))
    + v3 k * (d3 (err (m t)) · d3 (err (m t))) + v4 k * (d4 (err (m t)) · d4 (err (m t)))
    + lag * (a5 k * (mu (m t) · mu (m t)) + a6 k * (lift (m t) · lift (m t)))) * / 2).
  assert (E : forall t, 0 <= t <= until -> energy k (p t) (m t) = en t).
  { intros t I. unfold energy, en. rewrite (one_lag _ _ _ _ _ _ _ _ _ _ S t I). reflexivity. }
  assert (F : en until + memory M T (pace k) flown again until
    <= (en 0 + memory M T (pace k) flown again 0) * exp (- pace k * until)).
  { apply (decays (fun t => en t + memory M T (pace k) flown again t)
      (fun t => energy' k (p t) (m t) (gs t)
        + (- pace k * memory M T (pace k) flown again t + M * T * (moving (m t) · moving (m t))
           - M * (exp (- pace k * t) * (flown t - flown (t - T))))) (pace k) until U).
    intros t I. destruct (L t I) as [L1 [L2 [L3 L4]]]. split.
    - apply slope_plus; [|apply slope_memory; assumption]. unfold en.
      eapply slope_is.
      + apply (slope_ext (fun s => / 2 * (d1 (err (m s)) · d1 (err (m s)) + v2 k * (d2 (err (m s)) · d2 (err (m s)))
          + v3 k * (d3 (err (m s)) · d3 (err (m s))) + v4 k * (d4 (err (m s)) · d4 (err (m s)))
          + lag * (a5 k * (mu (m s) · mu (m s)) + a6 k * (lift (m s) · lift (m s))))));
          [intros; apply Rmult_comm|].
        apply slope_scale. apply slope_plus; [apply slope_plus; [apply slope_plus; [apply slope_plus|]|]|].
        * eapply slope_dot; apply (obeys1 _ _ _ _ _ _ _ _ _ _ S t I).
        * apply slope_scale. eapply slope_dot; apply (obeys2 _ _ _ _ _ _ _ _ _ _ S t I).
        * apply slope_scale. eapply slope_dot; apply (obeys3 _ _ _ _ _ _ _ _ _ _ S t I).
        * apply slope_scale. eapply slope_dot; apply (obeys4 _ _ _ _ _ _ _ _ _ _ S t I).
        * apply slope_scale. apply slope_plus; apply slope_scale; eapply slope_dot.
          -- apply (obeys5 _ _ _ _ _ _ _ _ _ _ S t I).
          -- apply (obeys5 _ _ _ _ _ _ _ _ _ _ S t I).
          -- apply (obeys6 _ _ _ _ _ _ _ _ _ _ S t I).
          -- apply (obeys6 _ _ _ _ _ _ _ _ _ _ S t I).
      + pose proof (pushed _ _ _ _ _ _ _ _ _ _ S t I) as B. cbv zeta in B. fold k in B. fold k.
        unfold energy'. rewrite <- B.
        generalize (go1 (p t) (m t)) (go2 k (p t) (m t)) (go3 k (p t) (m t)) (go4 k (p t) (m t))
          (lag_turn k (p t) (m t)) (lag_lift k (p t) (m t)) (h4 t) (h5 t) (h6 t) (mu (m t)) (lift (m t))
          (om t) (d1 (err (m t))) (d2 (err (m t))) (d3 (err (m t))) (d4 (err (m t))).
        intros a b d e f g i j l u v w x1 x2 x3 x4.
        assert (Twice : forall y z, y · z + z · y = 2 * (z · y)) by number.
        rewrite !Twice, !dot_plus, !dot_scale, !dot_turned, !dot_plus. field. lra.
    - rewrite <- (E t I).
      assert (Give : regained k * (stale (m t) · stale (m t))
        <= M * (exp (- pace k * t) * (flown t - flown (t - T)))) by exact L4.
      assert (Take : M * T * (moving (m t) · moving (m t)) <= spent k * (moving (m t) · moving (m t))).
      { apply Rmult_le_compat_r; [apply square_pos|exact Sp]. }
      assert (Fall : energy' k (p t) (m t) (gs t) + spent k * (moving (m t) · moving (m t))
        - regained k * (stale (m t) · stale (m t)) <= - pace k * energy k (p t) (m t)).
      { destruct (zero_or_not (parts (m t))) as [N|Z].
        - destruct (between_ends _ _ _ _ _ _ _ _ _ _ S t I) as [B1 [B2 [B3 B4]]].
          assert (B5 : within 0 (lag_most c) (tau (p t))).
          { unfold within. rewrite (one_lag _ _ _ _ _ _ _ _ _ _ S t I), Q2R_zero. lra. }
          pose proof (matrices_sound c O (m t) (gs t) (chi (p t)) (drag (p t)) (gain (p t)) (tau (p t)) (pi (p t))
            (in_its_ball _ _ _ _ _ _ _ _ _ _ S t I) (by_bounds _ _ _ _ _ _ _ _ _ _ S t I) B1 B2 B3 B5 B4 N) as P.
          replace (Corner (chi (p t)) (drag (p t)) (gain (p t)) (tau (p t)) (pi (p t))) with (p t) in P
            by (destruct (p t); reflexivity).
          fold k in P. unfold surplus in P. lra.
        - assert (N : ~ nonzero (parts (m t))) by (intros [y [In Ne]]; apply Ne, Z, In).
          destruct (still_moment k (p t) (m t) (gs t) N) as [-> [-> [-> ->]]]. lra. }
      lra. }
  unfold psi. rewrite !E by lra. exact F.
Qed.
