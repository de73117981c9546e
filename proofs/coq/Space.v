(** Vectors of three components, and what is needed of them. *)

Require Import Reals Lra.
Open Scope R_scope.

Record vec := V { px : R; py : R; pz : R }.

Definition zero : vec := V 0 0 0.
Definition e3 : vec := V 0 0 1.
Definition plus (u v : vec) : vec := V (px u + px v) (py u + py v) (pz u + pz v).
Definition scale (k : R) (u : vec) : vec := V (k * px u) (k * py u) (k * pz u).
Definition minus (u v : vec) : vec := plus u (scale (-1) v).
Definition dot (u v : vec) : R := px u * px v + py u * py v + pz u * pz v.
Definition cross (u v : vec) : vec :=
  V (py u * pz v - pz u * py v) (pz u * px v - px u * pz v) (px u * py v - py u * px v).
(** P u: the third component is dropped. *)
Definition flat (u : vec) : vec := V (px u) (py u) 0.

Declare Scope vec_scope.
Delimit Scope vec_scope with vec.
Bind Scope vec_scope with vec.
Infix "+" := plus : vec_scope.
Infix "-" := minus : vec_scope.
Infix "*" := scale : vec_scope.
Infix "×" := cross (at level 40, left associativity) : vec_scope.
Notation "u · v" := (dot u%vec v%vec) (at level 41) : R_scope.

Lemma vec_eq : forall u v, px u = px v -> py u = py v -> pz u = pz v -> u = v.
Proof. intros [a b c] [x y z]. simpl. intros -> -> ->. reflexivity. Qed.

(** Prove an equation between vectors, or between numbers made from them. *)
Ltac components :=
  unfold minus, dot; cbn [plus scale cross flat zero e3 px py pz].
Ltac vector := intros; apply vec_eq; components; ring.
Ltac number := intros; components; ring.
(** What is positive is not zero. *)
Tactic Notation "apart" := repeat split; first [assumption | apply Rgt_not_eq; assumption].

Lemma dot_plus : forall u v w, u · (v + w)%vec = u · v + u · w.
Proof. number. Qed.
Lemma dot_minus : forall u v w, u · (v - w)%vec = u · v - u · w.
Proof. number. Qed.
Lemma dot_scale : forall u k v, u · (k * v)%vec = k * (u · v).
Proof. number. Qed.
Lemma plus_dot : forall u v w, (u + v)%vec · w = u · w + v · w.
Proof. number. Qed.
Lemma minus_dot : forall u v w, (u - v)%vec · w = u · w - v · w.
Proof. number. Qed.
Lemma scale_dot : forall k u v, (k * u)%vec · v = k * (u · v).
Proof. number. Qed.
Lemma dot_zero : forall u, u · zero = 0.
Proof. number. Qed.
Lemma dot_turned : forall u w, u · (w × u)%vec = 0.
Proof. number. Qed.

Lemma cross_minus : forall u v w, (u × (v - w) = u × v - u × w)%vec.
Proof. vector. Qed.
Lemma cross_scale : forall u k v, (u × (k * v) = k * (u × v))%vec.
Proof. vector. Qed.
Lemma flat_plus : forall u v, (flat (u + v) = flat u + flat v)%vec.
Proof. vector. Qed.
Lemma flat_minus : forall u v, (flat (u - v) = flat u - flat v)%vec.
Proof. vector. Qed.
Lemma flat_scale : forall k u, (flat (k * u) = k * flat u)%vec.
Proof. vector. Qed.
Lemma flat_flat : forall u, flat (flat u) = flat u.
Proof. vector. Qed.
Lemma flat_lever : forall u, flat (e3 × u)%vec = (e3 × u)%vec.
Proof. vector. Qed.
Lemma scale_plus : forall k u v, (k * (u + v) = k * u + k * v)%vec.
Proof. vector. Qed.
Lemma scale_scale : forall k l u, (k * (l * u) = (k * l) * u)%vec.
Proof. vector. Qed.

(** ** Linear operators *)

Definition linear (J : vec -> vec) : Prop :=
  (forall u v, J (u + v)%vec = (J u + J v)%vec) /\ (forall k v, J (k * v)%vec = (k * J v)%vec).

(** J is linear and |J v - j v| <= rho |v| for all v. *)
Definition near (j rho : R) (J : vec -> vec) : Prop :=
  linear J /\ forall v, (J v - j * v)%vec · (J v - j * v) <= rho * rho * (v · v).

(** Q is linear, symmetric, and its eigenvalues are in [a, b]. *)
Definition between (a b : R) (Q : vec -> vec) : Prop :=
  linear Q /\ (forall u v, u · Q v = Q u · v) /\
  forall v, a * (v · v) <= v · Q v <= b * (v · v).

Lemma square_pos : forall u, 0 <= u · u.
Proof.
  intros [x y z]. unfold dot. simpl.
  pose proof (Rle_0_sqr x) as X. pose proof (Rle_0_sqr y) as Y. pose proof (Rle_0_sqr z) as Z.
  unfold Rsqr in *. lra.
Qed.

(** Petersen's step, for both kinds of operators: no more is lost than this. *)
Definition slack (j rho : R) (J : vec -> vec) : Prop :=
  forall u v tau, 0 < tau ->
    j * (u · v) - rho / 2 * (tau * (v · v) + / tau * (u · u)) <= u · J v.

Lemma near_slack : forall j rho J, 0 < rho -> near j rho J -> slack j rho J.
Proof.
  intros j rho J P [_ N] u v tau T.
  set (h := (J v - j * v)%vec). specialize (N v). fold h in N.
  assert (E : u · J v = j * (u · v) + u · h) by (unfold h; number).
  rewrite E.
  (* 0 <= |rho u + tau h|^2, divided by 2 rho tau *)
  pose proof (square_pos (rho * u + tau * h)%vec) as S.
  assert (X : (rho * u + tau * h)%vec · (rho * u + tau * h) =
    rho * rho * (u · u) + 2 * rho * tau * (u · h) + tau * tau * (h · h)) by number.
  rewrite X in S.
  assert (B : tau * tau * (h · h) <= tau * tau * (rho * rho * (v · v))).
  { apply Rmult_le_compat_l; [|exact N]. left. apply Rmult_lt_0_compat; assumption. }
  assert (K : 0 <= 2 * rho * tau * (u · h + rho / 2 * (tau * (v · v) + / tau * (u · u)))).
  { replace (2 * rho * tau * (u · h + rho / 2 * (tau * (v · v) + / tau * (u · u))))
      with (rho * rho * (u · u) + 2 * rho * tau * (u · h) + tau * tau * (rho * rho * (v · v)))
      by (field; lra).
    lra. }
  assert (0 < 2 * rho * tau).
  { apply Rmult_lt_0_compat; [lra|assumption]. }
  assert (0 <= u · h + rho / 2 * (tau * (v · v) + / tau * (u · u))).
  { apply Rmult_le_reg_l with (2 * rho * tau); [assumption|]. rewrite Rmult_0_r. exact K. }
  lra.
Qed.

Lemma between_slack : forall a b Q, between a b Q -> slack ((a + b) / 2) ((b - a) / 2) Q.
Proof.
  intros a b Q [[A S] [Y B]] u v tau T.
  (* u·Q v by polarisation, from w·Q w at w = u + tau v and u - tau v *)
  set (p := (u + tau * v)%vec). set (m := (u + (- tau) * v)%vec).
  assert (P : p · Q p = u · Q u + 2 * tau * (u · Q v) + tau * tau * (v · Q v)).
  { unfold p. rewrite A, S.
    replace ((u + tau * v)%vec · (Q u + tau * Q v)) with
      (u · Q u + tau * (u · Q v) + tau * (Q u · v) + tau * tau * (v · Q v)) by number.
    rewrite <- (Y u v). ring. }
  assert (M : m · Q m = u · Q u - 2 * tau * (u · Q v) + tau * tau * (v · Q v)).
  { unfold m. rewrite A, S.
    replace ((u + (- tau) * v)%vec · (Q u + (- tau) * Q v)) with
      (u · Q u - tau * (u · Q v) - tau * (Q u · v) + tau * tau * (v · Q v)) by number.
    rewrite <- (Y u v). ring. }
  pose proof (B p) as [L _]. pose proof (B m) as [_ U]. rewrite P in L. rewrite M in U.
  assert (NP : p · p = u · u + 2 * tau * (u · v) + tau * tau * (v · v)) by (unfold p; number).
  assert (NM : m · m = u · u - 2 * tau * (u · v) + tau * tau * (v · v)) by (unfold m; number).
  rewrite NP in L. rewrite NM in U.
  apply Rmult_le_reg_l with (4 * tau); [lra|].
  replace (4 * tau * ((a + b) / 2 * (u · v) - (b - a) / 2 / 2 * (tau * (v · v) + / tau * (u · u))))
    with (2 * (a + b) * tau * (u · v) - (b - a) * (tau * tau * (v · v) + u · u)) by (field; lra).
  lra.
Qed.
