/* The control allocation of a tree of PX4, its own files, from setpoints of torque and thrust to the share
 * of its most that each rotor is told: what ControlAllocator does of it with a multirotor, and CA_METHOD
 * by default. The rotors are those of px4.cpp, told by the names of their parameters. */
#include "ActuatorEffectivenessMultirotor.hpp"
#include "ControlAllocationSequentialDesaturation.hpp"

static const double place[4][3] = { { 1, 1, 1 }, { -1, -1, 1 }, { 1, -1, -1 }, { -1, 1, -1 } };
static char names[128][20];

param_t param_find(const char *name)
{
  for (auto &kept : names) {
    if ((kept[0] == '\0') || (strcmp(kept, name) == 0)) {
      (void)snprintf(kept, sizeof(kept), "%s", name);
      return reinterpret_cast<param_t>(kept);
    }
  }
  return 0;
}

int param_get(param_t param, void *value)
{
  const char *name = reinterpret_cast<const char *>(param);
  unsigned rotor = 0;
  char what[8] = "";
  int32_t number = 0; /* MC_AIRMODE: off */
  float real = 0.0f;
  if (sscanf(name, "CA_ROTOR%u_%7s", &rotor, what) == 2) {
    const double *at = place[rotor % 4];
    const char *of[] = { "PX", "PY", "AZ", "CT", "KM" };
    const double known[] = { at[0] * V_ARM, at[1] * V_ARM, -1.0, 6.5, at[2] * V_DRAG };
    for (int i = 0; i < 5; i++) {
      real = (strcmp(what, of[i]) == 0) ? static_cast<float>(known[i]) : real;
    }
    memcpy(value, &real, sizeof(real));
    return 0;
  }
  number = (strcmp(name, "CA_ROTOR_COUNT") == 0) ? 4 : number;
  memcpy(value, &number, sizeof(number));
  return 0;
}

__attribute__((visibility("default"))) void tree_mixer(const double setpoint[4], double share[4]);
void tree_mixer(const double setpoint[4], double share[4])
{
  static ControlAllocationSequentialDesaturation allocation;
  static bool ready = false;
  if (!ready) {
    static ActuatorEffectivenessMultirotor rotors(nullptr);
    ActuatorEffectiveness::Configuration config{};
    bool normalize[ActuatorEffectiveness::MAX_NUM_MATRICES];
    ControlAllocation::ActuatorVector lowest, highest;
    rotors.getNormalizeRPY(normalize);
    (void)rotors.getEffectivenessMatrix(config, EffectivenessUpdateReason::CONFIGURATION_UPDATE);
    highest.setAll(1.0f);
    allocation.setNormalizeRPY(normalize[0]);
    allocation.updateParameters();
    allocation.setActuatorMin(lowest);
    allocation.setActuatorMax(highest);
    allocation.setEffectivenessMatrix(
        config.effectiveness_matrices[0], config.trim[0], config.linearization_point[0],
        config.num_actuators_matrix[0], true);
    ready = true;
  }
  matrix::Vector<float, ControlAllocation::NUM_AXES> asked;
  for (int axis = 0; axis < 3; axis++) {
    asked(axis) = static_cast<float>(setpoint[axis]);
  }
  asked(ControlAllocation::THRUST_Z) = static_cast<float>(setpoint[3]);
  allocation.setControlSetpoint(asked);
  allocation.allocate();
  allocation.clipActuatorSetpoint();
  for (int i = 0; i < 4; i++) {
    share[i] = static_cast<double>(allocation.getActuatorSetpoint()(i));
  }
}
