/* Hash every bit of the camera: frames of any age, among them broken ones, and turns of any size.
 * Compiled for the host and for the target; both must print the same. Whatever comes in,
 * what the camera fills in is finite, and no index leaves its array. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "firmware_names.h"
#include CAMERA_HEADER

static uint64_t hash = 14695981039346656037u, seed = 88172645463325252u;

static void take(const void *data, size_t size) {
  const unsigned char *bytes = data;
  for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * 1099511628211u;
}

static uint32_t any(void) {
  seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
  return (uint32_t)(seed >> 32);
}

static real uniform(double low, double high) {
  return (real)(low + (high - low) * ((double)(any() >> 8) / 16777216.0));
}

static real broken(void) {
  static const double bad[] = {NAN, INFINITY, -INFINITY, 1e30, -1e30, 200.0};
  return (real)bad[any() % 6u];
}

static real sometimes(real value) { return any() % 200u == 0u ? broken() : value; }

int main(void) {
  camera_t camera;
  frame_t frame;
  input_t in = {0};
  uint32_t counts[3] = {0u, 0u, 0u}, frames[2] = {0u, 0u};
  (void)camera_init(&camera, (real)0.15);
  for (int k = 0; k < CALLS; k++) {
    if (k % 20000 == 19999) (void)camera_init(&camera, sometimes(uniform(0.05, 0.3)));
    if (any() % 12u == 0u) {
      real *numbers = (real *)(void *)&frame;
      const size_t n = offsetof(frame_t, age) / sizeof(real);
      for (size_t i = 0; i < n; i++) numbers[i] = sometimes(uniform(-0.5, 0.5));
      if (!OF_POINTS) numbers[2] += (real)3.3;
#if HEADED
      for (int i = 0; i < 3; i++)
        frame.gravity_direction[i] = sometimes(i < 2 ? uniform(-0.2, 0.2) : uniform(0.96, 1.0));
#endif
      frame.age = sometimes(uniform(-0.002, 0.16));
      const uint32_t status = camera_frame(&camera, &frame);
      take(&status, sizeof status);
      frames[status != 0u]++;
    }
    for (int i = 0; i < 3; i++) in.rate[i] = any() % 1500u == 0u ? broken() : uniform(-4, 4);
    in.dt = any() % 1500u == 0u ? sometimes((real)0.1) : uniform(0.002, 0.004);
#if HEADED
    for (int i = 0; i < 3; i++) in.gravity_direction[i] = uniform(-0.2, 0.2) + (real)(i == 2);
#endif
    const uint32_t status = camera_turn(&camera, &in);
    counts[status]++;
#if HEADED
    if (!isfinite(in.heading[0]) || !isfinite(in.heading[1])) return 3;
    take(in.heading, sizeof in.heading);
#endif
    for (int i = 0; i < 3; i++)
      if (!isfinite(in.feature[i])) return 1;
    if ((in.target_seen != 0u) != (status == 0u) || camera.newest >= 64u || camera.kept > 64u) return 2;
    take(&status, sizeof status);
    take(in.feature, sizeof in.feature);
  }
  printf("%lu %lu %lu, %lu %lu\n", (unsigned long)counts[0], (unsigned long)counts[1],
         (unsigned long)counts[2], (unsigned long)frames[0], (unsigned long)frames[1]);
  printf("%08lx%08lx\n", (unsigned long)(hash >> 32), (unsigned long)(uint32_t)hash);
  return 0;
}
