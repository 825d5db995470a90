#include "robocell/motion/collision_model.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/robot/collision_filter.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell::internal {
namespace {

std::vector<int> JointIds(const Robot& robot) {
  std::vector<int> joints;
  for (const std::string& name : robot.joint_names())
    joints.push_back(FindId(robot.scene().model(), mjOBJ_JOINT, name));
  return joints;
}

SceneObject Obstacle(const std::string& name, Shape shape, const Vec3& size, const Vec3& pos) {
  SceneObject object = BoxObject(name, pos);
  object.shape = shape;
  object.size = size;
  object.euler = Vec3{20, 30, 40};
  object.fixed = true;
  return object;
}

// A robot between obstacles of every kind.
class CollisionModels : public ::testing::TestWithParam<RobotCase> {
 protected:
  void SetUp() override {
    REQUIRE_ROBOT(GetParam());
    RobotSpec robot_spec = GetParam().spec();
    robot_spec.name = "robot";
    SceneSpec spec = SceneWith(std::move(robot_spec));
    spec.objects.push_back(Obstacle("box", Shape::kBox, {0.1, 0.15, 0.2}, {0.5, 0.1, 0.4}));
    spec.objects.push_back(Obstacle("ball", Shape::kSphere, {0.1, 0, 0}, {-0.3, 0.4, 0.6}));
    spec.objects.push_back(Obstacle("drum", Shape::kCylinder, {0.1, 0.1, 0}, {-0.4, -0.3, 0.3}));
    scene_ = Scene::Build(spec);
    robot_ = GetParam().robot(*scene_, "robot");
    joints_ = JointIds(*robot_);
  }

  std::vector<double> RandomRows(const CollisionModel& model, int count, Rng& rng) const {
    std::vector<double> rows;
    for (int k = 0; k < count; ++k) {
      for (const MovingLinks::Dof& dof : model.links().dofs())
        rows.push_back(rng.Uniform(std::max(dof.lower, -3.1), std::min(dof.upper, 3.1)));
    }
    return rows;
  }

  std::optional<Scene> scene_;
  std::optional<Robot> robot_;
  std::vector<int> joints_;
};

INSTANTIATE_TEST_SUITE_P(Robots, CollisionModels, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(CollisionModels, CautiousSpheresMissNothingThatTheEngineFinds) {
  CollisionModel model(*robot_, joints_, {.clearance = 0.005});
  CollisionFilter filter(*robot_, {.clearance = 0.005});
  Rng rng = Rng::Stream(1, "configurations");
  int free = 0, spheres_free = 0;
  for (int k = 0; k < 50; ++k) {
    const std::vector<double> rows = RandomRows(model, kLanes, rng);
    const uint32_t may = model.MayHit(rows, kLanes, SphereJudge::kCautious);
    const uint32_t hits = model.Hit(rows, kLanes);
    EXPECT_EQ(hits & ~may, 0u);
    for (int i = 0; i < kLanes; ++i) {
      const std::span<const double> q(rows.data() + static_cast<size_t>(i) * model.n_dofs(),
                                      model.n_dofs());
      const bool is_free = filter.IsFree(q);
      EXPECT_EQ((hits >> i & 1) == 0, is_free);
      if (is_free && (may >> i & 1)) ++spheres_free;
      free += is_free;
    }
  }
  EXPECT_GT(free, 20);
  // Spheres are a little larger than the geoms, but not much.
  EXPECT_LT(spheres_free, 0.2 * free);
}

TEST_P(CollisionModels, AnswersDependOnNeitherTheOthersNorTheInstructionSet) {
  CollisionModel model(*robot_, joints_, {.clearance = 0.002});
  Rng rng = Rng::Stream(2, "configurations");
  const std::vector<double> rows = RandomRows(model, 40 * kLanes, rng);
  const std::span<const double> all(rows);
  const size_t n = model.n_dofs();
  std::vector<uint32_t> expected;
  for (const SphereJudge judge : {SphereJudge::kCautious, SphereJudge::kBold}) {
    expected.clear();
    OnEveryInstructionSet([&](const std::string& name) {
      std::vector<uint32_t> found;
      for (size_t k = 0; k < 40; ++k)
        found.push_back(model.MayHit(all.subspan(k * kLanes * n), kLanes, judge));
      if (expected.empty()) expected = found;
      EXPECT_EQ(found, expected) << name;
      for (size_t k = 0; k < 40 * kLanes; k += 3) {
        const uint32_t alone = model.MayHit(all.subspan(k * n), 1, judge);
        EXPECT_EQ(alone, expected[k / kLanes] >> (k % kLanes) & 1) << name;
      }
    });
  }
}

// Obstacles of the kinds that scene objects lack.
constexpr const char* kKinds = R"(
  <asset><mesh name="wedge" vertex="-.1 -.1 -.1 .1 -.1 -.1 0 .1 -.1 0 0 .15 -.12 .05 0"/>
    <hfield name="hills" nrow="6" ncol="8" size=".4 .3 .2 .05" elevation="
      0 3 0 1 0 2 2 2 2 0 0 2 0 2 2 3 0 2 1 0 3 0 1 0
      0 0 3 0 2 0 2 0 3 0 2 2 3 0 1 0 0 2 1 0 2 3 0 0"/>
  </asset>
  <worldbody><body name="kinds">
    <geom name="capsule" type="capsule" size=".05 .2" pos=".35 -.3 .7" euler="30 20 10"/>
    <geom name="egg" type="ellipsoid" size=".1 .15 .08" pos=".2 .35 .8" euler="30 20 10"/>
    <geom name="wedge" type="mesh" mesh="wedge" pos=".45 .1 .6" euler="30 20 10"/>
    <geom name="hills" type="hfield" hfield="hills" pos="-.3 0 .3"/>
  </body></worldbody>)";

TEST(CollisionModelAmongAllKinds, MissesNothingThatTheEngineFinds) {
  ModelFolder folder;
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  spec.objects.push_back(
      {.name = "kinds", .mjcf_path = folder.Write("kinds", kKinds), .pos = Vec3{}, .fixed = true});
  const Scene scene = Scene::Build(spec);
  const Robot robot = Robot::Of(scene, "rc7");
  CollisionModel model(robot, JointIds(robot), {.clearance = 0.004});
  CollisionFilter filter(robot, {.clearance = 0.004});
  Rng rng = Rng::Stream(3, "configurations");
  std::vector<int> found(scene.model()->ngeom, 0);
  for (int k = 0; k < 1500; ++k) {
    std::vector<double> q;
    for (const MovingLinks::Dof& dof : model.links().dofs())
      q.push_back(rng.Uniform(dof.lower, dof.upper));
    const bool is_free = filter.IsFree(q);
    const auto contact = model.FindContact(q);
    EXPECT_EQ(!contact, is_free);
    if (contact) ++found[contact->other];
    if (!is_free) {
      EXPECT_EQ(model.MayHit(q, 1, SphereJudge::kCautious), 1u);
    }
  }
  for (const std::string name : {"capsule", "egg", "wedge", "hills"})
    EXPECT_GT(found[FindId(scene.model(), mjOBJ_GEOM, "kinds_" + name)], 3) << name;
}

class CollisionModelOfRc7 : public ::testing::Test {
 protected:
  static SceneSpec Spec() {
    SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
    spec.objects.push_back(BoxObject("cube", {0.6, 0.4, 0.3}));
    return spec;
  }
  Scene scene_ = Scene::Build(Spec());
  Robot robot_ = Robot::Of(scene_, "rc7");
  std::vector<int> joints_ = JointIds(robot_);

  // In the palm, which it touches, and from there along the approach axis.
  void PutCubeInHand(double beyond) {
    const Pose tcp = robot_.tcp_in_world();
    scene_.SetBodyPose("cube", tcp * Pose(Eigen::Vector3d(0, 0, beyond)));
  }
  std::string FoundAt(CollisionModel* model) {
    const auto contact = model->FindContact(model->present());
    return contact ? model->Describe(*contact) : "";
  }
};

TEST_F(CollisionModelOfRc7, NamesTheBodiesThatAreTooNear) {
  PutCubeInHand(-0.08);
  CollisionModel model(robot_, joints_, {.clearance = 0.01});
  EXPECT_NE(FoundAt(&model).find("'cube'"), std::string::npos);
  EXPECT_EQ(model.MayHit(model.present(), 1, SphereJudge::kBold), 1u);
  PutCubeInHand(0.2);
  EXPECT_NE(FoundAt(&model), "");  // it looks at the state of its last update
  model.Update();
  EXPECT_EQ(FoundAt(&model), "");
  EXPECT_EQ(model.MayHit(model.present(), 1, SphereJudge::kCautious), 0u);
}

TEST_F(CollisionModelOfRc7, AllowedContactsDoNotCount) {
  PutCubeInHand(-0.08);
  CollisionModel model(robot_, joints_, {.allowed = {{"cube", ""}}});
  EXPECT_EQ(FoundAt(&model), "");
  EXPECT_EQ(model.MayHit(model.present(), 1, SphereJudge::kCautious), 0u);
  ExpectThrow<NotFoundError>(
      [&] {
        CollisionModel(robot_, joints_, {.allowed = {{"cupe", ""}}});
      },
      "Did you mean 'cube'?");
}

TEST_F(CollisionModelOfRc7, AttachedBodiesMoveAndCollideWithTheRest) {
  PutCubeInHand(-0.08);
  const std::string hand =
      ElementName(scene_.model(), mjOBJ_BODY, scene_.model()->jnt_bodyid[joints_.back()]);
  CollisionModel model(robot_, joints_, {.attached = {{"cube", hand}}});
  EXPECT_EQ(FoundAt(&model), "");
  // Far down the cube, which hangs below the fingers, meets the floor first.
  std::vector<double> q = model.present();
  bool cube_meets_floor = false;
  for (int k = 0; k < 200 && !cube_meets_floor; ++k) {
    q[1] += 0.01;
    const auto contact = model.FindContact(q);
    cube_meets_floor = contact && model.Describe(*contact).find("'cube'") != std::string::npos;
  }
  EXPECT_TRUE(cube_meets_floor);
}

TEST_F(CollisionModelOfRc7, DistanceIsTheEngines) {
  PutCubeInHand(0.04);
  CollisionModel model(robot_, joints_, {});
  double nearest = 0.03;
  scene_.SyncPoses();
  const mjModel* m = scene_.model();
  const int cube = FindId(m, mjOBJ_BODY, "cube"), geom = m->body_geomadr[cube];
  for (const int own : robot_.collision_geom_ids()) {
    if (m->geom_contype[own] == 0 && m->geom_conaffinity[own] == 0) continue;
    nearest = std::min(nearest, mj_geomDistance(m, scene_.data(), own, geom, 0.03, nullptr));
  }
  EXPECT_NEAR(model.Distance(model.present(), 0.03), nearest, 1e-6);
  EXPECT_LT(nearest, 0.03);
  EXPECT_EQ(model.Distance(model.present(), 0.001), 0.001);
}

TEST_F(CollisionModelOfRc7, ThrowsAfterObjectsWereAdded) {
  CollisionModel model(robot_, joints_, {});
  scene_.AddObject(BoxObject("another", {0.6, -0.4, 0.3}));
  ExpectThrow<Error>([&] { model.Update(); }, "make the planner again");
}

}  // namespace
}  // namespace robocell::internal
