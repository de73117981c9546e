/* What a custom controller sees of ArduPilot, in brief, with names and signatures of its headers; the
 * other headers here lead to this. */
#pragma once
#include <cstdint>
#include <cstring>

struct Vector3f {
  float x, y, z;
  Vector3f() : x(0), y(0), z(0) {}
  Vector3f(float a, float b, float c) : x(a), y(b), z(c) {}
  float operator[](uint8_t i) const { return i == 0 ? x : i == 1 ? y : z; }
};
struct Matrix3f {
  Vector3f a, b, c; /* rows */
  Matrix3f transposed() const {
    Matrix3f t;
    t.a = Vector3f(a.x, b.x, c.x);
    t.b = Vector3f(a.y, b.y, c.y);
    t.c = Vector3f(a.z, b.z, c.z);
    return t;
  }
  Vector3f operator*(const Vector3f &v) const {
    return Vector3f(a.x * v.x + a.y * v.y + a.z * v.z, b.x * v.x + b.y * v.y + b.z * v.z,
                    c.x * v.x + c.y * v.y + c.z * v.z);
  }
};
enum ap_var_type { AP_PARAM_NONE = 0, AP_PARAM_INT8, AP_PARAM_INT16, AP_PARAM_INT32, AP_PARAM_FLOAT };
class AP_Param {
public:
  struct GroupInfo { const char *name; uint8_t index; float value; };
  static void setup_object_defaults(const void *object, const GroupInfo *info);
  static AP_Param *find(const char *name, enum ap_var_type *ptype, uint16_t *flags = nullptr);
};
template <typename T, ap_var_type PT> class AP_ParamT : public AP_Param {
public:
  AP_ParamT() : _value() {}
  const T &get() const { return _value; }
  void set(const T &v) { _value = v; }
private:
  T _value;
};
typedef AP_ParamT<float, AP_PARAM_FLOAT> AP_Float;
typedef AP_ParamT<int8_t, AP_PARAM_INT8> AP_Int8;
typedef AP_ParamT<int16_t, AP_PARAM_INT16> AP_Int16;
#define AP_GROUPINFO(name, index, clazz, element, def) { name, index, (sizeof(((clazz *)nullptr)->element) > 0) ? def : 0 }
#define AP_GROUPEND { nullptr, 0, 0 }

class AP_AHRS_View {
public:
  const Matrix3f &get_rotation_body_to_ned() const { return rotation; }
  Vector3f get_gyro_latest() const { return gyro; }
  bool get_velocity_NED(Vector3f &v) const {
    v = velocity;
    return moving;
  }
  Matrix3f rotation;
  Vector3f gyro, velocity;
  bool moving = true;
};
class AP_Motors {
public:
  enum class SpoolState : uint8_t {
    SHUT_DOWN = 0, GROUND_IDLE = 1, SPOOLING_UP = 2, THROTTLE_UNLIMITED = 3, SPOOLING_DOWN = 4
  };
  SpoolState get_spool_state() const { return spool; }
  bool armed() const { return is_armed; }
  float get_roll() const { return roll; }
  float get_pitch() const { return pitch; }
  float get_yaw() const { return yaw; }
  void set_roll_ff(float v) { roll_ff = v; }
  void set_pitch_ff(float v) { pitch_ff = v; }
  void set_yaw_ff(float v) { yaw_ff = v; }
  void set_throttle(float v) { throttle = v; }
  void set_throttle_filter_cutoff(float hz) { cutoff = hz; }
  SpoolState spool = SpoolState::THROTTLE_UNLIMITED;
  bool is_armed = true;
  float roll = 0, pitch = 0, yaw = 0, roll_ff = 0, pitch_ff = 0, yaw_ff = 0, throttle = 0, cutoff = 0;
};
class AP_MotorsMulticopter : public AP_Motors {};
class AC_AttitudeControl;
class AC_CustomControl {
public:
  void set_custom_controller(bool enabled) { active = enabled; }
  bool active = false;
};
class AP_InertialSensor {
public:
  const Vector3f &get_accel() const { return accel; }
  Vector3f accel;
};
class AP_Vehicle {
public:
  uint8_t get_mode() const { return mode; }
  uint8_t mode = 5;
};
namespace AP {
AP_InertialSensor &ins();
AP_Vehicle *vehicle();
}
namespace AP_HAL { uint32_t millis(); }
enum { MAV_SEVERITY_WARNING = 4 };
void gcs_text(const char *format, ...) __attribute__((format(printf, 1, 2)));
#define GCS_SEND_TEXT(severity, ...) gcs_text(__VA_ARGS__)
