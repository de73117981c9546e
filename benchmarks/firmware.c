/* The controller by hand, for a goal on the axis: what a careful engineer would write for a small
 * processor, from the error chain of the paper and with constants worked out beforehand. It has the
 * interface, the checks and the limits of the exported firmware; the numbers come from its header.
 * Compiled with HAND_POINTS, HAND_K1 ... by benchmarks/firmware.py. */
#include <math.h>

#include "firmware_names.h"
#include PARAMS_HEADER

#define MASS (HAND_MASS)
#define WEIGHT (MASS * HAND_GRAVITY)
#define K12 (HAND_K1 * HAND_K2)
#define C (HAND_K1 * HAND_K1 * HAND_K2 / MASS) /* N for one unit of error */
#define BETA (MASS / (C * (K12 + HAND_K3)))

typedef struct { float x, y, z; } vec;

static inline float square(const float a[3]) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

static inline uint32_t hold(float *value, float lowest, float highest) {
  if (*value < lowest) {
    *value = lowest;
    return S_SATURATED;
  }
  if (*value > highest) {
    *value = highest;
    return S_SATURATED;
  }
  return 0u;
}

static void safe(state_t *state, output_t *out) {
  state->thrust_excess = 0.0f;
  out->thrust = WEIGHT;
  out->thrust_rate = 0.0f;
  for (int i = 0; i < 3; i++) out->torque[i] = 0.0f;
  for (int i = 0; i < 4; i++) out->rotor[i] = WEIGHT / 4.0f;
}

uint32_t hand_step(const params_t *params, state_t *state, const input_t *in, output_t *out) {
  const float excess = state->thrust_excess;
  const float wx = in->rate[0], wy = in->rate[1], wz = in->rate[2];

  /* Image centroid, and the sum of squares that the check needs. */
  float all = 0.0f;
  vec q = {0.0f, 0.0f, 0.0f};
#pragma GCC unroll 8
  for (int i = 0; i < HAND_POINTS; i++) {
    const float x = in->image[i][0], y = in->image[i][1];
    const float r2 = x * x + y * y;
    const float inverse = 1.0f / sqrtf(1.0f + r2);
    all += r2;
    q.x += x * inverse;
    q.y += y * inverse;
    q.z += inverse;
  }

  const float down = square(in->gravity_direction);
  uint32_t status = 0u;
  if (!(all <= HAND_IMAGE && square(in->velocity) <= HAND_SPEED && square(in->rate) <= HAND_RATE &&
        down >= HAND_DOWN_LOW && down <= HAND_DOWN_HIGH && in->dt > 0.0f && in->dt <= HAND_DT))
    status |= S_INPUT;
  if (in->target_seen == 0u) status |= S_TARGET;
  if (!(excess > HAND_FLOOR && excess <= HAND_CEILING)) status |= S_SINGULAR;
  if (status & S_FAULT) {
    safe(state, out);
    return status;
  }

  /* Errors (eqs. 10, 17, 18) and force, T = m g + excess. */
  const vec d1 = {q.x, q.y, q.z - HAND_GOAL};
  const vec d2 = {MASS / HAND_K1 * in->velocity[0] - d1.x, MASS / HAND_K1 * in->velocity[1] - d1.y,
                  MASS / HAND_K1 * in->velocity[2] - d1.z};
  const vec F = {WEIGHT * in->gravity_direction[0], WEIGHT * in->gravity_direction[1],
                 WEIGHT * (in->gravity_direction[2] - 1.0f) - excess};
  const vec d3 = {1.0f / C * F.x + d2.x, 1.0f / C * F.y + d2.y, 1.0f / C * F.z + d2.z};

  /* U and the rates of the force error without the unknown depths. */
  const float U = C * (1.0f / HAND_K1 * F.z + K12 / MASS * d2.z + HAND_K3 / MASS * d3.z);
  const float lever = excess + (WEIGHT - C * HAND_GOAL); /* T - c q3* */
  const float turned = d3.z + 1.0f / C * lever;
  const float d3x = wz * d3.y - wy * turned + 1.0f / HAND_K1 * F.x;
  const float d3y = wx * turned - wz * d3.x + 1.0f / HAND_K1 * F.y;
  const float d4x = d3.x - BETA * lever * wy, d4y = d3.y + BETA * lever * wx;

  /* The angular acceleration that eq. 25 asks for, and its torque. */
  const float want_x = BETA * U * wy - d3x - (K12 + HAND_K3) / MASS * d3.x - HAND_K4 / MASS * d4x;
  const float want_y = -BETA * U * wx - d3y - (K12 + HAND_K3) / MASS * d3.y - HAND_K4 / MASS * d4y;
  const float inverse = 1.0f / BETA / lever;
  const float ax = want_y * inverse, ay = -want_x * inverse;
  const float torque_x = HAND_I1 * ax + (HAND_I3 - HAND_I2) * wy * wz;
  const float torque_y = HAND_I2 * ay + (HAND_I1 - HAND_I3) * wx * wz;
  const float torque_z = (HAND_I2 - HAND_I1) * wx * wy - HAND_KYAW * wz;

  /* Rotors: rear right, front right, rear left, front left. */
  const float thrust = WEIGHT + excess;
  const float share = 0.25f * thrust;
  const float roll = 0.25f / HAND_ARM * torque_x, pitch = 0.25f / HAND_ARM * torque_y;
  const float yaw = 0.25f / HAND_DRAG * torque_z;
  out->thrust = thrust;
  out->thrust_rate = U;
  out->torque[0] = torque_x;
  out->torque[1] = torque_y;
  out->torque[2] = torque_z;
  out->rotor[0] = share - roll - pitch - yaw;
  out->rotor[1] = share - roll + pitch + yaw;
  out->rotor[2] = share + roll - pitch + yaw;
  out->rotor[3] = share + roll + pitch - yaw;

  float next = excess + in->dt * U;
  for (int i = 0; i < 4; i++)
    status |= hold(&out->rotor[i], params->rotor_lowest, params->rotor_highest);
  status |= hold(&next, params->excess_lowest, params->excess_highest);
  if (excess < HAND_LOW || excess > HAND_HIGH) status |= S_THRUST;
  if (in->gravity_direction[2] < HAND_TILT) status |= S_TILT;
  state->thrust_excess = next;
  return status;
}
