#include "robocell/expert/expert_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/pick_task_config.h"
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

TEST(ExpertKind, ATaskNamesItsExpert) {
  RegisterTask<IdleConfig>(std::make_shared<TaskKindOf<IdleConfig, Idle>>());
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_EQ(ExpertKindFor(run), FindExpertKind("pick"));
  run.task = PickAndPlaceTaskConfig();
  EXPECT_EQ(ExpertKindFor(run), FindExpertKind("pick_and_place"));
  run.task = IdleConfig();
  ExpectThrow<SpecError>(
      [&] { ExpertKindFor(run); },
      "run 'demo': no expert demonstrates task 'idle_of_test'; register one under "
      "this name, name one as `expert` (there are ");
}

// Python has the same rule: an expert registered as "stack" demonstrates the task "stack".
TEST(ExpertKind, ATaskWithoutAnExpertUsesTheOneOfItsName) {
  RegisterTask("named_alike_of_test", std::make_shared<KindFieldsOf<IdleConfig>>(),
               std::make_shared<TaskKindOf<IdleConfig, Idle>>());
  RunConfig run = ExampleRun("demo.yaml");
  run.task = TaskSpec("named_alike_of_test");
  EXPECT_EQ(NameOfExpert(run), "");
  const auto expert = std::make_shared<Nobody>();
  RegisterExpert("named_alike_of_test", expert);
  EXPECT_EQ(ExpertKindFor(run), expert);
}

TEST(ExpertKind, ARunCanOverrideTheExpert) {
  const auto nobody = std::make_shared<Nobody>();
  RegisterExpert("nobody_of_test", nobody);
  EXPECT_THAT(ExpertKinds(), Contains("nobody_of_test"));
  RunConfig run = ExampleRun("demo.yaml");
  run.expert = "nobody_of_test";
  EXPECT_EQ(ExpertKindFor(run), nobody);
  run.expert = "nobody_of_tset";
  ExpectThrow<NotFoundError>([&] { ExpertKindFor(run); }, "Did you mean 'nobody_of_test'?");
}

TEST(ExpertKind, APolicyIsForEvaluations) {
  RunConfig run = ExampleRun("demo.yaml");
  run.expert = "pol:P";
  ExpectThrow<NotFoundError>([&] { ExpertKindFor(run); }, "are run by `robocell evaluate`");
}

TEST(ExpertKind, RejectsDuplicateNames) {
  ExpectThrow<ArgumentError>([] { RegisterExpert("pick", std::make_shared<Nobody>()); },
                             "expert 'pick' is registered already");
  ExpectThrow<ArgumentError>([] { RegisterExpert("", std::make_shared<Nobody>()); },
                             "needs a name");
  ExpectThrow<ArgumentError>([] { RegisterExpert("none", nullptr); }, "needs an ExpertKind");
}

}  // namespace
}  // namespace robocell
