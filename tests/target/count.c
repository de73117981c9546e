/* Call a step from states and inputs of a mission, to have its instructions counted. */
#include <stdio.h>

#include "vehicle.h"
#include "firmware_names.h"

#ifndef STEP
#define STEP step
#endif
uint32_t STEP(const params_t *, state_t *, const input_t *, output_t *);

int main(void) {
  params_t params;
  state_t state;
  input_t in;
  output_t out;
  vehicle_t vehicle;
  uint32_t status = 0u;
  init(&params);
  reset_state(&params, &state, (real)HOVER);
  vehicle_start(&vehicle);
  for (int k = 0; k < STEPS; k++) {
    vehicle_sense(&vehicle, &in);
    in.rate[0] = (real)0.1;
    in.rate[1] = (real)-0.2;
    in.rate[2] = (real)0.3;
    in.dt = (real)0.001;
    status |= STEP(&params, &state, &in, &out);
  }
  printf("%u\n", (unsigned)status);
  return 0;
}
