/* What the motors library of ArduCopter takes from the rest of its tree, in brief, with names and
 * signatures of its headers. Parameters have the defaults of their tables: see ardupilot_mixer.cpp. */
#pragma once
#include <cfloat>
#include <math.h>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <type_traits>

#define APM_BUILD_ArduCopter 2
#define APM_BUILD_ArduPlane 3
#define APM_BUILD_UNKNOWN 0
#define APM_BUILD_Heli 9
#define APM_BUILD_TYPE(type) ((type) == APM_BUILD_ArduCopter)
#define APM_BUILD_COPTER_OR_HELI 1
#define AP_SCRIPTING_ENABLED 0
#define AP_BATTERY_ENABLED 1
#define HAL_LOGGING_ENABLED 0
#define NUM_SERVO_CHANNELS 16
#define NEW_NOTHROW new (std::nothrow)
#define CLASS_NO_COPY(c) c(const c &other) = delete; c &operator=(const c &) = delete
#define FUNCTOR_TYPEDEF(name, rettype, ...) typedef rettype (*name)(__VA_ARGS__)
#define ARRAY_SIZE(a) (sizeof(a) / sizeof((a)[0]))
#define UNUSED_RESULT(expr) ((void)(expr))
#define DEFINE_BYTE_ARRAY_METHODS
#define M_2PI (2 * M_PI)
#define MAX(a, b) (((a) > (b)) ? (a) : (b))
#define MIN(a, b) (((a) < (b)) ? (a) : (b))
#define INTERNAL_ERROR(which) ((void)0)
#define CMDEBUG 0

template <typename T> bool is_zero(T v) { return fabs(static_cast<double>(v)) < FLT_EPSILON; }
template <typename T> bool is_positive(T v) { return static_cast<double>(v) >= FLT_EPSILON; }
template <typename T> bool is_negative(T v) { return static_cast<double>(v) <= -FLT_EPSILON; }
template <typename T, typename U> bool is_equal(T a, U b) { return is_zero(static_cast<double>(a) - static_cast<double>(b)); }
inline float constrain_float(float v, float low, float high) {
  return isnan(v) ? (low + high) / 2 : (v < low) ? low : (v > high) ? high : v;
}
inline float radians(float degrees) { return degrees * static_cast<float>(M_PI / 180); }
inline float safe_sqrt(float v) { return (v > 0) ? sqrtf(v) : 0.0f; }
inline float sq(float v) { return v * v; }
inline float calc_lowpass_alpha_dt(float dt, float cutoff) {
  return (cutoff > 0) ? dt / (dt + 1 / (static_cast<float>(M_2PI) * cutoff)) : 1.0f;
}
template <int N> struct Vector { /* filtered nowhere here */
  Vector operator-(const Vector &) const { return *this; }
  Vector operator*(float) const { return *this; }
  Vector &operator+=(const Vector &) { return *this; }
};
typedef Vector<2> Vector2f;
typedef Vector<3> Vector3f;

class AP_Param {
public:
  struct GroupInfo {
    const char *name;
    uint8_t idx;
    ptrdiff_t offset;
    float def_value;
    uint8_t size;
  };
  static void setup_object_defaults(void *object, const GroupInfo *info);
};
template <typename T> class AP_ParamT {
public:
  operator T() const { return value; }
  const T &get() const { return value; }
  void set(const T &v) { value = v; }
  void set_and_save(const T &v) { value = v; }
  void set_and_default(const T &v) { value = v; }
  void save() {}
  bool configured() const { return true; }

protected:
  T value{};
};
typedef AP_ParamT<float> AP_Float;
typedef AP_ParamT<int8_t> AP_Int8;
typedef AP_ParamT<int16_t> AP_Int16;
template <typename E> class AP_Enum : public AP_Int8 {
public:
  operator E() const { return static_cast<E>(value); }
};
#define AP_GROUPINFO(name, idx, clazz, element, def) \
  { name, idx, offsetof(clazz, element), def, sizeof(((clazz *)nullptr)->element) }
#define AP_GROUPINFO_FLAGS(name, idx, clazz, element, def, flags) AP_GROUPINFO(name, idx, clazz, element, def)
#define AP_GROUPINFO_FRAME(name, idx, clazz, element, def, flags) AP_GROUPINFO(name, idx, clazz, element, def)
#define AP_GROUPEND { nullptr, 0xff, 0, 0.0f, 0 }

enum MAV_TYPE {
  MAV_TYPE_GENERIC, MAV_TYPE_QUADROTOR = 2, MAV_TYPE_HELICOPTER = 4, MAV_TYPE_HEXAROTOR = 13, MAV_TYPE_OCTOROTOR = 14,
  MAV_TYPE_TRICOPTER = 15, MAV_TYPE_DODECAROTOR = 29, MAV_TYPE_DECAROTOR = 35
};

class SRV_Channel {
public:
  enum Function { k_boost_throttle, k_roll_out, k_pitch_out, k_yaw_out, k_thrust_out, k_throttleLeft, k_throttleRight, k_motor1 };
};
class SRV_Channels {
public:
  static SRV_Channel::Function get_motor_function(uint8_t motor) { return static_cast<SRV_Channel::Function>(SRV_Channel::k_motor1 + motor); }
  static uint32_t get_output_channel_mask(SRV_Channel::Function) { return 0; }
  static void set_output_pwm(SRV_Channel::Function function, uint16_t pwm);
  static void set_output_scaled(SRV_Channel::Function, float) {}
  static void set_range(SRV_Channel::Function, uint16_t) {}
  static void set_angle(SRV_Channel::Function, uint16_t) {}
  static bool set_aux_channel_default(SRV_Channel::Function, uint8_t) { return true; }
  static bool find_channel(SRV_Channel::Function, uint8_t &) { return true; }
  static bool have_digital_outputs(uint32_t) { return false; }
  static int get_dshot_esc_type() { return 0; }
};
namespace AP_HAL {
uint32_t micros();
void panic(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
struct RCOutput {
  enum output_mode {
    MODE_PWM_NORMAL, MODE_PWM_ONESHOT, MODE_PWM_ONESHOT125, MODE_PWM_BRUSHED, MODE_PWM_DSHOT150,
    MODE_PWM_DSHOT300, MODE_PWM_DSHOT600, MODE_PWM_DSHOT1200
  };
  void set_freq(uint32_t, uint16_t) {}
  void set_dshot_esc_type(int) {}
  void set_output_mode(uint32_t, output_mode) {}
  void set_esc_scaling(uint16_t, uint16_t) {}
};
struct Util {
  template <typename... A> int snprintf(char *to, size_t size, const char *format, A... a) { return ::snprintf(to, size, format, a...); }
};
struct HAL {
  RCOutput *rcout;
  Util *util;
};
} // namespace AP_HAL
struct AP_Notify {
  struct Flags { bool armed; };
  static Flags flags;
};
struct AP_BattMonitor { /* none is there */
  bool current_amps(float &, uint8_t) const { return false; }
  float get_resistance(uint8_t) const { return 0; }
  float voltage(uint8_t) const { return 0; }
  float voltage_resting_estimate(uint8_t) const { return 0; }
};
struct AP_AHRS { /* at sea level */
  float get_air_density_ratio() const { return 1; }
};
namespace AP {
AP_BattMonitor &battery();
AP_AHRS &ahrs();
} // namespace AP
