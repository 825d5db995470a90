#include "robocell/scene/scene_use.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"

namespace robocell {
namespace {

// Runs it in another thread; returns the text of its exception, else "".
template <class Work>
std::string Elsewhere(Work&& work) {
  std::string text;
  std::thread([&] {
    try {
      work();
    } catch (const Error& error) {
      text = error.what();
    }
  }).join();
  return text;
}

TEST(SceneUse, TheErrorNamesTheUserAndTheRemedy) {
  SceneUse use("scene 'pick'");
  const auto claim = [&] { const SceneUse::Claim other(use, "other"); };
  {
    const SceneUse::Claim mine(use, "Scene.step");
    EXPECT_FALSE(use.by_another_thread());
    const std::string text = Elsewhere([&] {
      EXPECT_TRUE(use.by_another_thread());
      claim();
    });
    EXPECT_NE(text.find("scene 'pick' is in use by another thread (Scene.step): "),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("Scene.from_compiled in each thread"), std::string::npos) << text;
  }
  EXPECT_EQ(Elsewhere(claim), "") << "it was let go of";
  EXPECT_FALSE(use.by_another_thread());
}

TEST(SceneUse, NestedClaimsLastUntilTheOutermostEnds) {
  SceneUse use("scene 'pick'");
  const auto other = [&] { const SceneUse::Claim claim(use, "other"); };
  use.Begin("Scene.reset");
  { const SceneUse::Claim inner(use, "Scene.time"); }
  EXPECT_NE(Elsewhere(other).find("(Scene.reset)"), std::string::npos) << "of the first call";
  use.End();
  EXPECT_EQ(Elsewhere(other), "");
}

TEST(SceneUse, CompetingThreadsNeverOverlap) {
  SceneUse use("scene 'pick'");
  std::atomic<int> inside = 0, together = 0, refused = 0;
  int done = 0;  // guarded by the use
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20000;) {
        try {
          const SceneUse::Claim claim(use, "work");
          together += ++inside != 1;
          ++done;
          --inside;
          ++i;
        } catch (const Error&) {
          ++refused;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together, 0);
  EXPECT_EQ(done, 60000);
}

}  // namespace
}  // namespace robocell
