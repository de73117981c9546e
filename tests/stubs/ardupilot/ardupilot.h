/* What a custom controller sees of ArduPilot, in brief; the other headers here lead to this. */
#pragma once
#include <cstdint>

struct Vector3f {
  float x, y, z;
  Vector3f() : x(0), y(0), z(0) {}
  Vector3f(float a, float b, float c) : x(a), y(b), z(c) {}
  float operator[](uint8_t i) const { return i == 0 ? x : i == 1 ? y : z; }
};
struct Matrix3f {
  Vector3f a, b, c; /* rows */
  Matrix3f transposed() const;
  Vector3f operator*(const Vector3f &v) const;
};
class AP_Param {
public:
  struct GroupInfo { const char *name; };
  static void setup_object_defaults(const void *object, const GroupInfo *info);
};
#define AP_GROUPEND { nullptr }
class AP_AHRS_View {
public:
  const Matrix3f &get_rotation_body_to_ned() const;
  Vector3f get_gyro_latest() const;
  bool get_velocity_NED(Vector3f &velocity) const;
};
class AP_Motors {
public:
  enum class SpoolState : uint8_t {
    SHUT_DOWN, GROUND_IDLE, SPOOLING_UP, THROTTLE_UNLIMITED, SPOOLING_DOWN
  };
  SpoolState get_spool_state() const;
  float get_roll() const;
  float get_pitch() const;
  float get_yaw() const;
  float get_throttle() const;
  void set_throttle(float throttle);
};
class AP_MotorsMulticopter : public AP_Motors {};
class AC_AttitudeControl;
class AC_CustomControl;
class AP_InertialSensor {
public:
  const Vector3f &get_accel() const;
};
namespace AP { AP_InertialSensor &ins(); }
namespace AP_HAL { uint32_t millis(); }
