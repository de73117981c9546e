/* The flight mode of PX4 between stand-ins: a commander, topics, the control allocation with rotors.
 * Each check names its line and ends the program. */
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

extern "C" {
#include "check.h"
#include "vehicle.h"
}
#define private public
#include MODULE
#undef private

#define DEFINED(name) orb_metadata name##_metadata{#name, 0, 0, {0}};
TOPICS(DEFINED)
float px4_params[2] = { ROTOR_MAX, 0.2f };
static hrt_abstime now = 5000000;
hrt_abstime hrt_absolute_time() { return now; }
void px4_log(const char *, ...) {}
int ModuleBase::main(Descriptor &, int, char **) { return 0; }
void ModuleBase::exit_and_cleanup(Descriptor &) {}

static constexpr int8_t MODE = 23, CHECK_ID = 3;
static vehicle_t vehicle;
static in_t told;
static HoverproofControl *module;

template <typename T> static void put(orb_metadata &meta, const T &data) { uORB::Publication<T>(&meta).publish(data); }
template <typename T> static T last(const orb_metadata &meta)
{
  T data;
  memcpy(&data, meta.last, sizeof(T));
  return data;
}

static void command(uint8_t nav_state, bool armed)
{
  vehicle_status_s status{};
  status.nav_state = nav_state;
  status.arming_state = armed ? vehicle_status_s::ARMING_STATE_ARMED : vehicle_status_s::ARMING_STATE_DISARMED;
  put(vehicle_status_metadata, status);
}

static hoverproof_image_s exposure()
{
  hoverproof_image_s image{};
  image.timestamp = image.timestamp_sample = now;
  for (int i = 0; i < SEEN; i++) {
#ifdef OF_POINTS
    image.seen[i] = (float)told.image[i / 2][i % 2];
#else
    image.seen[i] = (float)told.centroid[i];
#endif
  }
  return image;
}

static void see() { put(hoverproof_image_metadata, exposure()); }

static void tick(bool broken = false)
{
  const double *x = vehicle.x;
  vehicle_sense(&vehicle, &told);
  now += 1000;
  vehicle_attitude_s attitude{};
  attitude.timestamp = now;
  const double w = 0.5 * sqrt(1.0 + x[6] + x[10] + x[14]); /* r[i][j] is x[6 + 3 j + i] */
  attitude.q[0] = (float)w;
  attitude.q[1] = (float)((x[11] - x[13]) / (4.0 * w));
  attitude.q[2] = (float)((x[12] - x[8]) / (4.0 * w));
  attitude.q[3] = (float)((x[7] - x[9]) / (4.0 * w));
  put(vehicle_attitude_metadata, attitude);
  vehicle_local_position_s local{};
  float *v[3] = { &local.vx, &local.vy, &local.vz };
  for (int i = 0; i < 3; i++) {
    *v[i] = (float)((x[6 + i] * x[3]) + (x[9 + i] * x[4]) + (x[12 + i] * x[5]));
  }
  local.v_xy_valid = local.v_z_valid = local.heading_good_for_control = true;
  put(vehicle_local_position_metadata, local);
  vehicle_acceleration_s felt{};
  felt.xyz[2] = (float)(-vehicle.thrust / V_MASS);
  put(vehicle_acceleration_metadata, felt);
  vehicle_angular_velocity_s rate{};
  rate.timestamp = rate.timestamp_sample = now;
  for (int i = 0; i < 3; i++) {
    rate.xyz[i] = broken ? NAN : (float)x[15 + i];
  }
  put(vehicle_angular_velocity_metadata, rate);
  module->Run();
}

static unsigned torques() { return vehicle_torque_setpoint_metadata.generation; }
static unsigned thrusts() { return vehicle_thrust_setpoint_metadata.generation; }
static bool runs()
{
  arming_check_request_s request{};
  request.request_id = 9;
  put(arming_check_request_metadata, request);
  module->Run();
  const auto reply = last<arming_check_reply_s>(arming_check_reply_metadata);
  CHECK((reply.request_id == 9) && (reply.registration_id == CHECK_ID) && reply.mode_req_prevent_arming);
  return reply.can_arm_and_run;
}

static void start()
{
  vehicle_start(&vehicle);
  CHECK(HoverproofControl::task_spawn(0, nullptr) == PX4_OK);
  module = static_cast<HoverproofControl *>(HoverproofControl::desc.object.load());
  tick();
  const auto asked = last<register_ext_component_request_s>(register_ext_component_request_metadata);
  CHECK(asked.register_mode && asked.register_arming_check && (asked.name[0] != '\0'));
  register_ext_component_reply_s reply{};
  reply.request_id = asked.request_id + 1; /* another's */
  reply.success = true;
  put(register_ext_component_reply_metadata, reply);
  tick();
  CHECK(module->_mode < 0);
  reply.request_id = asked.request_id;
  reply.mode_id = MODE;
  reply.arming_check_id = CHECK_ID;
  put(register_ext_component_reply_metadata, reply);
  tick();
  const auto config = last<vehicle_control_mode_s>(config_control_setpoints_metadata);
  CHECK((config.source_id == MODE) && config.flag_control_allocation_enabled && !config.flag_control_rates_enabled);
  CHECK(!config.flag_control_climb_rate_enabled); /* else mc_pos_control runs beside, and winds up */
}

static void enter()
{
  command(MODE, true);
  tick();
  see();
  tick();
  command(0, true);
  tick();
  command(MODE, true);
  tick();
  CHECK(module->_flying && !module->_fault);
}

static bool levels()
{
  const auto thrust = last<vehicle_thrust_setpoint_s>(vehicle_thrust_setpoint_metadata);
  const auto torque = last<vehicle_torque_setpoint_s>(vehicle_torque_setpoint_metadata);
  bool good = fabs(thrust.xyz[2] + (V_MASS * V_GRAVITY / (4.0 * ROTOR_MAX))) < 1e-5;
  for (int i = 0; i < 3; i++) {
    good = good && std::isfinite(torque.xyz[i]) && (thrust.timestamp == now);
  }
  return good;
}

static void safety()
{
  start();
  const unsigned before = torques();
  CHECK(!runs()); /* no image */
  command(MODE, false); /* in the mode, disarmed */
  see();
  for (int k = 0; k < 50; k++) {
    tick();
  }
  CHECK(runs() && (torques() == before));
  const auto frozen = module->_state;
  command(0, true); /* armed, in another mode */
  for (int k = 0; k < 50; k++) {
    tick();
  }
  CHECK((torques() == before) && (memcmp(&frozen, &module->_state, sizeof(frozen)) == 0));

  enter();
  unsigned at = torques();
  tick();
  CHECK((torques() == at + 1) && (thrusts() == torques()));

  /* the image grows old: from that step on it levels, and the commander is told; it goes on until the mode is left */
  int k = 0;
  for (; !module->_fault; k++) {
    tick();
    CHECK(k < 300);
  }
  CHECK((k > 150) && levels() && (vehicle_command_metadata.generation == 1));
  const auto told_to = last<vehicle_command_s>(vehicle_command_metadata);
  CHECK((told_to.command == vehicle_command_s::VEHICLE_CMD_SET_NAV_STATE) && (told_to.param1 == 4.0f));
  CHECK(!runs());
  see();
  at = torques();
  for (k = 0; k < 20; k++) {
    tick();
    CHECK(levels()); /* the law does not come back by itself */
  }
  CHECK(torques() == at + 20);
  command(vehicle_status_s::NAVIGATION_STATE_AUTO_LOITER, true);
  at = torques();
  tick();
  CHECK((torques() == at) && runs());

  enter(); /* and back by the pilot */
  at = torques();
  tick(true); /* what is no number */
  CHECK((torques() == at + 1) && levels() && !runs());
  command(0, true);
  tick();

  enter(); /* disarmed, or killed: nothing more in that step */
  command(MODE, false);
  at = torques();
  tick();
  CHECK(torques() == at);
  (void)printf("safe\n");
}

#ifdef TREE_MIXER
/* That of a tree, see px4_mixer.cpp. */
void tree_mixer(const double setpoint[4], double share[4]);
static void allocate(const double sp[4], double u[4]) { tree_mixer(sp, u); }
#else
/* Thrusts of the rotors by the allocation of PX4: the pseudo-inverse of what rotors of unit thrust make
 * (its rows are orthogonal here), each of its columns brought to its scale. */
static void allocate(const double sp[4], double u[4])
{
  static const double place[4][3] = { { 1, 1, 1 }, { -1, -1, 1 }, { 1, -1, -1 }, { -1, 1, -1 } };
  for (int i = 0; i < 4; i++) {
    u[i] = 0.0;
  }
  for (int axis = 0; axis < 4; axis++) {
    double b[4], square = 0.0, mix[4], norm = 0.0, largest = 0.0, sum = 0.0;
    for (int i = 0; i < 4; i++) { /* torque by r x f with f along -z, drag, and thrust along z */
      const double row[4] = { -place[i][1] * V_ARM, place[i][0] * V_ARM, place[i][2] * V_DRAG, -1.0 };
      b[i] = row[axis];
      square += b[i] * b[i];
    }
    for (int i = 0; i < 4; i++) {
      mix[i] = b[i] / square;
      norm += mix[i] * mix[i];
      largest = fmax(largest, mix[i]);
      sum += fabs(mix[i]);
    }
    const double scale = (axis < 2) ? sqrt(norm / (4 / 2.0)) : (axis == 2) ? largest : sum / 4;
    for (int i = 0; i < 4; i++) {
      u[i] += mix[i] / scale * sp[axis];
    }
  }
}
#endif

static void fly(double share, int late)
{
  static const double place[4][3] = { { 1, 1, 1 }, { -1, -1, 1 }, { 1, -1, -1 }, { -1, 1, -1 } };
  double lowest = 1e9, highest = -1e9;
  hoverproof_image_s kept{};
  start();
  enter();
  for (long k = 0; k < 20000; k++) {
    tick();
    if ((k % 33) == 0) {
      kept = exposure();
    }
    if ((k % 33) == late) {
      put(hoverproof_image_metadata, kept);
    }
    CHECK(module->_flying && !module->_fault);
    const auto thrust = last<vehicle_thrust_setpoint_s>(vehicle_thrust_setpoint_metadata);
    const auto torque = last<vehicle_torque_setpoint_s>(vehicle_torque_setpoint_metadata);
    const double sp[4] = { torque.xyz[0], torque.xyz[1], torque.xyz[2], thrust.xyz[2] };
    double u[4];
    out_t out{};
    allocate(sp, u);
    double made = 0.0, turned[3] = { 0.0, 0.0, 0.0 };
    for (int i = 0; i < 4; i++) {
      const double force = share * ROTOR_MAX * fmin(fmax(u[i], 0.0), 1.0);
      made += force;
      turned[0] -= place[i][1] * V_ARM * force;
      turned[1] += place[i][0] * V_ARM * force;
      turned[2] += place[i][2] * V_DRAG * force;
    }
    out.thrust = (real)made;
    for (int i = 0; i < 3; i++) {
      out.torque[i] = (real)turned[i];
    }
    vehicle_step(&vehicle, &out, 0.001);
    if (k >= 15000) {
      lowest = fmin(lowest, vehicle.x[2]);
      highest = fmax(highest, vehicle.x[2]);
    }
  }
  const unsigned at = torques() + thrusts();
  command(MODE, false); /* disarmed: not a word more; and what asks for nothing stops the rotors */
  tick();
  const double none[4] = { 0.0, 0.0, 0.0, 0.0 };
  double u[4];
  allocate(none, u);
  CHECK((torques() + thrusts() == at) && (fabs(u[0]) + fabs(u[1]) + fabs(u[2]) + fabs(u[3]) == 0.0));
  (void)printf("%.6f %.6f %.6f %.6f\n", lowest, highest, vehicle.x[0], vehicle.x[1]);
}

/* The torque and thrust of a step against those that the allocation makes of what is published. */
static void scale()
{
  start();
  enter();
  out_t out{};
  out.thrust = (real)(1.1 * V_MASS * V_GRAVITY);
  out.torque[0] = (real)(0.2 * ROTOR_MAX * V_ARM);
  out.torque[1] = (real)(-0.1 * ROTOR_MAX * V_ARM);
  out.torque[2] = (real)(0.05 * ROTOR_MAX * V_DRAG);
  LAW_OUT sent{};
  sent.thrust = out.thrust;
  for (int i = 0; i < 3; i++) {
    sent.torque[i] = out.torque[i];
  }
  module->publish(sent, now);
  const auto thrust = last<vehicle_thrust_setpoint_s>(vehicle_thrust_setpoint_metadata);
  const auto torque = last<vehicle_torque_setpoint_s>(vehicle_torque_setpoint_metadata);
  const double sp[4] = { torque.xyz[0], torque.xyz[1], torque.xyz[2], thrust.xyz[2] };
  double u[4];
  allocate(sp, u);
  /* front right, rear left, front left, rear right */
  (void)printf("%.9g %.9g %.9g %.9g\n", ROTOR_MAX * (u[0] + u[1] + u[2] + u[3]),
               ROTOR_MAX * V_ARM * (-u[0] + u[1] + u[2] - u[3]), ROTOR_MAX * V_ARM * (u[0] - u[1] + u[2] - u[3]),
               ROTOR_MAX * V_DRAG * (u[0] + u[1] - u[2] - u[3]));
  (void)printf("%.9g %.9g %.9g %.9g\n", (double)out.thrust, (double)out.torque[0], (double)out.torque[1], (double)out.torque[2]);
}

int main(int argc, char **argv)
{
  const char *what = (argc > 1) ? argv[1] : "";
  if (strcmp(what, "safety") == 0) {
    safety();
  } else if (strcmp(what, "sick") == 0) {
    CHECK(HoverproofControl::task_spawn(0, nullptr) == PX4_ERROR);
    (void)printf("sick\n");
  } else if (strcmp(what, "scale") == 0) {
    scale();
  } else if ((strcmp(what, "fly") == 0) && (argc == 4)) {
    fly(strtod(argv[2], nullptr), atoi(argv[3]));
  } else {
    return 2;
  }
  return 0;
}
