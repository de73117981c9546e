/* What a controller sees of the Crazyflie firmware, in brief: names and layouts of its headers. */
#pragma once
#include <stdbool.h>
#include <stdint.h>

typedef uint32_t stabilizerStep_t;
typedef union { struct { float x, y, z; }; float axis[3]; } Axis3f;
typedef struct { uint32_t timestamp; float x, y, z; } point_t, velocity_t, acc_t, jerk_t;
typedef struct { uint32_t timestamp; float roll, pitch, yaw; } attitude_t;
typedef struct {
  union { struct { float q0, q1, q2, q3; }; struct { float x, y, z, w; }; };
} quaternion_t;
typedef struct { Axis3f acc, gyro, mag; uint64_t interruptTimestamp; } sensorData_t; /* acc in g, gyro in degrees/s */
typedef struct {
  attitude_t attitude;
  quaternion_t attitudeQuaternion;
  point_t position;
  velocity_t velocity;
  acc_t acc;
} state_t;
typedef enum { controlModeLegacy = 0, controlModeForceTorque = 1, controlModeForce = 2 } control_mode_t;
typedef struct {
  union {
    struct { int16_t roll, pitch, yaw; float thrust; };
    struct {
      float thrustSi;
      union { float torque[3]; struct { float torqueX, torqueY, torqueZ; }; };
    };
    float normalizedForces[4];
  };
  control_mode_t controlMode;
} control_t;
typedef enum { modeDisable = 0, modeAbs, modeVelocity } stab_mode_t;
typedef struct { stab_mode_t x, y, z, roll, pitch, yaw, quat; } setpoint_mode_t;
typedef struct {
  uint32_t timestamp;
  attitude_t attitude, attitudeRate;
  quaternion_t attitudeQuaternion;
  float thrust;
  point_t position;
  velocity_t velocity;
  acc_t acceleration;
  jerk_t jerk;
  bool velocity_body;
  setpoint_mode_t mode;
} setpoint_t;

#define RATE_1000_HZ 1000
#define RATE_MAIN_LOOP RATE_1000_HZ
