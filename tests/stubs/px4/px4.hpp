/* What a flight mode sees of PX4, in brief, with names and signatures of its headers, and topics that
 * keep what was published last; the other headers of this folder lead here. */
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

#define __EXPORT __attribute__((visibility("default")))
#define MODULE_NAME "stub"
#define PX4_OK 0
#define PX4_ERROR (-1)
#define PX4_ISFINITE(x) (std::isfinite(x))
#define M_SQRT1_2_F 0.70710678f
#define PX4_INFO(...) px4_log(__VA_ARGS__)
#define PX4_WARN(...) px4_log(__VA_ARGS__)
#define PX4_ERR(...) px4_log(__VA_ARGS__)
#define PRINT_MODULE_DESCRIPTION(text) px4_log("%s", text)
#define PRINT_MODULE_USAGE_NAME(name, category) px4_log(name)
#define PRINT_MODULE_USAGE_COMMAND(command) px4_log(command)
#define PRINT_MODULE_USAGE_DEFAULT_COMMANDS() px4_log("stop, status")
#define ORB_ID(name) (&name##_metadata)
void px4_log(const char *format, ...) __attribute__((format(printf, 1, 2)));

typedef uint64_t hrt_abstime;
hrt_abstime hrt_absolute_time();
static inline hrt_abstime hrt_elapsed_time(const hrt_abstime *then) { return hrt_absolute_time() - *then; }

namespace px4 {
struct wq_config_t { const char *name; };
namespace wq_configurations { static constexpr wq_config_t rate_ctrl{"wq:rate_ctrl"}; }
class WorkItem {
public:
  explicit WorkItem(const char *, const wq_config_t &) {}
  virtual ~WorkItem() = default;
  virtual void Run() = 0;
};
template <typename T> class atomic {
public:
  atomic() = default;
  explicit atomic(T value) : _value(value) {}
  void store(T value) { _value = value; }
  T load() const { return _value; }
private:
  T _value{};
};
enum class params { HPROOF_ROTOR_MAX, HPROOF_IMG_AGE };
} // namespace px4
extern float px4_params[2];

class ModuleBase {
public:
  struct Descriptor {
    Descriptor(int (*ts)(int, char **), int (*cc)(int, char **), int (*pu)(const char *))
        : task_spawn(ts), custom_command(cc), print_usage(pu) {}
    int (*task_spawn)(int argc, char *argv[]);
    int (*custom_command)(int argc, char *argv[]);
    int (*print_usage)(const char *reason);
    px4::atomic<ModuleBase *> object{nullptr};
    int task_id{-1};
  };
  virtual ~ModuleBase() = default;
  static int main(Descriptor &desc, int argc, char *argv[]);
  static void exit_and_cleanup(Descriptor &desc);
  virtual int print_status() { return 0; }
  bool should_exit() const { return false; }
  static constexpr int task_id_is_work_queue = -2;
};

class ModuleParams {
public:
  explicit ModuleParams(ModuleParams *) {}
protected:
  void updateParams() {}
};
template <px4::params P> class ParamFloat {
public:
  float get() const { return px4_params[static_cast<int>(P)]; }
};
#define UNPACKED(...) __VA_ARGS__
#define DEFINE_PARAMETERS(first, second) UNPACKED first; UNPACKED second;

struct orb_metadata { const char *name; unsigned size, generation; unsigned char last[512]; };
namespace uORB {
class Subscription {
public:
  explicit Subscription(orb_metadata *meta) : _meta(meta) {}
  bool updated() const { return _meta->generation != _seen; }
  bool copy(void *to) {
    _seen = _meta->generation;
    memcpy(to, _meta->last, _meta->size);
    return _meta->generation != 0;
  }
  bool update(void *to) { return updated() && copy(to); }
private:
  orb_metadata *_meta;
  unsigned _seen{0};
};
class SubscriptionCallbackWorkItem : public Subscription {
public:
  SubscriptionCallbackWorkItem(px4::WorkItem *, orb_metadata *meta) : Subscription(meta) {}
  bool registerCallback() { return true; }
  void unregisterCallback() {}
};
template <typename T> class Publication {
public:
  explicit Publication(orb_metadata *meta) : _meta(meta) {}
  bool publish(const T &data) {
    static_assert(sizeof(T) <= sizeof(_meta->last), "a topic fits");
    memcpy(_meta->last, &data, sizeof(T));
    _meta->size = sizeof(T);
    _meta->generation++;
    return true;
  }
private:
  orb_metadata *_meta;
};
} // namespace uORB

namespace matrix {
class Vector3f {
public:
  Vector3f(float x, float y, float z) : _v{x, y, z} {}
  float operator()(unsigned i) const { return _v[i]; }
private:
  float _v[3];
};
class Quatf { /* w, x, y, z */
public:
  explicit Quatf(const float *q) : w(q[0]), x(q[1]), y(q[2]), z(q[3]) {}
  float w, x, y, z;
};
class Dcmf {
public:
  explicit Dcmf(const Quatf &q)
      : _r{{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y)},
           {2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x)},
           {2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}} {}
  Dcmf transpose() const {
    Dcmf t(*this);
    for (unsigned i = 0; i < 3; i++) { for (unsigned j = 0; j < 3; j++) { t._r[i][j] = _r[j][i]; } }
    return t;
  }
  Vector3f operator*(const Vector3f &v) const {
    float a[3];
    for (unsigned i = 0; i < 3; i++) { a[i] = _r[i][0] * v(0) + _r[i][1] * v(1) + _r[i][2] * v(2); }
    return Vector3f(a[0], a[1], a[2]);
  }
  float operator()(unsigned i, unsigned j) const { return _r[i][j]; }
private:
  float _r[3][3];
};
} // namespace matrix

struct vehicle_angular_velocity_s { uint64_t timestamp, timestamp_sample; float xyz[3], xyz_derivative[3]; };
struct vehicle_acceleration_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
struct vehicle_attitude_s { uint64_t timestamp, timestamp_sample; float q[4]; };
struct vehicle_local_position_s { uint64_t timestamp; float vx, vy, vz; bool v_xy_valid, v_z_valid, heading_good_for_control; };
struct vehicle_thrust_setpoint_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
struct vehicle_torque_setpoint_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
struct parameter_update_s { uint64_t timestamp; };
struct vehicle_status_s {
  static constexpr uint8_t ARMING_STATE_DISARMED = 1, ARMING_STATE_ARMED = 2;
  static constexpr uint8_t NAVIGATION_STATE_AUTO_LOITER = 4;
  uint64_t timestamp;
  uint8_t arming_state, nav_state, system_id, component_id;
};
struct vehicle_control_mode_s {
  uint64_t timestamp;
  bool flag_control_climb_rate_enabled, flag_control_attitude_enabled, flag_control_rates_enabled;
  bool flag_control_allocation_enabled;
  uint8_t source_id;
};
struct vehicle_command_s {
  static constexpr uint32_t VEHICLE_CMD_SET_NAV_STATE = 100001;
  uint64_t timestamp;
  float param1;
  uint32_t command;
  uint8_t target_system, target_component, source_system;
  uint16_t source_component;
};
struct register_ext_component_request_s {
  static constexpr uint16_t LATEST_PX4_ROS2_API_VERSION = 1;
  uint64_t timestamp, request_id;
  uint16_t px4_ros2_api_version;
  char name[25];
  bool register_arming_check, register_mode;
};
struct register_ext_component_reply_s {
  uint64_t timestamp, request_id;
  bool success;
  int8_t arming_check_id, mode_id;
};
struct unregister_ext_component_s { uint64_t timestamp; char name[25]; int8_t arming_check_id, mode_id; };
struct arming_check_request_s { uint64_t timestamp; uint8_t request_id; };
struct arming_check_reply_s {
  static constexpr uint8_t HEALTH_COMPONENT_INDEX_NONE = 0;
  uint64_t timestamp;
  uint8_t request_id, registration_id, health_component_index;
  bool can_arm_and_run, mode_req_angular_velocity, mode_req_attitude, mode_req_local_alt, mode_req_local_position;
  bool mode_req_prevent_arming;
};
#define TOPICS(each)                                                                          \
  each(vehicle_angular_velocity) each(vehicle_attitude) each(vehicle_local_position)          \
  each(vehicle_thrust_setpoint) each(vehicle_torque_setpoint) each(vehicle_acceleration)      \
  each(parameter_update) each(vehicle_status) each(config_control_setpoints)                  \
  each(vehicle_command) each(register_ext_component_request)                                  \
  each(register_ext_component_reply) each(unregister_ext_component)                           \
  each(arming_check_request) each(arming_check_reply) each(hoverproof_image)
#define DECLARED(name) extern orb_metadata name##_metadata;
TOPICS(DECLARED)
