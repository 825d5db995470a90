// Tests the geoms near a robot, with the engine's distance of each pair of geoms as the oracle.
#include "robocell/robot/scratch_robot.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <utility>

#include "robocell/base/rng.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

constexpr double kHorizon = 0.2;

// The built-in robot, made of boxes, cylinders and a capsule, beside one geom.
Scene Beside(const std::string& geom) {
  const TempDir folder;
  std::ofstream(folder / "thing.xml")
      << R"(<mujoco><asset><mesh name="stone" vertex="0 0 .2 .16 .12 0 -.14 .16 0 -.16 -.12 0
               .12 -.14 0 0 0 -.14"/></asset><worldbody><body name="thing">)"
      << geom << "</body></worldbody></mujoco>";
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  SceneObject thing;
  thing.name = "thing";
  thing.mjcf_path = (folder / "thing.xml").string();
  thing.pos = {0.45, 0, 0.4};
  thing.fixed = true;
  spec.objects.push_back(thing);
  return Scene::Build(spec);
}

using Pair = std::pair<int, int>;

std::map<Pair, double> Found(ScratchRobot& scratch) {
  EXPECT_TRUE(scratch.FindTouches());
  std::map<Pair, double> nearest;
  for (const ScratchRobot::Touch& touch : scratch.touches()) {
    if (touch.itself) continue;
    const Pair pair(touch.own_geom, touch.other_geom);
    const auto [it, is_new] = nearest.emplace(pair, touch.distance);
    it->second = std::min(it->second, touch.distance);
  }
  return nearest;
}

// Compares with the engine wherever the two are separate. Returns the number of comparisons.
int Compare(const Robot& robot, ScratchRobot& scratch, int thing) {
  const std::map<Pair, double> found = Found(scratch);
  int compared = 0;
  for (const int own : robot.collision_geom_ids()) {
    const mjModel* m = scratch.model();
    // The engine finds no contacts between fixed bodies.
    if (m->body_dofnum[m->body_weldid[m->geom_bodyid[own]]] == 0) continue;
    if ((m->geom_contype[own] | m->geom_conaffinity[own]) == 0) continue;  // only drawn
    auto* data = const_cast<mjData*>(scratch.data());                      // which is only read
    const double expected = mj_geomDistance(m, data, own, thing, kHorizon, nullptr);
    if (expected < 1e-4 || expected > kHorizon - 1e-4) continue;
    const auto it = found.find({own, thing});
    EXPECT_NE(it, found.end()) << own << " is " << expected << " m away and was not found";
    if (it != found.end()) {
      EXPECT_NEAR(it->second, expected, 1e-6) << own;
    }
    ++compared;
  }
  return compared;
}

// Compares in many places.
int CompareAnywhere(const Robot& robot, ScratchRobot& scratch, int thing) {
  Rng rng = Rng::Stream(1, "scratch robot");
  JointVector q(robot.n_joints());
  int compared = 0;
  for (int k = 0; k < 400; ++k) {
    for (int i = 0; i < q.size(); ++i)
      q[i] = rng.Uniform(robot.joint_limits()[i].lower, robot.joint_limits()[i].upper);
    scratch.SetArm({q.data(), static_cast<size_t>(q.size())});
    compared += Compare(robot, scratch, thing);
  }
  return compared;
}

TEST(ScratchRobot, DistancesAreBetweenNearestPoints) {
  for (const std::string geom : {"type='sphere' size='.15'", "type='capsule' size='.08 .1'",
                                 "type='cylinder' size='.1 .15'", "type='box' size='.15 .15 .1'",
                                 "type='ellipsoid' size='.1 .15 .2'", "type='mesh' mesh='stone'"}) {
    const Scene scene = Beside("<geom mass='1' " + geom + "/>");
    const Robot robot = Robot::Of(scene, "rc7");
    ScratchRobot scratch(robot, kHorizon, "look again");
    const mjModel* m = scene.model();
    const int thing = m->body_geomadr[RequireId(m, mjOBJ_BODY, "thing_thing", "the scene")];
    EXPECT_GT(CompareAnywhere(robot, scratch, thing), 300) << geom;
  }
}

// When the copy was made, it could not collide with anything.
TEST(ScratchRobot, MeasuresPooledObjectsOnceTheyAreInTheScene) {
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  SceneObject box = BoxObject("box", {0.55, 0, 0.45});
  box.size = Vec3{0.15, 0.15, 0.1};
  box.parked = true;
  spec.objects.push_back(box);
  Scene scene = Scene::Build(spec);
  const Robot robot = Robot::Of(scene, "rc7");
  ScratchRobot scratch(robot, kHorizon, "look again");
  scene.AddObject("box");
  scratch.Update();
  const mjModel* m = scene.model();
  const int geom = m->body_geomadr[RequireId(m, mjOBJ_BODY, "box", "the scene")];
  EXPECT_GT(CompareAnywhere(robot, scratch, geom), 300);
  scene.RemoveObject("box");
  scratch.Update();
  EXPECT_TRUE(scratch.FindTouches());
  for (const ScratchRobot::Touch& touch : scratch.touches()) EXPECT_NE(touch.other_geom, geom);
}

// They are not at their parking places either, nor only half of them.
TEST(ScratchRobot, UsesPooledObjectsOfTheLastUpdate) {
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  SceneObject box = BoxObject("box", {0.55, 0, 0.45});
  box.parked = true;
  spec.objects.push_back(box);
  Scene scene = Scene::Build(spec);
  const Robot robot = Robot::Of(scene, "rc7");
  ScratchRobot scratch(robot, kHorizon, "look again");
  const int geom =
      scene.model()->body_geomadr[RequireId(scene.model(), mjOBJ_BODY, "box", "the scene")];
  const auto finds_it = [&] {
    int free = 0;  // the joints of the box
    while (scene.model()->jnt_type[free] != mjJNT_FREE) ++free;
    const int at = scene.model()->jnt_qposadr[free];
    mju_copy3(&scratch.qpos()[at], scene.data()->geom_xpos + 3 * robot.collision_geom_ids().back());
    EXPECT_TRUE(scratch.FindTouches());
    const auto is_box = [&](const auto& touch) { return touch.other_geom == geom; };
    return std::any_of(scratch.touches().begin(), scratch.touches().end(), is_box);
  };
  scene.Forward();
  EXPECT_FALSE(finds_it());
  scene.AddObject("box");
  EXPECT_FALSE(finds_it());
  scratch.Update();
  EXPECT_TRUE(finds_it());
  scene.RemoveObject("box");
  EXPECT_TRUE(finds_it());
  scratch.Update();
  EXPECT_FALSE(finds_it());
}

}  // namespace
}  // namespace robocell::internal
