/* Hash every bit that the firmware puts out, over random inputs and over a closed loop.
 * Compiled for the host and for the target; both must print the same. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "vehicle.h"
#include "firmware_names.h" /* params_t, step, ... for the prefix of this package */

static uint64_t hash = 14695981039346656037u;

static void take(const void *data, size_t size) {
  const unsigned char *bytes = data;
  for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * 1099511628211u;
}

static void show(const char *what) {
  printf("%s %08lx%08lx\n", what, (unsigned long)(hash >> 32), (unsigned long)(uint32_t)hash);
}

static uint64_t seed = 88172645463325252u;

static real uniform(real low, real high) {
  seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
  return low + (high - low) * ((real)(int32_t)(seed >> 42) / (real)4194304);
}

static void random_step(void) {
  params_t params;
  state_t state = {uniform((real)-60, (real)60)};
  input_t in;
  output_t out;
  init(&params);
  real *numbers = (real *)(void *)&in; /* image or centroid, then nine more, then dt */
  const size_t n = offsetof(input_t, velocity) / sizeof(real);
  for (size_t i = 0; i < n; i++) numbers[i] = uniform((real)-3, (real)3);
  for (int i = 0; i < 3; i++) {
    in.velocity[i] = uniform((real)-18, (real)18);
    in.rate[i] = uniform((real)-20, (real)20);
    in.gravity_direction[i] = uniform((real)-0.6, (real)0.6);
  }
  in.gravity_direction[2] += (real)0.7;
#if FELT
  for (int i = 0; i < 3; i++) in.specific_force[i] = uniform((real)-8, (real)8);
  in.specific_force[2] -= (real)8;
#endif
  in.dt = uniform((real)0, (real)0.1);
  in.target_seen = (uint32_t)(seed % 64u != 0u);
  const uint32_t status = step(&params, &state, &in, &out);
  take(&status, sizeof status);
  take(&state, sizeof state);
  take(&out, sizeof out);
}

int main(void) {
  printf("selftest %u\n", (unsigned)selftest());
  for (int i = 0; i < 10000; i++) random_step();
  show("random");

  params_t params;
  state_t state;
  input_t in;
  output_t out;
  vehicle_t vehicle;
  init(&params);
  reset_state(&params, &state, (real)HOVER);
  vehicle_start(&vehicle);
  for (int k = 0; k < STEPS; k++) {
    vehicle_sense(&vehicle, &in);
    in.dt = (real)0.001;
    const uint32_t status = step(&params, &state, &in, &out);
    take(&status, sizeof status);
    take(&out, sizeof out);
    vehicle_step(&vehicle, &out, 0.001);
    take(&vehicle, sizeof vehicle);
  }
  show("loop");
  printf("at %.17g %.17g %.17g\n", vehicle.x[0], vehicle.x[1], vehicle.x[2]);
  return 0;
}
