/* The mixer of a tree of the Crazyflie, its own file, from what a controller asks for to the thrust of
 * each rotor, N. */
#include <stdbool.h>
#include <stddef.h>

#include "power_distribution_quadrotor.c"

void tree_mixer(int force_torque, float thrust, const float torque[3], float force[4]);
void tree_mixer(int force_torque, float thrust, const float torque[3], float force[4])
{
  control_t asked;
  motors_thrust_uncapped_t wanted;
  motors_thrust_pwm_t given;
  int i;
  memset(&asked, 0, sizeof(asked));
  memset(&wanted, 0, sizeof(wanted));
  if (force_torque) {
    asked.controlMode = controlModeForceTorque;
    asked.thrustSi = thrust;
    asked.torqueX = torque[0];
    asked.torqueY = torque[1];
    asked.torqueZ = torque[2];
  }
  powerDistribution(&asked, &wanted);
  (void)powerDistributionCap(&wanted, &given);
  for (i = 0; i < 4; i++) {
    force[i] = (float)given.list[i] / 65535.0f * THRUST_MAX;
  }
}
