// Tasks in environments, and going back to saved states.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A cube in front of the built-in robot on a floor that is the root frame's ground.
class EnvTaskTest : public ::testing::Test {
 protected:
  EnvConfig Picking(const Pose& root = Pose()) {
    EnvConfig config = Rc7Env(ControlMode::kCartesianTquat, RelativeTo::kNone);
    config.root_frame_to_world = root;
    const std::string cube = folder_.Write("cube", R"(<worldbody><body name="cube"><freejoint/>
      <geom size="0.02 0.02 0.02" type="box" mass="0.05" friction="1 0.02 0.001" condim="4"/>
      </body></worldbody>)");
    const std::string ground = folder_.Write("ground", R"(<worldbody><body name="ground">
      <geom size="1 1 0.05" type="box" pos="0 0 -0.05"/></body></worldbody>)");
    config.root_frame_objects["cube"] = {.mjcf_path = cube,
                                         .offset = Pose(Eigen::Vector3d(0.45, 0, 0.02))};
    config.root_frame_objects["ground"] = {.mjcf_path = ground};
    config.task = EnvTaskConfig{.object = "cube", .spread = {0.05, 0.1}};
    return config;
  }

  static Pose Object(const Env& env) {
    const VectorPart part = env.layout().objects[0].tquat;
    return PoseOfAction(ControlMode::kCartesianTquat,
                        env.observation().subspan(part.begin, part.size));
  }

  static EnvStep MoveTo(Env& env, const Pose& tcp_in_shared, double gripper) {
    std::vector<double> action(8);
    PutTquat(tcp_in_shared, action);
    action[7] = gripper;
    return env.Step(action);
  }

  // Grasps the object from above and lifts it.
  static EnvStep PickUp(Env& env) {
    const Pose object = Object(env);
    const Pose grasp(
        object.translation(),
        Pose::FromRpy(Eigen::Vector3d::Zero(), {kPi, 0, object.rpy().z()}).quaternion());
    const auto above = [&](double height) {
      return Pose(grasp.translation() + Eigen::Vector3d(0, 0, height), grasp.quaternion());
    };
    MoveTo(env, above(0.12), 1);
    MoveTo(env, above(0.06), 1);
    MoveTo(env, above(0.0), 1);
    MoveTo(env, above(0.0), 0);
    MoveTo(env, above(0.05), 0);
    return MoveTo(env, above(0.12), 0);
  }

 private:
  ModelFolder folder_;
};

TEST_F(EnvTaskTest, StartsAreSpreadAroundTheObjectsPlaceInTheRootFrame) {
  const Pose root = Pose::FromRpy({1, -1, 0.3}, {0, 0, 2});
  Env env(Picking(root));
  double least_x = 1, most_x = 0, most_turn = 0;
  for (int i = 0; i < 40; ++i) {
    env.Reset();
    const Pose start = Object(env);  // the shared frame is the root frame here
    EXPECT_NEAR(start.translation().x(), 0.45, 0.05 + 1e-9);
    EXPECT_NEAR(start.translation().y(), 0, 0.1 + 1e-9);
    EXPECT_NEAR(start.translation().z(), 0.02, 1e-9);
    EXPECT_TRUE(env.scene().body_pose("cube_cube").is_close(root * start, 1e-9, 1e-9));
    least_x = std::min(least_x, start.translation().x());
    most_x = std::max(most_x, start.translation().x());
    most_turn = std::max(most_turn, start.angle());
  }
  EXPECT_LT(least_x, 0.42);
  EXPECT_GT(most_x, 0.48);
  EXPECT_GT(most_turn, 2);
}

TEST_F(EnvTaskTest, PickingItUpIsSuccessWhereverTheRootIs) {
  for (const Pose& root : {Pose(), Pose::FromRpy({1, -1, 0.3}, {0, 0, 2})}) {
    EnvConfig config = Picking(root);
    config.sim.max_convergence_time = 2;
    Env env(config);
    env.Reset({.seed = 3});
    EXPECT_EQ(env.instruction(), "pick up the cube");
    EnvStep step = MoveTo(env, Pose::FromRpy({0.4, 0, 0.3}, {kPi, 0, 0}), 1);
    EXPECT_FALSE(step.success);
    EXPECT_GT(step.reward, 0);
    EXPECT_LT(step.reward, 0.5);
    step = PickUp(env);
    EXPECT_TRUE(step.success);
    EXPECT_EQ(step.reward, 1);
  }
}

TEST_F(EnvTaskTest, AFixedObjectIsNothingToPick) {
  EnvConfig config = Picking();
  config.root_frame_objects["cube"].fixed = true;
  ExpectThrow<ArgumentError>([&] { Env env(config); },
                             "environment 'env': task.object 'cube' is fixed, so that nobody can "
                             "pick it; set fixed: false in root_frame_objects.cube");
}

TEST_F(EnvTaskTest, FromASavedStateEverythingIsTheSameToTheBit) {
  Env env(Picking());
  env.Reset({.seed = 1});
  MoveTo(env, Pose::FromRpy({0.4, 0.1, 0.2}, {kPi, 0, 0}), 0);
  env.Save("before");
  const auto go_on = [&] {
    std::vector<double> seen;
    for (int i = 0; i < 4; ++i) {
      const EnvStep step = PickUp(env);
      seen.push_back(step.time);
      seen.push_back(step.reward);
      seen.insert(seen.end(), env.observation().begin(), env.observation().end());
    }
    return seen;
  };
  const std::vector<double> then(env.observation().begin(), env.observation().end());
  const std::vector<double> first = go_on();
  env.Reset();
  env.Restore("before");
  EXPECT_EQ(std::vector<double>(env.observation().begin(), env.observation().end()), then);
  EXPECT_EQ(go_on(), first);
  EXPECT_THAT(env.saved(), ElementsAre("before"));
  ExpectThrow<NotFoundError>([&] { env.Restore("befor"); },
                             "environment 'env': no saved state 'befor'. Its saved states: before. "
                             "Did you mean 'before'?");
  env.Forget("before");
  EXPECT_THAT(env.saved(), IsEmpty());
}

TEST_F(EnvTaskTest, StatesAreSavedAfterAResetAndOnOneModel) {
  Env env(Picking());
  ExpectThrow<Error>([&] { env.Save("start"); }, "call reset before the first step");
  env.Reset();
  env.Save("start");
  Scene(env.scene()).AddObject(BoxObject("box", {2, 2, 1}));
  ExpectThrow<Error>([&] { env.Restore("start"); },
                     "the scene was compiled anew since 'start' was saved, so that there is no way "
                     "back to it");
}

}  // namespace
}  // namespace robocell
