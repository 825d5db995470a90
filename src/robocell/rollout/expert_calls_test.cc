#include "robocell/rollout/expert_calls.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// An expert of a user, whose done() raises an error.
class Raising : public Expert {
 public:
  void Begin(const Scene&, Rng&) override {}
  Action Act(const Scene&, Rng&) override { return {}; }
  bool done() const override { throw ArgumentError("no such gripper"); }
  std::string failure() const override {
    ++done_calls;
    return "gave up";
  }
  int phase() const override { return 3; }
  std::vector<std::string> phase_names() const override { return {}; }
  std::string PlaceOfHook(const char* method) const override {
    return std::string("mine.py:3, in ") + method;
  }

  mutable int done_calls = 0;
};

TEST(ExpertCalls, AnErrorNamesItsHookAndItsPlace) {
  Raising expert;
  ExpertCalls calls(expert, false);
  const std::string message = ExpectThrow<HookError>(
      [&] { calls("done", true, [&] { return expert.done(); }); }, "no such gripper");
  EXPECT_NE(message.find("mine.py:3, in done"), std::string::npos) << message;
  EXPECT_FALSE(calls.failed());
  EXPECT_EQ(calls.failure(), "gave up");
}

TEST(ExpertCalls, AnErrorThatFailsTheRolloutIsItsReasonAndEndsTheCalls) {
  Raising expert;
  ExpertCalls calls(expert, true);
  EXPECT_EQ(calls("phase", 0, [&] { return expert.phase(); }), 3);
  EXPECT_TRUE(calls("done", true, [&] { return expert.done(); }));
  EXPECT_TRUE(calls.failed());
  EXPECT_EQ(calls("phase", 0, [&] { return expert.phase(); }), 0) << "no hook is called any more";
  const std::string reason = calls.failure();
  EXPECT_EQ(reason.rfind("policy error: ", 0), 0u) << reason;
  EXPECT_NE(reason.find("no such gripper"), std::string::npos) << reason;
  EXPECT_EQ(expert.done_calls, 0);
}

}  // namespace
}  // namespace robocell::internal
