// Tests actuators and groups of control modes: added, unchanged and rejected ones.
#include "robocell/scene/control_modes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Modes = std::vector<CtrlMode>;

constexpr CtrlMode kPosition = CtrlMode::kPosition, kVelocity = CtrlMode::kVelocity,
                   kTorque = CtrlMode::kTorque;

class ControlModes : public ::testing::Test {
 protected:
  ModelFolder folder;
  std::string arm = folder.Write("arm", kTwoJointArm);
  std::string gripper = folder.Write("gripper", kTwoFingerGripper);

  // Arms side by side, without a configuration.
  SceneSpec Arms(int count, std::optional<Modes> modes) {
    SceneSpec spec = EmptyScene();
    for (int i = 0; i < count; ++i) {
      spec.robots.push_back({.path = arm,
                             .prefix = "a" + std::to_string(i) + "_",
                             .pos = {0, 1.0 * i, 0},
                             .control_modes = modes});
    }
    return spec;
  }
};

int Actuator(const mjModel* m, const std::string& name) {
  return RequireId(m, mjOBJ_ACTUATOR, name, "");
}

int GroupOf(const mjModel* m, const std::string& name) {
  return m->actuator_group[Actuator(m, name)];
}

bool IsOn(const mjModel* m, const std::string& name) {
  return !(m->opt.disableactuator & (1 << GroupOf(m, name)));
}

TEST_F(ControlModes, MotorsComeLastInTheirOwnGroup) {
  SceneSpec spec = Arms(2, std::nullopt);
  spec.robots[0].attachments.push_back(
      {.mjcf_path = gripper, .attach_to = Site("flange"), .prefix = "g_"});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  EXPECT_THAT(
      ElementNames(m, mjOBJ_ACTUATOR),
      ElementsAre("a0_servo1", "a0_servo2", "a0_g_grip", "a0_shoulder_torque", "a0_elbow_torque",
                  "a1_servo1", "a1_servo2", "a1_shoulder_torque", "a1_elbow_torque"));
  EXPECT_EQ(GroupOf(m, "a0_g_grip"), 0);
  EXPECT_EQ(GroupOf(m, "a0_servo1"), GroupOf(m, "a0_servo2"));
  const std::set<int> groups = {GroupOf(m, "a0_servo1"), GroupOf(m, "a0_elbow_torque"),
                                GroupOf(m, "a1_servo1"), GroupOf(m, "a1_elbow_torque")};
  EXPECT_EQ(groups, (std::set<int>{1, 2, 3, 4}));
  EXPECT_TRUE(IsOn(m, "a0_servo1") && IsOn(m, "a0_g_grip") && IsOn(m, "a1_servo2"));
  EXPECT_FALSE(IsOn(m, "a0_shoulder_torque") || IsOn(m, "a1_elbow_torque"));
  EXPECT_EQ(scene.actuator_ctrl("a0_shoulder_torque"), 0) << "at home";
}

TEST_F(ControlModes, PositionAloneLeavesTheModelAsAuthored) {
  const Scene scene = Scene::Build(Arms(1, Modes{kPosition}));
  const mjModel* m = scene.model();
  EXPECT_EQ(m->nu, 2);
  EXPECT_EQ(GroupOf(m, "a0_servo1"), 0);
  EXPECT_EQ(m->opt.disableactuator, 0);
}

TEST_F(ControlModes, AddedActuatorsHaveGearAndForceLimitOfTheServo) {
  std::string model = kTwoJointArm;
  const std::string servo = R"(<position name="servo1" joint="shoulder" kp="100" kv="10"/>)";
  model.replace(model.find(servo), servo.size(),
                R"(<position name="servo1" joint="shoulder" kp="100" kv="10" gear="3"
                   forcerange="-7 8"/>)");
  SceneSpec spec = Arms(1, Modes{kPosition, kVelocity, kTorque});
  spec.robots[0].path = folder.Write("geared", model);
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  for (const std::string name : {"a0_shoulder_torque", "a0_shoulder_velocity"}) {
    const int id = Actuator(m, name);
    EXPECT_EQ(m->actuator_gear[6 * id], 3);
    EXPECT_TRUE(m->actuator_forcelimited[id]);
    EXPECT_EQ(m->actuator_forcerange[2 * id], -7);
    EXPECT_EQ(m->actuator_forcerange[2 * id + 1], 8);
    EXPECT_FALSE(m->actuator_ctrllimited[id]);
  }
  const int brake = Actuator(m, "a0_shoulder_velocity");
  EXPECT_EQ(m->actuator_gainprm[mjNGAIN * brake], 10) << "as the servo brakes";
  EXPECT_EQ(m->actuator_biasprm[mjNBIAS * brake + 2], -10);
  EXPECT_FALSE(m->actuator_forcelimited[Actuator(m, "a0_elbow_torque")]);
}

TEST_F(ControlModes, RejectActuatorsWithTheirNames) {
  std::string model = kTwoJointArm;
  model.replace(model.find("</actuator>"), 0,
                R"(<motor name="elbow_torque" joint="elbow" gear="2"/>)");
  SceneSpec spec = Arms(1, Modes{kPosition, kTorque});
  spec.robots[0].path = folder.Write("named", model);
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      "robot 'a0': the control mode torque brings an actuator 'elbow_torque' for joint 'elbow', "
      "and the model has one of that name. Rename it in the model, or set control_modes without "
      "torque");
  spec.robots[0].control_modes = Modes{kPosition};
  Scene::Build(spec);
}

// The arm with motors, the one at the shoulder geared and limited in its control.
constexpr const char* kServos[] = {R"(<position name="servo1" joint="shoulder" kp="100" kv="10"/>)",
                                   R"(<position name="servo2" joint="elbow" kp="50" kv="5"/>)"};

std::string WithActuators(const std::string& shoulder, const std::string& elbow) {
  std::string model = kTwoJointArm;
  for (const auto& [servo, actuator] : {std::pair{kServos[0], shoulder}, {kServos[1], elbow}})
    model.replace(model.find(servo), std::string(servo).size(), actuator);
  return model;
}

TEST_F(ControlModes, VelocityServosOfMotorArmsMatchInertiaAndForceLimits) {
  RobotConfig config = ArmConfig(
      folder.Write("motors", WithActuators(R"(<motor name="servo1" joint="shoulder" gear="-4"
                                  ctrlrange="-0.5 1" forcerange="-9 0.7"/>)",
                                           R"(<general name="servo2" joint="elbow" gainprm="-3"
                                  ctrlrange="-2 1"/>)")));
  config.home["arm"] = {0.2, 0.9};
  config.control["arm"] = ControlKind::kJointTorque;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "a", .config = config, .prefix = "a_"});
  spec.robots[0].control_modes = Modes{kVelocity, kTorque};
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  std::vector<mjtNum> inertia(m->nv * m->nv);
  mj_fullM(m, scene.data(), inertia.data());
  const struct {
    const char* joint;
    double gear, low, high;
  } joints[] = {{"shoulder", -4, -0.5, 0.7}, {"elbow", 1, -3, 6}};
  for (const auto& [joint, gear, low, high] : joints) {
    const int id = Actuator(m, std::string("a_") + joint + "_velocity");
    const int dof = m->jnt_dofadr[RequireId(m, mjOBJ_JOINT, std::string("a_") + joint, "")];
    const double gain = inertia[dof * m->nv + dof] / 0.05 / (gear * gear);
    EXPECT_NEAR(m->actuator_gainprm[mjNGAIN * id], gain, 1e-9 * gain) << joint;
    EXPECT_NEAR(m->actuator_biasprm[mjNBIAS * id + 2], -gain, 1e-9 * gain) << joint;
    EXPECT_EQ(m->actuator_gear[6 * id], gear);
    EXPECT_TRUE(m->actuator_forcelimited[id]) << joint;
    EXPECT_EQ(m->actuator_forcerange[2 * id], low) << joint;
    EXPECT_EQ(m->actuator_forcerange[2 * id + 1], high) << joint;
  }
}

TEST_F(ControlModes, TheEngineRejectsAReversedForceRange) {
  arm = folder.Write("turned", R"(<compiler autolimits="true"/><worldbody><body name="base">
    <geom size="0.1"/><body><joint name="hinge"/><geom size="0.1"/></body></body></worldbody>
    <actuator><motor name="motor" joint="hinge" ctrlrange="-1 1" forcelimited="true"
    forcerange="5 -5"/></actuator>)");
  const SceneSpec spec = Arms(1, Modes{kVelocity, kTorque});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "turned.xml:3: actuator 'motor': invalid force range for actuator");
}

TEST_F(ControlModes, VelocityServosOfUndampedServosAreCriticallyDamped) {
  SceneSpec spec = Arms(1, Modes{kPosition, kVelocity});
  spec.robots[0].path = folder.Write(
      "undamped",
      WithActuators(R"(<position name="servo1" joint="shoulder" kp="100" gear="5"/>)", kServos[1]));
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  const int dof = m->jnt_dofadr[RequireId(m, mjOBJ_JOINT, "a0_shoulder", "")];
  const double joint_gain = 25 * m->actuator_gainprm[mjNGAIN * Actuator(m, "a0_shoulder_velocity")];
  EXPECT_NEAR(joint_gain, 2 * std::sqrt(100 * 25 / m->dof_invweight0[dof]), 1e-9 * joint_gain);
}

// A PD pair on each joint, whose position servos do not brake.
std::string PdPair(const std::string& more = "") {
  std::string model = WithActuators(
      R"(<position name="servo1" joint="shoulder" kp="100"/>
         <velocity name="brake1" joint="shoulder" kv="8"/>)",
      R"(<position name="servo2" joint="elbow" kp="50" gear="2"/>
         <velocity name="brake2" joint="elbow" kv="6"/><motor name="push" joint="elbow"/>)" +
          more);
  model.replace(model.find("ctrl=\"0.31 -0.41\""), 17, "");
  return model;
}

TEST_F(ControlModes, SwitchTheVelocityServosBesidePositionServos) {
  SceneSpec spec = Arms(1, Modes{kPosition, kVelocity, kTorque});
  spec.robots[0].path = folder.Write("pair", PdPair());
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  for (const std::string name : {"brake1", "brake2", "servo2"})
    EXPECT_EQ(GroupOf(m, "a0_" + name), GroupOf(m, "a0_servo1")) << name;
  EXPECT_EQ(GroupOf(m, "a0_push"), 0) << "pushes only as commanded";
  EXPECT_THAT(scene.compiled()->notes(), IsEmpty());
  const auto gain = [&](const std::string& joint) {
    return m->actuator_gainprm[mjNGAIN * Actuator(m, "a0_" + joint + "_velocity")];
  };
  EXPECT_DOUBLE_EQ(gain("shoulder"), 8);
  EXPECT_DOUBLE_EQ(gain("elbow"), 6.0 / 4) << "with the gear of the position servo";
}

// The oracle is the model with motors alone.
TEST_F(ControlModes, OfAPairPushLikeSingleMotors) {
  RobotConfig config = ArmConfig(folder.Write("pair", PdPair()));
  config.control["arm"] = ControlKind::kJointTorque;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "a", .config = config, .prefix = "a_"});
  Scene pair = Scene::Build(spec);
  std::string alone = WithActuators(R"(<motor name="servo1" joint="shoulder"/>)",
                                    R"(<motor name="servo2" joint="elbow" gear="2"/>)");
  alone.replace(alone.find("ctrl=\"0.31 -0.41\""), 17, "");
  spec.robots[0].config->model = folder.Write("motors", alone);
  Scene motors = Scene::Build(spec);
  pair.SetActuatorCtrl("a_shoulder_torque", 3);
  motors.SetActuatorCtrl("a_servo1", 3);
  for (Scene* scene : {&pair, &motors}) {
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(scene->Step().ok());
  }
  EXPECT_DOUBLE_EQ(pair.joint_pos("a_shoulder"), motors.joint_pos("a_shoulder"));
  EXPECT_GT(std::abs(pair.data()->qvel[0]), 0.5);
}

TEST_F(ControlModes, KeepActuatorsOfOtherJointsOnWithAWarning) {
  std::string model = PdPair(R"(<position name="cable" tendon="both" kp="1"/>)");
  model.insert(model.find("<sensor>"), R"(<tendon><fixed name="both"><joint joint="elbow" coef="1"/>
    <joint joint="tail" coef="1"/></fixed></tendon>)");
  model.insert(
      model.find("<site name=\"flange\""),
      R"(<body name="tail"><joint name="tail"/><geom size="0.01" fromto="0 0 0 0 0 0.1"/></body>)");
  model.replace(model.find("0.3 -0.4"), 8, "0.3 -0.4 0");
  RobotConfig config = ArmConfig(folder.Write("cable", model));
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "a", .config = config, .prefix = "a_"});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(GroupOf(scene.model(), "a_cable"), 0);
  EXPECT_THAT(scene.compiled()->notes(),
              ::testing::Contains(HasSubstr(
                  "robot 'a': actuator 'a_cable' acts on joint 'a_elbow' of arm 'arm' and also on "
                  "'a_tail', so that it stays on in all control modes of the arm")));
}

TEST_F(ControlModes, GroupsUsedByPartsAreNotReused) {
  std::string model = kTwoFingerGripper;
  model.replace(model.find("name=\"grip\""), 11, "name=\"grip\" group=\"1\"");
  SceneSpec spec = Arms(1, std::nullopt);
  spec.robots[0].attachments.push_back(
      {.mjcf_path = folder.Write("grouped", model), .attach_to = Site("flange"), .prefix = "g_"});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(GroupOf(scene.model(), "a0_g_grip"), 1);
  EXPECT_EQ(GroupOf(scene.model(), "a0_servo1"), 2);
  EXPECT_EQ(GroupOf(scene.model(), "a0_elbow_torque"), 3);
  EXPECT_TRUE(IsOn(scene.model(), "a0_g_grip"));
}

TEST_F(ControlModes, RejectMoreGroupsThanTheEngineHas) {
  ExpectThrow<SpecError>(
      [&] {
        Scene::Build(Arms(11, Modes{kPosition, kVelocity, kTorque}));
      },
      "robot 'a10': its arms need 3 actuator groups for their control modes and 0 of 30 are left; "
      "declare fewer control_modes");
  const Scene scene = Scene::Build(Arms(16, std::nullopt));
  EXPECT_THAT(scene.compiled()->notes(),
              ElementsAre(HasSubstr("robot 'a15': its arms need 2 actuator groups for their "
                                    "control modes and 0 of 30 are left, so they cannot be "
                                    "switched")));
}

// A torso that carries two arms, each with two fingers.
constexpr const char* kTorso = R"(
  <compiler angle="radian"/><default><geom size="0.01" mass="0.1"/></default>
  <worldbody><body name="torso"><joint name="waist"/><geom/>
    <body name="l1"><joint name="l1"/><geom/><body name="l2"><joint name="l2"/><geom/>
      <body name="lf"><joint name="lf" type="slide"/><geom/></body>
      <body name="lg"><joint name="lg" type="slide"/><geom/></body></body></body>
    <body name="r1"><joint name="r1"/><geom/><body name="r2"><joint name="r2"/><geom/></body></body>
  </body></worldbody>
  <actuator>
    <position name="waist" joint="waist"/><position name="l1" joint="l1"/>
    <position name="l2" joint="l2"/><position name="lf" joint="lf"/><position name="lg" joint="lg"/>
    <position name="r1" joint="r1"/><position name="r2" joint="r2"/>
  </actuator>)";

TEST_F(ControlModes, OfARobotWithoutGroupsBelongToItsSerialStretches) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = folder.Write("torso", kTorso)});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  EXPECT_EQ(GroupOf(m, "l1"), GroupOf(m, "l2"));
  EXPECT_EQ(GroupOf(m, "r1_torque"), GroupOf(m, "r2_torque"));
  const std::set<int> stretches = {GroupOf(m, "waist"), GroupOf(m, "l1"), GroupOf(m, "lf"),
                                   GroupOf(m, "lg"), GroupOf(m, "r1")};
  EXPECT_EQ(stretches.size(), 5u);
}

TEST_F(ControlModes, AreThoseOfTheArmGroupsOfAConfiguration) {
  RobotConfig config = ArmConfig(folder.Write("torso", kTorso));
  config.move_groups.at("arm") = {.kind = MoveGroupKind::kArm, .joints = {"l1", "l2"}};
  config.move_groups["hand"] = {.kind = MoveGroupKind::kGripper,
                                .joints = {"lf", "lg"},
                                .actuators = {"lf"},
                                .fingers = {{.name = "lf"}, {.name = "lg"}},
                                .ctrl = GripperCtrl{1, 0},
                                .distance = GripperDistance{0, 0.1}};
  config.control["arm"] = ControlKind::kJointTorque;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = config});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  EXPECT_EQ(m->nu, 9) << "two motors";
  EXPECT_FALSE(IsOn(m, "l1") || IsOn(m, "l2"));
  EXPECT_TRUE(IsOn(m, "l1_torque") && IsOn(m, "lf") && IsOn(m, "waist"));

  spec.robots[0].control_modes = Modes{kPosition};
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      "robot 'robot': control.arm: its controller needs the control mode torque, which the robot "
      "does not declare; add it to control_modes in the scene");
  EXPECT_THAT(config.used_modes(), ElementsAre(kPosition, kTorque));
}

TEST_F(ControlModes, ArePartOfSavedFiles) {
  Scene scene = Scene::Build(Arms(1, std::nullopt));
  const std::string file = (folder.path() / "saved.xml").string();
  scene.SaveXml(file);
  SpecPtr spec = ParseXmlFile(file);
  const ModelPtr loaded = Compile(spec.get());
  EXPECT_EQ(loaded->opt.disableactuator, scene.model()->opt.disableactuator);
  EXPECT_EQ(GroupOf(loaded.get(), "a0_elbow_torque"), GroupOf(scene.model(), "a0_elbow_torque"));
}

}  // namespace
}  // namespace robocell::internal
