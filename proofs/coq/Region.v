(** Theorem 3, its matrix step: the natural potential with the errors falls, for every Q with eigenvalues in
    [0, λ], all f and q3* between their ends and every tilt up to a bound, in whatever direction, if four matrices
    of rationals are positive definite. The direction is turned to that of x, about e3.

    That the ends follow from the level, that -(m/k1) Λ' is this form, and that the level is not left, is not
    claimed here. *)

Require Import QArith Qreals Reals List Bool Lra.
From Hoverproof Require Import Forms Space Loop Gains.
Import ListNotations.
Open Scope R_scope.

(** a2, a3, a4 of Λ = W + ½ (a2|δ2|² + a3|δ3|² + a4|δ4|²). *)
Record natural := Natural { na2 : R; na3 : R; na4 : R }.

(** η = (q3* c/(m g)) (P - e3 θᵀ)(δ3 - δ2), v = e + η + δ2, u = -(a2 δ2 + a3 δ3 + a4 δ4). In [errors], e stands in the
    place of δ1. *)
Definition eta (g : loop) (grav q3 : R) (th : vec) (x : errors) : vec :=
  let s := (d3 x - d2 x)%vec in
  ((q3 * (stiffness g / (mass g * grav))) * (flat s - (th · s) * e3))%vec.
Definition way (g : loop) (grav q3 : R) (th : vec) (x : errors) : vec := (d1 x + eta g grav q3 th x + d2 x)%vec.
Definition against (a : natural) (x : errors) : vec := (-1 * (na2 a * d2 x + na3 a * d3 x + na4 a * d4 x))%vec.

(** -(m/k1) Λ', but for uᵀ Q v; and all of it. *)
Definition rest (g : loop) (grav : R) (a : natural) (f q3 : R) (th : vec) (x : errors) : R :=
  let k := (k1 g * k2 g + k3 g) / k1 g in
  d1 x · way g grav q3 th x
  + na2 a * (k2 g * (d2 x · (d2 x - d3 x)%vec) + f * q3 * (d2 x · flat (d4 x - d3 x)%vec))
  + na3 a * (d3 x · (k2 g * d2 x - k * d4 x + (k3 g / k1 g) * d3 x)%vec)
  + na4 a * (d4 x · (k * d3 x + (k4 g / k1 g) * d4 x)%vec).
Definition dissipation (g : loop) (grav : R) (a : natural) (f q3 : R) (th : vec) (J : vec -> vec) (x : errors) : R :=
  rest g grav a f q3 th x + against a x · J (way g grav q3 th x).
Definition all_squares (x : errors) : R := d1 x · d1 x + d2 x · d2 x + d3 x · d3 x + d4 x · d4 x.

(** * It turns with all in it *)

Definition spin (c s : R) (u : vec) : vec := V (c * px u - s * py u) (s * px u + c * py u) (pz u).
Definition spun (c s : R) (x : errors) : errors :=
  Errors (spin c s (d1 x)) (spin c s (d2 x)) (spin c s (d3 x)) (px (spin c s (d4 x))) (py (spin c s (d4 x))).
Definition spun_map (c s : R) (J : vec -> vec) (u : vec) : vec := spin c s (J (spin c (- s) u)).

Ltac components ::= unfold minus, dot; cbn [plus scale cross flat zero e3 px py pz spin].
Lemma spin_plus : forall c s u v, spin c s (u + v)%vec = (spin c s u + spin c s v)%vec. Proof. vector. Qed.
Lemma spin_scale : forall c s k u, spin c s (k * u)%vec = (k * spin c s u)%vec. Proof. vector. Qed.
Lemma spin_minus : forall c s u v, spin c s (u - v)%vec = (spin c s u - spin c s v)%vec. Proof. vector. Qed.
Lemma spin_flat : forall c s u, spin c s (flat u) = flat (spin c s u). Proof. vector. Qed.
Lemma spin_up : forall c s, spin c s e3 = e3. Proof. vector. Qed.
Lemma spin_dot : forall c s u v, c * c + s * s = 1 -> spin c s u · spin c s v = u · v.
Proof.
  intros c s u v H. replace (spin c s u · spin c s v)
    with ((c * c + s * s) * (px u * px v + py u * py v) + pz u * pz v) by number. rewrite H. number.
Qed.
Lemma spin_back : forall c s u, c * c + s * s = 1 -> spin c (- s) (spin c s u) = u.
Proof.
  intros c s u H. apply vec_eq; components;
    [transitivity ((c * c + s * s) * px u)|transitivity ((c * c + s * s) * py u)|]; try ring; rewrite H; ring.
Qed.
Lemma spin_forth : forall c s u, c * c + s * s = 1 -> spin c s (spin c (- s) u) = u.
Proof. intros c s u H. rewrite <- (spin_back c (- s) u) at 2 by lra. rewrite Ropp_involutive. reflexivity. Qed.
Lemma spun_d4 : forall c s x, d4 (spun c s x) = spin c s (d4 x).
Proof. intros. unfold spun, d4 at 1. cbn [d4x d4y]. apply vec_eq; reflexivity. Qed.

Lemma spin_aside : forall c s u v, c * c + s * s = 1 -> spin c s u · v = u · spin c (- s) v.
Proof. intros c s u v H. rewrite <- (spin_forth c s v H) at 1. apply spin_dot, H. Qed.
Lemma spun_between : forall c s a b J, c * c + s * s = 1 -> between a b J -> between a b (spun_map c s J).
Proof.
  intros c s a b J H [[A S] [Y B]]. unfold spun_map. split; [split|split].
  - intros. rewrite spin_plus, A, spin_plus. reflexivity.
  - intros. rewrite spin_scale, S, spin_scale. reflexivity.
  - intros u v. rewrite (spin_aside c s _ v H), <- Y.
    rewrite <- (spin_forth c s u H) at 1. apply spin_dot, H.
  - intros v. specialize (B (spin c (- s) v)).
    replace (v · spin c s (J (spin c (- s) v))) with (spin c (- s) v · J (spin c (- s) v))
      by (rewrite <- (spin_forth c s v H) at 3; symmetry; apply spin_dot, H).
    rewrite (spin_dot c (- s) v v) in B by lra. exact B.
Qed.

Lemma way_turns : forall g grav q3 th c s x, c * c + s * s = 1 ->
  way g grav q3 (spin c s th) (spun c s x) = spin c s (way g grav q3 th x).
Proof.
  intros g grav q3 th c s x H. unfold way, eta. cbn [spun d1 d2 d3].
  rewrite <- spin_minus, spin_dot by exact H.
  rewrite !spin_plus, spin_scale. set (y := (d3 x - d2 x)%vec). clearbody y. generalize (th · y). intros.
  rewrite spin_minus, spin_scale, spin_up, spin_flat. reflexivity.
Qed.
Lemma dissipation_turns : forall g grav a f q3 th J c s x, c * c + s * s = 1 ->
  dissipation g grav a f q3 (spin c s th) (spun_map c s J) (spun c s x) = dissipation g grav a f q3 th J x.
Proof.
  intros g grav a f q3 th J c s x H. unfold dissipation, rest. rewrite way_turns by exact H.
  unfold against, spun_map. rewrite spun_d4, spin_back by exact H. cbn [spun d1 d2 d3].
  repeat rewrite <- ?spin_scale, <- ?spin_minus, <- ?spin_plus, <- ?spin_flat. rewrite !spin_dot by exact H. reflexivity.
Qed.

(** * At a corner *)

Record region := Region {
  r_mass : Q; r_k1 : Q; r_k2 : Q; r_k3 : Q; r_k4 : Q; r_grav : Q; r_a2 : Q; r_a3 : Q; r_a4 : Q;
  r_high : Q; r_rate : Q; r_tilt : Q; r_f : Q * Q; r_q3 : Q * Q; r_tau : Q * Q; r_hints : hint * hint }.
Definition loop_in (c : region) : loop :=
  Loop (Q2R (r_mass c)) (Q2R (r_k1 c)) (Q2R (r_k2 c)) (Q2R (r_k3 c)) (Q2R (r_k4 c)).
Definition natural_in (c : region) : natural := Natural (Q2R (r_a2 c)) (Q2R (r_a3 c)) (Q2R (r_a4 c)).

Definition fway (c : region) (q3 : Q) : forms :=
  let lean := Qred (q3 * (r_k1 c * r_k1 c * r_k2 c / (r_mass c * (r_mass c * r_grav c)))) in
  let s := fscale lean (fdiff D3 D2) in
  fplus (fplus D1 (F (fx s) (fy s) (Forms.scale (Qopp (r_tilt c)) (fx s)))) D2.
Definition fagainst (c : region) : forms :=
  fscale (-1) (fplus (fplus (fscale (r_a2 c) D2) (fscale (r_a3 c) D3)) (fscale (r_a4 c) D4)).
Definition lower (c : region) (f q3 tau : Q) : list term :=
  let k := Qred ((r_k1 c * r_k2 c + r_k3 c) / r_k1 c) in
  let v := fway c q3 in let u := fagainst c in
  let loss := Qred (r_high c * (-1 # 4)) in
  fdot 1 D1 v ++ fdot (Qred (r_high c * (1 # 2))) u v ++ fdot (times loss tau) v v ++ fdot (times loss (Qinv tau)) u u
  ++ fdot (times (r_a2 c) (r_k2 c)) D2 (fdiff D2 D3)
  ++ fdot (times (r_a2 c) (times f q3)) D2 (fflat (fdiff D4 D3))
  ++ fdot (r_a3 c) D3 (fplus (fdiff (fscale (r_k2 c) D2) (fscale k D4)) (fscale (Qred (r_k3 c / r_k1 c)) D3))
  ++ fdot (r_a4 c) D4 (fplus (fscale k D3) (fscale (Qred (r_k4 c / r_k1 c)) D4))
  ++ fdot (Qopp (r_rate c)) D1 D1 ++ fdot (Qopp (r_rate c)) D2 D2
  ++ fdot (Qopp (r_rate c)) D3 D3 ++ fdot (Qopp (r_rate c)) D4 D4.

Definition end_ok (c : region) (f tau : Q) (h : hint) : bool :=
  above 0 tau && forallb (fun q3 => positive 11 h (lower c f q3 tau)) (ends (fst (r_q3 c)) (snd (r_q3 c))).
Definition region_ok (c : region) : bool :=
  above 0 (r_mass c) && above 0 (r_k1 c) && above 0 (r_grav c) && above 0 (r_high c) && Qle_bool 0 (r_tilt c)
  && end_ok c (fst (r_f c)) (fst (r_tau c)) (fst (r_hints c))
  && end_ok c (snd (r_f c)) (snd (r_tau c)) (snd (r_hints c)).

Section Corner.
Variable c : region.
Hypothesis Pm : 0 < Q2R (r_mass c).
Hypothesis Pk : 0 < Q2R (r_k1 c).
Hypothesis Pg : 0 < Q2R (r_grav c).
Hypothesis Ph : 0 < Q2R (r_high c).
Local Notation g := (loop_in c).
Local Notation G := (Q2R (r_grav c)).
Local Notation th := (V (Q2R (r_tilt c)) 0 0).

Lemma inverse : forall q, 0 < Q2R q -> Q2R (/ q) = / Q2R q.
Proof. intros q P. apply Q2R_inv. intro X. apply Qeq_eqR in X. rewrite Q2R_zero in X. lra. Qed.
Lemma reduced : forall q, Q2R (Qred q) = Q2R q.
Proof. intros. apply Qeq_eqR, Qred_correct. Qed.

Lemma real_way : forall q3 x, real (fway c q3) x = way g G (Q2R q3) th x.
Proof.
  intros q3 x. unfold fway. cbv zeta.
  set (lean := Qred (q3 * (r_k1 c * r_k1 c * r_k2 c / (r_mass c * (r_mass c * r_grav c))))).
  assert (L : Q2R lean = Q2R q3 * (stiffness g / (mass g * G))).
  { unfold lean, Qdiv. rewrite reduced, !Q2R_mult, inverse.
    - unfold stiffness. cbn [loop_in mass k1 k2]. rewrite !Q2R_mult. field. lra.
    - rewrite !Q2R_mult. apply Rmult_lt_0_compat; [|apply Rmult_lt_0_compat]; assumption. }
  rewrite !real_plus, real_D1, real_D2. unfold way, eta. rewrite <- L. f_equal. f_equal.
  assert (S : real (fscale lean (fdiff D3 D2)) x = (Q2R lean * (d3 x - d2 x))%vec)
    by (rewrite real_scale, real_diff, real_D3, real_D2; reflexivity).
  set (s := fscale lean (fdiff D3 D2)) in *. clearbody s lean.
  pose proof (f_equal px S) as S1. pose proof (f_equal py S) as S2. cbn [real px py] in S1, S2.
  unfold real. cbn [fx fy fz]. rewrite scale_correct, Q2R_opp, S1, S2.
  generalize (d3 x - d2 x)%vec. intros. apply vec_eq; components; ring.
Qed.
Lemma real_against : forall x, real (fagainst c) x = against (natural_in c) x.
Proof.
  intros. unfold fagainst, against. rewrite real_scale, !real_plus, !real_scale, real_D2, real_D3, real_D4.
  replace (Q2R (-1)) with (-1) by (unfold Q2R; simpl; field). reflexivity.
Qed.

Lemma at_end : forall f tau h q3 J x, end_ok c f tau h = true -> In q3 (ends (fst (r_q3 c)) (snd (r_q3 c))) ->
  between 0 (Q2R (r_high c)) J -> some_error x ->
  Q2R (r_rate c) * all_squares x < dissipation g G (natural_in c) (Q2R f) (Q2R q3) th J x.
Proof.
  intros f tau h q3 J x O I B N. unfold end_ok in O. apply andb_prop in O. destruct O as [T O].
  apply above_correct in T. rewrite Q2R_zero in T. rewrite forallb_forall in O. specialize (O q3 I).
  pose proof (positive_sound _ _ _ (coordinates x) O eq_refl N) as P.
  assert (H4 : Q2R (-1 # 4) = - / 4) by (unfold Q2R; simpl; field).
  assert (H2 : Q2R (1 # 2) = / 2) by (unfold Q2R; simpl; field).
  unfold lower in P. cbv zeta in P. rewrite !total_app, !total_fdot in P.
  repeat rewrite ?real_way, ?real_against, ?real_plus, ?real_diff, ?real_scale, ?real_flat, ?real_D1, ?real_D2,
    ?real_D3, ?real_D4, ?times_correct, ?Q2R_opp, ?reduced, ?Q2R_mult, ?H4, ?H2, ?Q2R_one in P.
  rewrite (inverse tau T) in P.
  assert (E : forall a, Q2R (a / r_k1 c) = Q2R a / k1 g).
  { intros. unfold Qdiv. rewrite Q2R_mult, (inverse _ Pk). reflexivity. }
  rewrite !E, Q2R_plus, Q2R_mult in P.
  pose proof (between_slack 0 (Q2R (r_high c)) J B (against (natural_in c) x) (way g G (Q2R q3) th x) (Q2R tau) T) as S.
  unfold dissipation, rest, all_squares. cbn [loop_in natural_in k1 k2 k3 k4 na2 na3 na4] in *.
  set (uv := against (natural_in c) x · way g G (Q2R q3) th x) in *.
  set (vv := way g G (Q2R q3) th x · way g G (Q2R q3) th x) in *.
  set (uu := against (natural_in c) x · against (natural_in c) x) in *.
  unfold Rdiv in *. lra.
Qed.
End Corner.

(** * All between *)

Lemma affine_f : forall g grav a q3 th J x, exists y z, forall f, dissipation g grav a f q3 th J x = y + z * f.
Proof.
  intros. exists (dissipation g grav a 0 q3 th J x), (na2 a * (q3 * (d2 x · flat (d4 x - d3 x)%vec))).
  intros f. unfold dissipation, rest. ring.
Qed.
Lemma way_q3 : forall g grav q3 th x, way g grav q3 th x
  = ((d1 x + d2 x) + q3 * eta g grav 1 th x)%vec.
Proof.
  intros. unfold way, eta. rewrite Rmult_1_l. generalize (stiffness g / (mass g * grav)) (flat (d3 x - d2 x) - (th · (d3 x - d2 x)%vec) * e3)%vec.
  vector.
Qed.
Lemma affine_q3 : forall g grav a f th J x, linear J ->
  exists y z, forall q3, dissipation g grav a f q3 th J x = y + z * q3.
Proof.
  intros g grav a f th J x [A S].
  exists (dissipation g grav a f 0 th J x), (d1 x · eta g grav 1 th x + na2 a * (f * (d2 x · flat (d4 x - d3 x)%vec))
    + against a x · J (eta g grav 1 th x)).
  intros q3. unfold dissipation, rest. rewrite !(way_q3 _ _ q3), !(way_q3 _ _ 0), !A, !S, !dot_plus, !dot_scale. ring.
Qed.
(** Along a line of tilts. *)
Lemma way_tilt : forall g grav q3 n s x, way g grav q3 (s * n)%vec x
  = (way g grav q3 zero x + s * ((- (q3 * (stiffness g / (mass g * grav))) * (n · (d3 x - d2 x)%vec)) * e3))%vec.
Proof.
  intros. unfold way, eta. generalize (stiffness g / (mass g * grav)) (d3 x - d2 x)%vec. vector.
Qed.
Lemma affine_tilt : forall g grav a f q3 n J x, linear J ->
  exists y z, forall s, dissipation g grav a f q3 (s * n)%vec J x = y + z * s.
Proof.
  intros g grav a f q3 n J x [A S].
  set (w := ((- (q3 * (stiffness g / (mass g * grav))) * (n · (d3 x - d2 x)%vec)) * e3)%vec).
  exists (dissipation g grav a f q3 zero J x), (d1 x · w + against a x · J w).
  intros s. unfold dissipation, rest. rewrite !way_tilt. fold w. rewrite !A, !S, !dot_plus, !dot_scale. ring.
Qed.

Lemma some_spun : forall k s x, k * k + s * s = 1 -> some_error x -> some_error (spun k s x).
Proof.
  intros k s x H N. destruct (zero_or_not (coordinates (spun k s x))) as [Y|Z]; [exact Y|]. exfalso.
  assert (Q : forall u, spin k s u = zero -> u = zero).
  { intros u E. rewrite <- (spin_back k s u H), E. vector. }
  assert (Zi : forall i y, nth_error (coordinates (spun k s x)) i = Some y -> y = 0).
  { intros i y E. apply Z, (nth_error_In _ i E). }
  assert (E1 : d1 x = zero) by (apply Q, vec_eq; [apply (Zi 0%nat)|apply (Zi 1%nat)|apply (Zi 2%nat)]; reflexivity).
  assert (E2 : d2 x = zero) by (apply Q, vec_eq; [apply (Zi 3%nat)|apply (Zi 4%nat)|apply (Zi 5%nat)]; reflexivity).
  assert (E3 : d3 x = zero) by (apply Q, vec_eq; [apply (Zi 6%nat)|apply (Zi 7%nat)|apply (Zi 8%nat)]; reflexivity).
  assert (E4 : d4 x = zero) by (apply Q, vec_eq; [apply (Zi 9%nat); reflexivity|apply (Zi 10%nat); reflexivity|reflexivity]).
  destruct N as [y [I Ny]]. apply Ny. clear - I E1 E2 E3 E4. destruct x as [[a b c] [d e f] [g h i] j l].
  unfold d4 in E4. cbn [d1 d2 d3 d4x d4y zero] in *. injection E1. injection E2. injection E3. injection E4.
  intros. subst. cbn in I.
  repeat (destruct I as [<-|I]; [reflexivity|]). destruct I.
Qed.

(** For a tilt of the bound, in any direction. *)
Lemma any_direction : forall c f tau h q3 J x n, 0 < Q2R (r_mass c) -> 0 < Q2R (r_k1 c) -> 0 < Q2R (r_grav c) ->
  end_ok c f tau h = true -> In q3 (ends (fst (r_q3 c)) (snd (r_q3 c))) ->
  between 0 (Q2R (r_high c)) J -> some_error x -> pz n = 0 -> n · n = 1 ->
  Q2R (r_rate c) * all_squares x
  < dissipation (loop_in c) (Q2R (r_grav c)) (natural_in c) (Q2R f) (Q2R q3) (Q2R (r_tilt c) * n)%vec J x.
Proof.
  intros c f tau h q3 J x n Pm Pk Pg O I B N Nz N1.
  (* turn n to (1, 0, 0) *)
  set (k := px n). set (s := - py n).
  assert (H : k * k + s * s = 1).
  { rewrite <- N1. destruct n as [a b d]. cbn [pz] in Nz. subst d. unfold k, s, dot. cbn [px py pz]. ring. }
  assert (E : spin k s (Q2R (r_tilt c) * n)%vec = V (Q2R (r_tilt c)) 0 0).
  { destruct n as [a b d]. cbn [pz] in Nz. subst d. unfold k, s in *. cbn [px py] in *.
    apply vec_eq; components; [transitivity (Q2R (r_tilt c) * (a * a + - b * - b)); [ring|rewrite H; ring]|ring|ring]. }
  rewrite <- (dissipation_turns _ _ _ _ _ _ J k s x H), E.
  replace (all_squares x) with (all_squares (spun k s x)).
  - apply (at_end c Pm Pk Pg f tau h q3); [exact O|exact I|apply spun_between; assumption|apply some_spun; assumption].
  - unfold all_squares. rewrite spun_d4. cbn [spun d1 d2 d3]. rewrite !spin_dot by exact H. reflexivity.
Qed.

(** ** Theorem 3, the matrix step *)
Theorem region_sound : forall c, region_ok c = true ->
  forall J f q3 th x, between 0 (Q2R (r_high c)) J -> within (fst (r_f c)) (snd (r_f c)) f ->
  within (fst (r_q3 c)) (snd (r_q3 c)) q3 -> pz th = 0 -> th · th <= Q2R (r_tilt c) * Q2R (r_tilt c) -> some_error x ->
  Q2R (r_rate c) * all_squares x < dissipation (loop_in c) (Q2R (r_grav c)) (natural_in c) f q3 th J x.
Proof.
  intros c O J f q3 th x B Wf Wq Tz T N. unfold region_ok in O.
  do 6 (apply andb_prop in O; let H := fresh "O" in destruct O as [O H]).
  apply above_correct in O, O5, O4. rewrite Q2R_zero in O, O5, O4.
  apply Qle_bool_iff, Qle_Rle in O2. rewrite Q2R_zero in O2. set (t := Q2R (r_tilt c)) in *.
  pose proof B as [Lin _].
  (* a direction of the tilt, and how much of it *)
  assert (D : exists n s, pz n = 0 /\ n · n = 1 /\ th = (s * n)%vec /\ - t <= s <= t).
  { set (l := sqrt (th · th)). assert (L : l * l = th · th) by (apply sqrt_sqrt, square_pos).
    assert (L0 : 0 <= l) by apply sqrt_pos.
    assert (Lt : l <= t).
    { destruct (Rle_or_lt l t) as [K|K]; [exact K|]. pose proof (Rmult_le_0_lt_compat t l t l O2 O2 K K). lra. }
    destruct L0 as [L0|L0].
    - exists (/ l * th)%vec, l. split; [components; rewrite Tz; ring|]. split; [|split; [|lra]].
      + replace ((/ l * th)%vec · (/ l * th)) with (/ l * / l * (th · th)) by number. rewrite <- L. field. lra.
      + rewrite scale_scale. replace (l * / l) with 1 by (field; lra). vector.
    - exists (V 1 0 0), 0. split; [reflexivity|]. split; [number|]. split; [|lra].
      assert (Z : th · th = 0) by (rewrite <- L, <- L0; ring).
      destruct th as [a b d]. cbn [pz] in Tz. subst d. unfold dot in Z. cbn [px py pz] in Z.
      pose proof (Rle_0_sqr a) as A1. pose proof (Rle_0_sqr b) as B1. unfold Rsqr in A1, B1.
      assert (a = 0) by (apply Rsqr_0_uniq; unfold Rsqr; lra). assert (b = 0) by (apply Rsqr_0_uniq; unfold Rsqr; lra).
      subst. vector. }
  destruct D as [n [s [Nz [N1 [-> S]]]]].
  set (ep := Q2R (r_rate c) * all_squares x).
  set (d := dissipation (loop_in c) (Q2R (r_grav c)) (natural_in c)).
  assert (Corner : forall f' q', In f' [fst (r_f c); snd (r_f c)] -> In q' (ends (fst (r_q3 c)) (snd (r_q3 c))) ->
    forall n', pz n' = 0 -> n' · n' = 1 -> ep < d (Q2R f') (Q2R q') (t * n')%vec J x).
  { intros f' q' If Iq n' Z1 Z2. destruct If as [<-|[<-|[]]].
    - exact (any_direction c _ _ _ q' J x n' O O5 O4 O1 Iq B N Z1 Z2).
    - exact (any_direction c _ _ _ q' J x n' O O5 O4 O0 Iq B N Z1 Z2). }
  assert (Tilt : forall f' q', In f' [fst (r_f c); snd (r_f c)] -> In q' (ends (fst (r_q3 c)) (snd (r_q3 c))) ->
    ep < d (Q2R f') (Q2R q') (s * n)%vec J x).
  { intros f' q' If Iq. destruct (affine_tilt (loop_in c) (Q2R (r_grav c)) (natural_in c) (Q2R f') (Q2R q') n J x Lin)
      as [y [z E]]. fold d in E.
    pose proof (Corner f' q' If Iq n Nz N1) as C1.
    pose proof (Corner f' q' If Iq (-1 * n)%vec ltac:(components; rewrite Nz; ring)
      ltac:(transitivity (n · n); [number|exact N1])) as C2.
    replace (t * (-1 * n))%vec with ((- t) * n)%vec in C2 by vector.
    rewrite E in C1, C2 |- *. assert (0 < (y - ep) + z * s); [|lra].
    apply (affine_between _ _ (- t) t); lra. }
  assert (Height : forall f', In f' [fst (r_f c); snd (r_f c)] -> ep < d (Q2R f') q3 (s * n)%vec J x).
  { intros f' If. destruct (affine_q3 (loop_in c) (Q2R (r_grav c)) (natural_in c) (Q2R f') (s * n)%vec J x Lin)
      as [y [z E]]. fold d in E.
    assert (0 < d (Q2R f') q3 (s * n)%vec J x - ep); [|lra].
    apply (ends_sound (fst (r_q3 c)) (snd (r_q3 c)) (fun q => d (Q2R f') q (s * n)%vec J x - ep)); [| |exact Wq].
    - exists (y - ep), z. intros. rewrite E. ring.
    - intros q' Iq. pose proof (Tilt f' q' If Iq). lra. }
  destruct (affine_f (loop_in c) (Q2R (r_grav c)) (natural_in c) q3 (s * n)%vec J x) as [y [z E]]. fold d in E.
  pose proof (Height (fst (r_f c)) ltac:(cbn; tauto)) as C1. pose proof (Height (snd (r_f c)) ltac:(cbn; tauto)) as C2.
  rewrite E in C1, C2 |- *. assert (0 < (y - ep) + z * f); [|lra].
  apply (affine_between _ _ (Q2R (fst (r_f c))) (Q2R (snd (r_f c)))); [exact Wf|lra|lra].
Qed.
