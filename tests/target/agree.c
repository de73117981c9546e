/* Compare the exported step with the one by hand: the largest difference over the scale. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "firmware_names.h"

uint32_t hand_step(const params_t *, state_t *, const input_t *, output_t *);

static uint64_t seed = 88172645463325252u;

static float uniform(float low, float high) {
  seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
  return low + (high - low) * ((float)(int32_t)(seed >> 42) / 4194304.0f);
}

int main(void) {
  double worst[10] = {0}, scale[10] = {0};
  const int calls = 100000;
  params_t params;
  init(&params);
  for (int k = 0; k < calls; k++) {
    input_t in;
    output_t a, b;
    state_t s, t;
    for (int i = 0; i < 4; i++) {
      in.image[i][0] = uniform(-1, 1);
      in.image[i][1] = uniform(-1, 1);
    }
    for (int i = 0; i < 3; i++) {
      in.velocity[i] = uniform(-2, 2);
      in.rate[i] = uniform(-2, 2);
      in.gravity_direction[i] = i == 2 ? uniform(0.85f, 1.05f) : uniform(-0.2f, 0.2f);
    }
    in.dt = uniform(0.0f, 0.02f) + 1e-4f;
    in.target_seen = k % 50 != 0;
    s.thrust_excess = t.thrust_excess = uniform(-60, 20);
    const uint32_t x = step(&params, &s, &in, &a), y = hand_step(&params, &t, &in, &b);
    if ((x & ~S_SATURATED) != (y & ~S_SATURATED)) {
      printf("status %u against %u in call %d\n", (unsigned)x, (unsigned)y, k);
      return 1;
    }
    if ((x | y) & S_FAULT) continue;
    const float of_a[10] = {a.thrust,   a.thrust_rate, a.torque[0], a.torque[1], a.torque[2],
                            a.rotor[0], a.rotor[1],    a.rotor[2],  a.rotor[3],  s.thrust_excess};
    const float of_b[10] = {b.thrust,   b.thrust_rate, b.torque[0], b.torque[1], b.torque[2],
                            b.rotor[0], b.rotor[1],    b.rotor[2],  b.rotor[3],  t.thrust_excess};
    for (int i = 0; i < 10; i++) {
      worst[i] = fmax(worst[i], fabs((double)of_a[i] - (double)of_b[i]));
      scale[i] = fmax(scale[i], fabs((double)of_a[i]));
    }
  }
  double largest = 0.0;
  for (int i = 0; i < 10; i++) largest = fmax(largest, worst[i] / scale[i]);
  printf("%d %g\n", calls, largest);
  return 0;
}
