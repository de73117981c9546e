(** Theorem 5, its matrix step: the Lyapunov function of a vehicle within tolerances falls at its rate, for
    all vehicles and all that is known by bounds alone, if a few matrices of rationals are positive definite.

    For rotors that lag. What is taken from the set where the function is below its level, the intervals of
    the parameters and the radii, is here what the certificate says that it is. *)

Require Import QArith Qreals Reals List Bool Lra.
From Hoverproof Require Import Forms Space Loop Gains.
Import ListNotations.
Open Scope R_scope.

(** What stands along e3, as a vector. *)
Definition up (u : vec) : vec := V 0 0 (pz u).
Lemma up_plus : forall u v, (up (u + v) = up u + up v)%vec.
Proof. intros. apply vec_eq; cbn [up plus px py pz]; ring. Qed.
Lemma up_scale : forall k u, (up (k * u) = k * up u)%vec.
Proof. intros. apply vec_eq; cbn [up scale px py pz]; ring. Qed.
Lemma up_minus : forall u v, (up (u - v) = up u - up v)%vec.
Proof. intros. unfold minus. rewrite up_plus, up_scale. reflexivity. Qed.

(** * What there is at a moment *)

(** The errors; y, how fast the feature moves; n, the feature that is used less the feature now; and what
    the rotors lag behind, of the lever (two components) and of the thrust. *)
Record moment := Moment { err : errors; moving : vec; stale : vec; behind_x : R; behind_y : R; sinking : R }.
Definition mu (x : moment) : vec := V (behind_x x) (behind_y x) 0.
Definition lift (x : moment) : vec := V 0 0 (sinking x).
Definition twist (x : moment) : vec := (d4 (err x) - flat (d3 (err x)))%vec.          (** ζ *)
Definition strain (x : moment) : vec := (d3 (err x) - d2 (err x))%vec.

(** κ (1/s), K4 = κ + k4/m (1/s), k1 k2/m (1/s), k1/m; w2, w3, w4, a5, a6 of the Lyapunov function; the rate r
    (1/s); and of its memory, M T and M e^(-rT)/T or less, T the latency (s): zero and any number without. *)
Record constants (A : Type) := Constants {
  kap : A; stiff : A; k12 : A; speed : A; v2 : A; v3 : A; v4 : A; a5 : A; a6 : A;
  pace : A; spent : A; regained : A }.
Arguments kap {A}. Arguments stiff {A}. Arguments k12 {A}. Arguments speed {A}. Arguments v2 {A}.
Arguments v3 {A}. Arguments v4 {A}. Arguments a5 {A}. Arguments a6 {A}. Arguments pace {A}.
Arguments spent {A}. Arguments regained {A}. Arguments Constants {A}.

(** The parameters of a vehicle at a moment: χ, true lever over the lever that is known; s3* h, where the goal
    is in the image; ς, how much of a commanded change of thrust there is; τ, the lag of the rotors (s); π. *)
Record corner (A : Type) := Corner { chi : A; drag : A; gain : A; tau : A; pi : A }.
Arguments chi {A}. Arguments drag {A}. Arguments gain {A}. Arguments tau {A}. Arguments pi {A}.
Arguments Corner {A}.

(** The rates of the errors but for what is known by bounds alone; terms in Ω × δ left out, as they do nothing
    in what follows. And τ times those of what the rotors lag behind. *)
Definition go1 (p : corner R) (x : moment) : vec := (drag p * twist x - moving x)%vec.
Definition go2 (k : constants R) (p : corner R) (x : moment) : vec :=
  (moving x + k12 k * strain x - drag p * twist x)%vec.
Definition go3 (k : constants R) (p : corner R) (x : moment) : vec :=
  (moving x + k12 k * strain x + (kap k * chi p) * twist x
   - gain p * (kap k * up (d3 (err x)) + lift x))%vec.
Definition asked (k : constants R) (x : moment) : vec :=
  (mu x - stiff k * d4 (err x) - k12 k * flat (strain x))%vec.
Definition go4 (k : constants R) (p : corner R) (x : moment) : vec :=
  (flat (moving x + k12 k * strain x)
   + (kap k * chi p + (gain p - 1) * pi p / 2 + pi p) * twist x + asked k x)%vec.
Definition lag_turn (k : constants R) (p : corner R) (x : moment) : vec :=
  (stiff k * flat (stale x) - pi p * twist x - mu x
   + tau p * (stiff k * go4 k p x + (k12 k * (kap k * chi p + drag p)) * twist x))%vec.
Definition lag_lift (k : constants R) (p : corner R) (x : moment) : vec :=
  ((-1) * (kap k * up (stale x) + lift x + (tau p * kap k) * up (go3 k p x)))%vec.

(** What is known by bounds alone is uᵀ g, |g| <= R |v|, for eight pairs u, v. *)
Definition ahead (k : constants R) (p : corner R) (x : moment) : vec :=
  ((tau p * (stiff k * a5 k)) * mu x)%vec.
Definition lefts (k : constants R) (p : corner R) (x : moment) : list vec :=
  [ v4 k * d4 (err x) + ahead k p x; v4 k * d4 (err x) + ahead k p x; v4 k * twist x + ahead k p x;
    a5 k * mu x; a5 k * mu x; a5 k * mu x; a6 k * lift x; a5 k * mu x ]%vec.
Definition rights (k : constants R) (x : moment) : list vec :=
  [ asked k x; twist x; flat (d3 (err x)); twist x; flat (d3 (err x) - stale x); flat (strain x); twist x;
    asked k x ]%vec.
Fixpoint sum (us gs : list vec) : R :=
  match us, gs with u :: us, g :: gs => u · g + sum us gs | _, _ => 0 end.
Fixpoint bounded (radii : list R) (gs vs : list vec) : Prop :=
  match radii, gs, vs with
  | [], [], [] => True
  | r :: radii, g :: gs, v :: vs => 0 <= r /\ g · g <= r * r * (v · v) /\ bounded radii gs vs
  | _, _, _ => False
  end.

(** E = ½ (|δ1|² + w2|δ2|² + w3|δ3|² + w4|δ4|² + τ (a5|μ|² + a6 μT²)) and its derivative. *)
Definition energy (k : constants R) (p : corner R) (x : moment) : R :=
  (d1 (err x) · d1 (err x) + v2 k * (d2 (err x) · d2 (err x)) + v3 k * (d3 (err x) · d3 (err x))
   + v4 k * (d4 (err x) · d4 (err x)) + tau p * (a5 k * (mu x · mu x) + a6 k * (lift x · lift x))) / 2.
Definition energy' (k : constants R) (p : corner R) (x : moment) (gs : list vec) : R :=
  d1 (err x) · go1 p x + v2 k * (d2 (err x) · go2 k p x) + v3 k * (d3 (err x) · go3 k p x)
  + v4 k * (d4 (err x) · go4 k p x) + a5 k * (mu x · lag_turn k p x) + a6 k * (lift x · lag_lift k p x)
  + sum (lefts k p x) gs.

(** How much faster than at its rate the function falls, memory and all:
    -E' - r E - M T|y|² + (M e^(-rT)/T)|n|². *)
Definition surplus (k : constants R) (p : corner R) (x : moment) (gs : list vec) : R :=
  - energy' k p x gs - pace k * energy k p x
  - spent k * (moving x · moving x) + regained k * (stale x · stale x).

(** y = J V of a J within rho of j I, V = (k1/m) (δ1 + δ2). *)
Definition velocity (k : constants R) (x : moment) : vec := (speed k * flow (err x))%vec.
Definition in_ball (j rho : R) (k : constants R) (x : moment) : Prop :=
  (moving x - j * velocity k x)%vec · (moving x - j * velocity k x)
  <= rho * rho * (velocity k x · velocity k x).

(** ** What it loses where it is bounded *)

(** For any t > 0 and s >= 1/t. *)
Definition taken (t s r : R) (u v : vec) : R := r / 2 * (t * (v · v) + s * (u · u)).
Fixpoint all_taken (ts : list (R * R)) (radii : list R) (us vs : list vec) : R :=
  match ts, radii, us, vs with
  | (t, s) :: ts, r :: radii, u :: us, v :: vs => taken t s r u v + all_taken ts radii us vs
  | _, _, _, _ => 0
  end.
Definition priced (p : R * R) : Prop := 0 < fst p /\ 1 <= fst p * snd p.

Lemma at_most : forall t s r u v g, priced (t, s) -> 0 <= r -> g · g <= r * r * (v · v) ->
  u · g <= taken t s r u v.
Proof.
  intros t s r u v g [T TS] R G. cbn [fst snd] in T, TS. unfold taken.
  assert (I : / t <= s).
  { apply Rmult_le_reg_l with t; [exact T|]. rewrite Rinv_r by lra. exact TS. }
  pose proof (square_pos u) as U.
  assert (B0 : r / 2 * (t * (v · v) + / t * (u · u)) <= r / 2 * (t * (v · v) + s * (u · u))).
  { apply Rmult_le_compat_l; [lra|]. pose proof (Rmult_le_compat_r _ _ _ U I). lra. }
  eapply Rle_trans; [|exact B0]. clear B0 I TS.
  pose proof (square_pos (r * u - t * g)%vec) as S.
  replace ((r * u - t * g)%vec · (r * u - t * g)) with
    (r * r * (u · u) - 2 * r * t * (u · g) + t * t * (g · g)) in S by number.
  assert (B : t * t * (g · g) <= t * t * (r * r * (v · v))).
  { apply Rmult_le_compat_l; [|exact G]. left. apply Rmult_lt_0_compat; exact T. }
  destruct R as [R|R].
  - apply Rmult_le_reg_l with (2 * r * t); [apply Rmult_lt_0_compat; lra|].
    replace (2 * r * t * (r / 2 * (t * (v · v) + / t * (u · u)))) with
      (r * r * (u · u) + t * t * (r * r * (v · v))) by (field; lra). lra.
  - subst r. rewrite !Rmult_0_l in G.
    (* g is zero, as its square is *)
    assert (Z : g = zero).
    { destruct g as [a b c]. unfold dot in G. cbn [px py pz] in G.
      pose proof (Rle_0_sqr a) as X. pose proof (Rle_0_sqr b) as Y. pose proof (Rle_0_sqr c) as W.
      unfold Rsqr in *. apply vec_eq; cbn [px py pz zero]; apply Rsqr_0_uniq; unfold Rsqr; lra. }
    rewrite Z, dot_zero. right. field. lra.
Qed.

Lemma sum_taken : forall ts radii us vs gs,
  Forall priced ts -> length ts = length us -> bounded radii gs vs ->
  length us = length vs -> sum us gs <= all_taken ts radii us vs.
Proof.
  induction ts as [|[t s] ts IH]; intros [|r radii] [|u us] [|v vs] [|g gs] P L B M; simpl in *;
    try discriminate; try contradiction; try lra.
  destruct B as [R [G B]]. inversion P as [|? ? P1 P2]. subst.
  pose proof (at_most t s r u v g P1 R G). pose proof (IH radii us vs gs P2 ltac:(congruence) B ltac:(congruence)).
  lra.
Qed.

(** ** It is affine in each parameter *)

Definition affine (f : R -> R) : Prop := exists a b, forall s, f s = a + b * s.
Definition vaffine (f : R -> vec) : Prop := exists a b, forall s, f s = (a + s * b)%vec.

Lemma affine_const : forall a, affine (fun _ => a).
Proof. intros. exists a, 0. intros. ring. Qed.
Lemma affine_id : affine (fun s => s).
Proof. exists 0, 1. intros. ring. Qed.
Lemma affine_plus : forall f g, affine f -> affine g -> affine (fun s => f s + g s).
Proof. intros f g [a [b F]] [c [d G]]. exists (a + c), (b + d). intros. rewrite F, G. ring. Qed.
Lemma affine_minus : forall f g, affine f -> affine g -> affine (fun s => f s - g s).
Proof. intros f g [a [b F]] [c [d G]]. exists (a - c), (b - d). intros. rewrite F, G. ring. Qed.
Lemma affine_opp : forall f, affine f -> affine (fun s => - f s).
Proof. intros f [a [b F]]. exists (- a), (- b). intros. rewrite F. ring. Qed.
Lemma affine_left : forall k f, affine f -> affine (fun s => k * f s).
Proof. intros k f [a [b F]]. exists (k * a), (k * b). intros. rewrite F. ring. Qed.
Lemma affine_right : forall k f, affine f -> affine (fun s => f s * k).
Proof. intros k f [a [b F]]. exists (a * k), (b * k). intros. rewrite F. ring. Qed.
Lemma affine_over : forall k f, affine f -> affine (fun s => f s / k).
Proof. intros. apply (affine_right (/ k)). assumption. Qed.
Lemma affine_dot : forall u f, vaffine f -> affine (fun s => u · f s).
Proof. intros u f [a [b F]]. exists (u · a), (u · b). intros. rewrite F. number. Qed.
Lemma affine_dotted : forall u f, vaffine f -> affine (fun s => f s · u).
Proof. intros u f [a [b F]]. exists (a · u), (b · u). intros. rewrite F. number. Qed.
Lemma vaffine_const : forall a, vaffine (fun _ => a).
Proof. intros. exists a, zero. intros. vector. Qed.
Lemma vaffine_plus : forall f g, vaffine f -> vaffine g -> vaffine (fun s => (f s + g s)%vec).
Proof. intros f g [a [b F]] [c [d G]]. exists (a + c)%vec, (b + d)%vec. intros. rewrite F, G. vector. Qed.
Lemma vaffine_minus : forall f g, vaffine f -> vaffine g -> vaffine (fun s => (f s - g s)%vec).
Proof. intros f g [a [b F]] [c [d G]]. exists (a - c)%vec, (b - d)%vec. intros. rewrite F, G. vector. Qed.
Lemma vaffine_scale : forall k f, vaffine f -> vaffine (fun s => (k * f s)%vec).
Proof. intros k f [a [b F]]. exists (k * a)%vec, (k * b)%vec. intros. rewrite F. vector. Qed.
Lemma vaffine_times : forall f u, affine f -> vaffine (fun s => (f s * u)%vec).
Proof. intros f u [a [b F]]. exists (a * u)%vec, (b * u)%vec. intros. rewrite F. vector. Qed.
Lemma vaffine_flat : forall f, vaffine f -> vaffine (fun s => flat (f s)).
Proof. intros f [a [b F]]. exists (flat a), (flat b). intros. rewrite F. vector. Qed.
Lemma vaffine_up : forall f, vaffine f -> vaffine (fun s => up (f s)).
Proof. intros f [a [b F]]. exists (up a), (up b). intros. rewrite F. rewrite up_plus, up_scale. reflexivity. Qed.

Definition at_corner (k : constants R) (x : moment) (gs : list vec) (c d g t p : R) : R :=
  surplus k (Corner c d g t p) x gs.

(** Eight of them, so that the sum is a plain one. *)
Lemma eight : forall (gs : list vec), length gs = 8%nat -> exists a b c d e f g h, gs = [a; b; c; d; e; f; g; h].
Proof.
  intros gs L. do 8 (destruct gs as [|? gs]; [discriminate|]). destruct gs; [|discriminate].
  do 8 eexists. reflexivity.
Qed.

Ltac affine_step :=
  match goal with
  | |- affine (fun _ => ?a) => apply affine_const
  | |- vaffine (fun _ => ?a) => apply vaffine_const
  | |- affine (fun s => s) => apply affine_id
  | |- affine (fun s => @?f s + @?g s) => apply (affine_plus f g)
  | |- affine (fun s => @?f s - @?g s) => apply (affine_minus f g)
  | |- affine (fun s => - @?f s) => apply (affine_opp f)
  | |- affine (fun s => ?k * @?f s) => apply (affine_left k f)
  | |- affine (fun s => @?f s * ?k) => apply (affine_right k f)
  | |- affine (fun s => @?f s / ?k) => apply (affine_over k f)
  | |- affine (fun s => ?u · @?f s) => apply (affine_dot u f)
  | |- affine (fun s => @?f s · ?u) => apply (affine_dotted u f)
  | |- vaffine (fun s => (@?f s + @?g s)%vec) => apply (vaffine_plus f g)
  | |- vaffine (fun s => (@?f s - @?g s)%vec) => apply (vaffine_minus f g)
  | |- vaffine (fun s => (?k * @?f s)%vec) => apply (vaffine_scale k f)
  | |- vaffine (fun s => (@?f s * ?u)%vec) => apply (vaffine_times f u)
  | |- vaffine (fun s => flat (@?f s)) => apply (vaffine_flat f)
  | |- vaffine (fun s => up (@?f s)) => apply (vaffine_up f)
  end.
Ltac affine_in :=
  intros k x gs L; intros; destruct (eight gs L) as [g1 [g2 [g3 [g4 [g5 [g6 [g7 [g8 ->]]]]]]]];
  cbv beta iota zeta delta [at_corner surplus energy energy' go1 go2 go3 go4 asked lag_turn lag_lift ahead
    lefts sum chi drag gain tau pi];
  repeat affine_step.

Lemma affine_chi : forall k x gs, length gs = 8%nat -> forall d g t p,
  affine (fun s => at_corner k x gs s d g t p).
Proof. affine_in. Qed.
Lemma affine_drag : forall k x gs, length gs = 8%nat -> forall c g t p,
  affine (fun s => at_corner k x gs c s g t p).
Proof. affine_in. Qed.
Lemma affine_gain : forall k x gs, length gs = 8%nat -> forall c d t p,
  affine (fun s => at_corner k x gs c d s t p).
Proof. affine_in. Qed.
Lemma affine_tau : forall k x gs, length gs = 8%nat -> forall c d g p,
  affine (fun s => at_corner k x gs c d g s p).
Proof. affine_in. Qed.
Lemma affine_pi : forall k x gs, length gs = 8%nat -> forall c d g t,
  affine (fun s => at_corner k x gs c d g t s).
Proof. affine_in. Qed.

(** * The same with rationals, as forms in the twenty components of a moment *)

Definition axis (i : nat) : form := map (fun k => if (k =? i)%nat then 1%Q else 0%Q) (seq 0 20).
Definition none : form := map (fun _ => 0%Q) (seq 0 20).
Definition E1 := F (axis 0) (axis 1) (axis 2).
Definition E2 := F (axis 3) (axis 4) (axis 5).
Definition E3 := F (axis 6) (axis 7) (axis 8).
Definition E4 := F (axis 9) (axis 10) none.
Definition Y := F (axis 11) (axis 12) (axis 13).
Definition N := F (axis 14) (axis 15) (axis 16).
Definition MU := F (axis 17) (axis 18) none.
Definition LIFT := F none none (axis 19).

Definition parts (x : moment) : list R :=
  coordinates (err x) ++ [px (moving x); py (moving x); pz (moving x); px (stale x); py (stale x);
    pz (stale x); behind_x x; behind_y x; sinking x].
Definition is_of (u : forms) (x : moment) : vec :=
  V (value (fx u) (parts x)) (value (fy u) (parts x)) (value (fz u) (parts x)).
Definition ffl (u : forms) : forms := F (fx u) (fy u) none.
Definition fup (u : forms) : forms := F none none (fz u).

Lemma value_none : forall x, value none (parts x) = 0.
Proof. intros. cbn -[Q2R]. rewrite Q2R_zero. ring. Qed.
Ltac evaluated := intros [[[a b c] [d e f] [g h i] j k] [l m n] [o p q] r s t]; apply vec_eq; cbn -[Q2R];
  rewrite ?Q2R_one, ?Q2R_zero; ring.
Lemma is_E1 : forall x, is_of E1 x = d1 (err x). Proof. evaluated. Qed.
Lemma is_E2 : forall x, is_of E2 x = d2 (err x). Proof. evaluated. Qed.
Lemma is_E3 : forall x, is_of E3 x = d3 (err x). Proof. evaluated. Qed.
Lemma is_E4 : forall x, is_of E4 x = d4 (err x). Proof. evaluated. Qed.
Lemma is_Y : forall x, is_of Y x = moving x. Proof. evaluated. Qed.
Lemma is_N : forall x, is_of N x = stale x. Proof. evaluated. Qed.
Lemma is_MU : forall x, is_of MU x = mu x. Proof. evaluated. Qed.
Lemma is_LIFT : forall x, is_of LIFT x = lift x. Proof. evaluated. Qed.
Lemma is_plus : forall u v x, is_of (fplus u v) x = (is_of u x + is_of v x)%vec.
Proof. intros. apply vec_eq; apply add_correct. Qed.
Lemma is_scale : forall k u x, is_of (fscale k u) x = (Q2R k * is_of u x)%vec.
Proof. intros. apply vec_eq; apply scale_correct. Qed.
Lemma is_minus : forall u v x, is_of (fdiff u v) x = (is_of u x - is_of v x)%vec.
Proof.
  intros. unfold fdiff. rewrite is_plus, is_scale. unfold minus. do 2 f_equal. unfold Q2R. simpl. field.
Qed.
Lemma is_flat : forall u x, is_of (ffl u) x = flat (is_of u x).
Proof. intros. apply vec_eq; try reflexivity. apply value_none. Qed.
Lemma is_up : forall u x, is_of (fup u) x = up (is_of u x).
Proof. intros. apply vec_eq; try reflexivity; apply value_none. Qed.
Lemma total_dot : forall c u v x, total (fdot c u v) (parts x) = Q2R c * (is_of u x · is_of v x).
Proof. intros. unfold fdot, is_of, total, dot. cbn [fst snd px py pz]. ring. Qed.

Definition real_constants (k : constants Q) : constants R :=
  Constants (Q2R (kap k)) (Q2R (stiff k)) (Q2R (k12 k)) (Q2R (speed k)) (Q2R (v2 k)) (Q2R (v3 k)) (Q2R (v4 k))
    (Q2R (a5 k)) (Q2R (a6 k)) (Q2R (pace k)) (Q2R (spent k)) (Q2R (regained k)).
Definition real_corner (p : corner Q) : corner R :=
  Corner (Q2R (chi p)) (Q2R (drag p)) (Q2R (gain p)) (Q2R (tau p)) (Q2R (pi p)).

Definition ftwist : forms := fdiff E4 (ffl E3).
Definition fstrain : forms := fdiff E3 E2.
Definition fgo1 (p : corner Q) : forms := fdiff (fscale (drag p) ftwist) Y.
Definition fgo2 (k : constants Q) (p : corner Q) : forms :=
  fdiff (fplus Y (fscale (k12 k) fstrain)) (fscale (drag p) ftwist).
Definition fgo3 (k : constants Q) (p : corner Q) : forms :=
  fdiff (fplus (fplus Y (fscale (k12 k) fstrain)) (fscale (times (kap k) (chi p)) ftwist))
    (fscale (gain p) (fplus (fscale (kap k) (fup E3)) LIFT)).
Definition fasked (k : constants Q) : forms :=
  fdiff (fdiff MU (fscale (stiff k) E4)) (fscale (k12 k) (ffl fstrain)).
Definition turning (k : constants Q) (p : corner Q) : Q :=
  Forms.plus (Forms.plus (times (kap k) (chi p))
    (times (times (Forms.plus (gain p) (-1)) (pi p)) (1 # 2))) (pi p).
Definition fgo4 (k : constants Q) (p : corner Q) : forms :=
  fplus (fplus (ffl (fplus Y (fscale (k12 k) fstrain))) (fscale (turning k p) ftwist)) (fasked k).
Definition flag_turn (k : constants Q) (p : corner Q) : forms :=
  fplus (fdiff (fdiff (fscale (stiff k) (ffl N)) (fscale (pi p) ftwist)) MU)
    (fscale (tau p) (fplus (fscale (stiff k) (fgo4 k p))
      (fscale (times (k12 k) (Forms.plus (times (kap k) (chi p)) (drag p))) ftwist))).
Definition flag_lift (k : constants Q) (p : corner Q) : forms :=
  fscale (-1) (fplus (fplus (fscale (kap k) (fup N)) LIFT)
    (fscale (times (tau p) (kap k)) (fup (fgo3 k p)))).
Definition fahead (k : constants Q) (p : corner Q) : forms :=
  fscale (times (tau p) (times (stiff k) (a5 k))) MU.
Definition flefts (k : constants Q) (p : corner Q) : list forms :=
  [ fplus (fscale (v4 k) E4) (fahead k p); fplus (fscale (v4 k) E4) (fahead k p);
    fplus (fscale (v4 k) ftwist) (fahead k p); fscale (a5 k) MU; fscale (a5 k) MU; fscale (a5 k) MU;
    fscale (a6 k) LIFT; fscale (a5 k) MU ].
Definition frights (k : constants Q) : list forms :=
  [ fasked k; ftwist; ffl E3; ftwist; ffl (fdiff E3 N); ffl fstrain; ftwist; fasked k ].

Fixpoint ftaken (ts : list (Q * Q)) (radii : list Q) (us vs : list forms) : list term :=
  match ts, radii, us, vs with
  | (t, s) :: ts, r :: radii, u :: us, v :: vs =>
      let loss := times r (-1 # 2) in
      fdot (times loss t) v v ++ fdot (times loss s) u u ++ ftaken ts radii us vs
  | _, _, _, _ => []
  end.

(** The lower bound of [surplus], with a multiplier for the ball of J and one for each of the eight. *)
Definition lower (k : constants Q) (p : corner Q) (j rho slope : Q) (ts : list (Q * Q)) (radii : list Q) :
    list term :=
  let half := times (pace k) (-1 # 2) in
  let V := fscale (speed k) (fplus E1 E2) in
  let out := fdiff Y (fscale j V) in
  fdot (-1) E1 (fgo1 p) ++ fdot (Qopp (v2 k)) E2 (fgo2 k p) ++ fdot (Qopp (v3 k)) E3 (fgo3 k p)
  ++ fdot (Qopp (v4 k)) E4 (fgo4 k p) ++ fdot (Qopp (a5 k)) MU (flag_turn k p)
  ++ fdot (Qopp (a6 k)) LIFT (flag_lift k p)
  ++ fdot half E1 E1 ++ fdot (times half (v2 k)) E2 E2 ++ fdot (times half (v3 k)) E3 E3
  ++ fdot (times half (v4 k)) E4 E4 ++ fdot (times half (times (tau p) (a5 k))) MU MU
  ++ fdot (times half (times (tau p) (a6 k))) LIFT LIFT
  ++ fdot (Qopp (spent k)) Y Y ++ fdot (regained k) N N
  ++ fdot (Qopp (times slope (times rho rho))) V V ++ fdot slope out out
  ++ ftaken ts radii (flefts k p) (frights k).

Ltac is_it :=
  intros; repeat rewrite ?is_plus, ?is_minus, ?is_scale, ?is_flat, ?is_up, ?is_E1, ?is_E2, ?is_E3, ?is_E4, ?is_Y,
    ?is_N, ?is_MU, ?is_LIFT, ?times_correct, ?plus_correct.
Lemma is_twist : forall x, is_of ftwist x = twist x. Proof. unfold ftwist. is_it. reflexivity. Qed.
Lemma is_strain : forall x, is_of fstrain x = strain x. Proof. unfold fstrain. is_it. reflexivity. Qed.
Lemma is_go1 : forall p x, is_of (fgo1 p) x = go1 (real_corner p) x.
Proof. unfold fgo1. is_it. rewrite is_twist. reflexivity. Qed.
Lemma is_go2 : forall k p x, is_of (fgo2 k p) x = go2 (real_constants k) (real_corner p) x.
Proof. unfold fgo2. is_it. rewrite is_twist, is_strain. reflexivity. Qed.
Lemma is_go3 : forall k p x, is_of (fgo3 k p) x = go3 (real_constants k) (real_corner p) x.
Proof. unfold fgo3. is_it. rewrite is_twist, is_strain. reflexivity. Qed.
Lemma is_asked : forall k x, is_of (fasked k) x = asked (real_constants k) x.
Proof. unfold fasked. is_it. rewrite is_strain. reflexivity. Qed.
Lemma is_turning : forall k p, Q2R (turning k p) =
  let k := real_constants k in let p := real_corner p in kap k * chi p + (gain p - 1) * pi p / 2 + pi p.
Proof.
  intros. unfold turning. rewrite !plus_correct, !times_correct, plus_correct.
  replace (Q2R (-1)) with (-1) by (unfold Q2R; simpl; field).
  replace (Q2R (1 # 2)) with (/ 2) by (unfold Q2R; simpl; field). reflexivity.
Qed.
Lemma is_go4 : forall k p x, is_of (fgo4 k p) x = go4 (real_constants k) (real_corner p) x.
Proof. unfold fgo4. is_it. rewrite is_twist, is_strain, is_asked, is_turning. reflexivity. Qed.
Lemma is_lag_turn : forall k p x, is_of (flag_turn k p) x = lag_turn (real_constants k) (real_corner p) x.
Proof. unfold flag_turn. is_it. rewrite is_twist, is_go4. reflexivity. Qed.
Lemma is_lag_lift : forall k p x, is_of (flag_lift k p) x = lag_lift (real_constants k) (real_corner p) x.
Proof.
  unfold flag_lift. is_it. rewrite is_go3. replace (Q2R (-1)) with (-1) by (unfold Q2R; simpl; field).
  reflexivity.
Qed.
Lemma is_lefts : forall k p x,
  map (fun u => is_of u x) (flefts k p) = lefts (real_constants k) (real_corner p) x.
Proof. intros. unfold flefts, fahead. cbn [map]. is_it. rewrite is_twist. reflexivity. Qed.
Lemma is_rights : forall k x, map (fun u => is_of u x) (frights k) = rights (real_constants k) x.
Proof. intros. unfold frights. cbn [map]. is_it. rewrite is_twist, is_strain, is_asked. reflexivity. Qed.

Definition real_price (p : Q * Q) : R * R := (Q2R (fst p), Q2R (snd p)).
Lemma total_taken : forall ts radii us vs x,
  total (ftaken ts radii us vs) (parts x) =
  - all_taken (map real_price ts) (map Q2R radii) (map (fun u => is_of u x) us) (map (fun v => is_of v x) vs).
Proof.
  induction ts as [|[t s] ts IH]; intros radii us vs x; [cbn; ring|].
  destruct radii as [|r radii]; [cbn; ring|]. destruct us as [|u us]; [cbn; ring|].
  destruct vs as [|v vs]; [cbn; ring|].
  cbn [ftaken map all_taken real_price fst snd]. rewrite !total_app, !total_dot, IH.
  rewrite !times_correct.
  replace (Q2R (-1 # 2)) with (- / 2) by (unfold Q2R; simpl; field). unfold taken. field.
Qed.

Lemma total_lower : forall k p j rho slope ts radii x,
  let K := real_constants k in let P := real_corner p in
  total (lower k p j rho slope ts radii) (parts x) =
  surplus K P x [] - all_taken (map real_price ts) (map Q2R radii) (lefts K P x) (rights K x)
  - Q2R slope * (Q2R rho * Q2R rho * (velocity K x · velocity K x)
    - (moving x - Q2R j * velocity K x)%vec · (moving x - Q2R j * velocity K x)).
Proof.
  intros k p j rho slope ts radii x K P. unfold lower. cbv zeta.
  rewrite !total_app, total_taken, is_lefts, is_rights. fold K P.
  rewrite !total_dot, is_go1, is_go2, is_go3, is_go4, is_lag_turn, is_lag_lift. fold K P.
  repeat rewrite ?is_minus, ?is_plus, ?is_scale, ?is_E1, ?is_E2, ?is_E3, ?is_E4, ?is_Y, ?is_N, ?is_MU, ?is_LIFT,
    ?Q2R_opp, ?times_correct.
  replace (Q2R (-1)) with (-1) by (unfold Q2R; simpl; field).
  replace (Q2R (-1 # 2)) with (- / 2) by (unfold Q2R; simpl; field).
  change (Q2R (speed k) * (d1 (err x) + d2 (err x)))%vec with (velocity K x).
  unfold surplus, energy', energy. replace (sum (lefts K P x) []) with 0 by reflexivity.
  change (Q2R (tau p)) with (tau P). change (Q2R (pace k)) with (pace K).
  change (Q2R (v2 k)) with (v2 K). change (Q2R (v3 k)) with (v3 K). change (Q2R (v4 k)) with (v4 K).
  change (Q2R (a5 k)) with (a5 K). change (Q2R (a6 k)) with (a6 K).
  change (Q2R (spent k)) with (spent K). change (Q2R (regained k)) with (regained K).
  unfold Rdiv. ring.
Qed.

(** * The decision *)

(** The constants; the ball of J, as j - rho and j + rho; its multiplier and those of the eight, t and at least
    1/t; the radii R of these; the ends of χ, s3* h, ς and π, and of τ, which begins at 0; a hint for the matrix at each corner. *)
Record matrices := Matrices {
  its_constants : constants Q; ball_low : Q; ball_high : Q; ball_price : Q; prices : list (Q * Q); radii_of : list Q;
  chis : Q * Q; drags : Q * Q; gains_of : Q * Q; lag_most : Q; pi_most : Q; hints_of : list hint }.

Definition ends_of (i : Q * Q) : list Q := ends (fst i) (snd i).
Definition corners_of (c : matrices) : list (corner Q) :=
  flat_map (fun a => flat_map (fun b => flat_map (fun g => flat_map (fun t => map (fun p => Corner a b g t p)
    (ends (Qopp (pi_most c)) (pi_most c))) (ends 0 (lag_most c))) (ends_of (gains_of c))) (ends_of (drags c)))
    (ends_of (chis c)).

Definition middle (c : matrices) : Q := Qred ((ball_low c + ball_high c) * (1 # 2)).
Definition reach (c : matrices) : Q := Qred ((ball_high c - ball_low c) * (1 # 2)).
Definition lower_at (c : matrices) (p : corner Q) : list term :=
  lower (its_constants c) p (middle c) (reach c) (ball_price c) (prices c) (radii_of c).

Fixpoint shown (c : matrices) (ps : list (corner Q)) (hs : list hint) : bool :=
  match ps, hs with
  | [], [] => true
  | p :: ps, h :: hs => positive 20 h (lower_at c p) && shown c ps hs
  | _, _ => false
  end.

Definition price_ok (p : Q * Q) : bool := above 0 (fst p) && Qle_bool 1 (fst p * snd p).
Definition matrices_ok (c : matrices) : bool :=
  above 0 (ball_price c) && forallb price_ok (prices c) && (length (prices c) =? 8)%nat
  && shown c (corners_of c) (hints_of c).

Lemma shown_sound : forall c ps hs, shown c ps hs = true -> forall p, In p ps ->
  exists h, positive 20 h (lower_at c p) = true.
Proof.
  intros c. induction ps as [|p ps IH]; intros [|h hs] S q I; cbn [shown] in S; try discriminate;
    [destruct I|]. apply andb_prop in S. destruct S as [S1 S2].
  destruct I as [<-|I]; [exists h; exact S1|exact (IH hs S2 q I)].
Qed.

Lemma without_parameters : forall k p x gs, surplus k p x gs = surplus k p x [] - sum (lefts k p x) gs.
Proof. intros. unfold surplus, energy'. replace (sum (lefts k p x) []) with 0 by reflexivity. ring. Qed.

Lemma bounded_length : forall radii gs vs, bounded radii gs vs -> length gs = length vs.
Proof.
  induction radii as [|r radii IH]; intros [|g gs] [|v vs] B; simpl in *; try contradiction; [reflexivity|].
  f_equal. apply IH. apply B.
Qed.

(** At a corner. *)
Lemma corner_sound : forall c p x gs, matrices_ok c = true -> In p (corners_of c) ->
  let K := real_constants (its_constants c) in
  in_ball (Q2R (middle c)) (Q2R (reach c)) K x -> bounded (map Q2R (radii_of c)) gs (rights K x) ->
  nonzero (parts x) -> 0 < surplus K (real_corner p) x gs.
Proof.
  intros c p x gs O I K J B Z. unfold matrices_ok in O.
  repeat (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  apply above_correct in O. rewrite Q2R_zero in O. apply Nat.eqb_eq in O1.
  assert (T : Forall priced (map real_price (prices c))).
  { apply Forall_forall. intros t In. apply in_map_iff in In. destruct In as [q [<- In]].
    rewrite forallb_forall in O2. specialize (O2 q In). apply andb_prop in O2. destruct O2 as [P1 P2].
    apply above_correct in P1. rewrite Q2R_zero in P1. apply Qle_bool_iff, Qle_Rle in P2.
    rewrite Q2R_one, Q2R_mult in P2. split; assumption. }
  destruct (shown_sound c _ _ O0 p I) as [h P].
  pose proof (positive_sound _ _ _ (parts x) P eq_refl Z) as S.
  unfold lower_at in S. rewrite total_lower in S. fold K in S.
  rewrite without_parameters.
  assert (A : sum (lefts K (real_corner p) x) gs
    <= all_taken (map real_price (prices c)) (map Q2R (radii_of c)) (lefts K (real_corner p) x) (rights K x)).
  { apply sum_taken; [exact T| |exact B|reflexivity]. rewrite map_length, O1. reflexivity. }
  unfold in_ball in J.
  assert (0 <= Q2R (ball_price c) * (Q2R (reach c) * Q2R (reach c) * (velocity K x · velocity K x)
    - (moving x - Q2R (middle c) * velocity K x)%vec · (moving x - Q2R (middle c) * velocity K x)))
    by (apply Rmult_le_pos; lra).
  lra.
Qed.

(** For every vehicle with its parameters between the ends, all J of the ball and all that is known by bounds
    alone: the function falls faster than at its rate, at every moment that is not zero. *)
Theorem matrices_sound : forall c, matrices_ok c = true ->
  forall x gs chi drag gain tau pi,
  let K := real_constants (its_constants c) in
  in_ball (Q2R (middle c)) (Q2R (reach c)) K x -> bounded (map Q2R (radii_of c)) gs (rights K x) ->
  within (fst (chis c)) (snd (chis c)) chi -> within (fst (drags c)) (snd (drags c)) drag ->
  within (fst (gains_of c)) (snd (gains_of c)) gain -> within 0 (lag_most c) tau ->
  within (Qopp (pi_most c)) (pi_most c) pi -> nonzero (parts x) ->
  0 < surplus K (Corner chi drag gain tau pi) x gs.
Proof.
  intros c O x gs a b g t p K J B A1 A2 A3 A4 A5 Z.
  assert (L : length gs = 8%nat) by (rewrite (bounded_length _ _ _ B); reflexivity).
  assert (C : forall p', In p' (corners_of c) -> 0 < at_corner K x gs (Q2R (chi p')) (Q2R (drag p'))
    (Q2R (gain p')) (Q2R (tau p')) (Q2R (pi p'))).
  { intros p' I. exact (corner_sound c p' x gs O I J B Z). }
  change (0 < at_corner K x gs a b g t p).
  refine (ends_sound _ _ (fun s => at_corner K x gs s b g t p) (affine_chi K x gs L b g t p) _ a A1).
  intros a' Ia.
  refine (ends_sound _ _ (fun s => at_corner K x gs (Q2R a') s g t p) (affine_drag K x gs L _ _ _ _) _ b A2).
  intros b' Ib.
  refine (ends_sound _ _ (fun s => at_corner K x gs (Q2R a') (Q2R b') s t p) (affine_gain K x gs L _ _ _ _) _ g A3).
  intros g' Ig.
  refine (ends_sound _ _ (fun s => at_corner K x gs (Q2R a') (Q2R b') (Q2R g') s p) (affine_tau K x gs L _ _ _ _) _ t A4).
  intros t' It.
  refine (ends_sound _ _ (fun s => at_corner K x gs (Q2R a') (Q2R b') (Q2R g') (Q2R t') s) (affine_pi K x gs L _ _ _ _) _ p A5).
  intros p' Ip.
  apply (C (Corner a' b' g' t' p')). unfold corners_of.
  apply in_flat_map. exists a'. split; [exact Ia|].
  apply in_flat_map. exists b'. split; [exact Ib|].
  apply in_flat_map. exists g'. split; [exact Ig|].
  apply in_flat_map. exists t'. split; [exact It|].
  apply in_map_iff. exists p'. split; [reflexivity|exact Ip].
Qed.
