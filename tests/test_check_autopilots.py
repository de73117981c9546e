"""The check of packages inside autopilots' trees, with a stand-in of a tree."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import harnesses
from firmware_kit import export, tool
from hoverproof.mavlink.autopilots import AUTOPILOTS

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "tools" / "check-autopilots"
sys.path.append(str(SCRIPT.parent))

from autopilot_parameters import GUIDE, looked_up, named  # noqa: E402

STUBS = ROOT / "tests" / "stubs" / "ardupilot"
pytestmark = pytest.mark.slow


def check(*arguments):
    command = [sys.executable, ROOT / "tools" / "check-autopilots", *arguments]
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)


def tree(folder, *flags):
    """Make a tree of ArduPilot that has been configured: stand-ins, and how it compiles a file."""
    file = "libraries/AC_CustomControl/AC_CustomControl_PID.cpp"
    words = ["g++", "-std=gnu++11", f"-I{STUBS}", *flags, "-c", file, "-o", "made.o"]
    build = folder / "build" / "sitl"
    build.mkdir(parents=True)
    listed = [{"directory": str(folder), "file": file, "arguments": words}]
    (build / "compile_commands.json").write_text(json.dumps(listed))
    ardupilot_tree(folder, None, 1)
    return folder


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_package_is_compiled_by_the_flags_of_a_tree_and_its_selftest_run(precision, tmp_path):
    tool("g++")
    package = export(tmp_path / "fw", "crazyflie-2.1", precision=precision, allow_uncertified=True)
    done = check(package.folder, "--ardupilot", tree(tmp_path / "tree", "-O2", "-Wall", "-Werror"))
    assert done.returncode == 0, done.stdout
    assert f"{package.name} {precision}: compiled; self-test passes here (-O2); by its mixer" in (
        done.stdout
    )
    assert "parameters of the guide are there" in done.stdout


def test_what_does_not_compile_and_a_selftest_that_fails_are_told(tmp_path):
    tool("g++")
    package = export(tmp_path / "fw")
    other = tree(tmp_path / "tree", "-DAC_CustomControl_Backend=AnotherBackend", "-fno-such-flag")
    done = check(package.folder, "--ardupilot", other)
    assert done.returncode == 1
    assert "FAILED: g++" in done.stdout
    assert "no-such-flag" in done.stdout
    source = package.sources[1]
    source.write_text(source.read_text().replace("  return failed;", "  return failed + 1U;"))
    done = check(package.folder, "--ardupilot", tree(tmp_path / "good"))
    assert done.returncode == 1
    assert "FAILED: " in done.stdout


def test_no_tree_and_no_package_are_said_to_be_missing(tmp_path):
    package = export(tmp_path / "fw")
    for wrong in ((package.folder,), (tmp_path, "--ardupilot", tmp_path)):
        done = check(*wrong)
        assert done.returncode == 2
        assert "Traceback" not in done.stderr
    done = check(package.folder, "--px4", tmp_path)
    assert done.returncode == 1
    assert "has no ActuatorEffectiveness.cpp below src/lib/control_allocation" in done.stdout


TYPES = """
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
typedef enum { controlModeLegacy = 0, controlModeForceTorque = 1 } control_mode_t;
typedef struct { float thrustSi, torqueX, torqueY, torqueZ; control_mode_t controlMode; } control_t;
typedef struct { int32_t list[4]; } motors_thrust_uncapped_t;
typedef struct { uint16_t list[4]; } motors_thrust_pwm_t;
#define THRUST_MAX 0.15f
"""
"""What a mixer of the Crazyflie has to do with, in brief."""

MIXER = """
#include "power_distribution.h"
void powerDistribution(const control_t *c, motors_thrust_uncapped_t *out)
{
  static const int side[4] = { -1, -1, 1, 1 }, front[4] = { 1, -1, -1, 1 };
  static const int turn[4] = { -1, 1, -1, 1 };
  int i;
  for (i = 0; (i < 4) && (c->controlMode == controlModeForceTorque); i++) {
    const float roll = ROLL * side[i] * c->torqueX, pitch = -front[i] * c->torqueY;
    const float force = (c->thrustSi + (roll + pitch) / ARM + turn[i] * c->torqueZ / DRAG) / 4.0f;
    out->list[i] = (force < 0.0f) ? 0 : (int32_t)(force / THRUST_MAX * 65535.0f);
  }
}
bool powerDistributionCap(const motors_thrust_uncapped_t *in, motors_thrust_pwm_t *out)
{
  int i;
  for (i = 0; i < 4; i++) out->list[i] = (in->list[i] > 65535) ? 65535 : (uint16_t)in->list[i];
  return false;
}
"""


def crazyflie_tree(folder, package, roll):
    """Make a tree with a mixer of its own, right if `roll` is 1."""
    place = folder / "src" / "modules" / "src"
    place.mkdir(parents=True)
    vehicle = package.manifest["mission"]["vehicle"]
    arm, drag = (f"(({vehicle[k]}.0f))".replace("/", ".0f/") for k in ("arm", "drag_ratio"))
    macros = f"#define ROLL {roll}\n#define ARM {arm}\n#define DRAG {drag}\n"
    (place / "power_distribution.h").write_text("#pragma once\n" + TYPES + macros)
    (place / "power_distribution_quadrotor.c").write_text(MIXER)


ALLOCATION = """
#pragma once
#include <mathlib/mathlib.h>
#include <px4_platform_common/module_params.h>
enum class EffectivenessUpdateReason { CONFIGURATION_UPDATE };
struct ActuatorEffectiveness {
  static constexpr int MAX_NUM_MATRICES = 1;
  struct Configuration {
    int effectiveness_matrices[1], trim[1], linearization_point[1], num_actuators_matrix[1];
  };
};
struct ActuatorEffectivenessMultirotor {
  explicit ActuatorEffectivenessMultirotor(ModuleParams *) {}
  void getNormalizeRPY(bool *normalize) { *normalize = true; }
  bool getEffectivenessMatrix(ActuatorEffectiveness::Configuration &, EffectivenessUpdateReason) {
    float x = 0;
    return param_get(param_find("CA_ROTOR0_PX"), &x) == 0 && x > 0;
  }
};
struct ControlAllocation {
  static constexpr int NUM_AXES = 6, THRUST_Z = 5;
  typedef matrix::Vector<float, 16> ActuatorVector;
};
struct ControlAllocationSequentialDesaturation : ControlAllocation {
  matrix::Vector<float, 6> asked;
  ActuatorVector told;
  void setNormalizeRPY(bool) {}
  void updateParameters() {}
  void setActuatorMin(const ActuatorVector &) {}
  void setActuatorMax(const ActuatorVector &) {}
  void setEffectivenessMatrix(int, int, int, int, bool) {}
  void setControlSetpoint(const matrix::Vector<float, 6> &v) { asked = v; }
  void clipActuatorSetpoint() {}
  const ActuatorVector &getActuatorSetpoint() { return told; }
  void allocate() {
    const float right[4] = { 1, -1, -1, 1 }, front[4] = { 1, -1, 1, -1 };
    const float turn[4] = { 1, 1, -1, -1 }, half = 0.70710678f;
    for (int i = 0; i < 4; i++) {
      told(i) = -asked(5) - ROLL * right[i] * asked(0) * half + front[i] * asked(1) * half;
      told(i) += turn[i] * asked(2);
    }
  }
};
"""
"""What is asked of the allocation of PX4, in brief."""

MATHLIB = """
#pragma once
namespace matrix {
template <typename T, int N> struct Vector {
  T v[N] = {};
  T &operator()(int i) { return v[i]; }
  const T &operator()(int i) const { return v[i]; }
  void setAll(T a) { for (T &x : v) { x = a; } }
};
}
"""


def px4_tree(folder, package, roll):
    """Make a tree with an allocation of its own, right if `roll` is 1."""
    library, allocation = folder / "src" / "lib" / "mathlib", "src/lib/control_allocation"
    library.mkdir(parents=True)
    (library / "mathlib.h").write_text(MATHLIB)
    place = folder / allocation
    place.mkdir()
    for name in harnesses.MIXERS["px4"].sources:
        (place / f"{name}.cpp").write_text(f'#include "{name}.hpp"\n')
        (place / f"{name}.hpp").write_text('#include "all.hpp"\n')
    (place / "all.hpp").write_text(ALLOCATION.replace("ROLL", str(roll)))
    parameters = named(GUIDE.read_text(), "PX4")
    put_parameters(folder, [name for name, _ in parameters])


def put_parameters(folder, names, more=""):
    """Write what a tree of PX4 says of parameters."""
    lines = "".join(f"        {name}:\n            type: int32\n{more}" for name in names)
    told = f"module_name: it\nparameters:\n    - group: G\n      definitions:\n{lines}"
    (folder / "src").mkdir(exist_ok=True)
    (folder / "src" / "module.yaml").write_text(told)


MOTORS = """
#pragma once
#include <AP_HAL/AP_HAL.h>
class AP_Motors {
public:
  enum { MOTOR_FRAME_QUAD, MOTOR_FRAME_TYPE_X };
  enum class SpoolState { SHUT_DOWN, THROTTLE_UNLIMITED };
  enum class DesiredSpoolState { THROTTLE_UNLIMITED };
};
class AP_MotorsMatrix : public AP_Motors {
public:
  void init(int, int) {}
  void set_dt(float) {}
  void armed(bool is) { on = is; }
  void set_interlock(bool) {}
  SpoolState get_spool_state() { return SpoolState::THROTTLE_UNLIMITED; }
  void set_desired_spool_state(DesiredSpoolState) {}
  void set_roll(float v) { roll = v; }
  void set_pitch(float v) { pitch = v; }
  void set_yaw(float v) { yaw = v; }
  void set_throttle(float v) { throttle = v; }
  void set_roll_ff(float) {}
  void set_pitch_ff(float) {}
  void set_yaw_ff(float) {}
  void set_throttle_filter_cutoff(float) {}
  int get_pwm_output_min() { return 1000; }
  int get_pwm_output_max() { return 2000; }
  void output();
  bool on = false;
  float roll = 0, pitch = 0, yaw = 0, throttle = 0;
};
"""
"""What is asked of the motors library of ArduPilot, in brief."""

OUTPUT = """
#include "AP_MotorsMatrix.h"
void AP_MotorsMatrix::output() {
  const float right[4] = { 1, -1, -1, 1 }, front[4] = { 1, -1, 1, -1 }, turn[4] = { 1, 1, -1, -1 };
  for (int i = 0; i < 4; i++) {
    const float u = throttle + (-ROLL * right[i] * roll + front[i] * pitch + turn[i] * yaw) / 2;
    const float pwm = on ? 1000 + 1000 * constrain_float(u, 0, 1) : 1000;
    SRV_Channels::set_output_pwm(SRV_Channels::get_motor_function(i), pwm);
  }
}
"""


def ardupilot_tree(folder, package, roll):
    """Make a tree with motors of its own, right if `roll` is 1."""
    place = folder / "libraries" / "AP_Motors"
    place.mkdir(parents=True)
    (folder / "libraries" / "Filter").mkdir()
    for name in harnesses.MIXERS["ardupilot"].sources:
        (place / f"{name}.cpp").write_text("")
    (place / "AP_MotorsMatrix.h").write_text(MOTORS)
    (place / "AP_MotorsMatrix.cpp").write_text(OUTPUT.replace("ROLL", str(roll)))
    names = [name.replace("x", "4") for name, _ in named(GUIDE.read_text(), "ArduPilot")]
    tells_parameters(folder, {"": {name: {} for name in [*names, *REGISTERING]}})


REGISTERING = ("CUSTOMCONTROL_MAX_TYPES", "CONT_PID", "DOUBLE_PRECISION_SOURCES")
REGISTERING += ("CC_TYPE", "CC_AXIS_MASK", "RC4_OPTION")


def tells_parameters(folder, groups):
    """Write a script of a tree of ArduPilot that tells these parameters."""
    script = folder / "Tools" / "autotest" / "param_metadata" / "param_parse.py"
    script.parent.mkdir(parents=True, exist_ok=True)
    script.write_text(f"import json\njson.dump({groups!r}, open('apm.pdef.json', 'w'))\n")


TREES = {"crazyflie": crazyflie_tree, "px4": px4_tree, "ardupilot": ardupilot_tree}


@pytest.mark.parametrize("autopilot", TREES)
def test_a_package_flies_by_the_mixer_of_a_tree_if_that_is_right(autopilot, tmp_path):
    tool("g++")
    loader = importlib.machinery.SourceFileLoader("check_autopilots", str(SCRIPT))
    checks = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(checks)
    package = export(tmp_path / "fw", "crazyflie-2.1", allow_uncertified=True)
    for roll in (1, -1):
        folder = tmp_path / f"roll{roll}"
        (folder / "at").mkdir(parents=True)
        TREES[autopilot](folder, package, roll)
        flight = (autopilot, package.folder, folder, folder / "at")
        if roll == 1:
            assert "with 85 to 115 % of thrust, and power is cut" in checks.by_mixer(*flight)
        else:
            with pytest.raises(harnesses.Failure):
                checks.by_mixer(*flight)


def test_parameters_that_px4_has_not_or_that_are_never_so_are_told(tmp_path):
    package = export(tmp_path / "fw")
    names = [name for name, _ in named(GUIDE.read_text(), "PX4")]
    assert {"COM_OF_LOSS_T", "COM_RC_OVERRIDE", "MAV_1_CONFIG", "THR_MDL_FAC"} <= set(names)
    names[names.index("MAV_1_CONFIG")] = "MAV_${i}_CONFIG"
    put_parameters(tmp_path, names)
    assert f"all {len(set(names))} parameters" in looked_up("px4", tmp_path, package.folder)
    put_parameters(tmp_path, [name for name in names if name != "COM_RC_OVERRIDE"])
    with pytest.raises(harnesses.Failure, match=r"guide: no COM_RC_OVERRIDE$"):
        looked_up("px4", tmp_path, package.folder)
    put_parameters(tmp_path, names, "            max: 4\n")
    with pytest.raises(harnesses.Failure, match="COM_OBL_RC_ACT is never 5, "):
        looked_up("px4", tmp_path, package.folder)


def test_parameters_that_ardupilot_has_not_or_that_are_never_so_are_told(tmp_path):
    package = export(tmp_path / "fw")
    texts = (GUIDE.read_text(), (package.folder / "adapters" / "README.md").read_text())
    found = [name for text in texts for name, _ in named(text, "ArduPilot")]
    code = {"CUSTOMCONTROL_MAX_TYPES", "CONT_PID", "DOUBLE_PRECISION_SOURCES"} & set(found)
    names = [name.replace("x", "4") for name in found if name not in code]
    library = tmp_path / "libraries" / "AC_CustomControl"
    library.mkdir(parents=True)
    (library / "AC_CustomControl.h").write_text(" ".join(code))
    (tmp_path / "Tools" / "ardupilotwaf").mkdir(parents=True)

    def tells(groups):
        tells_parameters(tmp_path, groups)
        return looked_up("ardupilot", tmp_path, package.folder)

    all_of_them = {"json": {"version": 0}, "": {name: {} for name in names}}
    assert "parameters of the guide are there" in tells(all_of_them)
    bits = {"Bitmask": {"0": "arm", "2": "yaw"}}
    all_of_them[""]["GUID_OPTIONS"] = bits
    with pytest.raises(harnesses.Failure, match=r"GUID_OPTIONS is never 8$"):
        tells(all_of_them)
    del all_of_them[""]["GUID_OPTIONS"]
    with pytest.raises(harnesses.Failure, match=r"no GUID_OPTIONS$"):
        tells(all_of_them)


def test_what_an_autopilot_falls_back_on_is_in_the_guide():
    for known in AUTOPILOTS.values():
        words = re.findall(r"[A-Z0-9]+_[A-Z0-9_]+", known.fallback)
        assert words
        assert set(words) <= {name for name, _ in named(GUIDE.read_text(), known.name)}
