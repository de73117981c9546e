(** What the theorems rest on: `make` compares what this prints with allowed.txt. *)
From Hoverproof Require Import Gains Target Body Decay Tolerant Late Vehicle Stays Starts Region.
Definition all_of_them := (gains_sound, target_sound, given_sound, errors_obey, no_yaw, accelerometer_ideal,
  lyapunov_decays, level_sound, matrices_sound, tolerant_falls,
  late_remembers, vehicle_obeys, vehicle_stays, start_arrives,
  region_sound).
Print Assumptions all_of_them.
