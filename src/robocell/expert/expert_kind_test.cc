#include "robocell/expert/expert_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
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

TEST(ExpertKind, ATaskNamesWhoDemonstratesIt) {
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_EQ(ExpertKindOf(run), FindExpertKind("pick"));
  run.task = PickAndPlaceTaskConfig();
  ExpectThrow<SpecError>([&] { ExpertKindOf(run); },
                         "run 'demo': no expert demonstrates task 'pick_and_place'");
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

TEST(ExpertKind, NamesAreTakenOnce) {
  ExpectThrow<ArgumentError>([] { RegisterExpert("pick", std::make_shared<Nobody>()); },
                             "expert 'pick' is registered already");
  ExpectThrow<ArgumentError>([] { RegisterExpert("", std::make_shared<Nobody>()); },
                             "needs a name");
  ExpectThrow<ArgumentError>([] { RegisterExpert("none", nullptr); }, "needs an ExpertKind");
}

}  // namespace
}  // namespace robocell
