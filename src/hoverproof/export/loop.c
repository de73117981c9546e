/* Flies a package with its simulated vehicle; NAME stands for the package's prefix. */
#include "NAME.h"
#include "vehicle.h"

enum { ROTORS = sizeof(((NAME_output_t *)0)->rotor) / sizeof(((NAME_output_t *)0)->rotor[0]) };
enum { ROW = 22 + ROTORS, FAULT = 7 };

/* Writes up to samples + 1 rows (state, thrust, torque, rotors) with their status, one before each
 * `every` steps and one at the end; ends at the first fault. The last status holds every bit that
 * came up. Returns the number of rows. Setting *stop ends it soon. */
long hoverproof_fly(double dt, long samples, long every, double *rows, uint32_t *status,
                    const volatile int *stop) {
  NAME_params_t params;
  NAME_state_t state = {0};
  NAME_input_t in;
  NAME_output_t out;
  vehicle_t vehicle;
  uint32_t *all = &status[samples + 1];
  NAME_init(&params); /* the state is that of hover */
  vehicle_start(&vehicle);
  *all = 0;
  for (long k = 0; k <= samples * every && !*stop; k++) {
    vehicle_sense(&vehicle, &in);
    in.dt = dt;
    const uint32_t now = NAME_step(&params, &state, &in, &out);
    *all |= now;
    if (k % every == 0 || (now & FAULT)) {
      const long row = (k + every - 1) / every;
      double *to = &rows[row * ROW];
      for (int i = 0; i < VEHICLE_STATE; i++) *to++ = vehicle.x[i];
      *to++ = out.thrust;
      for (int i = 0; i < 3; i++) *to++ = out.torque[i];
      for (int i = 0; i < ROTORS; i++) *to++ = out.rotor[i];
      status[row] = now;
      if (now & FAULT) return row + 1;
    }
    vehicle_step(&vehicle, &out, dt);
  }
  return samples + 1;
}
