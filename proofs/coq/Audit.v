(** What the theorems rest on: `make` compares what this prints with allowed.txt. *)
From Hoverproof Require Import Gains Target Body Decay.
Definition all_of_them := (gains_sound, target_sound, errors_obey, lyapunov_decays).
Print Assumptions all_of_them.
