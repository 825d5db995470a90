#include "robocell/base/call_hook.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

class WithPlace final : public Hooks {
 public:
  std::string PlaceOfHook(const char* method) const override {
    return "mine.py:7, in " + std::string(method);
  }
};

template <class E>
std::string MessageOf(const E& error, const Hooks& hooks) {
  try {
    CallHook(hooks, "judge", [&] { throw error; });
  } catch (const HookError& hook) {
    return hook.what();
  }
  return "no HookError";
}

TEST(HookErrors, ReturnTheResultOfTheHook) {
  EXPECT_EQ(CallHook(Hooks(), "judge", [] { return 3; }), 3);
}

TEST(HookErrors, NameThePlaceOfTheHook) {
  EXPECT_EQ(MessageOf(ArgumentError("no number"), WithPlace()), "no number (mine.py:7, in judge)");
  EXPECT_EQ(MessageOf(NotFoundError("no 'cub'"), WithPlace()), "no 'cub' (mine.py:7, in judge)");
  EXPECT_EQ(MessageOf(std::out_of_range("at"), WithPlace()), "in judge: at (mine.py:7, in judge)");
  EXPECT_EQ(MessageOf(HookError("wrong", ""), WithPlace()), "wrong (mine.py:7, in judge)");
}

TEST(HookErrors, KeepAKnownPlace) {
  EXPECT_EQ(MessageOf(HookError("wrong", "other.py:1, in act"), WithPlace()),
            "wrong (other.py:1, in act)");
}

TEST(HookErrors, OfCompiledCodeHaveNoPlace) {
  EXPECT_EQ(MessageOf(ArgumentError("no number"), Hooks()), "no number");
}

TEST(HookErrors, KeepErrorsThatWouldRecur) {
  EXPECT_THROW(MessageOf(IoError("disk full"), WithPlace()), IoError);
  EXPECT_THROW(MessageOf(SpecError("wrong file"), WithPlace()), SpecError);
  EXPECT_THROW(MessageOf(3, WithPlace()), int);
  EXPECT_THROW(MessageOf(EngineError("stack overflow"), WithPlace()), EngineError);
  EXPECT_THROW(MessageOf(ClosedError("scene 'a' was closed"), WithPlace()), ClosedError);
  EXPECT_THROW(MessageOf(DivergedError("qacc is huge"), WithPlace()), DivergedError);
}

}  // namespace
}  // namespace robocell::internal
