(** The wanted centroid q* of a goal by its height: an enclosure of what a level camera sees there.

    q* = Σ (P - ξ)/|P - ξ| holds square roots. Points at equal distance are added first, so that what
    cancels is exactly zero; then each root is enclosed between two rationals, which are tested by
    squaring. *)

Require Import QArith Qreals Reals List Bool Lra.
From Hoverproof Require Import Forms Space Image Gains.
Import ListNotations.
Open Scope R_scope.

Definition place := (Q * Q * Q)%type.
Definition real_place (p : place) : vec := let '(x, y, z) := p in V (Q2R x) (Q2R y) (Q2R z).

Definition minus_place (p q : place) : place :=
  let '(x, y, z) := p in let '(a, b, c) := q in (Qred (x - a), Qred (y - b), Qred (z - c))%Q.
Definition plus_place (p q : place) : place :=
  let '(x, y, z) := p in let '(a, b, c) := q in (Qred (x + a), Qred (y + b), Qred (z + c))%Q.
Definition square (p : place) : Q := let '(x, y, z) := p in Qred (x * x + y * y + z * z)%Q.

(** Sums of the rays of each length; a length is given by its square. *)
Definition groups := list (Q * place).

Fixpoint join (s : Q) (ray : place) (g : groups) : groups :=
  match g with
  | [] => [(s, ray)]
  | (t, sum) :: g => if Qeq_bool s t then (t, plus_place ray sum) :: g else (t, sum) :: join s ray g
  end.

Definition times_place (k : Q) (p : place) : place :=
  let '(x, y, z) := p in (Qred (k * x), Qred (k * y), Qred (k * z))%Q.

(** Points, and how much each counts. *)
Definition counted := list (Q * place).
Definition real_points (ps : counted) : points := map (fun p => (Q2R (fst p), real_place (snd p))) ps.

Fixpoint gather (ps : counted) (xi : place) : groups :=
  match ps with
  | [] => []
  | (k, p) :: ps =>
      let ray := minus_place p xi in join (square ray) (times_place k ray) (gather ps xi)
  end.

Definition seen_of (g : groups) : vec :=
  fold_right (fun part rest => (/ sqrt (Q2R (fst part)) * real_place (snd part) + rest)%vec) zero g.

Lemma red : forall a, Q2R (Qred a) = Q2R a.
Proof. intros. apply Qeq_eqR, Qred_correct. Qed.

Lemma join_correct : forall s ray g,
  seen_of (join s ray g) = (/ sqrt (Q2R s) * real_place ray + seen_of g)%vec.
Proof.
  intros s ray. induction g as [|[t sum] g IH]; [reflexivity|]. cbn [join].
  destruct (Qeq_bool s t) eqn:E; cbn [seen_of fold_right fst snd].
  - apply Qeq_bool_eq, Qeq_eqR in E. rewrite E. fold (seen_of g).
    destruct ray as [[a b] c], sum as [[x y] z]. cbn [plus_place real_place].
    rewrite !red, !Q2R_plus. vector.
  - fold (seen_of (join s ray g)). fold (seen_of g). rewrite IH. vector.
Qed.

(** A level camera, at no yaw. *)
Definition level : rotation := Rotation (V 1 0 0) (V 0 1 0) (V 0 0 1).

Lemma gather_correct : forall ps xi,
  centroid (real_points ps) level (real_place xi) = seen_of (gather ps xi).
Proof.
  intros ps xi. induction ps as [|[k p] ps IH]; [reflexivity|].
  cbn [real_points map centroid gather fst snd]. rewrite join_correct, <- IH.
  unfold ray, distance.
  assert (M : real_place (minus_place p xi) = (real_place p - real_place xi)%vec).
  { destruct p as [[a b] c], xi as [[x y] z]. cbn [minus_place real_place].
    rewrite !red, !Q2R_minus. vector. }
  assert (S : Q2R (square (minus_place p xi))
    = (real_place p - real_place xi)%vec · (real_place p - real_place xi)).
  { rewrite <- M. destruct (minus_place p xi) as [[a b] c]. cbn [square real_place].
    rewrite red, !Q2R_plus, !Q2R_mult. unfold dot. cbn [px py pz]. ring. }
  assert (K : real_place (times_place k (minus_place p xi))
    = (Q2R k * (real_place p - real_place xi))%vec).
  { rewrite <- M. destruct (minus_place p xi) as [[a b] c]. cbn [times_place real_place].
    rewrite !red, !Q2R_mult. vector. }
  rewrite S, K. fold (real_points ps). f_equal. unfold back, level. vector.
Qed.

(** * Enclosures *)

(** 1/√s lies between 1/high and 1/low. *)
Definition root_ok (s : Q) (root : Q * Q) : bool :=
  let (low, high) := root in
  above 0 low && Qle_bool (low * low) s && Qle_bool s (high * high) && Qle_bool 0 high.

Definition least (x : Q) (root : Q * Q) : Q :=
  let (low, high) := root in Qred (if Qle_bool 0 x then x / high else x / low)%Q.
Definition most (x : Q) (root : Q * Q) : Q :=
  let (low, high) := root in Qred (if Qle_bool 0 x then x / low else x / high)%Q.

Lemma root_sound : forall s low high x, root_ok s (low, high) = true ->
  Q2R (least x (low, high)) <= / sqrt (Q2R s) * Q2R x <= Q2R (most x (low, high)).
Proof.
  intros s low high x H. unfold root_ok in H.
  apply andb_prop in H. destruct H as [H N]. apply andb_prop in H. destruct H as [H U].
  apply andb_prop in H. destruct H as [P L].
  apply above_correct in P. rewrite Q2R_zero in P.
  apply Qle_bool_iff, Qle_Rle in L. apply Qle_bool_iff, Qle_Rle in U. rewrite Q2R_mult in L, U.
  apply Qle_bool_iff, Qle_Rle in N. rewrite Q2R_zero in N.
  set (a := Q2R low) in *. set (b := Q2R high) in *. set (r := sqrt (Q2R s)).
  assert (SP : 0 < Q2R s). { assert (0 < a * a) by (apply Rmult_lt_0_compat; assumption). lra. }
  assert (LR : a <= r). { unfold r. rewrite <- (sqrt_square a) by lra. apply sqrt_le_1_alt. exact L. }
  assert (UR : r <= b). { unfold r. rewrite <- (sqrt_square b) by lra. apply sqrt_le_1_alt. exact U. }
  assert (I1 : / b <= / r) by (apply Rinv_le_contravar; lra).
  assert (I2 : / r <= / a) by (apply Rinv_le_contravar; lra).
  assert (NL : ~ (low == 0)%Q) by (intro E; apply Qeq_eqR in E; rewrite Q2R_zero in E; fold a in E; lra).
  assert (NH : ~ (high == 0)%Q) by (intro E; apply Qeq_eqR in E; rewrite Q2R_zero in E; fold b in E; lra).
  unfold least, most. destruct (Qle_bool 0 x) eqn:X; rewrite !red, !Q2R_div by assumption; fold a b.
  - apply Qle_bool_iff, Qle_Rle in X. rewrite Q2R_zero in X. unfold Rdiv.
    pose proof (Rmult_le_compat_r _ _ _ X I1). pose proof (Rmult_le_compat_r _ _ _ X I2). lra.
  - assert (Y : Q2R x <= 0).
    { destruct (Rle_or_lt (Q2R x) 0) as [Y|Y]; [exact Y|]. exfalso.
      assert (Z : (0 <= x)%Q) by (apply Rle_Qle; rewrite Q2R_zero; lra).
      apply Qle_bool_iff in Z. congruence. }
    assert (Y' : 0 <= - Q2R x) by lra. unfold Rdiv.
    pose proof (Rmult_le_compat_r _ _ _ Y' I1). pose proof (Rmult_le_compat_r _ _ _ Y' I2). lra.
Qed.

(** The sums of the ends of the intervals, in one component. *)
Fixpoint enclosed (pick : place -> Q) (g : groups) (roots : list (Q * Q)) : option (Q * Q) :=
  match g, roots with
  | [], [] => Some (0, 0)%Q
  | (s, sum) :: g, root :: roots =>
      match enclosed pick g roots with
      | Some (low, high) =>
          if root_ok s root
          then Some (Qred (low + least (pick sum) root), Qred (high + most (pick sum) root))%Q
          else None
      | None => None
      end
  | _, _ => None
  end.

Lemma enclosed_sound : forall pick part g roots low high,
  (forall p, Q2R (pick p) = part (real_place p)) ->
  (forall u v, part (u + v)%vec = part u + part v) -> (forall k v, part (k * v)%vec = k * part v) ->
  part zero = 0 ->
  enclosed pick g roots = Some (low, high) -> Q2R low <= part (seen_of g) <= Q2R high.
Proof.
  intros pick part g. induction g as [|[s sum] g IH]; intros roots low high P A S Z H.
  - destruct roots; [|discriminate]. injection H as <- <-. cbn [seen_of fold_right].
    rewrite Z, Q2R_zero. lra.
  - destruct roots as [|root roots]; [discriminate|]. cbn [enclosed] in H.
    destruct (enclosed pick g roots) as [[l h]|] eqn:E; [|discriminate].
    destruct root as [a b]. destruct (root_ok s (a, b)) eqn:R; [|discriminate].
    assert (EL : low = Qred (l + least (pick sum) (a, b))%Q) by congruence.
    assert (EH : high = Qred (h + most (pick sum) (a, b))%Q) by congruence.
    clear H. specialize (IH roots l h P A S Z E).
    pose proof (root_sound s a b (pick sum) R) as B.
    cbn [seen_of fold_right fst snd]. fold (seen_of g).
    rewrite A, S, <- P, EL, EH, !red, !Q2R_plus. lra.
Qed.

(** A target, where its goal is, and a pair of rationals around each distance of a group. *)
Record target := Target { points_of : counted; goal : place; roots : list (Q * Q) }.

Definition inside_ok (low high : Q) (found : option (Q * Q)) : bool :=
  match found with
  | Some (a, b) => Qle_bool low a && Qle_bool b high
  | None => false
  end.

Definition target_ok (t : target) (c : certificate) : bool :=
  let g := gather (points_of t) (goal t) in
  inside_ok (q1_low c) (q1_high c) (enclosed (fun p => fst (fst p)) g (roots t))
  && inside_ok (q2_low c) (q2_high c) (enclosed (fun p => snd (fst p)) g (roots t))
  && inside_ok (q3_low c) (q3_high c) (enclosed snd g (roots t)).

(** What a level camera sees from the goal is in the box of the certificate. *)
Theorem target_sound : forall t c, target_ok t c = true ->
  inside c (centroid (real_points (points_of t)) level (real_place (goal t))).
Proof.
  intros t c H. unfold target_ok in H.
  apply andb_prop in H. destruct H as [H H3]. apply andb_prop in H. destruct H as [H1 H2].
  rewrite gather_correct. unfold inside, within.
  assert (One : forall pick part low high found,
    (forall p, Q2R (pick p) = part (real_place p)) ->
    (forall u v, part (u + v)%vec = part u + part v) -> (forall k v, part (k * v)%vec = k * part v) ->
    part zero = 0 ->
    enclosed pick (gather (points_of t) (goal t)) (roots t) = found -> inside_ok low high found = true ->
    Q2R low <= part (seen_of (gather (points_of t) (goal t))) <= Q2R high).
  { intros pick part low high [[a b]|] P A S Z E I; [|discriminate]. cbn [inside_ok] in I.
    apply andb_prop in I. destruct I as [I J].
    apply Qle_bool_iff, Qle_Rle in I. apply Qle_bool_iff, Qle_Rle in J.
    pose proof (enclosed_sound pick part _ _ a b P A S Z E). lra. }
  split; [|split].
  - apply (One (fun p => fst (fst p)) px _ _ _ ltac:(intros [[x y] z]; reflexivity)
      ltac:(reflexivity) ltac:(reflexivity) ltac:(reflexivity) eq_refl H1).
  - apply (One (fun p => snd (fst p)) py _ _ _ ltac:(intros [[x y] z]; reflexivity)
      ltac:(reflexivity) ltac:(reflexivity) ltac:(reflexivity) eq_refl H2).
  - apply (One snd pz _ _ _ ltac:(intros [[x y] z]; reflexivity)
      ltac:(reflexivity) ltac:(reflexivity) ltac:(reflexivity) eq_refl H3).
Qed.

(** What is fixed in the image is given by its numbers: a centroid that the mission names, or, of a goal
    fixed to the vertical, nothing. *)
Definition given_ok (p : place) (c : certificate) : bool :=
  let '(x, y, z) := p in
  inside_ok (q1_low c) (q1_high c) (Some (x, x)) && inside_ok (q2_low c) (q2_high c) (Some (y, y))
  && inside_ok (q3_low c) (q3_high c) (Some (z, z)).

Theorem given_sound : forall p c, given_ok p c = true -> inside c (real_place p).
Proof.
  intros [[x y] z] c H. unfold given_ok, inside_ok in H.
  repeat (apply andb_prop in H; let E := fresh "E" in destruct H as [H E]).
  repeat match goal with B : (_ && _)%bool = true |- _ =>
    let E := fresh "E" in apply andb_prop in B; destruct B as [B E] end.
  repeat match goal with B : Qle_bool _ _ = true |- _ => apply Qle_bool_iff, Qle_Rle in B end.
  unfold inside, within. cbn [real_place px py pz]. repeat split; assumption.
Qed.
