#include "robocell/rollout/state_drawer.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// The pick scene, drawn by the back end that every machine has.
class StateDrawerTest : public ::testing::Test {
 protected:
  StateDrawerTest() {
    cameras.resolution = {64, 48};
    cameras.streams.push_back({.name = "wrist", .camera = "wrist_camera", .depth = true});
    cameras.streams.push_back({.name = "exo", .camera = "exo_camera", .segmentation = true});
  }

  void Change() {
    std::vector<double> q(pick.robot.n_joints());
    pick.robot.arm().GetJointPos(q);
    for (double& angle : q) angle += 0.2;
    pick.robot.SetJointPos(q);
    mjModel* model = scene.mutable_model();
    for (int geom = 0; geom < model->ngeom; ++geom) model->geom_rgba[4 * geom] = 0.1F;
  }
  static void ExpectSame(const std::vector<CellImage>& a, const std::vector<CellImage>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].rgb, b[i].rgb) << a[i].name;
      EXPECT_EQ(a[i].depth_mm, b[i].depth_mm) << a[i].name;
      EXPECT_EQ(a[i].bodies, b[i].bodies) << a[i].name;
    }
  }

  // Returns the name of a finger.
  std::string Finger() const {
    for (int body = 0; body < scene.model()->nbody; ++body) {
      const std::string name = mj_id2name(scene.model(), mjOBJ_BODY, body);
      if (name.ends_with("left_finger")) return name;
    }
    return "";
  }

  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  Scene scene = pick.scene;
  CameraSystemConfig cameras;
  std::unique_ptr<Renderer> renderer = MakeRenderer({.backend = "soft"});
};

TEST_F(StateDrawerTest, DrawsAnEarlierStateOnAnotherThreadAsItWas) {
  CellImages now(scene, cameras, renderer.get());
  now.Draw();
  const std::vector<CellImage> expected = now.drawn();
  const std::unique_ptr<Renderer> other = MakeRenderer({.backend = "soft"});
  CellImages later(scene, cameras, other.get());
  StateDrawer drawer(scene, later);
  const DrawnState state = drawer.Take();
  const int finger = mj_name2id(scene.model(), mjOBJ_BODY, Finger().c_str());
  ASSERT_GE(finger, 0);
  const Pose before = scene.body_pose(Finger());
  Change();
  std::thread([&] { drawer.Draw(state); }).join();
  ExpectSame(later.drawn(), expected);
  EXPECT_TRUE(drawer.DrawnPose(finger).is_close(before, 1e-12, 1e-12));
  drawer.Draw(drawer.Take());
  EXPECT_NE(later.drawn()[1].rgb, expected[1].rgb) << "the present state looks different";
  EXPECT_FALSE(drawer.DrawnPose(finger).is_close(before, 0.01, 0.001));
}

TEST_F(StateDrawerTest, TakesNothingWithoutImages) {
  CellImages none(scene, {}, nullptr);
  StateDrawer drawer(scene, none);
  EXPECT_TRUE(drawer.Take().qpos.empty());
}

}  // namespace
}  // namespace robocell::internal
