// Tests which of several arms acts: the nearest one that can begin.
#include "robocell/expert/any_arm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

constexpr const char* kTwoArms = R"(<worldbody><body name="beam">
<body name="l" pos="0 .3 .5"><joint name="l" axis="0 0 1" damping="1"/><geom size=".03" mass="1"/><site name="l"/></body>
<body name="r" pos="0 -.3 .5"><joint name="r" axis="0 0 1" damping="1"/><geom size=".03" mass="1"/><site name="r"/></body>
</body></worldbody><actuator><position name="l" joint="l" kp="50" kv="5"/><position name="r" joint="r" kp="50" kv="5"/></actuator>)";

// An expert that can begin or not, and remembers whether it acted.
struct Stub final : Expert {
  explicit Stub(std::string why_not) : failure_text(std::move(why_not)) {}
  void Begin(const Scene& /*scene*/, Rng& /*rng*/) override { ++begun; }
  Action Act(const Scene& /*scene*/, Rng& /*rng*/) override {
    ++acted;
    return {};
  }
  bool done() const override { return !failure_text.empty(); }
  std::string failure() const override { return failure_text; }
  int phase() const override { return 0; }
  std::vector<std::string> phase_names() const override { return {"act"}; }

  std::string failure_text;
  int begun = 0, acted = 0;
};

class AnyArmTest : public ::testing::Test {
 protected:
  AnyArmTest() {
    SceneSpec spec = EmptyScene();
    const RobotConfig config =
        ParseYaml<RobotConfig>("name: two\nmodel: " + folder_.Write("two", kTwoArms) +
                                   "\nroot_body: beam\nmove_groups:\n"
                                   "  left: {kind: arm, joints: [l], leaf: {site: l}}\n"
                                   "  right: {kind: arm, joints: [r], leaf: {site: r}}\n",
                               "two.yaml");
    spec.robots.push_back({.name = "two", .config = config});
    spec.objects.push_back(BoxObject("cube", {0.2, -0.3, 0.5}));
    scene_.emplace(Scene::Build(spec));
    scene_->Reset();
  }
  internal::AnyArm Make(const std::string& left, const std::string& right) {
    left_ = std::make_shared<Stub>(left);
    right_ = std::make_shared<Stub>(right);
    return internal::AnyArm({{"two/left", left_}, {"two/right", right_}}, "cube");
  }
  static std::string ArmOf(const Expert& expert) {
    return nlohmann::json::parse(expert.results_json()).at("arm");
  }

  ModelFolder folder_;
  std::optional<Scene> scene_;
  Rng rng_ = Rng::Stream(1, "test");
  std::shared_ptr<Stub> left_, right_;
};

TEST_F(AnyArmTest, IsTheNearestOne) {
  EXPECT_THAT(internal::NearestArms(*scene_, {"two/left", "two/right"}, "cube"),
              ElementsAre("two/right", "two/left"));
  internal::AnyArm expert = Make("", "");
  expert.Begin(*scene_, rng_);
  expert.Act(*scene_, rng_);
  EXPECT_EQ(right_->acted, 1);
  EXPECT_EQ(left_->begun, 0);
  EXPECT_EQ(ArmOf(expert), "right");
}

TEST_F(AnyArmTest, IsTheNextOneIfTheNearestCannotBegin) {
  internal::AnyArm expert = Make("", "out of reach");
  expert.Begin(*scene_, rng_);
  expert.Act(*scene_, rng_);
  EXPECT_EQ(left_->acted, 1);
  EXPECT_EQ(expert.failure(), "");
  EXPECT_EQ(ArmOf(expert), "left");
}

TEST_F(AnyArmTest, FailsIfNoneCanBegin) {
  internal::AnyArm expert = Make("too far", "out of reach");
  expert.Begin(*scene_, rng_);
  EXPECT_TRUE(expert.done());
  EXPECT_EQ(expert.failure(), "too far");
}

}  // namespace
}  // namespace robocell
