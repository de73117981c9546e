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

(** q = Σ pᵢ, and Q v = Σ (v - pᵢ pᵢᵀv)/rᵢ. *)
Fixpoint centroid (points : list vec) (r : rotation) (xi : vec) : vec :=
  match points with
  | [] => zero
  | p :: points => (ray r p xi + centroid points r xi)%vec
  end.
Fixpoint image_slope (points : list vec) (r : rotation) (xi : vec) (v : vec) : vec :=
  match points with
  | [] => zero
  | p :: points =>
      (/ distance p xi * (v - (ray r p xi · v) * ray r p xi) + image_slope points r xi v)%vec
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
Theorem slope_centroid : forall points r xi v om t,
  orthonormal (r t) -> turns r om t -> vslope xi t (turned (r t) (v t)) ->
  (forall p, In p points -> off p (xi t)) ->
  vslope (fun s => centroid points (r s) (xi s)) t
    (- 1 * (om t × centroid points (r t) (xi t)) - image_slope points (r t) (xi t) (v t))%vec.
Proof.
  intros points r xi v om t O T X. induction points as [|p points IH]; intros P.
  - eapply vslope_is; [apply (vslope_const zero)|]. cbn [centroid image_slope]. vector.
  - eapply vslope_is.
    + apply (vslope_plus (fun s => ray (r s) p (xi s)) (fun s => centroid points (r s) (xi s)));
        [apply slope_ray with (v := v) (om := om); auto; apply P; left; reflexivity|].
      apply IH. intros q I. apply P. right. exact I.
    + cbn [centroid image_slope]. vector.
Qed.

(** Q is linear and symmetric. *)
Lemma image_linear : forall points r xi, linear (image_slope points r xi).
Proof.
  intros points r xi. induction points as [|p points [A S]]; split; intros; cbn [image_slope].
  - vector.
  - vector.
  - rewrite A. vector.
  - rewrite S. vector.
Qed.
Lemma image_symmetric : forall points r xi u v,
  u · image_slope points r xi v = image_slope points r xi u · v.
Proof.
  intros points r xi u v. induction points as [|p points IH]; cbn [image_slope]; [number|].
  rewrite dot_plus, plus_dot, IH. f_equal. number.
Qed.

