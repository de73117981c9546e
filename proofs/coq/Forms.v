(** Quadratic forms with rational coefficients, and a decision that one is positive definite.

    A linear form in real variables x0, x1, ... is the list of its coefficients. A quadratic form is
    a sum of terms c (l·x) (r·x). [positive] decides in whole numbers, with a hint that comes with each
    form: what makes its matrix integral, and squares to take away, after which what is left is dominated
    by its diagonal. [positive_sound] says what a true answer means. Nothing in this file knows of
    vehicles. *)

Require Import QArith Qreals Reals List Bool Lra Lia ZArith.
Import ListNotations.
Open Scope R_scope.

Definition form := list Q.
Definition term := (Q * form * form)%type.

(** The value of a linear form, and of a sum of terms, at real numbers. *)
Fixpoint value (l : form) (x : list R) : R :=
  match l, x with
  | a :: l, y :: x => Q2R a * y + value l x
  | _, _ => 0
  end.

Fixpoint total (q : list term) (x : list R) : R :=
  match q with
  | [] => 0
  | (c, l, r) :: q => Q2R c * value l x * value r x + total q x
  end.

(** Arithmetic of linear forms. Zeros are passed over, as most coefficients are zero. *)
Definition times (a b : Q) : Q :=
  match Qnum a, Qnum b with
  | Z0, _ | _, Z0 => 0%Q
  | _, _ => Qred (a * b)
  end.

Definition plus (a b : Q) : Q :=
  match Qnum a, Qnum b with
  | Z0, _ => b
  | _, Z0 => a
  | _, _ => Qred (a + b)
  end.

Fixpoint add (l r : form) : form :=
  match l, r with
  | [], _ => r
  | _, [] => l
  | a :: l, b :: r => plus a b :: add l r
  end.

Definition scale (c : Q) (l : form) : form := map (times c) l.

Lemma zero_numerator : forall a, Qnum a = 0%Z -> Q2R a = 0.
Proof. intros a H. unfold Q2R. rewrite H. simpl. ring. Qed.

Lemma times_correct : forall a b, Q2R (times a b) = Q2R a * Q2R b.
Proof.
  intros a b. unfold times.
  destruct (Qnum a) eqn:A; [rewrite (zero_numerator a A); unfold Q2R; simpl; ring | |];
    (destruct (Qnum b) eqn:B; [rewrite (zero_numerator b B); unfold Q2R; simpl; ring | |]);
    rewrite <- Q2R_mult; apply Qeq_eqR, Qred_correct.
Qed.

Lemma plus_correct : forall a b, Q2R (plus a b) = Q2R a + Q2R b.
Proof.
  intros a b. unfold plus.
  destruct (Qnum a) eqn:A; [rewrite (zero_numerator a A); ring | |];
    (destruct (Qnum b) eqn:B; [rewrite (zero_numerator b B); ring | |]);
    rewrite <- Q2R_plus; apply Qeq_eqR, Qred_correct.
Qed.

Lemma add_correct : forall l r x, value (add l r) x = value l x + value r x.
Proof.
  induction l as [|a l IH]; intros r x; [simpl; ring|].
  destruct r as [|b r]; [simpl; destruct x; simpl; ring|].
  destruct x as [|y x]; [simpl; ring|].
  simpl. rewrite IH, plus_correct. ring.
Qed.

Lemma scale_correct : forall c l x, value (scale c l) x = Q2R c * value l x.
Proof.
  intros c. induction l as [|a l IH]; intros x; [simpl; ring|].
  destruct x as [|y x]; [simpl; ring|].
  simpl. rewrite IH, times_correct. ring.
Qed.

Lemma total_app : forall p q x, total (p ++ q) x = total p x + total q x.
Proof.
  induction p as [|[[c l] r] p IH]; intros q x; simpl; [ring|]. rewrite IH. ring.
Qed.

(** * Triangles: the upper half of a symmetric matrix of whole numbers, row by row. *)

Definition triangle := list (list Z).

Fixpoint inner (b : list Z) (x : list R) : R :=
  match b, x with
  | a :: b, y :: x => IZR a * y + inner b x
  | _, _ => 0
  end.

(** xᵀ M x. *)
Fixpoint quadratic (t : triangle) (x : list R) : R :=
  match t, x with
  | (a :: b) :: t, y :: x => IZR a * y * y + 2 * y * inner b x + quadratic t x
  | _, _ => 0
  end.

Fixpoint shaped (t : triangle) : bool :=
  match t with
  | [] => true
  | row :: t => (length row =? S (length t))%nat && shaped t
  end.

(** Two rows, entry by entry. *)
Fixpoint both (g : Z -> Z -> Z) (p q : list Z) : list Z :=
  match p, q with
  | a :: p, b :: q => g a b :: both g p q
  | _, _ => []
  end.

(** Each diagonal entry is above the sum of the absolute values of all others in its row and column.
    The list holds those sums of the rows above. *)
Fixpoint dominant (above : list Z) (t : triangle) : bool :=
  match above, t with
  | [], [] => true
  | c :: above, (a :: b) :: t =>
      ((length b =? length above)%nat && (c + fold_right Z.add 0 (map Z.abs b) <? a)%Z
       && dominant (both Z.add above (map Z.abs b)) t)%bool
  | _, _ => false
  end.

Lemma inner_both : forall g h k row b x,
  length row = length b ->
  (forall m e, IZR (g m e) = h * IZR m + k * IZR e) ->
  inner (both g row b) x = h * inner row x + k * inner b x.
Proof.
  intros g h k row. induction row as [|m row IH]; intros b x L G; destruct b as [|e b]; simpl in *;
    try discriminate; [ring|].
  destruct x as [|y x]; [ring|]. rewrite IH, G; auto. ring.
Qed.

Definition nonzero (x : list R) : Prop := exists y, In y x /\ y <> 0.

Lemma zero_or_not : forall x, nonzero x \/ (forall y, In y x -> y = 0).
Proof.
  induction x as [|y x [[z [I N]]|Z]].
  - right. intros y [].
  - left. exists z. split; [right; exact I|exact N].
  - destruct (Req_dec y 0) as [E|N].
    + right. intros z [<-|I]; auto.
    + left. exists y. split; [left; reflexivity|exact N].
Qed.

(** Σ cᵢ xᵢ². *)
Fixpoint diagonal (c : list Z) (x : list R) : R :=
  match c, x with
  | a :: c, y :: x => IZR a * y * y + diagonal c x
  | _, _ => 0
  end.

Lemma diagonal_both : forall c b x, length c = length b ->
  diagonal (both Z.add c b) x = diagonal c x + diagonal b x.
Proof.
  induction c as [|a c IH]; intros [|e b] x L; simpl in *; try discriminate; [ring|].
  destruct x as [|y x]; [ring|]. injection L as L. rewrite IH, plus_IZR by exact L. ring.
Qed.

(** 2 y (b·x) >= - (Σ|bᵢ|) y² - Σ|bᵢ| xᵢ². *)
Lemma cross_term : forall b y x,
  - IZR (fold_right Z.add 0 (map Z.abs b))%Z * (y * y) - diagonal (map Z.abs b) x <= 2 * y * inner b x.
Proof.
  induction b as [|a b IH]; intros y x; cbn [map fold_right diagonal inner].
  - destruct x; lra.
  - assert (P : 0 <= IZR (Z.abs a)) by (apply IZR_le; lia).
    pose proof (Rle_0_sqr y) as Y. unfold Rsqr in Y.
    destruct x as [|z x].
    + specialize (IH y []). rewrite plus_IZR.
      assert (E : inner b [] = 0) by (destruct b; reflexivity). rewrite E in IH.
      assert (E2 : diagonal (map Z.abs b) [] = 0) by (destruct b; reflexivity). rewrite E2 in IH.
      pose proof (Rmult_le_pos _ _ P Y). lra.
    + specialize (IH y x). rewrite plus_IZR.
      assert (A : IZR (Z.abs a) = IZR a \/ IZR (Z.abs a) = - IZR a).
      { destruct (Z.abs_eq_or_opp a) as [->| ->]; [left; reflexivity|right; apply opp_IZR]. }
      pose proof (Rle_0_sqr (y + z)) as S. pose proof (Rle_0_sqr (y - z)) as D. unfold Rsqr in *.
      assert (- IZR (Z.abs a) * (y * y) - IZR (Z.abs a) * z * z <= 2 * y * (IZR a * z)).
      { destruct A as [A|A]; rewrite A in *.
        - pose proof (Rmult_le_pos _ _ P S). lra.
        - pose proof (Rmult_le_pos _ _ P D). lra. }
      lra.
Qed.

Lemma dominant_sound : forall t c x, dominant c t = true -> length x = length c ->
  diagonal c x <= quadratic t x /\ (nonzero x -> diagonal c x < quadratic t x).
Proof.
  induction t as [|row t IH]; intros [|e c] x D L; simpl in *; try discriminate.
  - destruct x; [|discriminate]. simpl. split; [lra|]. intros [y [[] _]].
  - destruct row as [|a b]; [discriminate|].
    apply andb_prop in D. destruct D as [D T]. apply andb_prop in D. destruct D as [B D].
    apply Nat.eqb_eq in B. apply Z.ltb_lt, IZR_lt in D. rewrite plus_IZR in D.
    destruct x as [|y x]; [discriminate|]. simpl in L. injection L as L.
    assert (M : length c = length (map Z.abs b)) by (rewrite map_length; congruence).
    assert (N : length x = length (both Z.add c (map Z.abs b))).
    { rewrite L. clear - M. revert M. generalize (map Z.abs b). induction c; intros [|z l] H;
        simpl in *; try discriminate; auto. }
    destruct (IH _ x T N) as [H1 H2]. rewrite diagonal_both in H1, H2 by exact M.
    pose proof (cross_term b y x) as C. pose proof (Rle_0_sqr y) as Y. unfold Rsqr in Y.
    set (s := IZR (fold_right Z.add 0%Z (map Z.abs b))) in *.
    assert (G : 0 <= (IZR a - IZR e - s) * (y * y)) by (apply Rmult_le_pos; lra).
    split; [lra|]. intros [z [[<-|I] NZ]].
    + assert (0 < (IZR a - IZR e - s) * (y * y)).
      { apply Rmult_lt_0_compat; [lra|]. apply Rsqr_pos_lt in NZ. exact NZ. }
      lra.
    + assert (nonzero x) by (exists z; auto). specialize (H2 H). lra.
Qed.

(** Two triangles, entry by entry. *)
Fixpoint combined (g : Z -> Z -> Z) (p q : triangle) : triangle :=
  match p, q with
  | a :: p, b :: q => both g a b :: combined g p q
  | _, _ => []
  end.

Lemma combined_correct : forall g h k p q x,
  (forall m e, IZR (g m e) = h * IZR m + k * IZR e) ->
  shaped p = true -> shaped q = true -> length p = length q ->
  quadratic (combined g p q) x = h * quadratic p x + k * quadratic q x.
Proof.
  intros g h k. induction p as [|a p IH]; intros [|b q] x G S T L; simpl in *; try discriminate; [ring|].
  apply andb_prop in S. destruct S as [S1 S]. apply Nat.eqb_eq in S1.
  apply andb_prop in T. destruct T as [T1 T]. apply Nat.eqb_eq in T1. injection L as L.
  destruct a as [|m a]; [discriminate|]. destruct b as [|e b]; [discriminate|].
  destruct x as [|y x]; simpl; [ring|]. simpl in S1, T1.
  rewrite IH by assumption. rewrite (inner_both _ h k) by (assumption || lia). rewrite G. ring.
Qed.

(** What is left of k M when d (r·x)² is taken away, for each of a list of d >= 0 and rows r. *)
Fixpoint outer (d : Z) (r : list Z) : triangle :=
  match r with
  | [] => []
  | a :: s => map (fun b => d * a * b)%Z r :: outer d s
  end.

Lemma inner_map : forall k r x, inner (map (fun b => k * b)%Z r) x = IZR k * inner r x.
Proof.
  intros k. induction r as [|a r IH]; intros [|y x]; simpl; try ring. rewrite IH, mult_IZR. ring.
Qed.

Lemma outer_correct : forall d r x, quadratic (outer d r) x = IZR d * inner r x * inner r x.
Proof.
  intros d. induction r as [|a r IH]; intros [|y x]; cbn [outer quadratic inner map]; try ring.
  rewrite IH, inner_map, !mult_IZR. ring.
Qed.

Definition squares := list (Z * list Z).

Fixpoint remainder (n : nat) (hint : squares) (t : triangle) : option triangle :=
  match hint with
  | [] => Some t
  | (d, r) :: hint =>
      if ((0 <=? d)%Z && shaped t && (length t =? n)%nat && (length r =? n)%nat)%bool
      then remainder n hint (combined Z.sub t (outer d r)) else None
  end.

Lemma outer_shaped : forall d r, shaped (outer d r) = true /\ length (outer d r) = length r.
Proof.
  intros d. induction r as [|a r [S L]]; [split; reflexivity|].
  cbn [outer shaped length]. rewrite S, L. split; [|reflexivity].
  rewrite map_length. cbn [length]. rewrite Nat.eqb_refl. reflexivity.
Qed.

Lemma remainder_sound : forall n hint t r x,
  remainder n hint t = Some r -> quadratic r x <= quadratic t x.
Proof.
  intros n. induction hint as [|[d row] hint IH]; intros t r x H; cbn [remainder] in H.
  - injection H as <-. lra.
  - destruct (_ && _)%bool eqn:B in H; [|discriminate].
    repeat (apply andb_prop in B; destruct B as [B ?]). apply Z.leb_le, IZR_le in B.
    repeat match goal with E : (_ =? _)%nat = true |- _ => apply Nat.eqb_eq in E end.
    destruct (outer_shaped d row) as [S L]. apply IH with (x := x) in H.
    rewrite (combined_correct Z.sub 1 (-1)) in H; try congruence.
    2:{ intros. rewrite minus_IZR. ring. }
    rewrite outer_correct in H.
    pose proof (Rle_0_sqr (inner row x)) as Q. unfold Rsqr in Q.
    pose proof (Rmult_le_pos _ _ B Q). lra.
Qed.

Definition multiplied (k : Z) (t : triangle) : triangle := map (map (fun b => k * b)%Z) t.

Lemma multiplied_correct : forall k t x, quadratic (multiplied k t) x = IZR k * quadratic t x.
Proof.
  intros k. induction t as [|[|a b] t IH]; intros [|y x]; cbn [multiplied map quadratic]; try ring.
  rewrite IH, inner_map, mult_IZR. ring.
Qed.

(** k M less the squares of the hint is dominated by its diagonal. *)
Definition definite (n : nat) (k : Z) (hint : squares) (t : triangle) : bool :=
  (0 <? k)%Z &&
  match remainder n hint (multiplied k t) with
  | Some r => dominant (repeat 0%Z n) r
  | None => false
  end.

Lemma diagonal_zero : forall n x, diagonal (repeat 0%Z n) x = 0.
Proof. induction n as [|n IH]; intros [|y x]; simpl; try reflexivity. rewrite IH. ring. Qed.

Theorem definite_sound : forall n k hint t x,
  definite n k hint t = true -> length x = n -> nonzero x -> 0 < quadratic t x.
Proof.
  intros n k hint t x D L N. unfold definite in D. apply andb_prop in D. destruct D as [K D].
  apply Z.ltb_lt, IZR_lt in K. destruct (remainder _ _ _) as [r|] eqn:R; [|discriminate].
  apply remainder_sound with (x := x) in R. rewrite multiplied_correct in R.
  destruct (dominant_sound r _ x D) as [_ P]; [rewrite repeat_length; exact L|].
  specialize (P N). rewrite diagonal_zero in P.
  apply Rmult_lt_reg_l with (IZR k); lra.
Qed.

(** * From terms to a triangle. *)

(** The triangle of scale times twice c (l·x)(r·x): entries c (l_i r_j + l_j r_i). *)

Definition whole (s : Z) (a : Q) : Z := (Qnum a * (s / Zpos (Qden a)))%Z.

Definition fits (s : Z) (a : Q) : bool :=
  match Qnum a with Z0 => true | _ => (Zpos (Qden a) * (s / Zpos (Qden a)) =? s)%Z end.

Lemma whole_correct : forall s a, fits s a = true -> IZR (whole s a) = IZR s * Q2R a.
Proof.
  intros s a H. unfold whole, fits in *. destruct (Qnum a) eqn:A.
  - rewrite (zero_numerator a A). simpl. ring.
  - apply Z.eqb_eq in H. rewrite <- A in *. unfold Q2R. rewrite mult_IZR.
    rewrite <- H at 2. rewrite mult_IZR.
    assert (IZR (Zpos (Qden a)) <> 0) by (apply not_0_IZR; discriminate). field. assumption.
  - apply Z.eqb_eq in H. rewrite <- A in *. unfold Q2R. rewrite mult_IZR.
    rewrite <- H at 2. rewrite mult_IZR.
    assert (IZR (Zpos (Qden a)) <> 0) by (apply not_0_IZR; discriminate). field. assumption.
Qed.

Definition entry (c a b y z : Q) : Q := times c (plus (times a z) (times b y)).

Fixpoint entries (c a b : Q) (l r : form) : list Q :=
  match l, r with
  | y :: l, z :: r => entry c a b y z :: entries c a b l r
  | _, _ => []
  end.

Fixpoint product (s : Z) (c : Q) (l r : form) : triangle :=
  match l, r with
  | a :: l', b :: r' => map (whole s) (entries c a b l r) :: product s c l' r'
  | _, _ => []
  end.

Fixpoint product_fits (s : Z) (c : Q) (l r : form) : bool :=
  match l, r with
  | a :: l', b :: r' => (forallb (fits s) (entries c a b l r) && product_fits s c l' r')%bool
  | _, _ => true
  end.

Lemma entries_correct : forall s c a b l r x,
  length l = length r -> forallb (fits s) (entries c a b l r) = true ->
  inner (map (whole s) (entries c a b l r)) x =
    IZR s * Q2R c * (Q2R a * value r x + Q2R b * value l x).
Proof.
  intros s c a b. induction l as [|y l IH]; intros [|z r] x L F; simpl in *; try discriminate; [ring|].
  apply andb_prop in F. destruct F as [F G]. injection L as L.
  destruct x as [|v x]; [ring|].
  rewrite (IH r x L G), (whole_correct s _ F). unfold entry.
  rewrite times_correct, plus_correct, !times_correct. ring.
Qed.

Lemma product_correct : forall s c l r x,
  length l = length r -> product_fits s c l r = true ->
  quadratic (product s c l r) x = 2 * IZR s * Q2R c * value l x * value r x.
Proof.
  intros s c. induction l as [|a l IH]; intros [|b r] x L F; simpl in *; try discriminate; [ring|].
  apply andb_prop in F. destruct F as [F G]. apply andb_prop in F. destruct F as [F1 F].
  injection L as L. destruct x as [|y x]; [ring|].
  rewrite (IH r x L G), (entries_correct s c a b l r x L F), (whole_correct s _ F1). unfold entry.
  rewrite times_correct, plus_correct, !times_correct. ring.
Qed.

Fixpoint zeros (n : nat) : triangle :=
  match n with O => [] | S m => repeat 0%Z n :: zeros m end.

Lemma zeros_correct : forall n x, quadratic (zeros n) x = 0.
Proof.
  assert (I : forall n x, inner (repeat 0%Z n) x = 0).
  { induction n as [|n IH]; intros [|y x]; simpl; try reflexivity. rewrite IH. ring. }
  induction n as [|n IH]; intros [|y x]; simpl; try reflexivity. rewrite IH, I. ring.
Qed.

(** The matrix of a sum of terms, times twice s; [None] where s does not make it integral. *)
Fixpoint matrix (n : nat) (s : Z) (q : list term) : option triangle :=
  match q with
  | [] => Some (zeros n)
  | (c, l, r) :: q =>
      match matrix n s q with
      | Some t =>
          let p := product s c l r in
          if (product_fits s c l r && (length l =? n)%nat && (length r =? n)%nat && shaped p
              && shaped t && (length t =? n)%nat && (length p =? n)%nat)%bool
          then Some (combined Z.add p t) else None
      | None => None
      end
  end.

Lemma matrix_correct : forall n s q t x,
  matrix n s q = Some t -> quadratic t x = 2 * IZR s * total q x.
Proof.
  intros n s. induction q as [|[[c l] r] q IH]; intros t x H; cbn [matrix total] in *.
  - injection H as <-. rewrite zeros_correct. ring.
  - destruct (matrix n s q) as [u|]; [|discriminate].
    destruct (_ && _)%bool eqn:B in H; [|discriminate]. injection H as <-.
    repeat (apply andb_prop in B; destruct B as [B ?]).
    repeat match goal with E : (_ =? _)%nat = true |- _ => apply Nat.eqb_eq in E end.
    rewrite (combined_correct Z.add 1 1); try congruence.
    2:{ intros. rewrite plus_IZR. ring. }
    rewrite product_correct by congruence. rewrite (IH u x eq_refl). ring.
Qed.

(** What makes a sum of terms integral, and its matrix times k a sum of squares and of what is dominated by
    its diagonal. None of it is believed: [positive] tests it. *)
Record hint := Hint { scaling : Z; times_more : Z; parts : squares }.

Definition positive (n : nat) (h : hint) (q : list term) : bool :=
  (0 <? scaling h)%Z &&
  match matrix n (scaling h) q with
  | Some t => definite n (times_more h) (parts h) t
  | None => false
  end.

Theorem positive_sound : forall n h q x,
  positive n h q = true -> length x = n -> nonzero x -> 0 < total q x.
Proof.
  intros n h q x H L N. unfold positive in H. apply andb_prop in H. destruct H as [S H].
  apply Z.ltb_lt, IZR_lt in S. destruct (matrix n (scaling h) q) as [t|] eqn:M; [|discriminate].
  pose proof (definite_sound n _ _ t x H L N) as P. rewrite (matrix_correct n _ q t x M) in P.
  apply Rmult_lt_reg_l with (2 * IZR (scaling h)); [lra|]. lra.
Qed.
