#include "robocell/base/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

TEST(Registry, FindsRegisteredEntries) {
  Registry<int> registry("gadget", {{"lamp", 1}});
  registry.Register("fan", 2, false);
  EXPECT_THAT(registry.names(), ElementsAre("fan", "lamp"));
  EXPECT_EQ(registry.Find("fan"), 2);
  EXPECT_TRUE(registry.Has("lamp"));
  EXPECT_FALSE(registry.Get("saw"));
}

TEST(Registry, ReplacesATakenNameOnlyOnRequest) {
  Registry<int> registry("gadget", {{"lamp", 1}});
  ExpectThrow<ArgumentError>([&] { registry.Register("lamp", 2, false); },
                             "gadget 'lamp' is registered already; choose another name");
  EXPECT_EQ(registry.Find("lamp"), 1);
  registry.Register("lamp", 2, true);
  EXPECT_EQ(registry.Find("lamp"), 2);
  ExpectThrow<ArgumentError>([&] { registry.Register("", 2, true); },
                             "a kind of gadget that is registered needs a name");
}

TEST(Registry, AnUnknownNameErrorListsTheNames) {
  const Registry<int> registry("gadget", {{"lamp", 1}, {"fan", 2}});
  ExpectThrow<NotFoundError>(
      [&] { (void)registry.Find("lam", "room 'a'"); },
      "room 'a': no gadget 'lam'. Its gadgets: fan, lamp. Did you mean 'lamp'?");
}

}  // namespace
}  // namespace robocell
