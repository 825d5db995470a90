#include "robocell/expert/expert_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::Contains;

class Nobody final : public ExpertKind {
 public:
  std::shared_ptr<Expert> Make(const RunConfig&, const EpisodeStart&) const override {
    return nullptr;
  }
};

// A task that no expert demonstrates.
struct IdleConfig {
  int seconds = 1;
  static constexpr const char* kKind = "idle_of_test";
  static constexpr const char* kTypeName = "IdleConfig";
  template <class V>
  static void Fields(V&& v) {
    v("seconds", &IdleConfig::seconds, "How long to wait.");
  }
};
class Idle : public Task {
 public:
  explicit Idle(const IdleConfig&) {}
  TaskVerdict Judge(const Scene&) override { return {}; }
  std::string instruction() const override { return "wait"; }
};

TEST(ExpertKind, ATaskNamesWhoDemonstratesIt) {
  RegisterTask<IdleConfig>(std::make_shared<TaskKindOf<IdleConfig, Idle>>());
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_EQ(ExpertKindOf(run), FindExpertKind("pick"));
  run.task = PickAndPlaceTaskConfig();
  EXPECT_EQ(ExpertKindOf(run), FindExpertKind("pick_and_place"));
  run.task = IdleConfig();
  ExpectThrow<SpecError>([&] { ExpertKindOf(run); },
                         "run 'demo': no expert demonstrates task 'idle_of_test'");
}

TEST(ExpertKind, ARunMayNameAnother) {
  const auto nobody = std::make_shared<Nobody>();
  RegisterExpert("nobody_of_test", nobody);
  EXPECT_THAT(ExpertKinds(), Contains("nobody_of_test"));
  RunConfig run = ExampleRun("demo.yaml");
  run.expert = "nobody_of_test";
  EXPECT_EQ(ExpertKindOf(run), nobody);
  run.expert = "nobody_of_tset";
  ExpectThrow<NotFoundError>([&] { ExpertKindOf(run); }, "Did you mean 'nobody_of_test'?");
}

TEST(ExpertKind, APolicyIsForEvaluations) {
  RunConfig run = ExampleRun("demo.yaml");
  run.expert = "pol:P";
  ExpectThrow<NotFoundError>([&] { ExpertKindOf(run); }, "are run by `robocell evaluate`");
}

TEST(ExpertKind, NamesAreTakenOnce) {
  ExpectThrow<ArgumentError>([] { RegisterExpert("pick", std::make_shared<Nobody>()); },
                             "expert 'pick' is registered already");
  ExpectThrow<ArgumentError>([] { RegisterExpert("", std::make_shared<Nobody>()); },
                             "needs a name");
  ExpectThrow<ArgumentError>([] { RegisterExpert("none", nullptr); }, "needs an ExpertKind");
}

}  // namespace
}  // namespace robocell
