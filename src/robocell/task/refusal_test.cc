#include "robocell/task/refusal.h"

#include <gtest/gtest.h>

#include <set>

namespace robocell {
namespace {

TEST(Refusal, EveryReasonHasATextOfItsOwn) {
  std::set<std::string> texts;
  for (int reason = Refusal::kNoFreePlace; reason <= Refusal::kInvalidScene; ++reason)
    texts.insert(ToString(static_cast<Refusal::Reason>(reason)));
  EXPECT_EQ(texts.size(), static_cast<size_t>(Refusal::kInvalidScene) + 1);
  EXPECT_EQ(texts.count("?"), 0u) << "a reason that ToString does not know";
}

}  // namespace
}  // namespace robocell
