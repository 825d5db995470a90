// Tests inertias that no body has, and gains that the timestep cannot follow.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// A link on a hinge with a servo.
class Inertia : public ::testing::Test {
 protected:
  Scene Build(const std::string& inertial, const std::string& servo,
              const std::string& joint = "") {
    const std::string model =
        folder_.Write(fmt::format("arm{}", ++count_), fmt::format(R"(
      <compiler angle="radian"/><worldbody><body name="base"><geom size="0.05" contype="0"/>
      <body name="link" pos="0 0 0.1"><joint name="hip" axis="0 1 0" {}/>{}
      <geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.2" contype="0"/></body></body></worldbody>
      <actuator>{}</actuator>)",
                                                                  joint, inertial, servo));
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.path = model, .prefix = "r_"});
    return Scene::Build(spec);
  }
  ModelFolder& folder() { return folder_; }
  static const std::vector<std::string>& Warnings(const Scene& scene) {
    return scene.compiled()->warnings();
  }

 private:
  ModelFolder folder_;
  int count_ = 0;
};

constexpr const char* kSoft = R"(<position name="drive" joint="hip" kp="10" kv="1"/>)";

TEST_F(Inertia, RejectsInertiaThatNoBodyCanHave) {
  const auto of = [](double value) {
    return fmt::format(R"(<inertial pos="0 0 0.1" mass="1" diaginertia="{0} {0} {0}"/>)", value);
  };
  EXPECT_THAT(
      Warnings(Build(of(1e-12), kSoft)),
      Contains(HasSubstr(
          "robot 'r': the inertia 1e-12 kg m2 of body 'link' is too small: of 1 kg even a "
          "thin rod of 2 m has 3.5e-06 kg m2 about its axis. Correct its <inertial> (kg and "
          "kg m2, not g or mm), or leave it out, so that its geoms give it; or let the joint "
          "have the inertia of its rotor: edits: [{joint: 'hip', armature: 0.01}]")));
  EXPECT_THAT(Warnings(Build(of(1e5), kSoft)),
              Contains(HasSubstr("the inertia 1e+05 kg m2 of body 'link' is too large: 1 kg within "
                                 "5 m of its centre of mass have at most 25 kg m2")));
  EXPECT_THAT(Warnings(Build(of(1e-3), kSoft)), Not(Contains(HasSubstr("inertia"))));
  EXPECT_THAT(Warnings(Build("", kSoft)), Not(Contains(HasSubstr("inertia"))));
}

TEST_F(Inertia, WarnsAboutAMassAboveThatOfMetal) {
  const auto of = [](double mass) {
    return fmt::format(R"(<inertial pos="0 0 0.1" mass="{}" diaginertia="5 5 1"/>)", mass);
  };
  EXPECT_THAT(Warnings(Build(of(1000), kSoft)),
              Contains(HasSubstr("the mass 1e+03 kg of body 'link' is too large: made of the "
                                 "densest metal, its rigid parts would weigh 14 kg. Correct it")));
  EXPECT_THAT(Warnings(Build(of(10), kSoft)), Not(Contains(HasSubstr("the mass"))));
}

TEST_F(Inertia, WarnsAboutAGainTooHighForTheTimestep) {
  EXPECT_THAT(Warnings(Build("", R"(<position name="drive" joint="hip" kp="5e9" kv="1"/>)")),
              Contains(::testing::AllOf(
                  HasSubstr("robot 'r': the gain 5e+09 of servo 'drive' is too high for "
                            "joint 'hip', which moves "),
                  HasSubstr("with a timestep of 0.002 s it blows up from "),
                  HasSubstr("Give it a lower one: edits: [{actuator: 'drive', kp: "))));
}

TEST_F(Inertia, WarnsAboutASpringTooStiffForTheTimestep) {
  EXPECT_THAT(Warnings(Build("", kSoft, R"(stiffness="1e8")")),
              Contains(HasSubstr("the stiffness 1e+08 of joint 'hip' is too high for the ")));
  EXPECT_THAT(Warnings(Build("", kSoft, R"(stiffness="10")")),
              Not(Contains(HasSubstr("the stiffness"))));
}

TEST_F(Inertia, ReportsAStiffnessOfTheRobotFileThereOnce) {
  SceneSpec spec = EmptyScene();
  RobotConfig arm = ArmConfig(folder().Write("two", kTwoJointArm));
  arm.stiffness = 5e9;
  spec.robots.push_back({.name = "arm", .config = arm});
  const Scene scene = Scene::Build(spec);
  int found = 0;
  for (const std::string& warning : Warnings(scene)) {
    if (warning.find("is too high for") == std::string::npos) continue;
    ++found;
    EXPECT_THAT(warning, HasSubstr("robot 'arm': stiffness: the gain 5e+09 of servo 'servo"));
    EXPECT_THAT(warning, HasSubstr("Write a lower one: `stiffness: "));
  }
  EXPECT_EQ(found, 1);
}

// The servo of a gripper may be scaled and act on a tendon.
TEST_F(Inertia, TheLimitOfATendonsGainIsTheEngines) {
  const auto build = [&](double kp) {
    const std::string model =
        folder().Write(fmt::format("hand{}", kp), fmt::format(R"(
      <worldbody><body name="base"><geom size="0.05" contype="0"/>
      <body name="l"><joint name="l" type="slide" axis="0 1 0" damping="3"/>
      <geom size="0.02" mass="0.1" contype="0" conaffinity="0"/></body>
      <body name="r"><joint name="r" type="slide" axis="0 1 0" damping="1"/>
      <geom size="0.02" mass="0.2" contype="0" conaffinity="0"/></body></body></worldbody>
      <tendon><fixed name="split"><joint joint="l" coef="0.5"/><joint joint="r" coef="-1"/></fixed></tendon>
      <actuator><general name="grip" tendon="split" gear="2" biastype="affine" gainprm="{}"
        biasprm="0 {} -2"/></actuator>)",
                                                              0.01 * kp, -kp));
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.path = model, .prefix = "r_"});
    return Scene::Build(spec);
  };
  double limit = 0;
  const Scene stiff = build(1e9);
  for (const std::string& warning : Warnings(stiff)) {
    const std::string mark = "servo 'grip' is too high for tendon 'split', which moves ";
    if (warning.find(mark) == std::string::npos) continue;
    EXPECT_THAT(warning, HasSubstr("Give it a lower one: edits: [{actuator: 'grip', kp: "));
    const size_t at = warning.find("blows up from ") + 14;
    limit = std::stod(warning.substr(at));
  }
  ASSERT_GT(limit, 0);
  for (const double share : {0.85, 1.15}) {
    Scene scene = build(share * limit);
    scene.mutable_model()->opt.gravity[2] = 0;
    scene.data()->qpos[0] = 1e-6;
    scene.Forward();
    double most = 0;
    for (int i = 0; i < 2000 && scene.Step().ok(); ++i)
      most = std::max(most, std::abs(scene.data()->qpos[0]));
    EXPECT_EQ(most > 1e-3, share > 1) << share << " " << most;
    EXPECT_EQ(
        !Warnings(scene).empty() && Warnings(scene).back().find("is too high") != std::string::npos,
        share > 1);
  }
}

// The largest gain is the one from which on the engine's own steps overshoot more each time.
TEST_F(Inertia, TheLimitOfAGainIsTheEngines) {
  for (const double damping : {0.0, 0.5, 5.0}) {
    const auto servo = [&](double kp) {
      return fmt::format(R"(<position name="drive" joint="hip" kp="{}" kv="{}"/>)", kp, damping);
    };
    const Scene any = Build("", servo(1));
    const double moved = any.model()->dof_M0[0], dt = any.timestep();
    const double limit = (4 * moved + 2 * dt * damping) / (dt * dt);
    for (const double share : {0.9, 1.1}) {
      Scene scene = Build("", servo(share * limit));
      scene.mutable_model()->opt.gravity[2] = 0;
      scene.data()->qpos[0] = 1e-6;
      scene.Forward();
      double most = 0;
      for (int i = 0; i < 1000 && scene.Step().ok(); ++i)
        most = std::max(most, std::abs(scene.data()->qpos[0]));
      const bool unstable = most > 1e-3;
      EXPECT_EQ(unstable, share > 1) << damping << " " << share << " " << most;
      bool found = false;
      for (const std::string& warning : Warnings(scene))
        found |= warning.find("is too high for joint") != std::string::npos;
      EXPECT_EQ(found, unstable) << damping << " " << share;
    }
  }
}

}  // namespace
}  // namespace robocell
