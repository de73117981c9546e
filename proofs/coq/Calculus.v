(** Derivatives of numbers and vectors that depend on time. *)

Require Import Reals Lra.
From Hoverproof Require Import Space.
Open Scope R_scope.

(** f has the derivative d at t. *)
Definition slope (f : R -> R) (t d : R) : Prop := derivable_pt_lim f t d.
Definition vslope (u : R -> vec) (t : R) (d : vec) : Prop :=
  slope (fun s => px (u s)) t (px d) /\ slope (fun s => py (u s)) t (py d) /\
  slope (fun s => pz (u s)) t (pz d).

Lemma slope_const : forall a t, slope (fun _ => a) t 0.
Proof. intros. apply derivable_pt_lim_const. Qed.
Lemma slope_plus : forall f g t a b, slope f t a -> slope g t b -> slope (fun s => f s + g s) t (a + b).
Proof. intros. apply derivable_pt_lim_plus; assumption. Qed.
Lemma slope_mult : forall f g t a b,
  slope f t a -> slope g t b -> slope (fun s => f s * g s) t (a * g t + f t * b).
Proof. intros. apply derivable_pt_lim_mult; assumption. Qed.
Lemma slope_is : forall f t a b, slope f t a -> a = b -> slope f t b.
Proof. intros f t a b H <-. exact H. Qed.
Lemma slope_scale : forall k f t a, slope f t a -> slope (fun s => k * f s) t (k * a).
Proof.
  intros k f t a H. eapply slope_is; [apply slope_mult; [apply slope_const|exact H]|]. cbv beta. ring.
Qed.
Lemma slope_sqrt : forall f t a, slope f t a -> 0 < f t ->
  slope (fun s => sqrt (f s)) t (a / (2 * sqrt (f t))).
Proof.
  intros f t a H P. unfold slope.
  eapply slope_is; [apply (derivable_pt_lim_comp f sqrt t a (/ (2 * sqrt (f t))));
    [exact H|apply derivable_pt_lim_sqrt; exact P]|].
  unfold Rdiv. ring.
Qed.
Lemma slope_inv : forall f t a, slope f t a -> f t <> 0 ->
  slope (fun s => / f s) t (- a / (f t * f t)).
Proof.
  intros f t a H N. pose proof (derivable_pt_lim_div (fun _ => 1) f t 0 a) as D.
  assert (E : slope (fun s => 1 / f s) t ((0 * f t - a * 1) / Rsqr (f t))).
  { apply D; [apply slope_const|exact H|exact N]. }
  intros eps P. destruct (E eps P) as [d X]. exists d. intros h HN HD. specialize (X h HN HD).
  unfold Rdiv in X. rewrite !Rmult_1_l in X. unfold Rsqr in X.
  replace (- a / (f t * f t)) with ((0 * f t - a * 1) * / (f t * f t)) by (unfold Rdiv; ring).
  exact X.
Qed.
Lemma slope_exp : forall k t, slope (fun s => exp (k * s)) t (k * exp (k * t)).
Proof.
  intros. eapply slope_is.
  - apply (derivable_pt_lim_comp (fun s => k * s) exp t k (exp (k * t))).
    + eapply slope_is; [apply slope_scale, derivable_pt_lim_id|]. cbv beta. ring.
    + apply derivable_pt_lim_exp.
  - ring.
Qed.

Lemma vslope_is : forall u t a b, vslope u t a -> a = b -> vslope u t b.
Proof. intros u t a b H <-. exact H. Qed.
Lemma vslope_const : forall a t, vslope (fun _ => a) t zero.
Proof. intros. repeat split; simpl; apply slope_const. Qed.
Lemma vslope_plus : forall u v t a b,
  vslope u t a -> vslope v t b -> vslope (fun s => (u s + v s)%vec) t (a + b)%vec.
Proof. intros u v t a b [? [? ?]] [? [? ?]]. repeat split; simpl; apply slope_plus; assumption. Qed.
Lemma vslope_scale : forall k u t a, vslope u t a -> vslope (fun s => (k * u s)%vec) t (k * a)%vec.
Proof. intros k u t a [? [? ?]]. repeat split; simpl; apply slope_scale; assumption. Qed.
Lemma vslope_minus : forall u v t a b,
  vslope u t a -> vslope v t b -> vslope (fun s => (u s - v s)%vec) t (a - b)%vec.
Proof. intros. unfold minus. apply vslope_plus; [assumption|]. apply vslope_scale. assumption. Qed.
Lemma vslope_times : forall f u t a b, slope f t a -> vslope u t b ->
  vslope (fun s => (f s * u s)%vec) t (a * u t + f t * b)%vec.
Proof. intros f u t a b F [? [? ?]]. repeat split; simpl; apply slope_mult; assumption. Qed.
Lemma vslope_flat : forall u t a, vslope u t a -> vslope (fun s => flat (u s)) t (flat a).
Proof. intros u t a [? [? ?]]. repeat split; simpl; try assumption. apply slope_const. Qed.
Lemma slope_dot : forall u v t a b, vslope u t a -> vslope v t b ->
  slope (fun s => u s · v s) t (a · v t + u t · b).
Proof.
  intros u v t a b [? [? ?]] [? [? ?]]. unfold dot.
  eapply slope_is; [apply slope_plus; [apply slope_plus|]; apply slope_mult; eassumption|]. cbv beta. ring.
Qed.
Lemma slope_minus : forall f g t a b, slope f t a -> slope g t b -> slope (fun s => f s - g s) t (a - b).
Proof. intros. apply derivable_pt_lim_minus; assumption. Qed.
Lemma vslope_cross : forall u v t a b, vslope u t a -> vslope v t b ->
  vslope (fun s => (u s × v s)%vec) t (a × v t + u t × b)%vec.
Proof.
  intros u v t a b [? [? ?]] [? [? ?]]. repeat split; simpl;
  (eapply slope_is; [apply slope_minus; apply slope_mult; eassumption|]; cbv beta; ring).
Qed.

(** Two functions that are equal at all times have the same slopes. *)
Lemma slope_ext : forall f g t a, (forall s, f s = g s) -> slope f t a -> slope g t a.
Proof.
  intros f g t a E H eps P. destruct (H eps P) as [d X]. exists d. intros h N D.
  rewrite <- !E. apply X; assumption.
Qed.
Lemma vslope_ext : forall u v t a, (forall s, u s = v s) -> vslope u t a -> vslope v t a.
Proof.
  intros u v t a E [X [Y Z]]. repeat split; (eapply slope_ext; [|eassumption]);
  intros s; simpl; rewrite E; reflexivity.
Qed.

(** What has a slope of at most zero at all times does not grow. *)
Lemma falling : forall f d a b, a <= b -> (forall t, a <= t <= b -> slope f t (d t) /\ d t <= 0) ->
  f b <= f a.
Proof.
  intros f d a b [L|E] H; [|subst; lra].
  destruct (MVT_cor2 f d a b L) as [c [M [C1 C2]]].
  - intros c C. apply H. exact C.
  - assert (d c <= 0) by (apply H; lra).
    assert (0 <= - d c * (b - a)) by (apply Rmult_le_pos; lra). lra.
Qed.

Lemma still : forall f a b, a <= b -> (forall t, a <= t <= b -> slope f t 0) -> f b = f a.
Proof.
  intros f a b [L|E] H; [|subst; reflexivity].
  destruct (MVT_cor2 f (fun _ => 0) a b L) as [c [M _]]; [intros; apply H; assumption|]. lra.
Qed.

(** What falls at a rate of r times itself is below an exponential. *)
Lemma decays : forall f d r b, 0 <= b ->
  (forall t, 0 <= t <= b -> slope f t (d t) /\ d t <= - r * f t) ->
  f b <= f 0 * exp (- r * b).
Proof.
  intros f d r b B H.
  assert (G : f b * exp (r * b) <= f 0 * exp (r * 0)).
  { apply (falling (fun t => f t * exp (r * t)) (fun t => d t * exp (r * t) + f t * (r * exp (r * t))) 0 b B).
    intros t T. destruct (H t T) as [S D]. split.
    - apply (slope_mult f (fun s => exp (r * s))); [exact S|apply slope_exp].
    - pose proof (exp_pos (r * t)) as E.
      replace (d t * exp (r * t) + f t * (r * exp (r * t))) with (- ((- r * f t - d t) * exp (r * t))) by ring.
      assert (0 <= (- r * f t - d t) * exp (r * t)) by (apply Rmult_le_pos; lra). lra. }
  rewrite Rmult_0_r, exp_0, Rmult_1_r in G.
  pose proof (exp_pos (- r * b)) as E.
  apply Rmult_le_compat_r with (r := exp (- r * b)) in G; [|lra].
  rewrite Rmult_assoc, <- exp_plus in G.
  replace (r * b + - r * b) with 0 in G by ring. rewrite exp_0, Rmult_1_r in G. exact G.
Qed.
