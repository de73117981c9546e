(* Decide certificates, as `literals.py --plain` writes them, by the program extracted from Coq.
   Standard input: for each its kind, its name, its rationals and its hints. Prints the name and what holds. Of
   gains, with a target if there is one: certificate_ok, and target_ok or given_ok (a "-" where neither is asked).
   Of vehicles within tolerances: matrices_ok, memory_ok, limits_ok, settled_ok and start_ok of all its starts.
   Of regions of attraction: region_ok. *)
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

let hint n =
  let scaling = whole () in
  let times_more = whole () in
  let row () =
    let d = whole () in
    (d, times n whole)
  in
  let rows = count () in
  { scaling; times_more; parts = times rows row }

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
      let hint_low = hint 11 in
      let hint_high = hint 11 in
      { its; low; high; thrust_low; thrust_high; q1_low; q1_high; q2_low; q2_high; q3_low; q3_high;
        f_low; f_high; margin; tau_low; tau_high; hint_low; hint_high }
  | _ -> failwith "too few numbers"

let pair () =
  let a = rational () in
  (a, rational ())

let target () =
  let counted () =
    let k = rational () in
    (k, place ())
  in
  let points_of = times (count ()) counted in
  let goal = place () in
  { points_of; goal; roots = times (count ()) pair }

let gains () =
  let c = certificate () in
  let seen =
    match word () with
    | "target" -> string_of_bool (target_ok (target ()) c)
    | "given" -> string_of_bool (given_ok (place ()) c)
    | _ -> "-"
  in
  [ string_of_bool (certificate_ok c); seen ]

let matrices () =
  match times 15 rational with
  | [ kap; stiff; k12; speed; v2; v3; v4; a5; a6; pace; spent; regained; ball_low; ball_high; ball_price ] ->
      let its_constants = { kap; stiff; k12; speed; v2; v3; v4; a5; a6; pace; spent; regained } in
      let prices = times 8 pair in
      let radii_of = times 8 rational in
      let chis = pair () in
      let drags = pair () in
      let gains_of = pair () in
      let lag_most = rational () in
      let pi_most = rational () in
      let hints_of = times (count ()) (fun () -> hint 20) in
      { its_constants; ball_low; ball_high; ball_price; prices; radii_of; chis; drags; gains_of; lag_most;
        pi_most; hints_of }
  | _ -> failwith "too few numbers"

let limits () =
  match times 19 rational with
  | [ thrust_off; torque_off; gyroscopic; windy; yawing; latest; keeps; level_of; start_of; spread; sink; turn_most;
      fast; lever_least; quick; missed; sinks_most; cross_most; far ] ->
      { thrust_off; torque_off; gyroscopic; windy; yawing; latest; keeps; level_of; start_of; spread; sink; turn_most;
        fast; lever_least; quick; missed; sinks_most; cross_most; far }
  | _ -> failwith "too few numbers"

let setting () =
  match times 6 rational with
  | [ m_of; k1_of; k2_of; k3_of; k4_of; g_of ] -> { m_of; k1_of; k2_of; k3_of; k4_of; g_of }
  | _ -> failwith "too few numbers"

let settling () =
  match times 4 rational with
  | [ near_off; after; sixtyfourth; first_power ] ->
      { near_off; after; sixtyfourth; first_power; powers = times 6 rational }
  | _ -> failwith "too few numbers"

let start () =
  match times 9 rational with
  | [ off_by; level_off; speed0; force0; rate0; cosine; lean; flat1; turn0 ] ->
      { off_by; level_off; speed0; force0; rate0; cosine; lean; flat1; turn0 }
  | _ -> failwith "too few numbers"

let tolerant () =
  let c = matrices () in
  let n = setting () in
  let b = limits () in
  let z = settling () in
  let starts = times (count ()) start in
  List.map string_of_bool
    [ matrices_ok c; memory_ok b.keeps b.latest c; limits_ok n b c; settled_ok b c z;
      List.for_all (start_ok n b c) starts ]

let region () =
  match times 12 rational with
  | [ r_mass; r_k1; r_k2; r_k3; r_k4; r_grav; r_a2; r_a3; r_a4; r_high; r_rate; r_tilt ] ->
      let r_f = pair () in
      let r_q3 = pair () in
      let r_tau = pair () in
      let hint_low = hint 11 in
      let r_hints = (hint_low, hint 11) in
      [ string_of_bool
          (region_ok
             { r_mass; r_k1; r_k2; r_k3; r_k4; r_grav; r_a2; r_a3; r_a4; r_high; r_rate; r_tilt; r_f; r_q3; r_tau;
               r_hints }) ]
  | _ -> failwith "too few numbers"

let rec decide () =
  match word () with
  | "" -> ()
  | kind ->
      let name = word () in
      let said =
        match kind with "gains" -> gains () | "region" -> region () | _ -> tolerant ()
      in
      Printf.printf "%s %s\n%!" name (String.concat " " said);
      decide ()

let () = decide ()
