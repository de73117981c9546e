/* For Frama-C Eva: the law, and a whole step, over every input of a box. */
#include "__fc_builtin.h"

#include "firmware_names.h"
#include SOURCE

#define NUMBERS ((int)(offsetof(input_t, target_seen) / sizeof(real)))

static real any(double reach) {
  return (real)Frama_C_double_interval(-reach, reach);
}

static real root_of(double square) {
  return (real)sqrt(square);
}

/* The largest that each number of an input can be where the squares of its vector are in the box. */
static void reach_of(input_t *most) {
  real *numbers = (real *)(void *)most;
  const int n = (int)(offsetof(input_t, velocity) / sizeof(real));
  for (int i = 0; i < n; i++) numbers[i] = root_of(SEEN_SQUARE);
  for (int i = 0; i < 3; i++) {
    most->velocity[i] = root_of(P_SPEED_SQUARE);
    most->rate[i] = root_of(P_RATE_SQUARE);
    most->gravity_direction[i] = root_of(P_DIRECTION_HIGH);
#if FELT
    most->specific_force[i] = root_of(P_FORCE_SQUARE);
#endif
  }
  most->dt = (real)1;
}

static void fill(input_t *in, double wider) {
  input_t most;
  reach_of(&most);
  const real *reach = (const real *)(const void *)&most;
  real *numbers = (real *)(void *)in;
  for (int i = 0; i < NUMBERS; i++) numbers[i] = any((double)reach[i] * wider);
  in->target_seen = Frama_C_unsigned_int_interval(0u, 1u);
}

/* Take an input apart by which number is the first that is out of a range: Eva looks at each case.
 * A macro, for at the end of a function the cases would be one again. */
#define SPLIT(numbers, i, count, edge)         \
  for (i = 0; i < (count); i++) {              \
    if ((numbers)[i] > (edge)) break;          \
    if ((numbers)[i] < -(edge)) break;         \
  }

#if SIZED && !SENSED_POINTS
/* A centroid that the firmware takes for one of a target has a number above this. */
#define LONG_ENOUGH ((real)(0.57 * TARGET_POINTS / 25))
#endif

/* The law alone over the certified box, or over one that holds the singularity. */
void law_over_box(void) {
  input_t in;
  output_t out;
  fill(&in, 1.0);
#ifdef LONG_ENOUGH
  int i;
  SPLIT(in.centroid, i, 3, LONG_ENOUGH)
  if (i == 3) return;
#endif
  control_law(&in, (real)Frama_C_double_interval(EXCESS_FROM, EXCESS_TO),
#if SIZED
              (real)Frama_C_double_interval(P_SPREAD_LOW, TARGET_POINTS * TARGET_POINTS),
#endif
#if FELT
              (real)Frama_C_double_interval(EXCESS_FROM, EXCESS_TO),
#endif
              &out);
}

/* A step from any state on any finite input of up to 1e12 times the box: its own checks hold. */
void step_on_anything(void) {
  params_t params;
  state_t state;
  input_t in, most;
  output_t out;
  int i;
  init(&params);
  state.thrust_excess = any(1e15);
  fill(&in, 1e12);
  reach_of(&most);
  const real *numbers = (const real *)(const void *)&in;
  const real *reach = (const real *)(const void *)&most;
#ifdef LONG_ENOUGH
  SPLIT(in.centroid, i, 3, LONG_ENOUGH)
#endif
  SPLIT(numbers, i, NUMBERS, (real)1.001 * reach[i])
  (void)step(&params, &state, &in, &out);
}
