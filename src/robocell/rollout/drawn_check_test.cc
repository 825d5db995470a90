#include "robocell/rollout/drawn_check.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/features/cell_features.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// The pick scene, whose target falls from 0.3 m above the table.
class DrawnCheckTest : public ::testing::Test {
 protected:
  DrawnCheckTest() {
    cameras.resolution = {16, 12};
    cameras.streams.push_back({.name = "exo", .camera = "exo_camera"});
    images.emplace(scene, cameras, renderer.get());
    drawer.emplace(scene, *images);
    pose = scene.body_pose(pick.target_body);
    pose = Pose(Eigen::Vector3d(0, 0, 0.3)) * pose;
    scene.SetBodyPose(pick.target_body, pose);
    scene.Forward();
  }
  std::vector<double> Row() {
    const auto row = features.ReadState();
    return {row.begin(), row.end()};
  }

  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  Scene scene = pick.scene;
  CameraSystemConfig cameras;
  std::unique_ptr<Renderer> renderer = MakeRenderer({.backend = "soft"});
  std::optional<CellImages> images;
  std::optional<StateDrawer> drawer;
  CellFeatures features{scene, {pick.robot}, {.objects = {"target"}}};
  DrawnCheck check{scene, features.observed()};
  Pose pose;
};

TEST_F(DrawnCheckTest, AcceptsImagesOfTheRowsOwnState) {
  const std::vector<double> row = Row();
  const DrawnState state = drawer->Take();
  ASSERT_TRUE(scene.StepN(20).ok());
  drawer->Draw(state);
  EXPECT_NO_THROW(check.Require("e", 7, row, *drawer));
}

TEST_F(DrawnCheckTest, RejectsImagesOfALaterStateWithTheRowAndTheObject) {
  const std::vector<double> row = Row();
  ASSERT_TRUE(scene.StepN(20).ok());
  drawer->Draw(drawer->Take());
  ExpectThrow<Error>([&] { check.Require("e", 7, row, *drawer); },
                     "episode 'e', row 7: object 'target' is drawn at");
}

TEST_F(DrawnCheckTest, RejectsAnArmThatHasMovedWithTheRowAndTheJoint) {
  const std::vector<double> row = Row();
  const std::string joint = pick.robot.group("arm").joint_names().at(2);
  const int id = mj_name2id(scene.model(), mjOBJ_JOINT, joint.c_str());
  scene.data()->qpos[scene.model()->jnt_qposadr[id]] += 1e-6;
  drawer->Draw(drawer->Take());
  ExpectThrow<Error>([&] { check.Require("e", 7, row, *drawer); },
                     "episode 'e', row 7: joint '" + joint + "' is drawn at");
}

TEST_F(DrawnCheckTest, RejectsATurnAndAcceptsTheOtherQuaternionOfTheSameRotation) {
  std::vector<double> row = Row();
  drawer->Draw(drawer->Take());
  size_t at = 0;
  for (const Feature& feature : features.observed().features()) {
    if (feature.column.name == "objects/target/pose") break;
    at += static_cast<size_t>(feature.size());
  }
  for (size_t i = 3; i < 7; ++i) row[at + i] = -row[at + i];
  EXPECT_NO_THROW(check.Require("e", 0, row, *drawer));
  const Quaternion turned = (pose * Pose::FromRpy({0, 0, 0}, {0, 0, 0.01})).quaternion();
  for (size_t i = 0; i < 4; ++i) row[at + 3 + i] = turned[i];
  ExpectThrow<Error>([&] { check.Require("e", 0, row, *drawer); }, "or turned otherwise");
}

}  // namespace
}  // namespace robocell::internal
