/* The controller of the Crazyflie between stand-ins of its tree: a commander, a supervisor, a PID
 * controller that writes at even steps alone as that of the tree does, and a mixer with a vehicle.
 * Each check names its line and ends the program. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include CONTROLLER
#include "check.h"
#include "vehicle.h"

static bool armed = true, can_fly = true;
static float actuator_thrust;
static unsigned pid_resets;

bool supervisorIsArmed(void) { return armed; }
bool supervisorCanFly(void) { return can_fly; }
void controllerPidInit(void) {}
bool controllerPidTest(void) { return true; }
void controllerPid(
    control_t *control, const setpoint_t *setpoint, const sensorData_t *sensors, const state_t *state,
    const stabilizerStep_t step)
{
  static const setpoint_t none;
  (void)sensors;
  (void)state;
  control->controlMode = controlModeLegacy;
  pid_resets += (memcmp(setpoint, &none, sizeof(none)) == 0) ? 1U : 0U;
  if ((step % 2U) == 0U) {
    actuator_thrust = setpoint->thrust;
    control->roll = 11;
    control->pitch = -12;
    control->yaw = 13;
  }
  control->thrust = actuator_thrust;
}

static const control_t zero;
static control_t control;
static setpoint_t setpoint;
static sensorData_t sensors;
static state_t state;
static uint32_t step;
static vehicle_t vehicle;
static in_t told;

static void see(float seconds)
{
  float seen[SEEN];
  int i;
  for (i = 0; i < SEEN; i++) {
#ifdef OF_POINTS
    seen[i] = (float)told.image[i / 2][i % 2];
#else
    seen[i] = (float)told.centroid[i];
#endif
  }
  OBSERVE(seen, seconds);
}

/* What the sensors and the estimator of the Crazyflie make of the vehicle: x forward, y left, z up. */
static void measure(void)
{
  static const double s[3] = { 1.0, -1.0, -1.0 };
  const double *x = vehicle.x;
  double r[3][3], v[3];
  int i, k;
  vehicle_sense(&vehicle, &told);
  for (i = 0; i < 3; i++) {
    v[i] = 0.0;
    for (k = 0; k < 3; k++) {
      r[i][k] = s[i] * s[k] * x[6 + (3 * k) + i];
      v[i] += r[i][k] * s[k] * x[3 + k];
    }
  }
  const double w = 0.5 * sqrt(1.0 + r[0][0] + r[1][1] + r[2][2]);
  state.attitudeQuaternion.w = (float)w;
  state.attitudeQuaternion.x = (float)((r[2][1] - r[1][2]) / (4.0 * w));
  state.attitudeQuaternion.y = (float)((r[0][2] - r[2][0]) / (4.0 * w));
  state.attitudeQuaternion.z = (float)((r[1][0] - r[0][1]) / (4.0 * w));
  state.velocity.x = (float)v[0];
  state.velocity.y = (float)v[1];
  state.velocity.z = (float)v[2];
  for (i = 0; i < 3; i++) {
    sensors.gyro.axis[i] = (float)(s[i] * x[15 + i] * 57.29577951308232);
    sensors.acc.axis[i] = (i == 2) ? (float)(vehicle.thrust / V_MASS / 9.80665) : 0.0f;
  }
}

static void tick(void)
{
  step++;
  controllerOutOfTree(&control, &setpoint, &sensors, &state, step);
}

static bool law_has(void) { return (control.controlMode == controlModeForceTorque) && (flies == 1U); }
static bool pid_has(void)
{
  return (control.controlMode == controlModeLegacy) && (control.roll == 11) && (control.pitch == -12) &&
         (control.yaw == 13) && (control.thrust == setpoint.thrust) && (flies == 0U);
}
static bool cut(void) { return memcmp(&control, &zero, sizeof(zero)) == 0; }

/* Hovering by the PID controller, armed, with an image, at an even or an odd step. */
static void hover(unsigned parity)
{
  memset(&control, 0, sizeof(control));
  memset(&setpoint, 0, sizeof(setpoint));
  setpoint.thrust = 30000.0f;
  armed = can_fly = true;
  step = 1000U + parity;
  vehicle_start(&vehicle);
  controllerOutOfTreeInit();
  measure();
  tick();
  tick();
  see(0.0f);
}

static void law_flies(unsigned parity)
{
  hover(parity);
  tick();
  CHECK(pid_has());
  enable = 1;
  tick();
  CHECK(law_has());
  CHECK(why == 0U);
}

static void safety(void)
{
  unsigned parity, k;
  for (parity = 0U; parity < 2U; parity++) {
    /* nothing before all is there */
    hover(parity);
    tick();
    CHECK(pid_has() && ((why & WHY_DISABLED) != 0U));
    enable = 1;
    armed = false;
    tick();
    CHECK(pid_has() && ((why & WHY_DISARMED) != 0U));
    armed = true;
    can_fly = false;
    tick();
    CHECK(pid_has() && ((why & WHY_DISARMED) != 0U));
    can_fly = true;
    controllerOutOfTreeInit(); /* forgets the image, and that it was enabled */
    CHECK(enable == 0U);
    enable = 1;
    tick();
    CHECK(pid_has() && ((why & WHY_NO_IMAGE) != 0U));

    /* the null setpoint cuts the power in that step, from the law and from PID, and goes on cutting it */
    law_flies(parity);
    setpoint.thrust = 0.0f;
    tick();
    CHECK(cut());
    tick();
    CHECK(cut());
    hover(parity);
    tick();
    setpoint.thrust = 0.0f;
    tick();
    CHECK(cut());

    /* disarmed: the law has lost the motors in that step */
    law_flies(parity);
    armed = false;
    tick();
    CHECK(pid_has());

    /* an image too old: PID has the motors in that step, with none of the law's bits; and back */
    law_flies(parity);
    k = 0U;
    pid_resets = 0U;
    while (law_has()) {
      tick();
      k++;
    }
    CHECK(pid_has() && ((why & WHY_NO_IMAGE) != 0U) && (pid_resets > 0U));
    CHECK((k > (image_ms - 10U)) && (k < (image_ms + 10U)));
    tick();
    CHECK(pid_has());
    see(0.0f);
    tick();
    CHECK(law_has());

    /* an image that was old when it came */
    law_flies(parity);
    for (k = 0U; law_has(); k++) {
      tick();
    }
    see(0.001f * (float)(image_ms + 5U));
    tick();
    CHECK(pid_has());
    see(NAN);
    tick();
    CHECK(pid_has());

    /* what is no number: PID in that step, until enabled anew */
    law_flies(parity);
    sensors.gyro.x = NAN;
    tick();
    CHECK(pid_has() && (enable == 0U));
    measure();
    tick();
    CHECK(pid_has());
    see(0.0f);
    enable = 1;
    tick();
    CHECK(law_has());

    /* disabled by the pilot */
    enable = 0;
    tick();
    CHECK(pid_has());
  }
  (void)printf("safe\n");
}

/* The self-test is a stand-in that fails. */
static void sick(void)
{
  hover(0U);
  enable = 1;
  tick();
  CHECK(pid_has() && (why == WHY_SELFTEST));
  CHECK(!controllerOutOfTreeTest());
  (void)printf("sick\n");
}

static volatile bool enough;

static void *write_images(void *unused)
{
  float seen[SEEN];
  long k;
  int i;
  (void)unused;
  for (k = 0; !enough; k++) {
    for (i = 0; i < SEEN; i++) {
      seen[i] = (float)(k % 1000L);
    }
    OBSERVE(seen, (float)(k % 1000L) / 1000.0f);
    for (i = 0; i < (int)(k % 200L); i++) {
      __asm__ volatile("");
    }
  }
  return NULL;
}

/* Take images while another task writes them, as fast as both can. */
static void torn(void)
{
  pthread_t writer;
  const clock_t end = clock() + (3 * CLOCKS_PER_SEC); /* of both tasks together */
  long images = 0L;
  int i;
  CHECK(pthread_create(&writer, NULL, write_images, NULL) == 0);
  while ((images < 500000L) && (clock() < end)) {
    if (take_image()) {
      images++;
      for (i = 1; i < SEEN; i++) {
        CHECK(image.seen[i] == image.seen[0]);
      }
      CHECK(image.age == (image.seen[0] / 1000.0f));
    }
  }
  enough = true;
  CHECK(pthread_join(writer, NULL) == 0);
  CHECK(images > 100L); /* on one busy core, one for each turn of the tasks */
  (void)printf("whole\n");
}

/* Packets in hexadecimal, one an argument: what the controller has of them. */
static void packets(int count, char **hex)
{
  int k, i;
  for (k = 0; k < count; k++) {
    uint8_t bytes[64];
    size_t n = 0U;
    const char *at = hex[k];
    for (; (at[0] != '\0') && (n < sizeof(bytes)); at += 2) {
      const char pair[3] = { at[0], at[1], '\0' };
      bytes[n++] = (uint8_t)strtoul(pair, NULL, 16);
    }
    (void)printf("%d", (int)RECEIVE(bytes, n));
    if (take_image()) {
      (void)printf(" %.9g", (double)image.age);
      for (i = 0; i < SEEN; i++) {
        (void)printf(" %.9g", (double)image.seen[i]);
      }
    }
    (void)printf("\n");
  }
}

#ifdef TREE_MIXER
/* That of a tree, see crazyflie_mixer.c. */
void tree_mixer(int force_torque, float thrust, const float torque[3], float force[4]);
#endif

/* Fly with a mixer whose rotors give a share of what they are told, images at 30 Hz, some ms late. */
static void fly(double share, int late)
{
  /* m1 front right, m2 rear right, m3 rear left, m4 front left; x forward, y left, in arms, and the
   * sign of the drag torque about z up: m1 and m3 turn to the left, seen from above. */
  static const double place[4][3] = { { 1, -1, -1 }, { -1, -1, 1 }, { -1, 1, -1 }, { 1, 1, 1 } };
  float posted_seen[SEEN] = { 0.0f };
  double lowest = 1e9, highest = -1e9;
  long k;
  int i;
  hover(0U);
  enable = 1;
  for (k = 0; k < 20000; k++) {
    out_t out = { 0 };
    double thrust_now = 0.0, torque_now[3] = { 0.0, 0.0, 0.0 };
    measure();
    if ((k % 33) == 0) {
      for (i = 0; i < SEEN; i++) {
#ifdef OF_POINTS
        posted_seen[i] = (float)told.image[i / 2][i % 2];
#else
        posted_seen[i] = (float)told.centroid[i];
#endif
      }
    }
    if ((k % 33) == late) {
      OBSERVE(posted_seen, 0.001f * (float)late);
    }
    tick();
    CHECK((k < 100) || law_has());
    if (law_has()) {
#ifdef TREE_MIXER
      const float asked[3] = { control.torqueX, control.torqueY, control.torqueZ };
      float mixed[4];
      tree_mixer(1, control.thrustSi, asked, mixed);
#endif
      for (i = 0; i < 4; i++) {
        double force = (control.thrustSi / 4.0) + (place[i][1] * control.torqueX / (4.0 * V_ARM)) -
                       (place[i][0] * control.torqueY / (4.0 * V_ARM)) + (place[i][2] * control.torqueZ / (4.0 * V_DRAG));
#ifdef TREE_MIXER
        force = (double)mixed[i];
#endif
        force = share * ((force < 0.0) ? 0.0 : force);
        thrust_now += force;
        torque_now[0] += place[i][1] * V_ARM * force;
        torque_now[1] -= place[i][0] * V_ARM * force;
        torque_now[2] += place[i][2] * V_DRAG * force;
      }
    } else {
      thrust_now = V_MASS * V_GRAVITY;
    }
    out.thrust = (real)thrust_now;
    out.torque[0] = (real)torque_now[0];
    out.torque[1] = (real)-torque_now[1];
    out.torque[2] = (real)-torque_now[2];
    vehicle_step(&vehicle, &out, 0.001);
    if (k >= 15000) {
      lowest = (vehicle.x[2] < lowest) ? vehicle.x[2] : lowest;
      highest = (vehicle.x[2] > highest) ? vehicle.x[2] : highest;
    }
  }
  memset(&setpoint, 0, sizeof(setpoint));
  tick();
  CHECK(cut());
#ifdef TREE_MIXER
  {
    float mixed[4];
    tree_mixer(0, 0.0f, mixed, mixed);
    CHECK((mixed[0] == 0.0f) && (mixed[1] == 0.0f) && (mixed[2] == 0.0f) && (mixed[3] == 0.0f));
  }
#endif
  (void)printf("%.6f %.6f %.6f %.6f\n", lowest, highest, vehicle.x[0], vehicle.x[1]);
}

int main(int argc, char **argv)
{
  const char *what = (argc > 1) ? argv[1] : "";
  if (strcmp(what, "safety") == 0) {
    safety();
  } else if (strcmp(what, "sick") == 0) {
    sick();
  } else if (strcmp(what, "torn") == 0) {
    torn();
  } else if (strcmp(what, "packets") == 0) {
    packets(argc - 2, argv + 2);
  } else if ((strcmp(what, "fly") == 0) && (argc == 4)) {
    fly(strtod(argv[2], NULL), atoi(argv[3]));
  } else {
    return 2;
  }
  return 0;
}
