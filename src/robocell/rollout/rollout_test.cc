#include "robocell/rollout/rollout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/data/episode_reader.h"
#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::StartsWith;

TEST_F(RolloutTest, CountsAndNamesCommandsWithoutAnIkSolution) {
  Commanding expert(Pose(Eigen::Vector3d(50, 0, 0)), 5);
  const RolloutResult result = Rollout(expert);
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.failure, "no IK solution for rc7/arm");
  ASSERT_THAT(result.ik_failures, ElementsAre(Pair("rc7/arm", ::testing::_)));
  const NoIkSolution& none = result.ik_failures.at("rc7/arm");
  EXPECT_EQ(none.actions, 3);
  const Episode episode(folder / "e");
  EXPECT_THAT(episode.Read<uint8_t>("ik_failed"), ElementsAre(1, 0, 1, 0, 1));
  EXPECT_THAT(episode.warnings(),
              ElementsAre("3 x no IK solution for rc7/arm, first at " + none.first));
  // The pose is 50 m away, of which the arm covers its reach.
  const double reach = Robot::Of(start->scene, "rc7").reach();
  double time = -1, metres = 0;
  ASSERT_EQ(std::sscanf(none.first.c_str(), "%lf s", &time), 1) << none.first;
  const size_t at = none.first.find(" m and ");
  ASSERT_NE(at, std::string::npos) << none.first;
  metres = std::stod(none.first.substr(none.first.rfind(' ', at - 1)));
  EXPECT_EQ(time, 0);
  EXPECT_NEAR(metres, 50, 2 * reach);
  EXPECT_THAT(none.first, ::testing::HasSubstr("in phase '"));
  EXPECT_EQ(episode.end_reason(), "no IK solution for rc7/arm");
}

TEST_F(RolloutTest, FollowedCommandsAreNotFailures) {
  Commanding expert(Robot::Of(start->scene, "rc7").FkFrame(), 4);
  const RolloutResult result = Rollout(expert);
  EXPECT_EQ(result.failure, "not lifted");
  EXPECT_THAT(result.ik_failures, IsEmpty());
  EXPECT_THAT(Episode(folder / "e").Read<uint8_t>("ik_failed"), Each(0));
}

TEST_F(RolloutTest, AFailureReportedByTheExpertIsNotASuccess) {
  class GivingUp : public Commanding {
   public:
    GivingUp() : Commanding(Pose(), 4) {}
    std::string failure() const override { return done() ? "the hand closed on nothing" : ""; }
    Action Act(const Scene& scene, Rng& rng) override {
      Commanding::Act(scene, rng);
      return {};
    }
  } expert;
  start->task = std::make_shared<Content>();
  const RolloutResult result = Rollout(expert);
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.failure, "the hand closed on nothing");
  const Episode episode(folder / "e");
  EXPECT_FALSE(episode.success());
  EXPECT_EQ(episode.end_reason(), "the hand closed on nothing");
  EXPECT_THAT(episode.Read<uint8_t>("success"), ElementsAre(1, 1, 1, 0));
}

TEST_F(RolloutTest, ResultsThatAreNoJsonObjectNameTheExpertsMethod) {
  class Telling : public Commanding {
   public:
    explicit Telling(std::string results) : Commanding(Pose(), 1), results_(std::move(results)) {}
    Action Act(const Scene& scene, Rng& rng) override {
      return Commanding::Act(scene, rng), Action();
    }
    std::string results_json() const override { return results_; }

   private:
    std::string results_;
  };
  for (const char* results : {"two grasps", "[2]", "", "{\"grasps\": }"}) {
    Telling expert(results);
    ExpectThrow<HookError>([&] { Rollout(expert); }, "results_json() must return a JSON object");
  }
  Telling expert(R"({"grasps": 2})");
  Rollout(expert);
  EXPECT_EQ(nlohmann::json::parse(Episode(folder / "e").results_json()),
            nlohmann::json({{"grasps", 2}}));
}

TEST_F(RolloutTest, AnUnfinishedTaskIsAFailureEvenIfTheExpertReportsNone) {
  class Demanding : public Content {
   public:
    TaskVerdict Judge(const Scene&) override { return {.reward = 1}; }
  };
  start->task = std::make_shared<Demanding>();
  Commanding expert(Robot::Of(start->scene, "rc7").FkFrame(), 4);
  EXPECT_EQ(Rollout(expert).failure, "the task was not done");
}

// Adds an object in the middle of an episode.
class Adding : public Commanding {
 public:
  Adding() : Commanding(Pose(), 4) {}
  Action Act(const Scene& scene, Rng&) override {
    if (scene.object_names().back() != "late") {
      Scene(scene).AddObject({.name = "late",
                              .shape = Shape::kSphere,
                              .size = Vec3{0.01, 0, 0},
                              .rgba = Vec4{1, 1, 1, 1},
                              .mass = 0.1,
                              .friction = Vec3{1, 0.1, 0.1},
                              .pos = Vec3{3, 3, 0.01}});
    }
    return {};
  }
};

TEST_F(RolloutTest, AddingObjectsDuringARolloutIsAnError) {
  Adding expert;
  ExpectThrow<Error>([&] { Rollout(expert); },
                     "objects were added or removed while an episode is recorded");
}

// Images of different renderers differ.
TEST_F(RolloutTest, RecordsTheRendererWithTheImages) {
  const auto renderer_of = [&](const std::string& id) {
    return nlohmann::json::parse(Episode(folder / id).metadata_json()).value("renderer", "none");
  };
  Commanding expert(Pose(), 0);
  Rollout(expert);
  EXPECT_EQ(renderer_of("e"), "none");
  run.cameras.resolution = {64, 48};
  run.cameras.streams.push_back({.name = "wrist", .camera = "wrist_camera"});
  const std::unique_ptr<Renderer> renderer =
      MakeRenderer({.quality = run.cameras.renderer.quality});
  Rng rng = Rng::Stream(2, "expert");
  RunRollout(run, *start, expert, rng,
             {.dataset = folder.path(),
              .episode_id = "seen",
              .metadata_json = "{}",
              .keep_failures = true,
              .renderer = renderer.get()});
  EXPECT_EQ(renderer_of("seen"), renderer->description());
  EXPECT_THAT(renderer_of("seen"),
              AnyOf(AllOf(StartsWith("gl: "), HasSubstr("OpenGL")), StartsWith("soft: ")));
}

TEST_F(RolloutTest, ExcludesWarningsBeforeTheStart) {
  start->scene.data()->warning[mjWARN_CONTACTFULL].number = 7;
  Commanding expert(Pose(), 0);
  Rollout(expert);
  const Episode episode(folder / "e");
  EXPECT_THAT(episode.Read<int32_t>("engine_warnings"), Each(0));
  EXPECT_THAT(episode.warnings(), IsEmpty());
}

TEST_F(RolloutTest, WarningsOfTheEpisodeAreCounted) {
  class Warning : public Commanding {
   public:
    explicit Warning(Scene scene) : Commanding(Pose(), 3), scene_(std::move(scene)) {}
    Action Act(const Scene& scene, Rng& rng) override {
      ++scene_.data()->warning[mjWARN_CONTACTFULL].number;
      Commanding::Act(scene, rng);
      return {};
    }

   private:
    Scene scene_;
  } expert(start->scene);
  Rollout(expert);
  const Episode episode(folder / "e");
  EXPECT_THAT(episode.Read<int32_t>("engine_warnings"), ElementsAre(1, 2, 3));
  EXPECT_THAT(episode.warnings(), ElementsAre("3 x contact buffer full"));
}

}  // namespace
}  // namespace robocell::internal
