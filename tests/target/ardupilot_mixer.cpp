/* The motors library of a tree of ArduPilot, its own files, from what a controller asks for to the share of
 * its most that each rotor is told, in the order of ardupilot.cpp. Its parameters have their defaults but
 * for those of the rotors, whose thrust is in proportion to what they are told, from 0 on. */
#include <cstdlib>

#include "AP_MotorsMatrix.h"

static AP_HAL::RCOutput outputs;
static AP_HAL::Util util;
static const AP_HAL::HAL board = { &outputs, &util };
const AP_HAL::HAL &hal = board;
AP_Notify::Flags AP_Notify::flags;
static AP_BattMonitor monitor;
static AP_AHRS attitude;
static uint16_t sent[4];
static uint32_t now;
AP_BattMonitor &AP::battery() { return monitor; }
AP_AHRS &AP::ahrs() { return attitude; }
uint32_t AP_HAL::micros() { return now; }
void AP_HAL::panic(const char *, ...) { abort(); }

void SRV_Channels::set_output_pwm(SRV_Channel::Function function, uint16_t pwm)
{
  const int motor = static_cast<int>(function) - static_cast<int>(SRV_Channel::k_motor1);
  if ((motor >= 0) && (motor < 4)) {
    sent[motor] = pwm;
  }
}

void AP_Param::setup_object_defaults(void *object, const GroupInfo *info)
{
  static const struct { const char *name; float value; } told[] = { { "THST_EXPO", 0 }, { "SPIN_MIN", 0 }, { "SPIN_ARM", 0 }, { "SPIN_MAX", 1 } };
  for (; info->name != nullptr; info++) {
    float value = info->def_value;
    for (const auto &other : told) {
      value = (strcmp(other.name, info->name) == 0) ? other.value : value;
    }
    void *at = static_cast<char *>(object) + info->offset;
    if (info->size == sizeof(AP_Float)) {
      static_cast<AP_Float *>(at)->set(value);
    } else if (info->size == sizeof(AP_Int16)) {
      static_cast<AP_Int16 *>(at)->set(static_cast<int16_t>(value));
    } else {
      static_cast<AP_Int8 *>(at)->set(static_cast<int8_t>(value));
    }
  }
}

/* A loop of 2.5 ms; asked for are roll, pitch, yaw and throttle, what is fed forward about each axis, and the
 * cutoff of the filter of the throttle, Hz. */
static void loop(AP_MotorsMatrix &motors, const float asked[8])
{
  now += 2500;
  motors.set_roll(asked[0]);
  motors.set_pitch(asked[1]);
  motors.set_yaw(asked[2]);
  motors.set_throttle(asked[3]);
  motors.set_roll_ff(asked[4]);
  motors.set_pitch_ff(asked[5]);
  motors.set_yaw_ff(asked[6]);
  motors.set_throttle_filter_cutoff(asked[7]);
  motors.output();
}

__attribute__((visibility("default"))) void tree_mixer(bool armed, const float asked[8], double share[4]);
void tree_mixer(bool armed, const float asked[8], double share[4])
{
  static AP_MotorsMatrix &motors = *new AP_MotorsMatrix(); /* not torn down */
  static bool ready = false;
  if (!ready) { /* on the ground: armed, and the rotors brought to speed */
    motors.init(AP_Motors::MOTOR_FRAME_QUAD, AP_Motors::MOTOR_FRAME_TYPE_X);
    motors.set_dt(0.0025f);
    motors.armed(true);
    motors.set_interlock(true);
    for (int k = 0; (k < 4000) && (motors.get_spool_state() != AP_Motors::SpoolState::THROTTLE_UNLIMITED); k++) {
      motors.set_desired_spool_state(AP_Motors::DesiredSpoolState::THROTTLE_UNLIMITED);
      loop(motors, asked);
    }
    ready = true;
  }
  motors.armed(armed);
  loop(motors, asked);
  const double least = motors.get_pwm_output_min(), most = motors.get_pwm_output_max();
  for (int i = 0; i < 4; i++) {
    share[i] = (sent[i] - least) / (most - least);
  }
}
