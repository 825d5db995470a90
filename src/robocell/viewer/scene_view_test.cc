#include "robocell/viewer/scene_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <set>
#include <string>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/robot_config.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

constexpr double kAspect = 4. / 3;

SceneSpec ArmAndCube() {
  SceneSpec spec = EmptyScene();
  const RobotConfig config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
  spec.robots.push_back({.name = "arm", .config = config, .control_modes = config.used_modes()});
  spec.objects.push_back(BoxObject("cube", {0.6, 0.2, 0.02}));
  spec.cameras.push_back(
      {.name = "side", .pos = Vec3{0, -3, 0.7}, .fovy = 45, .look_at = Vec3{0, 0, 0.5}});
  return spec;
}

class Views : public testing::Test {
 protected:
  Views() : scene_(Scene::Build(ArmAndCube())), view_(scene_) { view_.Update(kAspect); }
  mjvScene* Drawn() {
    view_.Update(kAspect);
    return view_.list();
  }
  Scene scene_;
  SceneView view_;
};

TEST_F(Views, ReturnsToTheFreeCameraWhereItWas) {
  view_.SetFreeCamera(2.5, 135, -20, {0, 0, 0.7});
  view_.UseCamera("side");
  EXPECT_EQ(view_.camera(), "side");
  EXPECT_TRUE(std::holds_alternative<ModelCamera>(view_.view()));
  view_.UseCamera("");
  EXPECT_EQ(view_.camera(), "Free");
  const auto free = std::get<OrbitCamera>(view_.view());
  EXPECT_EQ(free.distance, 2.5);
  EXPECT_EQ(free.azimuth, 135);
  EXPECT_EQ(free.lookat, Eigen::Vector3d(0, 0, 0.7));
}

TEST_F(Views, NamesTheCamerasWhenOneIsUnknown) {
  try {
    view_.UseCamera("sied");
    FAIL();
  } catch (const NotFoundError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("Did you mean 'side'?"));
  }
  EXPECT_EQ(view_.camera(), "Free");
}

TEST_F(Views, AFixedCameraThatTheMouseMovesBecomesTheFreeOneInItsPlace) {
  view_.UseCamera("side");
  view_.Update(kAspect);
  const auto before = view_.Project({0.3, 0.1, 0.4});
  view_.MoveCamera(mjMOUSE_ROTATE_V, 0, 0);
  EXPECT_EQ(view_.camera(), "Free");
  view_.Update(kAspect);
  const auto after = view_.Project({0.3, 0.1, 0.4});
  ASSERT_TRUE(before && after);
  EXPECT_LT((*before - *after).norm(), 1e-4);
}

TEST_F(Views, ProjectsAsTheCamerasOfTheRenderersDo) {
  Rng rng = Rng::Stream(3, "viewer", "points");
  const int width = 400, height = 300;
  for (int i = 0; i < 50; ++i) {
    view_.SetFreeCamera(rng.Uniform(0.5, 4), rng.Uniform(-180, 180), rng.Uniform(-80, 80),
                        {rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(0, 1)});
    view_.Update(kAspect);
    const CameraModel oracle =
        ComputeCamera(scene_.model(), scene_.data(), view_.view(), width, height);
    const Eigen::Vector3d point(rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(0, 1));
    const auto seen = view_.Project(point);
    if (!seen) {
      EXPECT_LE(oracle.Depth(point), 0);
      continue;
    }
    const Eigen::Vector2d pixel = oracle.Project(point);
    EXPECT_NEAR(seen->x() * width - 0.5, pixel.x(), 0.02);
    EXPECT_NEAR((1 - seen->y()) * height - 0.5, pixel.y(), 0.02);
    EXPECT_LT((view_.Unproject(*seen, point) - point).norm(), 1e-4);
  }
}

TEST_F(Views, ShowsFramesOfEveryKindWhereTheElementsAre) {
  const ViewElement elements[] = {{ViewElement::kBody, "cube"},
                                  {ViewElement::kSite, view_.elements(ViewElement::kSite).front()},
                                  {ViewElement::kTcp, "arm"},
                                  {ViewElement::kCamera, "side"}};
  for (const ViewElement& element : elements) {
    const int before = Drawn()->ngeom;
    view_.ShowFrame(element, true);
    const mjvScene* list = Drawn();
    ASSERT_GE(list->ngeom, before + 3) << Describe(element);
    const Eigen::Vector3d at = view_.pose(element)->translation();
    for (int i = before; i < before + 3; ++i) {
      EXPECT_EQ(list->geoms[i].type, mjGEOM_ARROW);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(list->geoms[i].pos[k], at[k], 1e-6);
    }
    view_.ShowFrame(element, false);
    EXPECT_EQ(Drawn()->ngeom, before);
  }
  EXPECT_THROW(view_.ShowFrame({ViewElement::kBody, "cubes"}, true), NotFoundError);
}

TEST_F(Views, FollowsObjectsThatComeAndGo) {
  view_.ShowFrame({ViewElement::kBody, "cube"}, true);
  view_.SelectBody("cube");
  view_.UseCamera("side");
  scene_.AddObject(BoxObject("a_post", {1, 0, 0.02}));  // ids change
  Drawn();
  EXPECT_EQ(view_.selected(), "cube");
  EXPECT_EQ(view_.camera(), "side");
  EXPECT_TRUE(view_.ShowsFrame({ViewElement::kBody, "cube"}));
  scene_.RemoveObject("cube");
  Drawn();
  EXPECT_EQ(view_.selected(), "");
  scene_.AddObject(BoxObject("cube", {0.5, 0, 0.02}));
  EXPECT_TRUE(view_.pose({ViewElement::kBody, "cube"}));
  Drawn();
}

TEST_F(Views, ShowsExactlyTheGeomsThatCollide) {
  view_.flags.collision_geoms = true;
  const mjvScene* list = Drawn();
  const mjModel* m = scene_.model();
  std::set<int> shown, colliding;
  for (int i = 0; i < list->ngeom; ++i) {
    const mjvGeom& geom = list->geoms[i];
    if (geom.objtype == mjOBJ_GEOM && geom.category != mjCAT_DECOR) shown.insert(geom.objid);
  }
  for (int i = 0; i < m->ngeom; ++i) {
    if (m->geom_contype[i] || m->geom_conaffinity[i]) colliding.insert(i);
  }
  EXPECT_EQ(shown, colliding);
  view_.flags.collision_geoms = false;
}

TEST_F(Views, SelectsTheBodyUnderTheMouse) {
  view_.SetFreeCamera(1, 60, -35, {0.6, 0.2, 0.02});
  view_.Update(kAspect);
  const auto place = view_.Project(scene_.body_pose("cube").translation());
  ASSERT_TRUE(place);
  EXPECT_EQ(view_.Select(place->x(), place->y(), kAspect), "cube");
  view_.SetFreeCamera(1, 90, -89, {3, 3, 0});
  view_.Update(kAspect);
  EXPECT_EQ(view_.Select(0.5, 0.5, kAspect), "") << "the floor";
}

TEST_F(Views, TheMousePullsAndLeavesTheForcesOfTheProgram) {
  const Eigen::Vector3d own(0.01, 0.02, 0);
  scene_.SetBodyWrench("cube", own);
  Scene other = Scene::Build(ArmAndCube());
  other.SetBodyWrench("cube", own);
  view_.SetFreeCamera(1, 90, -30, {0.6, 0.2, 0.02});
  view_.Update(kAspect);
  view_.SelectBody("cube");
  ASSERT_TRUE(view_.Hold(false));
  view_.MoveHeld(mjMOUSE_MOVE_V, 0, -0.3);  // up
  for (int i = 0; i < 100; ++i) {
    view_.ApplyForce(false);
    ASSERT_TRUE(scene_.Step().ok());
    view_.EndForce();
    ASSERT_TRUE(other.Step().ok());
  }
  EXPECT_GT(scene_.body_pose("cube").translation().z(),
            other.body_pose("cube").translation().z() + 0.02);
  const int body = mj_name2id(scene_.model(), mjOBJ_BODY, "cube");
  for (int k = 0; k < 3; ++k) EXPECT_EQ(scene_.data()->xfrc_applied[6 * body + k], own[k]);
}

TEST_F(Views, PausedItMovesFreeBodies) {
  view_.SetFreeCamera(1, 90, -30, {0.6, 0.2, 0.02});
  view_.Update(kAspect);
  view_.SelectBody("cube");
  ASSERT_TRUE(view_.Hold(false));
  const Eigen::Vector3d before = scene_.body_pose("cube").translation();
  view_.MoveHeld(mjMOUSE_MOVE_V, 0.2, 0);
  view_.ApplyForce(true);
  EXPECT_GT((scene_.body_pose("cube").translation() - before).norm(), 0.05);
}

TEST_F(Views, PathsFollowTheirPointsAndAreBounded) {
  view_.TracePoint({ViewElement::kTcp, "arm"}, true);
  view_.traces.set_length(0.1);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> q(7, 0.003 * i);
    scene_.data()->time += 0.002;
    view_.robots().front().arm().SetJointPos(q);
    view_.ExtendTraces();
  }
  const auto& path = view_.traces.paths().begin()->second;
  EXPECT_LT((path.back().position - view_.pose({ViewElement::kTcp, "arm"})->translation()).norm(),
            1e-3);
  EXPECT_GE(path.front().time, scene_.time() - 0.1 - 1e-9);
  EXPECT_GT(path.size(), 40u);
  const int with = Drawn()->ngeom;
  view_.traces.Clear();
  EXPECT_LT(Drawn()->ngeom, with);
  for (int i = 0; i < 9000; ++i) view_.traces.AddSegment({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(view_.traces.segments().size(), TraceLines::kMostSegments);
  EXPECT_LE(Drawn()->ngeom, view_.list()->maxgeom);
}

TEST_F(Views, ATrackingCameraKeepsItsBodyAndItsPlaceWhenObjectsComeAndGo) {
  view_.SetFreeCamera(2.5, 135, -20, {0, 0, 0.7});
  view_.SetTrackingCamera("cube", 0.7, 30, -40);
  view_.SelectBody(view_.elements(ViewElement::kBody)[2]);
  scene_.AddObject(BoxObject("first", {3, 3, 0.02}));  // ids move
  Drawn();
  EXPECT_EQ(view_.camera(), "Tracking");
  const auto tracking = std::get<TrackingCamera>(view_.view());
  EXPECT_EQ(tracking.body, mj_name2id(scene_.model(), mjOBJ_BODY, "cube"));
  EXPECT_EQ(tracking.distance, 0.7);
  EXPECT_EQ(tracking.azimuth, 30);
  EXPECT_EQ(tracking.elevation, -40);
  scene_.RemoveObject("cube");
  Drawn();
  EXPECT_EQ(view_.camera(), "Free") << "nothing is left to follow";
}

TEST_F(Views, PathsThatAreTooLongAreDrawnToTheirEnds) {
  view_.traces.set_length(0);
  constexpr int kPaths = 6;
  for (int path = 0; path < kPaths; ++path) {
    for (int i = 0; i < 8192; ++i)
      view_.traces.Extend(std::to_string(path), i, {1e-3 * i, 0.1 * path, 1});
  }
  const mjvScene* list = Drawn();
  EXPECT_LT(list->ngeom, list->maxgeom);
  std::set<int> ends;  // paths whose last point is drawn
  for (int i = 0; i < list->ngeom; ++i) {
    const mjvGeom& geom = list->geoms[i];
    if (geom.type == mjGEOM_CAPSULE && geom.pos[0] > 8.18)
      ends.insert(static_cast<int>(std::lround(10 * geom.pos[1])));
  }
  EXPECT_EQ(ends.size(), kPaths);
}

TEST_F(Views, RefusesARobotOfAnotherScene) {
  const Scene other = Scene::Build(ArmAndCube());
  EXPECT_THROW(SceneView(scene_, {Robot::Of(other, "arm")}), ArgumentError);
  EXPECT_EQ(SceneView(scene_, {Robot::Of(scene_, "arm")}).robots().size(), 1u);
}

}  // namespace
}  // namespace robocell
