(** What the theorems rest on: `make` compares what this prints with allowed.txt. *)
From Hoverproof Require Import Gains Target Body Decay.
Print Assumptions gains_sound.
Print Assumptions target_sound.
Print Assumptions errors_obey.
Print Assumptions lyapunov_decays.
