/* Vectors of HP_LANES numbers, and the few functions that generated code asks of them. */

#if !defined(HP_LANES)
#if defined(__AVX512F__)
#define HP_LANES 8
#elif defined(__AVX__)
#define HP_LANES 4
#else
#define HP_LANES 2
#endif
#endif

typedef double V __attribute__((vector_size(8 * HP_LANES)));
typedef long long I __attribute__((vector_size(8 * HP_LANES)));
typedef unsigned long long U __attribute__((vector_size(8 * HP_LANES)));

#define casadi_real V
#define casadi_int long long

static inline V hp_pick(I mask, V a, V b) { return (V)((mask & (I)a) | (~mask & (I)b)); }
static inline V hp_sq(V x) { return x * x; }
static inline V hp_fabs(V x) { return (V)((I)x & 0x7FFFFFFFFFFFFFFFll); }
static inline V hp_fmin(V x, V y) { return hp_pick((y < x) | (x != x), y, x); } /* as C's */
static inline V hp_fmax(V x, V y) { return hp_pick((y > x) | (x != x), y, x); }
static inline V hp_sqrt(V x) {
  V root;
  for (int i = 0; i < HP_LANES; ++i) root[i] = __builtin_sqrt(x[i]);
  return root;
}
static inline V hp_floor(V x) {
  V below;
  for (int i = 0; i < HP_LANES; ++i) below[i] = __builtin_floor(x[i]);
  return below;
}
