#include "robocell/robot/joint_resistance.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <vector>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"

namespace robocell::internal {
namespace {

// Returns the forces of constraints of joints at constant speeds, here of friction alone.
std::vector<double> EngineFriction(const mjModel* m, mjData* d) {
  std::fill_n(d->qacc, m->nv, 0.0);
  mj_inverse(m, d);
  return {d->qfrc_constraint, d->qfrc_constraint + m->nv};
}

// Two consecutive hinges, with every resistance that a joint and its actuator can have.
constexpr const char* kStiffJoints = R"(<mujoco>
  <compiler angle="radian"/>
  <default><joint armature="0.05" damping="2 3 5" stiffness="20 5 3" springref="0.4" frictionloss="7"/>
    <geom type="capsule" contype="0" conaffinity="0" size="0.03"/></default>
  <worldbody>
    <body name="upper"><joint name="j1" axis="0 0 1"/><geom mass="2" fromto="0 0 0 0.3 0 0"/>
      <body name="fore" pos="0.3 0 0"><joint name="j2" axis="0 1 0"/>
        <geom mass="1" fromto="0 0 0 0.3 0 0"/></body></body>
  </worldbody>
  <actuator><position joint="j1" kp="500" damping="12 2 1" gear="2"/>
    <position joint="j2" kp="500" damping="12 2 1" gear="2"/></actuator>
</mujoco>)";

TEST(JointResistance, MatchesTheEngineWithEachPartOnAndOff) {
  const ModelPtr model = Compile(ParseXmlString(kStiffJoints).get());
  const DataPtr data = MakeData(model.get());
  mjModel* m = model.get();
  mjData* d = data.get();
  const std::vector<int> joints = {0, 1};
  const int on = m->opt.disableflags;
  for (const int off : {0, int{mjDSBL_SPRING}, int{mjDSBL_DAMPER}, mjDSBL_SPRING | mjDSBL_DAMPER,
                        int{mjDSBL_FRICTIONLOSS}, int{mjDSBL_CONSTRAINT}}) {
    SCOPED_TRACE(off);
    m->opt.disableflags = on | off;
    for (const double x : {-1.3, -0.2, -1e-3, 1e-6, 0.0, 0.6, 2.1}) {
      const std::vector<double> q = {x, 0.3 - x}, v = {0.5 - x, 1.1 * x};
      std::copy_n(q.data(), 2, d->qpos);
      std::copy_n(v.data(), 2, d->qvel);
      mj_forward(m, d);
      const std::vector<double> passive(d->qfrc_passive, d->qfrc_passive + 2);
      const std::vector<double> friction = EngineFriction(m, d);
      std::vector<double> torque = {10, 20};
      AddJointResistance(m, joints, q, v, torque);
      for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(torque[i], 10.0 * (i + 1) - passive[i] - friction[i], 1e-9) << x;
      }
    }
  }
}

}  // namespace
}  // namespace robocell::internal
