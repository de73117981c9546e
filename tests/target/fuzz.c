/* Fuzz a step: bytes become state, parameters and input, with NaN, infinities, denormals and huge
 * numbers planted. The status is held against conditions worked out apart, in double. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware_names.h"
#include PARAMS_HEADER

#define REQUIRE(condition)                                        \
  do {                                                            \
    if (!(condition)) {                                           \
      fprintf(stderr, "line %d: %s\n", __LINE__, #condition);     \
      abort();                                                    \
    }                                                             \
  } while (0)

unsigned long calls = 0;

#if FELT
static const double FORCE_SQUARE = P_FORCE_SQUARE;
#else
static const double FORCE_SQUARE = 1.0;
#endif

static const double planted[] = {NAN,     INFINITY, -INFINITY, 0.0,   -0.0,  1e-40, -1e-310,
                                 1e38,    -1e300,   3.4e38,    1.0,   -1.0,  1e19,  -1e19,
                                 5e-324,  20.0,     30.0,      61.0,  0.1,   1e10,  -93.0};

/* A number in a range, one of the planted ones, or any bits at all. */
static real number(const uint8_t **data, double reach) {
  uint8_t kind;
  uint64_t bits;
  real value;
  memcpy(&kind, *data, 1);
  memcpy(&bits, *data + 1, 8);
  *data += 9;
  if (kind < 8) {
    memcpy(&value, &bits, sizeof value);
  } else if (kind < 16) {
    value = (real)planted[bits % (sizeof planted / sizeof *planted)];
  } else {
    value = (real)(reach * ((double)(int64_t)bits / 9223372036854775808.0));
  }
  return value;
}

enum { SEEN = (int)(offsetof(input_t, velocity) / sizeof(real)), BYTES = 9 * (SEEN + 13 + 3 * FELT + 4 * RATES) + 1 };

static int certain(double value, double limit) { /* farther from a limit than rounding reaches */
  return !(fabs(value - limit) <= 1e-5 * fabs(limit));
}

#if SIZED
/* The root mean square of the distances of the unit vectors from their mean. */
static double angular_radius(const real *seen) {
  double q[3] = {0.0, 0.0, 0.0};
  if (SENSED_POINTS) {
    double p[TARGET_POINTS][3], sum = 0.0;
    for (int i = 0; i < TARGET_POINTS; i++) {
      const double x = (double)seen[2 * i], y = (double)seen[2 * i + 1];
      const double far = sqrt(1.0 + x * x + y * y);
      p[i][0] = x / far, p[i][1] = y / far, p[i][2] = 1.0 / far;
      for (int k = 0; k < 3; k++) q[k] += p[i][k] / TARGET_POINTS;
    }
    for (int i = 0; i < TARGET_POINTS; i++)
      for (int k = 0; k < 3; k++) sum += (p[i][k] - q[k]) * (p[i][k] - q[k]);
    return sqrt(sum / TARGET_POINTS);
  }
  for (int k = 0; k < 3; k++) q[k] = (double)seen[k] / TARGET_POINTS;
  return sqrt(1.0 - (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]));
}
#endif

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < BYTES) return 0;
  calls++;
  params_t params;
  state_t state;
  input_t in;
  output_t out;
  init(&params);
  memset(&out, 0xff, sizeof out); /* NaN unless written */
  real *numbers = (real *)(void *)&in;
  double image = 0.0, speed = 0.0, turn = 0.0, down = 0.0;
  for (int i = 0; i < SEEN; i++) {
    numbers[i] = number(&data, SENSED_POINTS ? 3.0 : 2.0);
    image += (double)numbers[i] * (double)numbers[i];
  }
  for (int i = 0; i < 3; i++) {
    in.velocity[i] = number(&data, 18.0);
    in.rate[i] = number(&data, 36.0);
    in.gravity_direction[i] = number(&data, 0.3);
    if (i == 2) in.gravity_direction[i] += (real)1;
    speed += (double)in.velocity[i] * (double)in.velocity[i];
    turn += (double)in.rate[i] * (double)in.rate[i];
    down += (double)in.gravity_direction[i] * (double)in.gravity_direction[i];
  }
  double felt = 0.0, lift = 0.0, radius = 0.0;
  int sized = 1, sure = 1;
#if FELT
  for (int i = 0; i < 3; i++) {
    in.specific_force[i] = number(&data, i == 2 ? 4.0 : 90.0);
    if (i == 2) in.specific_force[i] -= (real)P_GRAVITY;
    felt += (double)in.specific_force[i] * (double)in.specific_force[i];
  }
  lift = -P_MASS * ((double)in.specific_force[2] + P_GRAVITY);
#endif
#if SIZED
  radius = angular_radius(numbers);
  sized = radius >= RADIUS_LOW && (SENSED_POINTS || radius <= RADIUS_HIGH);
  sure = !(fabs(radius / RADIUS_LOW - 1.0) < 0.1) && !(fabs(radius / RADIUS_HIGH - 1.0) < 0.1);
#endif
  (void)radius;
  in.dt = number(&data, 0.1);
  state.thrust_excess = number(&data, 1.2 * HOVER);
  const real low = number(&data, HOVER), high = number(&data, 3.0 * HOVER);
  (void)set_rotor_limits(&params, low, high);
#if RATES
  const real felt_before[3] = {number(&data, 9.0), number(&data, 9.0), number(&data, 30.0)};
  const real throttle = number(&data, 1.1);
  state_t started = state;
  const real floor = params.excess_lowest;
  if (take_over(&params, &started, felt_before, throttle) == 0u) {
    REQUIRE(throttle > 0 && throttle <= 1 && felt_before[2] < 0);
    REQUIRE(fabs((double)(params.throttle_per_newton * (started.thrust_excess + (real)P_WEIGHT)) -
                 (double)throttle) < 1e-5);
  }
  REQUIRE(params.throttle_per_newton > 0 && isfinite(params.throttle_per_newton));
  REQUIRE(params.excess_highest > floor && params.excess_lowest == floor);
#endif
  in.target_seen = *data & 7u;
  const real excess = state.thrust_excess;

  const uint32_t status = step(&params, &state, &in, &out);

  const real *results[] = {&out.thrust, out.torque, out.rotor, &out.thrust_rate,
                           &state.thrust_excess};
  const int sizes[] = {1, 3, 4, 1, 1};
  for (int k = 0; k < 5; k++)
    for (int i = 0; i < sizes[k]; i++) REQUIRE(isfinite(results[k][i]));
#if RATES
  for (int i = 0; i < 3; i++) REQUIRE(isfinite(out.rate_command[i]));
  REQUIRE(out.throttle >= 0 && out.throttle <= 1);
  if (status & S_FAULT)
    for (int i = 0; i < 3; i++) REQUIRE(out.rate_command[i] == 0);
#endif
  for (int i = 0; i < 4; i++)
    REQUIRE(out.rotor[i] >= params.rotor_lowest && out.rotor[i] <= params.rotor_highest);
  REQUIRE(state.thrust_excess > (real)P_EXCESS_FLOOR - 1 && state.thrust_excess <= (real)P_EXCESS_CEILING);

  const int inside = image <= SEEN_SQUARE && speed <= P_SPEED_SQUARE && turn <= P_RATE_SQUARE &&
                     down >= P_DIRECTION_LOW && down <= P_DIRECTION_HIGH && in.dt > 0 &&
                     in.dt <= P_DT_HIGHEST && sized && (!FELT || felt <= FORCE_SQUARE);
  const int clear = certain(image, SEEN_SQUARE) && certain(speed, P_SPEED_SQUARE) &&
                    certain(turn, P_RATE_SQUARE) && certain(down, P_DIRECTION_LOW) &&
                    certain(down, P_DIRECTION_HIGH) && sure && certain(felt, FORCE_SQUARE);
  if (clear) REQUIRE(((status & S_INPUT) == 0u) == inside);
  REQUIRE(((status & S_TARGET) != 0u) == (in.target_seen == 0u));
  const int held = excess > P_EXCESS_FLOOR && excess <= P_EXCESS_CEILING;
  const int carries = !FELT || (lift > P_EXCESS_FLOOR && lift <= P_EXCESS_CEILING);
  if (!FELT || (certain(lift, P_EXCESS_FLOOR) && certain(lift, P_EXCESS_CEILING)))
    REQUIRE(((status & S_SINGULAR) != 0u) == !(held && carries));
  if (status & S_FAULT) {
    REQUIRE((status & ~S_FAULT) == 0u);
    REQUIRE(out.thrust == (real)P_WEIGHT && out.torque[0] == 0 && out.torque[1] == 0);
    REQUIRE(out.torque[2] == 0 && out.rotor[0] == (real)P_ROTOR_HOVER && out.thrust_rate == 0);
    REQUIRE(state.thrust_excess == 0);
  } else {
    const int beyond = FELT && (lift < P_FELT_LOW || lift > P_FELT_HIGH);
    if (!FELT || (certain(lift, P_FELT_LOW) && certain(lift, P_FELT_HIGH)))
      REQUIRE(((status & S_THRUST) != 0u) ==
              (excess < P_EXCESS_LOW || excess > P_EXCESS_HIGH || beyond));
    REQUIRE(((status & S_TILT) != 0u) == (in.gravity_direction[2] < P_TILT_COSINE));
    int limited = state.thrust_excess != excess + in.dt * out.thrust_rate;
    for (int i = 0; i < 4; i++)
      limited |= out.rotor[i] == params.rotor_lowest || out.rotor[i] == params.rotor_highest;
#if RATES
    limited |= out.throttle == 0 || out.throttle == 1;
#endif
    if (!limited) REQUIRE((status & S_SATURATED) == 0u);
  }
  return 0;
}

__attribute__((destructor)) static void tell(void) { fprintf(stderr, "%lu whole calls\n", calls); }

/* With "alone" and a number: so many calls with random bytes, in place of the fuzzer's. */
int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerInitialize(int *argc, char ***argv) {
  static uint8_t data[BYTES];
  uint64_t seed = 88172645463325252u;
  if (*argc < 3 || strcmp((*argv)[1], "alone") != 0) return 0;
  const unsigned long wanted = strtoul((*argv)[2], NULL, 10);
  while (calls < wanted) {
    for (size_t i = 0; i < sizeof data; i++) {
      seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
      data[i] = (uint8_t)(seed >> 32);
    }
    LLVMFuzzerTestOneInput(data, sizeof data);
  }
  printf("%lu calls\n", calls);
  exit(0);
}
