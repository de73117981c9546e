/* Runs the generated step without leaving C and keeps every so many states.
 * The generated code stands above this text; everything in it is static. */

/* Fills `out` with up to `samples` flight states, one after each `every` steps from `start`.
 * Returns how many were taken: fewer if the next one has diverged or breaks a guard; that one is
 * still written. The parameters are copied so that the compiler knows that nothing changes them. */
__attribute__((visibility("default"))) long hoverproof_run(
    const double *start, const double *design, const double *points, double dt, long samples,
    long every, double *out) {
  double now[HP_FLIGHT], next[HP_FLIGHT], d[HP_DESIGN], p[HP_POINTS];
  for (int i = 0; i < HP_FLIGHT; ++i) now[i] = start[i];
  for (int i = 0; i < HP_DESIGN; ++i) d[i] = design[i];
  for (int i = 0; i < HP_POINTS; ++i) p[i] = points[i];
  for (long s = 0; s < samples; ++s) {
    for (long k = 0; k < every; ++k) {
      const double *arg[] = {now, d, p, &dt};
      double *res[] = {next};
      hoverproof_step(arg, res, 0, 0, 0);
#pragma GCC unroll 32 /* one by one: a wider load would wait for the narrow stores */
      for (int i = 0; i < HP_FLIGHT; ++i) now[i] = next[i];
    }
    int good = 1; /* false for NaN */
    for (int i = 0; i < HP_FLIGHT; ++i) {
      out[s * HP_FLIGHT + i] = now[i];
      good &= i < HP_STATE ? fabs(now[i]) < HP_DIVERGED : i >= HP_GUARDED || now[i] > 0;
    }
    if (!good) return s;
  }
  return samples;
}
