#include "robocell/env/env_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/features/own_features.h"
#include "robocell/features/robot_features.h"
#include "robocell/task/task_features.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

std::vector<double> PartOfSeen(const Env& env, const VectorPart& part) {
  const auto begin = env.observation().begin() + part.begin;
  return {begin, begin + part.size};
}

// Adds a tactile pad beside the cube.
EnvConfig WithPad(ModelFolder& folder) {
  EnvConfig config = Rc7WithCube();
  config.root_frame_objects["pad"] = {
      .mjcf_path = folder.Write("pad", R"(<worldbody><body name="plate">
        <geom size="0.05 0.05 0.01" type="box"/><site name="top" size="0.06" type="sphere"/>
        </body></worldbody><sensor><touch name="weight" site="top"/></sensor>)"),
      .offset = Pose(Eigen::Vector3d(0.3, 0.4, 0.01)),
      .fixed = true};
  return config;
}

TEST(EnvLayoutSchemas, DescribeEachNumber) {
  for (const ControlMode mode :
       {ControlMode::kJoints, ControlMode::kCartesianTrpy, ControlMode::kCartesianTquat}) {
    EnvConfig config = Rc7WithCube();
    config.control_mode = mode;
    const Env env(config);
    const EnvLayout& layout = env.layout();
    for (const auto* schema : {&layout.observed, &layout.commanded}) {
      const bool seen = schema == &layout.observed;
      const auto& paths = seen ? layout.observed_paths : layout.commanded_paths;
      const VectorRange& range = seen ? layout.observation : layout.action;
      EXPECT_EQ(schema->size(), range.size());
      ASSERT_EQ(schema->features().size(), paths.size());
      int begin = 0;
      for (size_t i = 0; i < paths.size(); ++i) {
        const Feature& feature = schema->features()[i];
        std::string name = seen ? "observation" : "action";
        for (const std::string& key : paths[i]) name += "/" + key;
        EXPECT_EQ(feature.column.name, name);
        EXPECT_TRUE(
            std::equal(feature.lower.begin(), feature.lower.end(), range.lower.begin() + begin));
        begin += static_cast<int>(feature.size());
      }
    }
    const Feature& tquat = layout.observed.Find("observation/robot/tquat");
    EXPECT_EQ(tquat.column.units, "m, 1");
    EXPECT_EQ(tquat.column.frame, "shared base frame");
    EXPECT_THAT(tquat.column.names, ElementsAre("x", "y", "z", "qx", "qy", "qz", "qw"));
    const Feature& joints = layout.observed.Find("observation/robot/joints");
    EXPECT_EQ(joints.column.units, "rad");
    const Robot robot = Robot::Of(env.scene(), "robot");
    ASSERT_EQ(robot.joint_names().front(), robot.prefix() + "joint1");
    EXPECT_EQ(joints.column.names, OwnNames(robot, robot.joint_names()));
    EXPECT_EQ(joints.column.names.front(), "joint1");
    EXPECT_EQ(layout.observed.Find("observation/objects/cube/tquat").role,
              FeatureRole::kPrivileged);
    EXPECT_EQ(NameOfObservation(layout, layout.robots[0].joints.begin + 2), "robot.joints[2]");
  }
}

TEST(EnvLayoutSchemas, ChosenFeaturesAreObservedWithUnitAndFrame) {
  RegisterFeature("layout_test_height",
                  {.column = {.units = "m", .frame = "world"}, .lower = {0}, .upper = {0.1}},
                  [](const Scene& scene, std::span<double> out) {
                    out[0] = scene.body_pose("cube").translation().z() + 1;
                  });
  ModelFolder folder;
  EnvConfig config = WithPad(folder);
  config.features = {"sensors/*", "layout_test_height", "robots/robot/arm/qvel"};
  Env env(config);
  const EnvLayout& layout = env.layout();
  ASSERT_EQ(layout.features.size(), 3u);
  EXPECT_EQ(layout.features[0].key, "sensors/pad_weight");
  EXPECT_EQ(layout.observed.Find("observation/features/sensors/pad_weight").column.units, "N");
  const Feature& height = layout.observed.Find("observation/features/layout_test_height");
  EXPECT_EQ(height.column.units, "m");
  EXPECT_EQ(height.column.frame, "world");
  env.Reset({.seed = 3});
  env.Step(std::vector<double>{0.4, 0, 0.3, 1, 0, 0, 0, 1});
  EXPECT_EQ(PartOfSeen(env, layout.features[1].part), std::vector<double>{0.1})
      << "cut to its range";
  // The oracle is the cell as episodes record it.
  CellFeatures cell = FeaturesOfCell(env.scene(), RobotsOf(env.scene()), env.task(), {});
  std::span<const double> rest = cell.ReadState();
  for (const Feature& feature : cell.observed().features()) {
    const auto size = static_cast<size_t>(feature.size());
    const std::vector<double> numbers(rest.begin(), rest.begin() + feature.size());
    for (const FeatureLayout& chosen : layout.features) {
      if (chosen.key != feature.column.name) continue;
      EXPECT_EQ(PartOfSeen(env, chosen.part), numbers) << chosen.key;
    }
    rest = rest.subspan(size);
  }
}

TEST(EnvLayoutSchemas, WithoutChosenFeaturesNothingIsAdded) {
  ModelFolder folder;
  const Env plain(Rc7WithCube()), pad(WithPad(folder));
  EXPECT_EQ(plain.layout().observation.lower, pad.layout().observation.lower);
  EXPECT_TRUE(pad.layout().features.empty());
  EnvConfig config = Rc7WithCube();
  config.features = {"sensor/wrist"};
  ExpectThrow<NotFoundError>([&] { Env env(config); }, "no feature 'sensor/wrist'");
}

}  // namespace
}  // namespace robocell
