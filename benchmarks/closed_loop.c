/* The closed loop written by hand: what an engineer would write who wants it fast and readable.
 * It has the layout, the duties and the entry point of the generated loop and its driver (loop.c).
 * State: position, velocity, rotation column by column, rate, thrust; then the lowest guards.
 * The command line defines HP_DIVERGED, the size at which a flight has diverged, and HP_FLIGHT,
 * that of a flight state. */

#include <math.h>

enum { TARGET = 4, STATE = 19, FLIGHT = HP_FLIGHT }; /* the log at its end is not kept */

typedef struct { double x, y, z; } Vec;
typedef struct { Vec position, velocity, column[3], rate; double thrust; } State;
typedef struct { double depth, thrust; } Guards;
typedef struct { double x[TARGET], y[TARGET], z[TARGET]; } Points;

/* What the control law makes of mass, gains and goal, worked out once. */
typedef struct {
  Vec inertia, inverse_inertia, goal, goal_force; /* goal_force = c q* */
  double weight, inverse_mass, mass_over_k1, inverse_k1, inverse_c;
  double beta, inverse_beta, d3_gain, d4_gain, yaw_gain;
} Law;

static inline Vec vec(double x, double y, double z) { return (Vec){x, y, z}; }
static inline Vec add(Vec a, Vec b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline Vec sub(Vec a, Vec b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline Vec scale(double s, Vec a) { return vec(s * a.x, s * a.y, s * a.z); }
static inline Vec times(Vec a, Vec b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double lower(double a, double b) { return a < b ? a : b; }
static inline Vec cross(Vec a, Vec b) {
  return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline Vec combine(const Vec m[3], Vec a) {
  return add(add(scale(a.x, m[0]), scale(a.y, m[1])), scale(a.z, m[2]));
}

static Law make_law(const double *d) {
  const double mass = d[0], gravity = d[1], k1 = d[5], k2 = d[6], k3 = d[7], k4 = d[8];
  const double c = k1 * k1 * k2 / mass, gain = k1 * k2 + k3;
  const Vec inertia = {d[2], d[3], d[4]}, goal = {d[10], d[11], d[12]};
  return (Law){
      .inertia = inertia,
      .inverse_inertia = vec(1 / inertia.x, 1 / inertia.y, 1 / inertia.z),
      .goal = goal,
      .goal_force = scale(c, goal),
      .weight = mass * gravity,
      .inverse_mass = 1 / mass,
      .mass_over_k1 = mass / k1,
      .inverse_k1 = 1 / k1,
      .inverse_c = 1 / c,
      .beta = mass / (c * gain),
      .inverse_beta = c * gain / mass,
      .d3_gain = gain / mass,
      .d4_gain = k4 / mass,
      .yaw_gain = d[9] / inertia.z,
  };
}

/* Image centroid: pinhole, then spherical image, summed; also the depth of the nearest point. */
static inline Vec see(const State *s, const Points *target, double *nearest) {
  double px[TARGET], py[TARGET], pz[TARGET], depth[TARGET];
  for (int i = 0; i < TARGET; ++i) {
    const Vec away = sub(vec(target->x[i], target->y[i], target->z[i]), s->position);
    depth[i] = dot(s->column[2], away);
    const double inverse_depth = 1 / depth[i];
    const double u = dot(s->column[0], away) * inverse_depth;
    const double v = dot(s->column[1], away) * inverse_depth;
    pz[i] = 1 / sqrt(u * u + v * v + 1);
    px[i] = u * pz[i];
    py[i] = v * pz[i];
  }
  Vec q = {px[0], py[0], pz[0]};
  *nearest = depth[0];
  for (int i = 1; i < TARGET; ++i) {
    q = add(q, vec(px[i], py[i], pz[i]));
    *nearest = lower(*nearest, depth[i]);
  }
  return q;
}

/* Time derivative of the state with the controller in the loop, and the guards at the state. */
static inline State rate_of(const State *s, const Law *law, const Points *target, Guards *guards) {
  const Vec q = see(s, target, &guards->depth);
  guards->thrust = s->thrust - law->goal_force.z;

  /* Error chain. */
  const Vec gravity_direction = {s->column[0].z, s->column[1].z, s->column[2].z};
  Vec force = scale(law->weight, gravity_direction);
  force.z -= s->thrust;
  const Vec d1 = sub(q, law->goal);
  const Vec d2 = sub(scale(law->mass_over_k1, s->velocity), d1);
  const Vec d3 = add(scale(law->inverse_c, force), d2);
  const Vec w = {-law->goal_force.x, -law->goal_force.y, guards->thrust}; /* T e3 - c q* */
  const Vec lever = cross(w, s->rate);
  const double d4x = law->beta * lever.x + d3.x, d4y = law->beta * lever.y + d3.y;

  /* Control law: what d4 must still gain beside its drift is for the angular acceleration. */
  const double thrust_rate = lever.z + law->inverse_beta * d3.z;
  const Vec turn = cross(s->rate, d3);
  const double driftx = law->inverse_c * lever.x + law->inverse_k1 * force.x - turn.x;
  const double drifty = law->inverse_c * lever.y + law->inverse_k1 * force.y - turn.y;
  const double wantx = -(law->d3_gain * d3.x + law->d4_gain * d4x);
  const double wanty = -(law->d3_gain * d3.y + law->d4_gain * d4y);
  const double rx = law->inverse_beta * (wantx - driftx) + thrust_rate * s->rate.y;
  const double ry = law->inverse_beta * (wanty - drifty) - thrust_rate * s->rate.x;
  const double yaw = -law->yaw_gain * s->rate.z, inverse_w = 1 / w.z;
  const Vec acceleration = {(ry + w.x * yaw) * inverse_w, (w.y * yaw - rx) * inverse_w, yaw};
  const Vec gyroscopic = cross(s->rate, times(law->inertia, s->rate));
  const Vec torque = add(times(law->inertia, acceleration), gyroscopic);

  /* Rigid body. */
  const Vec o = s->rate;
  return (State){
      .position = combine(s->column, s->velocity),
      .velocity = sub(scale(law->inverse_mass, force), cross(o, s->velocity)),
      .column = {sub(scale(o.z, s->column[1]), scale(o.y, s->column[2])),
                 sub(scale(o.x, s->column[2]), scale(o.z, s->column[0])),
                 sub(scale(o.y, s->column[0]), scale(o.x, s->column[1]))},
      .rate = times(law->inverse_inertia, sub(torque, gyroscopic)),
      .thrust = thrust_rate,
  };
}

/* Return s + h d. */
static inline State advance(const State *s, double h, const State *d) {
  State after = {
      .position = add(s->position, scale(h, d->position)),
      .velocity = add(s->velocity, scale(h, d->velocity)),
      .rate = add(s->rate, scale(h, d->rate)),
      .thrust = s->thrust + h * d->thrust,
  };
  for (int i = 0; i < 3; ++i) after.column[i] = add(s->column[i], scale(h, d->column[i]));
  return after;
}

/* One step of Newton and Schulz toward the nearest rotation, R(3I - R'R)/2. */
static inline void orthonormalise(Vec r[3]) {
  const double xx = dot(r[0], r[0]), xy = dot(r[0], r[1]), xz = dot(r[0], r[2]);
  const double yy = dot(r[1], r[1]), yz = dot(r[1], r[2]), zz = dot(r[2], r[2]);
  const Vec x = combine(r, vec(1.5 - 0.5 * xx, -0.5 * xy, -0.5 * xz));
  const Vec y = combine(r, vec(-0.5 * xy, 1.5 - 0.5 * yy, -0.5 * yz));
  const Vec z = combine(r, vec(-0.5 * xz, -0.5 * yz, 1.5 - 0.5 * zz));
  r[0] = x, r[1] = y, r[2] = z;
}

/* One step of Runge and Kutta's method of order 4. */
static inline void step(State *s, Guards *lowest, const Law *law, const Points *target, double dt) {
  Guards now, unused;
  const State a = rate_of(s, law, target, &now);
  const State at_b = advance(s, dt / 2, &a), b = rate_of(&at_b, law, target, &unused);
  const State at_c = advance(s, dt / 2, &b), c = rate_of(&at_c, law, target, &unused);
  const State at_d = advance(s, dt, &c), d = rate_of(&at_d, law, target, &unused);
  const State ends = advance(&a, 1, &d), middle = advance(&b, 1, &c);
  const State slope = advance(&ends, 2, &middle);
  *s = advance(s, dt / 6, &slope);
  orthonormalise(s->column);
  lowest->depth = lower(lowest->depth, now.depth);
  lowest->thrust = lower(lowest->thrust, now.thrust);
}

static inline State load(const double *x) {
  const Vec *v = (const Vec *)x;
  return (State){v[0], v[1], {v[2], v[3], v[4]}, v[5], x[STATE - 1]};
}

static inline void store(double *x, const State *s, const Guards *lowest) {
  Vec *v = (Vec *)x;
  v[0] = s->position, v[1] = s->velocity, v[5] = s->rate;
  for (int i = 0; i < 3; ++i) v[2 + i] = s->column[i];
  x[STATE - 1] = s->thrust;
  x[STATE] = lowest->depth, x[STATE + 1] = lowest->thrust;
}

/* As the function of this name in loop.c. */
__attribute__((visibility("default"))) long hoverproof_run(
    const double *start, const double *design, const double *points, double dt, long samples,
    long every, double *out) {
  const Law law = make_law(design);
  Points target;
  for (int i = 0; i < TARGET; ++i) {
    target.x[i] = points[3 * i], target.y[i] = points[3 * i + 1], target.z[i] = points[3 * i + 2];
  }
  State s = load(start);
  Guards lowest = {start[STATE], start[STATE + 1]};
  for (long sample = 0; sample < samples; ++sample, out += FLIGHT) {
    for (long k = 0; k < every; ++k) step(&s, &lowest, &law, &target, dt);
    store(out, &s, &lowest);
    int good = lowest.depth > 0 && lowest.thrust > 0;
    for (int i = 0; i < STATE; ++i) good &= fabs(out[i]) < HP_DIVERGED; /* false for NaN */
    if (!good) return sample;
  }
  return samples;
}
