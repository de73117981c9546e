/* What the control allocation of PX4 takes from the rest of its tree, in brief, with names and
 * signatures of its headers. Parameters are asked for by their names: see px4_mixer.cpp. */
#pragma once
#include <cmath>
#include <cfloat>
#include <cstdint>
#include <cstdio>
#include <cstring>

#define PX4_ISFINITE(x) (std::isfinite(x))
#define PX4_ERR(...) ((void)0)
#define M_PI_F 3.14159265f
#define M_TWOPI_F 6.28318531f
#define M_PI_2_F 1.57079632f

typedef uintptr_t param_t; /* the name of a parameter, kept */
param_t param_find(const char *name);
int param_get(param_t param, void *value);

struct control_allocator_status_s {};

namespace time_literals {}
namespace px4 {
enum class params { MC_AIRMODE, CA_ROTOR_COUNT };
} // namespace px4

class ModuleParams {
public:
  explicit ModuleParams(ModuleParams *) {}
  virtual ~ModuleParams() = default;

protected:
  virtual void updateParams() {}
};
template <px4::params P> class ParamInt {
public:
  int32_t get() const {
    int32_t value = 0;
    (void)param_get(param_find((P == px4::params::MC_AIRMODE) ? "MC_AIRMODE" : "CA_ROTOR_COUNT"), &value);
    return value;
  }
};
#define UNPACKED(...) __VA_ARGS__
#define DEFINE_PARAMETERS(first) UNPACKED first;
