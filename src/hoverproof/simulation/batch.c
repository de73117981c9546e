/* Flies many vehicles at once: one in each lane of a vector, several vectors one after the other.
 * The generated functions stand above this text, with casadi_real a vector; each lane does the
 * operations of the scalar run in the same order, so it has the same bits. */

typedef struct {
  long samples, every; /* records after the start, and steps between them */
  unsigned long long seed, first_run;
#ifdef HP_CONDITIONS
  /* An event happens at the first step at or after each multiple of its period. Its rate times the
   * step is num/den. */
  long long frame_num, frame_den, control_num, control_den, latency; /* latency in steps */
#endif
} Plan;

static inline V hp_all(double x) { return (V){0} + x; }


#ifdef HP_CONDITIONS
static const unsigned long long HP_LOW = 0xFFFFFFFFu;

/* Two normal numbers in each lane; the numpy twin of this is noise.normals. */
static void hp_normals(U run, unsigned long long step, unsigned long long channel,
                       unsigned long long seed, V out[2]) {
  U c0 = run & HP_LOW, c1 = (U){0} + (step & HP_LOW), c2 = (U){0} + channel, c3 = (U){0};
  unsigned long long k0 = seed & HP_LOW, k1 = seed >> 32;
  for (int round = 0; round < 10; ++round) {
    const U a = c0 * 0xD2511F53ull, b = c2 * 0xCD9E8D57ull;
    const U d0 = (b >> 32) ^ c1 ^ k0, d2 = (a >> 32) ^ c3 ^ k1;
    c0 = d0, c1 = b & HP_LOW, c2 = d2, c3 = a & HP_LOW;
    k0 = (k0 + 0x9E3779B9ull) & HP_LOW, k1 = (k1 + 0xBB67AE85ull) & HP_LOW;
  }
  const unsigned long long one = 0x3FF0000000000000ull, fraction = 0x000FFFFFFFFFFFFFull;
  const U u = (U)(2.0 - (V)((((c0 << 32) | c1) >> 12) | one)); /* in (0, 1] */
  const V v = (V)((((c2 << 32) | c3) >> 12) | one) - 1.5;      /* in [-1/2, 1/2) */
  const V mantissa = (V)((u & fraction) | one);
  const V exponent = __builtin_convertvector((I)(u >> 52) - 1023, V);
  const V *arg[] = {&mantissa, &exponent, &v};
  V *res[] = {out, out + 1};
  hoverproof_normals(arg, res, 0, 0, 0);
}

static void hp_draw(V *noise, int size, U run, unsigned long long step, int channel,
                    unsigned long long seed) {
  V pair[2];
  for (int i = 0; i < size; i += 2) {
    hp_normals(run, step, (unsigned long long)(channel + i / 2), seed, pair);
    noise[i] = pair[0];
    if (i + 1 < size) noise[i + 1] = pair[1];
  }
}

static inline int hp_due(long long step, long long num, long long den) {
  return step == 0 || step * num / den != (step - 1) * num / den;
}

/* Frames on their way from the camera to the controller, the same for all lanes but for content. */
typedef struct {
  V seen[HP_RING][HP_SEEN];
  long long arrival[HP_RING], taken, delivered;
} Frames;

static void hp_look(const Plan *plan, Frames *frames, V *now, const V *params, const V *points,
                    U run, long long step) {
  if (hp_due(step, plan->frame_num, plan->frame_den)) {
    V noise[HP_CAMERA_NOISE] = {0}, margin;
    V *seen = frames->seen[frames->taken % HP_RING];
    const V *held = frames->taken ? frames->seen[(frames->taken - 1) % HP_RING] : seen;
    if (HP_CAMERA_NOISY)
      hp_draw(noise, HP_CAMERA_NOISE, run, step, HP_CAMERA_CHANNEL, plan->seed);
    const V *arg[] = {now, params, points, noise};
    V *res[] = {seen, &margin};
    hoverproof_frame(arg, res, 0, 0, 0);
    const I visible = margin > 0;
    for (int i = 0; i < HP_SEEN; ++i) seen[i] = hp_pick(visible, seen[i], held[i]);
    if (HP_ABORT || frames->taken == 0) { /* at first there is nothing to hold */
      const I lower = margin < now[HP_VIEW];
      now[HP_VIEW] = hp_pick(lower, margin, now[HP_VIEW]);
    }
    const I first = ~visible & (now[HP_LOST] == 0);
    now[HP_LOST_AT] = hp_pick(first, hp_all((double)step), now[HP_LOST_AT]);
    now[HP_LOST] += hp_pick(visible, hp_all(0), hp_all(1));
    frames->arrival[frames->taken % HP_RING] = frames->taken ? step + plan->latency : step;
    ++frames->taken;
  }
  while (frames->delivered < frames->taken &&
         frames->arrival[frames->delivered % HP_RING] <= step) {
    const V *told = frames->seen[frames->delivered % HP_RING];
    for (int i = 0; i < 3; ++i) now[HP_HELD + i] = told[i];
    for (int i = 3; i < HP_SEEN; ++i) now[HP_NORTH + i - 3] = told[i];
    ++frames->delivered;
  }
}

static void hp_advance(const Plan *plan, Frames *frames, V *now, const V *params, const V *points,
                       U run, long long step) {
  V next[HP_MEMORY], imu[HP_IMU_NOISE] = {0}, gust[3] = {0};
  hp_look(plan, frames, now, params, points, run, step);
  if (hp_due(step, plan->control_num, plan->control_den)) {
    if (HP_IMU_NOISY) hp_draw(imu, HP_IMU_NOISE, run, step, HP_IMU_CHANNEL, plan->seed);
    const V *arg[] = {now, params, imu};
    V *res[] = {next};
    hoverproof_control(arg, res, 0, 0, 0);
    for (int i = 0; i < HP_MEMORY; ++i) now[i] = next[i];
  }
  if (HP_GUSTY) hp_draw(gust, 3, run, step, HP_GUST_CHANNEL, plan->seed);
  const V *arg[] = {now, params, points, gust};
  V *res[] = {next};
  hoverproof_move(arg, res, 0, 0, 0);
  for (int i = 0; i < HP_MEMORY; ++i) now[i] = next[i];
}
#else
typedef int Frames;

static inline void hp_advance(const Plan *plan, Frames *frames, V *now, const V *params,
                              const V *points, U run, long long step) {
  V next[HP_MEMORY];
  const V *arg[] = {now, params, points, params + HP_STEP};
  V *res[] = {next};
  hoverproof_step(arg, res, 0, 0, 0);
  for (int i = 0; i < HP_MEMORY; ++i) now[i] = next[i];
}
#endif

static void hp_record(const V *now, const V *params, const V *points, int lanes, double *out,
                      long stride, const long *taken, long sample) {
  V record[HP_RECORD];
  const V *arg[] = {now, params, points};
  V *res[] = {record};
  hoverproof_record(arg, res, 0, 0, 0);
  for (int lane = 0; lane < lanes; ++lane)
    if (taken[lane] == sample)
      for (int i = 0; i < HP_RECORD; ++i) out[lane * stride + i] = record[i][lane];
}

/* Fly up to HP_LANES vehicles; lanes without one repeat the last. */
static void hp_group(const Plan *plan, int lanes, unsigned long long run, double *memory,
                     const double *parameters, const double *target, double *out, long *taken,
                     const volatile int *stop) {
  V now[HP_MEMORY], params[HP_PARAMS], points[HP_POINTS];
  U runs = {0};
  Frames frames = {0};
  const long stride = (plan->samples + 1) * HP_RECORD;
  for (int lane = 0; lane < HP_LANES; ++lane) {
    const int from = lane < lanes ? lane : lanes - 1;
    for (int i = 0; i < HP_MEMORY; ++i) now[i][lane] = memory[from * HP_MEMORY + i];
    for (int i = 0; i < HP_PARAMS; ++i) params[i][lane] = parameters[from * HP_PARAMS + i];
    runs[lane] = run + (unsigned long long)from;
  }
  for (int i = 0; i < HP_POINTS; ++i) points[i] = hp_all(target[i]);
  for (int lane = 0; lane < lanes; ++lane) taken[lane] = 0;
  hp_record(now, params, points, lanes, out, stride, taken, 0);

  long long step = 0;
  int flying = lanes;
  for (long s = 1; s <= plan->samples && flying && !*stop; ++s) {
    for (long k = 0; k < plan->every && !*stop; ++k, ++step)
      hp_advance(plan, &frames, now, params, points, runs, step);
    I good = (I){0} - 1;
    for (int i = 0; i < HP_STATE; ++i) { /* false for what is not a number */
      good &= (now[i] < (double)HP_DIVERGED) & (now[i] > -(double)HP_DIVERGED);
    }
    for (int i = HP_STATE; i < HP_STATE + HP_GUARDS; ++i) good &= now[i] > 0;
    for (int lane = 0; lane < lanes; ++lane) {
      if (taken[lane] < s - 1) continue; /* ended before */
      for (int i = 0; i < HP_MEMORY; ++i) memory[lane * HP_MEMORY + i] = now[i][lane];
      if (good[lane]) taken[lane] = s;
      else --flying;
    }
    hp_record(now, params, points, lanes, out + s * HP_RECORD, stride, taken, s);
  }
}

/* Fly `count` vehicles. `memory` (count, HP_MEMORY) holds their start and is left with the last
 * state of each, good or not; `out` (count, samples + 1, HP_RECORD) gets the records of the good
 * ones and is not touched elsewhere; `taken` gets how many good ones came after the start.
 * Setting *stop ends all of it soon. */
__attribute__((visibility("default"))) void hoverproof_batch(
    const Plan *plan, long count, double *memory, const double *parameters, const double *target,
    double *out, long *taken, const volatile int *stop) {
  for (long begin = 0; begin < count && !*stop; begin += HP_LANES) {
    const int lanes = count - begin < HP_LANES ? (int)(count - begin) : HP_LANES;
    hp_group(plan, lanes, plan->first_run + (unsigned long long)begin,
             memory + begin * HP_MEMORY, parameters + begin * HP_PARAMS, target,
             out + begin * (plan->samples + 1) * HP_RECORD, taken + begin, stop);
  }
}

__attribute__((visibility("default"))) int hoverproof_lanes(void) { return HP_LANES; }
