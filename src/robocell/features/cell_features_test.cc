#include "robocell/features/cell_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "robocell/base/error.h"
#include "robocell/features/own_features.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The rc7 beside a box.
struct Cell {
  Cell() : scene(Scene::Build(Spec())) {
    scene.Reset();
    robot.emplace(Robot::Of(scene, "rc7"));
  }
  static SceneSpec Spec() {
    SceneSpec spec{.name = "cell", .timestep = 0.002, .add_floor = true, .add_skybox = false};
    spec.robots.push_back({.name = "rc7", .config = Rc7(), .pos = {0.1, 0.2, 0}});
    SceneObject box{.name = "box", .shape = Shape::kBox};
    box.size = Vec3{0.02, 0.02, 0.02};
    box.mass = 0.1;
    box.rgba = Vec4{1, 0.5, 0, 1};
    box.friction = Vec3{0.8, 0.02, 0.001};
    box.pos = {0.5, 0.1, 0.02};
    spec.objects.push_back(box);
    return spec;
  }
  std::span<const double> Numbers(const CellFeatures& features, const std::string& name) const {
    std::span<const double> rest = features.state();
    for (const Feature& feature : features.observed().features()) {
      const auto size = static_cast<size_t>(feature.size());
      if (feature.column.name == name) return rest.first(size);
      rest = rest.subspan(size);
    }
    throw Error("no feature " + name);
  }
  static Pose ToPose(std::span<const double> n) {
    return Pose({n[0], n[1], n[2]}, Quaternion{n[3], n[4], n[5], n[6]});
  }

  Scene scene;
  std::optional<Robot> robot;
};

TEST(CellFeatures, ObserveObjectsInWorldBaseAndTcpFrames) {
  const Cell cell;
  CellFeatures features(cell.scene, {*cell.robot}, {.objects = {"box"}});
  features.ReadState();
  const Pose box = cell.scene.body_pose("box");
  const auto pose = [&](const std::string& name) {
    return Cell::ToPose(cell.Numbers(features, name));
  };
  EXPECT_TRUE(pose("objects/box/pose").is_close(box, 1e-12, 1e-12));
  EXPECT_TRUE((cell.robot->base_in_world() * pose("robots/rc7/objects/box/pose_in_base"))
                  .is_close(box, 1e-9, 1e-9));
  EXPECT_TRUE((cell.robot->tcp_in_world() * pose("robots/rc7/objects/box/pose_in_tcp"))
                  .is_close(box, 1e-9, 1e-9));
  EXPECT_THAT(features.observed().Names(FeatureRole::kPrivileged), Contains("objects/box/pose"));
  EXPECT_EQ(features.observed().size() + features.commanded().size(), features.schema().size());
}

TEST(CellFeatures, IncludeCustomFeatures) {
  RegisterFeature("height_of_test", {.column = {.units = "m", .frame = "world"}},
                  [](const Scene& scene, std::span<double> out) {
                    out[0] = scene.body_pose("box").translation().z();
                  });
  EXPECT_THAT(OwnFeatures(), Contains("height_of_test"));
  const Cell cell;
  CellFeatures features(cell.scene, {*cell.robot}, {.own = {"height_of_test"}});
  features.ReadState();
  EXPECT_EQ(cell.Numbers(features, "features/height_of_test")[0],
            cell.scene.body_pose("box").translation().z());
  EXPECT_EQ(features.observed().Find("features/height_of_test").column.units, "m");
  ExpectThrow<NotFoundError>(
      [&] { CellFeatures(cell.scene, {*cell.robot}, {.own = {"hight_of_test"}}); },
      "Did you mean 'height_of_test'?");
}

TEST(CellFeatures, RejectNonFiniteCustomFeatures) {
  RegisterFeature("bad_of_test", {},
                  [](const Scene&, std::span<double> out) { out[0] = std::nan(""); });
  const Cell cell;
  CellFeatures features(cell.scene, {*cell.robot}, {.own = {"bad_of_test"}});
  ExpectThrow<HookError>([&] { features.ReadState(); },
                         "feature 'features/bad_of_test' is nan at t = 0.000 s");
}

TEST(CellFeatures, ReadValuesBeyondTheirRangeUnchanged) {
  RegisterFeature("far_of_test", {.column = {.shape = {2}}, .lower = {0, 0}, .upper = {1, 1}},
                  [](const Scene&, std::span<double> out) {
                    out[0] = 5;
                    out[1] = -5;
                  });
  const Cell cell;
  CellFeatures features(cell.scene, {*cell.robot}, {.own = {"far_of_test"}});
  features.ReadState();
  EXPECT_THAT(cell.Numbers(features, "features/far_of_test"), ElementsAre(5, -5));
}

// A sensor of the engine that shows infinity.
class BrokenSensor final : public FeatureSource {
 public:
  explicit BrokenSensor(const Scene& scene) : FeatureSource(scene) {
    Add({.column = {.name = "sensors/broken"}, .lower = {0}, .upper = {1}});
  }

 private:
  void ReadNumbers(std::span<double> out) override { out[0] = HUGE_VAL; }
};

TEST(CellFeatures, ReadEngineValuesUnchanged) {
  const Cell cell;
  CellFeatures features(cell.scene, {*cell.robot},
                        {.more = std::make_unique<BrokenSensor>(cell.scene)});
  features.ReadState();
  EXPECT_THAT(cell.Numbers(features, "sensors/broken"), ElementsAre(HUGE_VAL));
}

TEST(CellFeatures, AFunctionThatFailsIsNamed) {
  RegisterFeature("failing_of_test", {},
                  [](const Scene&, std::span<double>) { throw std::runtime_error("no light"); });
  const Cell cell;
  CellFeatures features(cell.scene, {*cell.robot}, {.own = {"failing_of_test"}});
  ExpectThrow<HookError>([&] { features.ReadState(); }, "in features/failing_of_test: no light");
}

TEST(CellFeatures, ApplyActionsByName) {
  const Cell cell;
  const CellFeatures features(cell.scene, {*cell.robot});
  const std::vector<double> q = cell.robot->arm().joint_pos();
  const Action action =
      features.ToAction({{"robots/rc7/action/arm", q}, {"robots/rc7/action/gripper", {2}}});
  EXPECT_EQ(action.at("rc7").at("arm").values, q);
  EXPECT_THAT(action.at("rc7").at("gripper").values, ElementsAre(1));
  ExpectThrow<ArgumentError>(
      [&] {
        features.ToAction({{"robots/rc7/action/arm", q}, {"robots/rc7/action/arm_relative", q}});
      },
      "both move group 'arm' of robot 'rc7'");
  ExpectThrow<NotFoundError>(
      [&] {
        features.ToAction({{"robots/rc7/action/ram", q}});
      },
      "Did you mean 'robots/rc7/action/arm'?");
}

}  // namespace
}  // namespace robocell
