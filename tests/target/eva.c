/* For Frama-C Eva: the law, and a whole step, over every input of a box. */
#include "__fc_builtin.h"

#include "firmware_names.h"
#include SOURCE

static real any(double reach) {
  return (real)Frama_C_double_interval(-reach, reach);
}

static void fill(input_t *in, double wider) {
  real *numbers = (real *)(void *)in;
  const int n = (int)(offsetof(input_t, velocity) / sizeof(real));
  for (int i = 0; i < n; i++) numbers[i] = any(IMAGE_REACH * wider);
  for (int i = 0; i < 3; i++) {
    in->velocity[i] = any(SPEED_REACH * wider);
    in->rate[i] = any(RATE_REACH * wider);
    in->gravity_direction[i] = any(DOWN_REACH * wider);
  }
#if FELT
  for (int i = 0; i < 3; i++) in->specific_force[i] = any(160.0 * wider);
#endif
  in->dt = any(wider);
  in->target_seen = Frama_C_unsigned_int_interval(0u, 1u);
}

/* The law alone over the certified box, or over one that holds the singularity. */
void law_over_box(void) {
  input_t in;
  output_t out;
  fill(&in, 1.0);
  control_law(LAW_PARAMS &in, (real)Frama_C_double_interval(EXCESS_FROM, EXCESS_TO), &out);
}

/* A step from any state on any finite input of up to 1e12 times the box: its own checks hold. */
void step_on_anything(void) {
  params_t params;
  state_t state;
  input_t in;
  output_t out;
  init(&params);
  state.thrust_excess = any(1e15);
  fill(&in, 1e12);
  (void)step(&params, &state, &in, &out);
}
