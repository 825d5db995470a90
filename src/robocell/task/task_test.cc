#include "robocell/task/task.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hook_error.h"
#include "robocell/task/task_calls.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// Reads its scene's annotations on request.
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
  int calls = 0;
  Task::KnownScene known = [this] {
    ++calls;
    SceneAnnotations annotations;
    annotations.rooms.push_back({.name = "kitchen"});
    return std::make_shared<const SceneAnnotations>(annotations);
  };
};

TEST(Task, QueriesAnnotationsOnceAndKeepsThem) {
  House house;
  Looking task(true);
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "task");
  internal::TaskCalls(task).Prepare(house.known, spec, rng, "");
  EXPECT_EQ(task.rooms, 1u);
  EXPECT_EQ(task.annotations().rooms[0].name, "kitchen");
  EXPECT_EQ(house.calls, 1);
  internal::TaskCalls(task).Prepare(house.known, spec, rng, "");
  EXPECT_EQ(house.calls, 2) << "it may be another scene";
}

TEST(Task, WithoutAnnotationsCostsNothing) {
  House house;
  Looking task(false);
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "task");
  internal::TaskCalls(task).Prepare(house.known, spec, rng, "");
  EXPECT_EQ(house.calls, 0);
  ExpectThrow<Error>([&] { (void)task.annotations(); }, "in prepare() first");
}

TEST(Task, AFailedPreparationChangesNothing) {
  Looking task(true);
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "task");
  const Task::KnownScene fails = []() -> std::shared_ptr<const SceneAnnotations> {
    throw IoError("no file");
  };
  ExpectThrow<IoError>([&] { internal::TaskCalls(task).Prepare(fails, spec, rng, ""); }, "no file");
  ExpectThrow<Error>([&] { (void)task.annotations(); }, "in prepare() first");
}

// Adds spheres of that name and radius.
class Adding final : public Task {
 public:
  Adding(std::vector<std::string> names, double radius)
      : names_(std::move(names)), radius_(radius) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    for (const std::string& name : names_) {
      spec.objects.push_back(
          {.name = name, .shape = Shape::kSphere, .size = Vec3{radius_, 0, 0}, .mass = 0.1});
    }
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "add"; }
  std::string PlaceOfHook(const char* method) const override {
    return std::string("mine.py:3, in ") + method;
  }
  std::string WhyNot() {
    SceneSpec spec{.name = "lab"};
    spec.objects.push_back({.name = "table", .shape = Shape::kBox, .size = Vec3{20, 20, 0.1}});
    Rng rng = Rng::Stream(1, "task");
    const auto nothing = [] { return std::make_shared<const SceneAnnotations>(); };
    return ExpectThrow<HookError>(
        [&] { internal::TaskCalls(*this).Prepare(nothing, spec, rng, "mine"); },
        "task 'mine': prepare() added ");
  }

 private:
  std::vector<std::string> names_;
  double radius_;
};

TEST(Task, ThatAddsAnObjectTwiceIsRejectedWithItsPlace) {
  const std::string twice = Adding({"ball", "ball"}, 0.02).WhyNot();
  EXPECT_NE(twice.find("object 'ball' twice to scene 'lab' (objects[1] and objects[2]); append"),
            std::string::npos)
      << twice;
  EXPECT_NE(twice.find("(mine.py:3, in prepare)"), std::string::npos) << twice;
  const std::string taken = Adding({"table"}, 0.02).WhyNot();
  EXPECT_NE(taken.find("a name that scene 'lab' has already (objects[0])"), std::string::npos)
      << taken;
}

// Puts a cube before the objects that are there, or in place of them.
class Shuffling final : public Task {
 public:
  explicit Shuffling(bool removes) : removes_(removes) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    if (removes_) spec.objects.clear();
    spec.objects.push_back({.name = "cube", .shape = Shape::kBox, .size = Vec3{0.02, 0.02, 0.02}});
    std::swap(spec.objects.boxes().front(), spec.objects.boxes().back());
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "shuffle"; }

 private:
  bool removes_;
};

TEST(Task, LeavesTheObjectsOfTheScene) {
  for (const bool removes : {false, true}) {
    Shuffling task(removes);
    SceneSpec spec{.name = "lab"};
    spec.objects.push_back({.name = "table", .shape = Shape::kBox, .size = Vec3{1, 1, 0.1}});
    Rng rng = Rng::Stream(1, "task");
    const auto nothing = [] { return std::make_shared<const SceneAnnotations>(); };
    ExpectThrow<HookError>([&] { internal::TaskCalls(task).Prepare(nothing, spec, rng, "mine"); },
                           "task 'mine': prepare() moved or removed object 'table' of scene 'lab'; "
                           "leave those that are there where they are, and append others");
  }
}

TEST(Task, ThatAddsAnObjectInMillimetresIsRejectedWithTheSizeThatIsMeant) {
  const std::string reason = Adding({"ball"}, 30).WhyNot();
  EXPECT_NE(reason.find("object 'ball' is 60 m large"), std::string::npos) << reason;
  EXPECT_NE(reason.find("(in millimetres it would be 0.06 m)"), std::string::npos) << reason;
}

}  // namespace
}  // namespace robocell
