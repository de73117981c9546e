(** A camera that turns and moves with the vehicle, and how what it sees moves: q' = -Ω × q - Q V.

    World axes have z down. Velocities and rays are in body axes. A rotation is given by the three body
    axes in world axes. Equations 1, 3, 5 and 7 of the paper. *)

Require Import Reals List Lra.
From Hoverproof Require Import Space Calculus.
Import ListNotations.
Open Scope R_scope.

(** * Rotations *)

Record rotation := Rotation { bx : vec; by_ : vec; bz : vec }.

(** R v, and Rᵀ u. *)
Definition turned (r : rotation) (v : vec) : vec := (px v * bx r + py v * by_ r + pz v * bz r)%vec.
Definition back (r : rotation) (u : vec) : vec := V (bx r · u) (by_ r · u) (bz r · u).

Ltac components ::=
  unfold minus, dot; cbn [plus scale cross flat zero e3 px py pz bx by_ bz turned back].

Definition orthonormal (r : rotation) : Prop :=
  bx r · bx r = 1 /\ by_ r · by_ r = 1 /\ bz r · bz r = 1 /\
  bx r · by_ r = 0 /\ by_ r · bz r = 0 /\ bz r · bx r = 0.

(** R' = R sk(Ω): each body axis turns with Ω. *)
Definition turns (r : R -> rotation) (om : R -> vec) (t : R) : Prop :=
  vslope (fun s => bx (r s)) t (turned (r t) (om t × V 1 0 0)) /\
  vslope (fun s => by_ (r s)) t (turned (r t) (om t × V 0 1 0)) /\
  vslope (fun s => bz (r s)) t (turned (r t) (om t × V 0 0 1)).

Lemma back_turned : forall r v, orthonormal r -> back r (turned r v) = v.
Proof.
  intros [[a b c] [d e f] [g h i]] [x y z] [X [Y [Z [XY [YZ ZX]]]]].
  unfold dot in X, Y, Z, XY, YZ, ZX. simpl in X, Y, Z, XY, YZ, ZX.
  unfold back, turned. apply vec_eq; components.
  - transitivity (x * (a * a + b * b + c * c) + y * (a * d + b * e + c * f)
      + z * (g * a + h * b + i * c)); [ring|]. rewrite X, XY, ZX. ring.
  - transitivity (x * (a * d + b * e + c * f) + y * (d * d + e * e + f * f)
      + z * (d * g + e * h + f * i)); [ring|]. rewrite XY, Y, YZ. ring.
  - transitivity (x * (g * a + h * b + i * c) + y * (d * g + e * h + f * i)
      + z * (g * g + h * h + i * i)); [ring|]. rewrite ZX, YZ, Z. ring.
Qed.

Lemma back_dot : forall r u v, back r u · v = u · turned r v.
Proof. intros. unfold back, turned. number. Qed.

(** (Rᵀu)' = -Ω × Rᵀu + Rᵀu'. *)
Lemma slope_back : forall r om u t du,
  turns r om t -> vslope u t du ->
  vslope (fun s => back (r s) (u s)) t (back (r t) du - om t × back (r t) (u t))%vec.
Proof.
  intros r om u t du [X [Y Z]] U.
  repeat split; cbn [back px py pz];
    (eapply slope_is; [apply slope_dot; eassumption|]); unfold turned, back; number.
Qed.

(** * The image *)

(** What the camera sees of a point: a ray p of length 1, at a distance. *)
Definition distance (point xi : vec) : R := sqrt ((point - xi)%vec · (point - xi)).
Definition ray (r : rotation) (point xi : vec) : vec := (/ distance point xi * back r (point - xi))%vec.

(** q = Σ ωᵢ pᵢ, and Q v = Σ ωᵢ (v - pᵢ pᵢᵀv)/rᵢ; ωᵢ is how much a point counts. *)
Definition points := list (R * vec).
Fixpoint centroid (ps : points) (r : rotation) (xi : vec) : vec :=
  match ps with
  | [] => zero
  | (k, p) :: ps => (k * ray r p xi + centroid ps r xi)%vec
  end.
Fixpoint image_slope (ps : points) (r : rotation) (xi : vec) (v : vec) : vec :=
  match ps with
  | [] => zero
  | (k, p) :: ps =>
      (k * (/ distance p xi * (v - (ray r p xi · v) * ray r p xi)) + image_slope ps r xi v)%vec
  end.

Definition off (point xi : vec) : Prop := 0 < (point - xi)%vec · (point - xi).

Lemma slope_ray : forall point r xi v om t,
  orthonormal (r t) -> turns r om t -> vslope xi t (turned (r t) (v t)) -> off point (xi t) ->
  vslope (fun s => ray (r s) point (xi s)) t
    (- 1 * (om t × ray (r t) point (xi t))
     - / distance point (xi t)
       * (v t - (ray (r t) point (xi t) · v t) * ray (r t) point (xi t)))%vec.
Proof.
  intros point r xi v om t O T X P.
  set (u := fun s => (point - xi s)%vec).
  assert (U : vslope u t (zero - turned (r t) (v t))%vec).
  { apply (vslope_minus (fun _ => point) xi); [apply vslope_const|exact X]. }
  set (d := fun s => distance point (xi s)).
  assert (P' : 0 < d t) by (apply sqrt_lt_R0; exact P).
  assert (S : d t * d t = u t · u t) by (apply sqrt_sqrt; left; exact P).
  (* the distance falls by the speed along the ray *)
  assert (D : slope d t (- (back (r t) (u t) · v t) / d t)).
  { eapply slope_is.
    - apply (slope_sqrt (fun s => u s · u s)); [apply slope_dot; exact U|exact P].
    - rewrite back_dot. change (sqrt (u t · u t)) with (d t).
      replace (((zero - turned (r t) (v t))%vec · u t + u t · (zero - turned (r t) (v t))%vec))
        with (-2 * (u t · turned (r t) (v t))) by number.
      field. apart. }
  assert (N : d t <> 0) by lra.
  pose proof (vslope_times _ _ _ _ _ (slope_inv d t _ D N) (slope_back r om u t _ T U)) as H.
  eapply vslope_is; [exact H|].
  assert (B : back (r t) (zero - turned (r t) (v t))%vec = (-1 * v t)%vec).
  { transitivity (-1 * back (r t) (turned (r t) (v t)))%vec; [unfold back; vector|].
    rewrite back_turned by exact O. reflexivity. }
  rewrite B. unfold ray. change (point - xi t)%vec with (u t). change (distance point (xi t)) with (d t).
  set (b := back (r t) (u t)). rewrite scale_dot.
  set (s := b · v t). clearbody s b. destruct b, (v t), (om t).
  apply vec_eq; components; field; exact N.
Qed.

(** The image moves as q' = -Ω × q - Q V (equation 7). *)
Theorem slope_centroid : forall ps r xi v om t,
  orthonormal (r t) -> turns r om t -> vslope xi t (turned (r t) (v t)) ->
  (forall k p, In (k, p) ps -> off p (xi t)) ->
  vslope (fun s => centroid ps (r s) (xi s)) t
    (- 1 * (om t × centroid ps (r t) (xi t)) - image_slope ps (r t) (xi t) (v t))%vec.
Proof.
  intros ps r xi v om t O T X. induction ps as [|[k p] ps IH]; intros P.
  - eapply vslope_is; [apply (vslope_const zero)|]. cbn [centroid image_slope]. vector.
  - eapply vslope_is.
    + apply (vslope_plus (fun s => (k * ray (r s) p (xi s))%vec)
        (fun s => centroid ps (r s) (xi s))).
      * apply vslope_scale, slope_ray with (v := v) (om := om); auto.
        apply (P k). left. reflexivity.
      * apply IH. intros j q I. apply (P j). right. exact I.
    + cbn [centroid image_slope]. vector.
Qed.

(** Q is linear and symmetric. *)
Lemma image_linear : forall ps r xi, linear (image_slope ps r xi).
Proof.
  intros ps r xi. induction ps as [|[k p] ps [A S]]; split; intros; cbn [image_slope].
  - vector.
  - vector.
  - rewrite A. vector.
  - rewrite S. vector.
Qed.
Lemma image_symmetric : forall ps r xi u v,
  u · image_slope ps r xi v = image_slope ps r xi u · v.
Proof.
  intros ps r xi u v. induction ps as [|[k p] ps IH]; cbn [image_slope]; [number|].
  rewrite dot_plus, plus_dot, IH. f_equal. number.
Qed.

(** * The feature: the centroid, or the scaled centroid

    s = φ(a) q/a, a = |q|, φ(a) = 1/√(2 (1 - a/n)), n the sum of all ωᵢ. It moves as s' = -Ω × s - J V,
    J v = (φ/a) Q v + κ (q·Q v) q. *)

Inductive feature := Centroid | Scaled.

Definition room (n : R) (q : vec) : R := sqrt (2 * (1 - sqrt (q · q) / n)).
Definition stretch (n : R) (q : vec) : R := / (sqrt (q · q) * room n q).
(** The derivative of φ/a is κ q·q'. *)
Definition stretching (n : R) (q : vec) : R :=
  - (room n q / sqrt (q · q) - / (n * room n q))
  / ((sqrt (q · q) * room n q) * (sqrt (q · q) * room n q)).

Definition feature_of (k : feature) (n : R) (q : vec) : vec :=
  match k with Centroid => q | Scaled => (stretch n q * q)%vec end.
Definition feature_slope (k : feature) (n : R) (q : vec) (Q : vec -> vec) (v : vec) : vec :=
  match k with
  | Centroid => Q v
  | Scaled => (stretch n q * Q v + (stretching n q * (q · Q v)) * q)%vec
  end.
(** Where it is defined. *)
Definition featured (k : feature) (n : R) (q : vec) : Prop :=
  match k with Centroid => True | Scaled => 0 < q · q < n * n /\ 0 < n end.

Lemma feature_linear : forall k n q Q, linear Q -> linear (feature_slope k n q Q).
Proof.
  intros [|] n q Q [A S]; [split; assumption|].
  split; intros; cbn [feature_slope].
  - rewrite A. vector.
  - rewrite S. vector.
Qed.

Lemma slope_stretch : forall n q t dq, vslope q t dq -> featured Scaled n (q t) ->
  slope (fun s => stretch n (q s)) t (stretching n (q t) * (q t · dq)).
Proof.
  intros n q t dq D [[P L] N].
  set (a := fun s => sqrt (q s · q s)).
  assert (A : 0 < a t) by (apply sqrt_lt_R0; exact P).
  assert (AN : a t < n).
  { unfold a. rewrite <- (sqrt_square n) by lra. apply sqrt_lt_1_alt. lra. }
  assert (DA : slope a t ((q t · dq) / a t)).
  { eapply slope_is; [apply (slope_sqrt (fun s => q s · q s)); [apply slope_dot; exact D|exact P]|].
    fold (a t). replace (dq · q t + q t · dq) with (2 * (q t · dq)) by number. field. apart. }
  set (b := fun s => sqrt (2 * (1 - a s / n))).
  assert (B0 : 0 < 2 * (1 - a t / n)).
  { apply Rmult_lt_0_compat; [lra|]. apply Rlt_Rminus.
    apply Rmult_lt_reg_r with n; [exact N|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
  assert (B : 0 < b t) by (apply sqrt_lt_R0; exact B0).
  assert (DB : slope b t (- ((q t · dq) / a t) / (n * b t))).
  { eapply slope_is.
    - apply (slope_sqrt (fun s => 2 * (1 - a s / n))); [|exact B0].
      apply slope_scale, (slope_minus (fun _ => 1) (fun s => a s / n)); [apply slope_const|].
      apply (slope_ext (fun s => / n * a s)); [intros; unfold Rdiv; ring|].
      apply slope_scale. exact DA.
    - fold (b t). field. apart. }
  eapply slope_is.
  - apply (slope_inv (fun s => a s * b s)); [apply slope_mult; [exact DA|exact DB]|].
    apply Rgt_not_eq, Rmult_lt_0_compat; assumption.
  - cbv beta. unfold stretching, room. fold (a t). fold (b t). field. apart.
Qed.

(** s' = -Ω × s - J V, for both. *)
Theorem slope_feature : forall k n ps r xi v om t,
  orthonormal (r t) -> turns r om t -> vslope xi t (turned (r t) (v t)) ->
  (forall j p, In (j, p) ps -> off p (xi t)) ->
  featured k n (centroid ps (r t) (xi t)) ->
  vslope (fun s => feature_of k n (centroid ps (r s) (xi s))) t
    (- 1 * (om t × feature_of k n (centroid ps (r t) (xi t)))
     - feature_slope k n (centroid ps (r t) (xi t)) (image_slope ps (r t) (xi t)) (v t))%vec.
Proof.
  intros k n ps r xi v om t O T X P F.
  pose proof (slope_centroid ps r xi v om t O T X P) as S.
  destruct k; [exact S|]. cbn [feature_of feature_slope].
  eapply vslope_is.
  - apply (vslope_times (fun s => stretch n (centroid ps (r s) (xi s)))
      (fun s => centroid ps (r s) (xi s))); [|exact S].
    exact (slope_stretch n (fun s => centroid ps (r s) (xi s)) t _ S F).
  - cbv beta. generalize (stretching n (centroid ps (r t) (xi t))) (stretch n (centroid ps (r t) (xi t)))
      (image_slope ps (r t) (xi t) (v t)) (centroid ps (r t) (xi t)) (om t).
    intros a b y q w. vector.
Qed.
