#include "robocell/task/task.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// Looks at what is known of its scene if it is told to.
class Looking final : public Task {
 public:
  explicit Looking(bool looks) : looks_(looks) {}
  void Prepare(SceneSpec& /*spec*/, Rng& /*rng*/) override {
    if (looks_) rooms = annotations().rooms.size();
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look"; }

  size_t rooms = 0;

 private:
  bool looks_;
};

struct House {
  int asked = 0;
  Task::KnownScene known = [this] {
    ++asked;
    SceneAnnotations annotations;
    annotations.rooms.push_back({.name = "kitchen"});
    return std::make_shared<const SceneAnnotations>(annotations);
  };
};

TEST(Task, AsksForAnnotationsOnceAndKeepsThem) {
  House house;
  Looking task(true);
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "task");
  task.PrepareIn(house.known, spec, rng);
  EXPECT_EQ(task.rooms, 1u);
  EXPECT_EQ(task.annotations().rooms[0].name, "kitchen");
  EXPECT_EQ(house.asked, 1);
  task.PrepareIn(house.known, spec, rng);
  EXPECT_EQ(house.asked, 2) << "it may be another scene";
}

TEST(Task, ThatDoesNotAskCostsNothingAndHasNoneLater) {
  House house;
  Looking task(false);
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "task");
  task.PrepareIn(house.known, spec, rng);
  EXPECT_EQ(house.asked, 0);
  ExpectThrow<Error>([&] { (void)task.annotations(); }, "asked for in prepare() first");
}

TEST(Task, APreparationThatFailsLeavesNothingBehind) {
  Looking task(true);
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "task");
  const Task::KnownScene fails = []() -> std::shared_ptr<const SceneAnnotations> {
    throw IoError("no file");
  };
  ExpectThrow<IoError>([&] { task.PrepareIn(fails, spec, rng); }, "no file");
  ExpectThrow<Error>([&] { (void)task.annotations(); }, "asked for in prepare() first");
}

}  // namespace
}  // namespace robocell
