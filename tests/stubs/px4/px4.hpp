/* What a module sees of PX4, in brief; the other headers of this folder lead here. */
#pragma once
#include <cstdint>

#define __EXPORT __attribute__((visibility("default")))
#define MODULE_NAME "stub"
#define PX4_OK 0
#define PX4_ERROR (-1)
#define PX4_WARN(...) px4_log(__VA_ARGS__)
#define PRINT_MODULE_USAGE_NAME(name, category) px4_log(name)
#define PRINT_MODULE_USAGE_COMMAND(command) px4_log(command)
#define PRINT_MODULE_USAGE_DEFAULT_COMMANDS() px4_log("stop, status")
#define ORB_ID(name) (&name##_metadata)
void px4_log(const char *format, ...) __attribute__((format(printf, 1, 2)));

typedef uint64_t hrt_abstime;
hrt_abstime hrt_absolute_time();
hrt_abstime hrt_elapsed_time(const hrt_abstime *then);

namespace px4 {
struct wq_config_t { const char *name; };
namespace wq_configurations { static constexpr wq_config_t rate_ctrl{"wq:rate_ctrl"}; }
class WorkItem {
public:
  explicit WorkItem(const char *name, const wq_config_t &config);
  virtual ~WorkItem() = default;
  virtual void Run() = 0;
};
template <typename T> class atomic {
public:
  void store(T value) { _value = value; }
private:
  T _value{};
};
} // namespace px4

template <class T> class ModuleBase {
public:
  static int main(int argc, char *argv[]);
  bool should_exit() const;
  static void exit_and_cleanup();
  static constexpr int task_id_is_work_queue = -2;
protected:
  static px4::atomic<T *> _object;
  static int _task_id;
};
template <class T> px4::atomic<T *> ModuleBase<T>::_object;
template <class T> int ModuleBase<T>::_task_id;

struct orb_metadata { const char *name; };
namespace uORB {
class Subscription {
public:
  explicit Subscription(const orb_metadata *meta);
  bool copy(void *to);
  bool update(void *to);
};
class SubscriptionCallbackWorkItem : public Subscription {
public:
  SubscriptionCallbackWorkItem(px4::WorkItem *item, const orb_metadata *meta);
  bool registerCallback();
  void unregisterCallback();
};
template <typename T> class Publication {
public:
  explicit Publication(const orb_metadata *meta);
  bool publish(const T &data);
};
} // namespace uORB

namespace matrix {
class Quatf { public: explicit Quatf(const float *q); };
class Vector3f {
public:
  Vector3f(float x, float y, float z);
  float operator()(unsigned i) const;
};
class Dcmf {
public:
  explicit Dcmf(const Quatf &q);
  Dcmf transpose() const;
  Vector3f operator*(const Vector3f &v) const;
  float operator()(unsigned i, unsigned j) const;
};
} // namespace matrix

struct vehicle_angular_velocity_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
struct vehicle_acceleration_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
struct vehicle_attitude_s { uint64_t timestamp; float q[4]; };
struct vehicle_local_position_s { uint64_t timestamp; float vx, vy, vz; bool v_xy_valid, v_z_valid, heading_good_for_control; };
struct vehicle_thrust_setpoint_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
struct vehicle_torque_setpoint_s { uint64_t timestamp, timestamp_sample; float xyz[3]; };
extern const orb_metadata vehicle_angular_velocity_metadata, vehicle_attitude_metadata;
extern const orb_metadata vehicle_local_position_metadata, vehicle_thrust_setpoint_metadata;
extern const orb_metadata vehicle_torque_setpoint_metadata, vehicle_acceleration_metadata;
