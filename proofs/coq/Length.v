(** Lengths of vectors, and that a rotation keeps them. *)

Require Import Reals List Lra.
From Hoverproof Require Import Space Calculus Image Tolerant.
Open Scope R_scope.

Definition len (u : vec) : R := sqrt (u · u).

Lemma len_pos : forall u, 0 <= len u.
Proof. intros. apply sqrt_pos. Qed.
Lemma len_square : forall u, len u * len u = u · u.
Proof. intros. apply sqrt_sqrt, square_pos. Qed.

(** A square is compared by what is squared. *)
Lemma below_square : forall a b, 0 <= b -> a * a <= b * b -> a <= b.
Proof.
  intros a b B S. destruct (Rle_or_lt a b) as [L|L]; [exact L|].
  pose proof (Rmult_le_0_lt_compat b a b a B B L L). lra.
Qed.
Lemma squares_below : forall a b, 0 <= a -> a <= b -> a * a <= b * b.
Proof. intros. apply Rmult_le_compat; assumption. Qed.
Lemma len_at_most : forall u r, 0 <= r -> u · u <= r * r -> len u <= r.
Proof. intros u r P S. apply below_square; [exact P|]. rewrite len_square. exact S. Qed.
Lemma at_most_len : forall u r, len u <= r -> u · u <= r * r.
Proof. intros u r L. rewrite <- len_square. apply squares_below; [apply len_pos|exact L]. Qed.

Lemma dot_at_most : forall u v, u · v <= len u * len v.
Proof.
  intros u v. apply below_square; [apply Rmult_le_pos; apply len_pos|].
  replace (len u * len v * (len u * len v)) with ((len u * len u) * (len v * len v)) by ring.
  rewrite !len_square. pose proof (square_pos (u × v)%vec) as S.
  replace ((u × v)%vec · (u × v)) with ((u · u) * (v · v) - (u · v) * (u · v)) in S by number. lra.
Qed.
Lemma len_plus : forall u v, len (u + v)%vec <= len u + len v.
Proof.
  intros u v. pose proof (len_pos u). pose proof (len_pos v).
  apply len_at_most; [lra|]. pose proof (dot_at_most u v) as D.
  replace ((u + v)%vec · (u + v)) with (u · u + 2 * (u · v) + v · v) by number.
  rewrite <- !len_square. lra.
Qed.
Lemma len_scale : forall k u, len (k * u)%vec = Rabs k * len u.
Proof.
  intros. unfold len. replace ((k * u)%vec · (k * u)) with (Rsqr k * (u · u)) by (unfold Rsqr; number).
  rewrite sqrt_mult_alt by apply Rle_0_sqr. rewrite sqrt_Rsqr_abs. reflexivity.
Qed.
Lemma len_minus : forall u v, len (u - v)%vec <= len u + len v.
Proof.
  intros. unfold minus. eapply Rle_trans; [apply len_plus|]. rewrite len_scale.
  replace (Rabs (-1)) with 1; [lra|]. rewrite Rabs_left; lra.
Qed.
Lemma len_scaled : forall k u a b, Rabs k <= a -> len u <= b -> len (k * u)%vec <= a * b.
Proof. intros. rewrite len_scale. apply Rmult_le_compat; auto using Rabs_pos, len_pos. Qed.
Lemma len_plus_to : forall u v a b, len u <= a -> len v <= b -> len (u + v)%vec <= a + b.
Proof. intros. eapply Rle_trans; [apply len_plus|]. lra. Qed.
Lemma len_minus_to : forall u v a b, len u <= a -> len v <= b -> len (u - v)%vec <= a + b.
Proof. intros. eapply Rle_trans; [apply len_minus|]. lra. Qed.
Lemma len_zero : len zero = 0.
Proof. unfold len. replace (zero · zero) with 0 by number. apply sqrt_0. Qed.

Lemma len_flat : forall u, len (flat u) <= len u.
Proof.
  intros. apply len_at_most; [apply len_pos|]. rewrite len_square.
  pose proof (Rle_0_sqr (pz u)) as Q. unfold Rsqr in Q. components. lra.
Qed.
Lemma len_up : forall u, len (up u) = Rabs (pz u).
Proof.
  intros. unfold len, up. replace (V 0 0 (pz u) · V 0 0 (pz u)) with (Rsqr (pz u)) by (unfold Rsqr; number).
  apply sqrt_Rsqr_abs.
Qed.
Lemma pz_len : forall u, Rabs (pz u) <= len u.
Proof.
  intros. rewrite <- len_up. apply len_at_most; [apply len_pos|]. rewrite len_square.
  pose proof (Rle_0_sqr (px u)) as X. pose proof (Rle_0_sqr (py u)) as Y. unfold Rsqr in *.
  unfold up, dot. cbn [px py pz]. lra.
Qed.
(** A quarter turn about e3. *)
Lemma len_quarter : forall u, len (e3 × u)%vec = len (flat u).
Proof. intros. unfold len. f_equal. number. Qed.

(** |k u + l v| where a|u|² + b|v|² is known: Cauchy and Schwarz. *)
Lemma len_sum : forall u v a b e r, 0 < a -> 0 < b -> 0 <= r -> a * (u · u) + b * (v · v) <= e ->
  e * (/ a + / b) <= r * r -> len (u - v)%vec <= r.
Proof.
  intros u v a b e r A B P E S. apply len_at_most; [exact P|]. eapply Rle_trans; [|exact S].
  assert (I : 0 < / a + / b) by (pose proof (Rinv_0_lt_compat _ A); pose proof (Rinv_0_lt_compat _ B); lra).
  apply Rle_trans with ((a * (u · u) + b * (v · v)) * (/ a + / b));
    [|apply Rmult_le_compat_r; [lra|exact E]].
  assert (Q : (a * (u · u) + b * (v · v)) * (/ a + / b) - (u - v)%vec · (u - v)
    = / (a * b) * ((a * u + b * v)%vec · (a * u + b * v))).
  { generalize u v. clear - A B. intros. components. field. lra. }
  pose proof (square_pos (a * u + b * v)%vec) as W.
  assert (0 <= / (a * b)) by (left; apply Rinv_0_lt_compat, Rmult_lt_0_compat; assumption).
  pose proof (Rmult_le_pos _ _ H W). lra.
Qed.
Lemma len_of : forall u a e r, 0 < a -> 0 <= r -> a * (u · u) <= e -> e * / a <= r * r -> len u <= r.
Proof.
  intros u a e r A P E S. apply len_at_most; [exact P|]. eapply Rle_trans; [|exact S].
  apply Rmult_le_reg_l with a; [exact A|]. replace (a * (e * / a)) with e by (field; lra). exact E.
Qed.

(** ** Rotations *)

Ltac components ::=
  unfold minus, dot; cbn [plus scale cross flat zero e3 px py pz bx by_ bz turned back up].

Lemma back_plus : forall r u v, back r (u + v)%vec = (back r u + back r v)%vec.
Proof. intros. unfold back. vector. Qed.
Lemma back_scale : forall r k u, back r (k * u)%vec = (k * back r u)%vec.
Proof. intros. unfold back. vector. Qed.
Lemma back_minus : forall r u v, back r (u - v)%vec = (back r u - back r v)%vec.
Proof. intros. unfold minus. rewrite back_plus, back_scale. reflexivity. Qed.

Lemma volume : forall r, orthonormal r -> let d := bx r · (by_ r × bz r)%vec in d * d = 1.
Proof.
  intros [u v w] [U [V [W [UV [VW WU]]]]] d. cbn [bx by_ bz] in *.
  assert (G : d * d = (u · u) * ((v · v) * (w · w) - (v · w) * (v · w))
    - (u · v) * ((u · v) * (w · w) - (v · w) * (w · u)) + (w · u) * ((u · v) * (v · w) - (v · v) * (w · u)))
    by (unfold d; number).
  rewrite G, U, V, W, UV, VW, WU. ring.
Qed.
(** What has no part along any of the three body axes is zero. *)
Lemma no_part : forall r u, orthonormal r -> back r u = zero -> u = zero.
Proof.
  intros r u O Z. pose proof (volume r O) as D. cbv zeta in D. set (d := bx r · (by_ r × bz r)%vec) in *.
  assert (E : (d * u)%vec = (px (back r u) * (by_ r × bz r) + py (back r u) * (bz r × bx r)
    + pz (back r u) * (bx r × by_ r))%vec) by (unfold d, back; vector).
  rewrite Z in E.
  assert (F : (d * (d * u))%vec = zero) by (rewrite E; vector).
  rewrite scale_scale, D in F. rewrite <- F. vector.
Qed.
Lemma turned_back : forall r u, orthonormal r -> turned r (back r u) = u.
Proof.
  intros r u O. assert (Z : (u - turned r (back r u))%vec = zero).
  { apply (no_part r); [exact O|]. rewrite back_minus, back_turned by exact O. vector. }
  revert Z. generalize (turned r (back r u)). intros [a b c] Z. destruct u as [x y z].
  unfold minus, plus, scale, zero in Z. cbn [px py pz] in Z. injection Z as Z1 Z2 Z3. apply vec_eq; cbn [px py pz]; lra.
Qed.
Lemma back_square : forall r u, orthonormal r -> back r u · back r u = u · u.
Proof. intros. rewrite back_dot, turned_back by assumption. reflexivity. Qed.
Lemma len_back : forall r u, orthonormal r -> len (back r u) = len u.
Proof. intros. unfold len. rewrite back_square by assumption. reflexivity. Qed.
Lemma len_turned : forall r u, orthonormal r -> len (turned r u) = len u.
Proof. intros r u O. rewrite <- (len_back r) by exact O. rewrite back_turned by exact O. reflexivity. Qed.

(** ** The image of a level camera, and of one that is turned *)

Definition level : rotation := Rotation (V 1 0 0) (V 0 1 0) (V 0 0 1).
Lemma level_is : forall u, back level u = u.
Proof. intros. unfold back, level. vector. Qed.
Lemma level_orthonormal : orthonormal level.
Proof. unfold orthonormal, level. cbn [bx by_ bz]. repeat split; number. Qed.

Lemma ray_turned : forall r p xi, ray r p xi = back r (ray level p xi).
Proof. intros. unfold ray. rewrite back_scale, level_is. reflexivity. Qed.
Lemma centroid_turned : forall ps r xi, centroid ps r xi = back r (centroid ps level xi).
Proof.
  intros ps r xi. induction ps as [|[k p] ps IH]; cbn [centroid].
  - unfold back. vector.
  - rewrite IH, ray_turned, back_plus, back_scale. reflexivity.
Qed.
Lemma slope_turned : forall ps r xi v, orthonormal r ->
  image_slope ps r xi v = back r (image_slope ps level xi (turned r v)).
Proof.
  intros ps r xi v O. induction ps as [|[k p] ps IH]; cbn [image_slope].
  - unfold back. vector.
  - rewrite IH, !(ray_turned r), back_plus, back_scale, back_scale, back_minus, back_scale.
    rewrite back_turned by exact O. rewrite (back_dot r). reflexivity.
Qed.
Lemma stretch_turned : forall r n q, orthonormal r -> stretch n (back r q) = stretch n q /\
  stretching n (back r q) = stretching n q.
Proof.
  intros. unfold stretch, stretching, room. rewrite !back_square by assumption. split; reflexivity.
Qed.
Lemma feature_turned : forall k n ps r xi, orthonormal r ->
  feature_of k n (centroid ps r xi) = back r (feature_of k n (centroid ps level xi)).
Proof.
  intros k n ps r xi O. rewrite centroid_turned. destruct k; [reflexivity|]. cbn [feature_of].
  destruct (stretch_turned r n (centroid ps level xi) O) as [-> _]. rewrite back_scale. reflexivity.
Qed.
Lemma back_dots : forall r u v, orthonormal r -> back r u · back r v = u · v.
Proof. intros. rewrite back_dot, turned_back by assumption. reflexivity. Qed.
Lemma feature_slope_turned : forall k n ps r xi v, orthonormal r ->
  feature_slope k n (centroid ps r xi) (image_slope ps r xi) v
  = back r (feature_slope k n (centroid ps level xi) (image_slope ps level xi) (turned r v)).
Proof.
  intros k n ps r xi v O. destruct k; cbn [feature_slope]; [apply slope_turned; exact O|].
  rewrite centroid_turned. destruct (stretch_turned r n (centroid ps level xi) O) as [-> ->].
  rewrite (slope_turned ps r xi v O), back_dots by exact O. rewrite back_plus, !back_scale. reflexivity.
Qed.
Lemma featured_turned : forall k n ps r xi, orthonormal r -> featured k n (centroid ps level xi) ->
  featured k n (centroid ps r xi).
Proof.
  intros k n ps r xi O F. rewrite centroid_turned. destruct k; [exact I|]. cbn [featured] in *.
  rewrite back_square by exact O. exact F.
Qed.

(** ** How far a vector gets *)

Lemma moved_at_most : forall (u du : R -> vec) a b k, a <= b -> 0 <= k ->
  (forall x, a <= x <= b -> vslope u x (du x) /\ len (du x) <= k) -> len (u b - u a)%vec <= k * (b - a).
Proof.
  intros u du a b k AB K H. set (d := (u b - u a)%vec).
  assert (F : d · u b - len d * k * b <= d · u a - len d * k * a).
  { apply (falling (fun x => d · u x - len d * k * x) (fun x => (zero · u x + d · du x) - len d * k * 1) a b AB).
    intros x X. destruct (H x X) as [S L]. split.
    - apply slope_minus; [|apply slope_scale, derivable_pt_lim_id].
      apply (slope_dot (fun _ => d) u); [apply vslope_const|exact S].
    - pose proof (dot_at_most d (du x)) as D. pose proof (Rmult_le_compat_l _ _ _ (len_pos d) L).
      replace (zero · u x) with 0 by number. lra. }
  assert (D : d · u b - d · u a = d · d) by (unfold d; number).
  rewrite <- len_square in D. pose proof (len_pos d) as P.
  assert (Q : 0 <= k * (b - a)) by (apply Rmult_le_pos; lra).
  destruct P as [P|P]; [|rewrite <- P; exact Q].
  apply Rmult_le_reg_l with (len d); [exact P|]. lra.
Qed.
