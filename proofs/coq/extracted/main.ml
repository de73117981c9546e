(* Decide certificates of gains, as `literals.py --plain` writes them, by the program extracted from Coq.
   Standard input: for each, its name, its rationals, its hints, and its target if it has one. Prints the
   name and whether certificate_ok holds, and target_ok or given_ok (a "-" where neither is asked). *)
open Decide

let tokens = Scanf.Scanning.stdin
let word () = Scanf.bscanf tokens " %s" (fun s -> s)
let whole () = Big_int_Z.big_int_of_string (word ())
let count () = int_of_string (word ())

let rational () =
  match String.split_on_char '/' (word ()) with
  | [ p ] -> { qnum = Big_int_Z.big_int_of_string p; qden = Big_int_Z.unit_big_int }
  | [ p; d ] -> { qnum = Big_int_Z.big_int_of_string p; qden = Big_int_Z.big_int_of_string d }
  | _ -> failwith "not a rational number"

(* In the order in which they stand: List.init promises none. *)
let rec times n f = if n = 0 then [] else let x = f () in x :: times (n - 1) f

let hint () =
  let scaling = whole () in
  let times_more = whole () in
  let row () =
    let d = whole () in
    (d, times 11 whole)
  in
  let n = count () in
  { scaling; times_more; parts = times n row }

let place () =
  let x = rational () in
  let y = rational () in
  let z = rational () in
  ((x, y), z)

let certificate () =
  match times 24 rational with
  | [ qmass; qk1; qk2; qk3; qk4; qw1; qw2; qw3; qw4; low; high; thrust_low; thrust_high; q1_low;
      q1_high; q2_low; q2_high; q3_low; q3_high; f_low; f_high; margin; tau_low; tau_high ] ->
      let its = { qmass; qk1; qk2; qk3; qk4; qw1; qw2; qw3; qw4 } in
      let hint_low = hint () in
      let hint_high = hint () in
      { its; low; high; thrust_low; thrust_high; q1_low; q1_high; q2_low; q2_high; q3_low; q3_high;
        f_low; f_high; margin; tau_low; tau_high; hint_low; hint_high }
  | _ -> failwith "too few numbers"

let target () =
  let counted () =
    let k = rational () in
    (k, place ())
  in
  let points_of = times (count ()) counted in
  let goal = place () in
  let pair () =
    let a = rational () in
    (a, rational ())
  in
  { points_of; goal; roots = times (count ()) pair }

let rec decide () =
  match word () with
  | "" -> ()
  | name ->
      let c = certificate () in
      let seen =
        match word () with
        | "target" -> string_of_bool (target_ok (target ()) c)
        | "given" -> string_of_bool (given_ok (place ()) c)
        | _ -> "-"
      in
      Printf.printf "%s %b %s\n%!" name (certificate_ok c) seen;
      decide ()

let () = decide ()
