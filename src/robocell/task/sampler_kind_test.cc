#include "robocell/task/sampler_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/pick_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

// It refuses every start.
class NeverOfTest final : public TaskSampler {
 public:
  explicit NeverOfTest(const RunConfig& run) : run_(run.run) {}
  SampleResult Sample(const SampleRequest& /*request*/, Rng& /*rng*/) override {
    return {.start = {}, .refusal = {.reason = "never in " + run_}};
  }

 private:
  std::string run_;
};

TEST(SamplerKind, ARunNamesTheOneThatItUses) {
  RegisterSampler("never_of_test", std::make_shared<SamplerKindOf<NeverOfTest>>(), true);
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_NE(std::dynamic_pointer_cast<PickTaskSampler>(MakeSampler(run)), nullptr);
  run.sampler = "never_of_test";
  Rng rng = Rng::Stream(1, "start");
  EXPECT_EQ(MakeSampler(run)->Sample({}, rng).refusal.counted_as(), "never in demo");
  EXPECT_THAT(SamplerKinds(), ::testing::Contains("never_of_test"));
}

TEST(SamplerKind, NamesThatAreTakenAndUnknownOnesAreTold) {
  RegisterSampler("never_of_test", std::make_shared<SamplerKindOf<NeverOfTest>>(), true);
  ExpectThrow<ArgumentError>(
      [] { RegisterSampler("never_of_test", std::make_shared<SamplerKindOf<NeverOfTest>>()); },
      "sampler 'never_of_test' is registered already");
  ExpectThrow<NotFoundError>([] { FindSamplerKind("nevre_of_test"); },
                             "Did you mean 'never_of_test'?");
}

}  // namespace
}  // namespace robocell
