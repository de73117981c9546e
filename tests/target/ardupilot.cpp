/* The custom controller of ArduCopter between stand-ins: its frontend, a main controller, a mixer with
 * rotors. Each check names its line and ends the program. */
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

extern "C" {
#include "check.h"
#include "vehicle.h"
}
#define private public
#include BACKEND
#undef private

static constexpr float MAIN[3] = { 0.11f, -0.12f, 0.13f }, MAIN_THROTTLE = 0.44f, MAIN_CUTOFF = 3.0f;
static uint32_t now = 5000;
static AP_Int8 mask;
static AP_InertialSensor imu;
static AP_Vehicle copter;
static vehicle_t vehicle;
static in_t told;
static char said[200];

uint32_t AP_HAL::millis() { return now; }
AP_InertialSensor &AP::ins() { return imu; }
AP_Vehicle *AP::vehicle() { return &copter; }
void gcs_text(const char *format, ...)
{
  va_list rest;
  va_start(rest, format);
  (void)vsnprintf(said, sizeof(said), format, rest);
  va_end(rest);
}
void AP_Param::setup_object_defaults(const void *, const GroupInfo *) {}
AP_Param *AP_Param::find(const char *name, enum ap_var_type *type, uint16_t *)
{
  *type = AP_PARAM_INT8;
  return (strcmp(name, "CC_AXIS_MASK") == 0) ? &mask : nullptr;
}

struct Copter {
  AP_AHRS_View view;
  AP_MotorsMulticopter motors;
  AP_AHRS_View *ahrs = &view;
  AP_MotorsMulticopter *out = &motors;
  AC_AttitudeControl *attitude = nullptr;
  AC_CustomControl frontend;
  CONTROL backend{ frontend, ahrs, attitude, out, 0.0025f };

  Copter()
  {
    mask.set(7);
    copter.mode = 5;
    backend._rotor_max.set(ROTOR_MAX);
    backend._image_age.set(200);
    backend._mode.set(5);
    vehicle_start(&vehicle);
    measure();
  }

  void measure()
  {
    const double *x = vehicle.x;
    vehicle_sense(&vehicle, &told);
    Vector3f *rows[3] = { &view.rotation.a, &view.rotation.b, &view.rotation.c };
    for (int i = 0; i < 3; i++) {
      *rows[i] = Vector3f((float)x[6 + i], (float)x[9 + i], (float)x[12 + i]);
    }
    view.velocity = view.rotation * Vector3f((float)x[3], (float)x[4], (float)x[5]);
    view.gyro = Vector3f((float)x[15], (float)x[16], (float)x[17]);
    imu.accel = Vector3f(0, 0, (float)(-vehicle.thrust / V_MASS));
  }

  void see()
  {
    float seen[SEEN];
    for (int i = 0; i < SEEN; i++) {
#ifdef OF_POINTS
      seen[i] = (float)told.image[i / 2][i % 2];
#else
      seen[i] = (float)told.centroid[i];
#endif
    }
    backend.observe(seen, now);
  }

  /* The switch of the pilot. */
  void on()
  {
    backend.reset();
    frontend.set_custom_controller(true);
    said[0] = '\0';
    motors.throttle = MAIN_THROTTLE;
  }

  /* A loop: the flight mode and the main controller, then the custom one, as its frontend has it. */
  void loop()
  {
    now += 3;
    motors.roll = MAIN[0];
    motors.pitch = MAIN[1];
    motors.yaw = MAIN[2];
    motors.roll_ff = motors.pitch_ff = motors.yaw_ff = 0.05f;
    motors.throttle = MAIN_THROTTLE;
    motors.cutoff = MAIN_CUTOFF;
    if (frontend.active) {
      const Vector3f rpy = backend.update();
      if ((mask.get() & 1) != 0) { motors.roll = rpy.x; }
      if ((mask.get() & 2) != 0) { motors.pitch = rpy.y; }
      if ((mask.get() & 4) != 0) { motors.yaw = rpy.z; }
    }
  }

  bool law_has() const { return frontend.active && (motors.throttle != MAIN_THROTTLE) && (motors.roll_ff == 0.0f) && (motors.cutoff == 0.0f); }
  bool main_has(const char *why) const
  {
    return !frontend.active && (strstr(said, why) != nullptr) && (motors.roll == MAIN[0]) && (motors.pitch == MAIN[1]) &&
           (motors.yaw == MAIN[2]) && (motors.roll_ff == 0.05f) && (motors.throttle == MAIN_THROTTLE) &&
           (motors.cutoff == MAIN_CUTOFF);
  }

  void flies()
  {
    mask.set(7);
    copter.mode = 5;
    motors.is_armed = true;
    motors.spool = AP_Motors::SpoolState::THROTTLE_UNLIMITED;
    view.moving = true;
    measure();
    on();
    for (int k = 0; !law_has(); k++) { /* until then all is the main controller's */
      CHECK((k < 20) && frontend.active && ((k == 0) || (motors.roll == MAIN[0])));
      if ((k % 5) == 3) {
        see();
      }
      loop();
    }
  }
};

static void safety()
{
  Copter c;
  c.on();
  for (int k = 0; c.frontend.active; k++) { /* no image comes */
    c.loop();
    CHECK((k < 400) && (c.motors.roll == MAIN[0]) && (c.motors.roll_ff == 0.05f) && (c.motors.throttle == MAIN_THROTTLE));
  }
  CHECK(c.main_has("image"));
  c.flies();
  copter.mode = 9; /* a failsafe lands */
  c.loop();
  CHECK(c.main_has("mode"));
  copter.mode = 5;
  c.loop();
  CHECK(c.main_has("mode")); /* until the pilot switches it on again */
  c.flies();
  for (int axes = 0; axes < 7; axes++) {
    c.flies();
    mask.set((int8_t)axes);
    c.loop();
    CHECK(c.main_has("AXIS"));
  }
  c.flies();
  c.motors.is_armed = false;
  c.loop();
  CHECK(c.main_has("not flying"));
  for (auto spool : { AP_Motors::SpoolState::SHUT_DOWN, AP_Motors::SpoolState::GROUND_IDLE,
                      AP_Motors::SpoolState::SPOOLING_UP, AP_Motors::SpoolState::SPOOLING_DOWN }) {
    c.flies();
    c.motors.spool = spool;
    c.loop();
    CHECK(c.main_has("not flying"));
  }
  c.flies();
  c.view.moving = false;
  c.loop();
  CHECK(c.main_has("velocity"));
  c.flies();
  int k = 0;
  c.see();
  for (; c.law_has(); k++) {
    c.loop();
    CHECK(k < 200);
  }
  CHECK((k > 50) && c.main_has("image"));
  c.flies();
  c.view.gyro = Vector3f(NAN, 0, 0);
  c.loop();
  CHECK(!c.frontend.active && c.main_has(""));
  c.flies();
  (void)printf("safe\n");
}

static void sick()
{
  Copter c;
  c.on();
  c.see();
  c.loop();
  CHECK(c.main_has("self-test"));
  (void)printf("sick\n");
}

static const double place[4][3] = { { 1, 1, 1 }, { -1, -1, 1 }, { 1, -1, -1 }, { -1, 1, -1 } };

/* What each rotor gives of its most. */
#ifdef TREE_MIXER
/* That of a tree, see ardupilot_mixer.cpp. */
void tree_mixer(bool armed, const float asked[8], double share[4]);
static void mix(const AP_Motors &m, double u[4])
{
  const float asked[8] = { m.roll, m.pitch, m.yaw, m.throttle, m.roll_ff, m.pitch_ff, m.yaw_ff, m.cutoff };
  tree_mixer(m.is_armed, asked, u);
}
#else
/* As the mixer of ArduPilot: factors of +-0.5 about each axis, the throttle for all. */
static void mix(const AP_Motors &m, double u[4])
{
  for (int i = 0; i < 4; i++) {
    u[i] = m.throttle - (0.5 * place[i][1] * (m.roll + m.roll_ff)) + (0.5 * place[i][0] * (m.pitch + m.pitch_ff)) +
           (0.5 * place[i][2] * (m.yaw + m.yaw_ff));
    u[i] = m.is_armed ? fmin(fmax(u[i], 0.0), 1.0) : 0.0;
  }
}
#endif

static void fly(double share, int late)
{
  double lowest = 1e9, highest = -1e9, u[4];
  Copter c;
  float kept[SEEN] = { 0.0f };
  uint32_t exposed = 0;
  c.flies();
  for (long k = 0; k < 8000; k++) {
    now -= (k % 2 == 0) ? 1 : 0; /* a loop counts 3 ms; these are 2.5 ms on the mean */
    c.measure();
    if ((k % 13) == 0) {
      exposed = now;
      for (int i = 0; i < SEEN; i++) {
#ifdef OF_POINTS
        kept[i] = (float)told.image[i / 2][i % 2];
#else
        kept[i] = (float)told.centroid[i];
#endif
      }
    }
    if ((k % 13) == late) {
      c.backend.observe(kept, exposed);
    }
    c.loop();
    CHECK(c.law_has());
    mix(c.motors, u);
    double made = 0.0, turned[3] = { 0.0, 0.0, 0.0 };
    for (int i = 0; i < 4; i++) {
      const double force = share * ROTOR_MAX * u[i];
      made += force;
      turned[0] -= place[i][1] * V_ARM * force;
      turned[1] += place[i][0] * V_ARM * force;
      turned[2] += place[i][2] * V_DRAG * force;
    }
    out_t out{};
    out.thrust = (real)made;
    for (int i = 0; i < 3; i++) {
      out.torque[i] = (real)turned[i];
    }
    vehicle_step(&vehicle, &out, 0.0025);
    if (k >= 6000) {
      lowest = fmin(lowest, vehicle.x[2]);
      highest = fmax(highest, vehicle.x[2]);
    }
  }
  c.motors.is_armed = false; /* disarmed: the rotors stop in that loop */
  c.loop();
  mix(c.motors, u);
  CHECK(!c.frontend.active && (u[0] == 0.0) && (u[1] == 0.0) && (u[2] == 0.0) && (u[3] == 0.0));
  (void)printf("%.6f %.6f %.6f %.6f\n", lowest, highest, vehicle.x[0], vehicle.x[1]);
}

int main(int argc, char **argv)
{
  const char *what = (argc > 1) ? argv[1] : "";
  if (strcmp(what, "safety") == 0) {
    safety();
  } else if (strcmp(what, "sick") == 0) {
    sick();
  } else if ((strcmp(what, "fly") == 0) && (argc == 4)) {
    fly(strtod(argv[2], nullptr), atoi(argv[3]));
  } else {
    return 2;
  }
  return 0;
}
