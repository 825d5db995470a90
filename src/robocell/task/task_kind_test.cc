#include "robocell/task/task_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_contents.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(TaskKind, BuiltInKindsExist) {
  for (const char* kind : {"pick", "pick_and_place"})
    EXPECT_NE(FindTaskKind(kind)->Make(TaskSpec(kind)), nullptr) << kind;
  ExpectThrow<NotFoundError>([] { FindTaskKind("pik"); }, "Did you mean 'pick'?");
}

TEST(TaskKind, ItsFieldsAreRegisteredWithIt) {
  const auto pick = FindTaskKind("pick");
  ExpectThrow<ArgumentError>(
      [&] { RegisterTask("pick", std::make_shared<KindFieldsOf<PickTaskConfig>>(), pick); },
      "task 'pick' is registered already");
  ExpectThrow<ArgumentError>(
      [] { RegisterTask("none", std::make_shared<KindFieldsOf<PickTaskConfig>>(), nullptr); },
      "task 'none' needs a TaskKind");
  EXPECT_THAT(TaskKinds(), ::testing::Not(::testing::Contains("none")));
}

// Adds one ball, whose kind takes its turn among `kinds`.
class Balls final : public Task {
 public:
  explicit Balls(int kinds) {
    for (int i = 0; i < kinds; ++i) kinds_.push_back("kind_" + std::to_string(i));
  }
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    kind_ = turn().Choose(kinds_);
    spec.objects.push_back(
        {.name = "ball", .shape = Shape::kSphere, .size = Vec3{0.02, 0, 0}, .mass = 0.1});
  }
  std::string kind_of(const std::string& /*object*/) const override { return kind_; }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look at the ball"; }

 private:
  std::vector<std::string> kinds_;
  std::string kind_;
};

class BallsKind final : public TaskKind {
 public:
  explicit BallsKind(int kinds) : kinds_(kinds) {}
  std::shared_ptr<Task> Make(const TaskSpec& /*spec*/) const override {
    return std::make_shared<Balls>(kinds_);
  }

 private:
  int kinds_;
};

// The turns of the starts themselves are the oracle, for turns that are short and long.
TEST(TaskKind, PossibleContentsHaveEverythingThatTakesItsTurn) {
  const RunConfig run = ExampleRun("demo.yaml");
  const auto nothing = [] { return std::make_shared<const SceneAnnotations>(); };
  const Task::KnownScene known = nothing;
  for (const int kinds : {1, 3, 16, 17, 40}) {
    std::set<std::string> possible, started;
    for (const StartContents& contents :
         BallsKind(kinds).PossibleContents(run, 0, SceneSpec(), known)) {
      ASSERT_EQ(contents.kinds.size(), 1u);
      possible.insert(contents.kinds.front());
    }
    for (int episode = 0; episode < 5 * kinds; ++episode) {
      Balls task(kinds);
      SceneSpec spec;
      Rng rng = Rng::Stream(1, "start", episode);
      const StartContents contents = PrepareContents(
          task, {.known = known, .kind = "balls", .turn = {0, 0, episode}}, spec, rng);
      started.insert(contents.kinds.front());
    }
    EXPECT_EQ(possible, started) << kinds << " kinds";
    EXPECT_EQ(possible.size(), static_cast<size_t>(kinds));
  }
}

}  // namespace
}  // namespace robocell
