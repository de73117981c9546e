(** The decisions as a program in OCaml: extracted/decide.ml, with whole numbers of Zarith. *)
From Hoverproof Require Import Gains Target Tolerant Late Stays Starts Region.
Require Import Extraction ExtrOcamlBasic ExtrOcamlNatInt ExtrOcamlZBigInt.
Extraction Language OCaml.
Extraction "extracted/decide.ml" certificate_ok target_ok given_ok
  matrices_ok memory_ok limits_ok start_ok settled_ok region_ok.
