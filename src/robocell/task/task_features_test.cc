#include "robocell/task/task_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::Not;

// Observes objects under names of its own, and has a signal.
class Watching : public Task {
 public:
  std::string instruction() const override { return "watch the cubes"; }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::vector<std::string> objects() const override { return names; }
  std::string object_of(const std::string& name) const override {
    return name == "chosen" ? chosen : name;
  }
  std::vector<Feature> signals() const override { return {{.column = {.name = "height"}}}; }
  void Observe(const Scene& /*scene*/, std::span<double> out) const override { out[0] = 0.25; }
  std::string PlaceOfHook(const char* method) const override {
    return "mine.cc:7, in " + std::string(method);
  }

  std::vector<std::string> names = {"chosen", "b"};
  std::string chosen = "a";
};

Scene TwoCubes() {
  SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
  double x = 1;
  for (const char* name : {"a", "b"}) {
    spec.objects.push_back({.name = name,
                            .shape = Shape::kBox,
                            .size = Vec3{0.02, 0.02, 0.02},
                            .rgba = Vec4{1, 0, 0, 1},
                            .mass = 0.1,
                            .friction = Vec3{1, 0.02, 0.001},
                            .pos = Vec3{x++, 0, 0.5}});
  }
  return Scene::Build(spec);
}

std::vector<std::string> NamesOf(const CellFeatures& features) {
  std::vector<std::string> names;
  for (const Feature& feature : features.observed().features())
    names.push_back(feature.column.name);
  return names;
}

// Returns the first number of a feature.
double First(CellFeatures& features, const std::string& name) {
  std::span<const double> rest = features.ReadState();
  for (const Feature& feature : features.observed().features()) {
    if (feature.column.name == name) return rest[0];
    rest = rest.subspan(static_cast<size_t>(feature.size()));
  }
  throw Error("no feature " + name);
}

TEST(TaskFeatures, HaveTheTasksObjectsAndSignals) {
  const Scene scene = TwoCubes();
  const auto task = std::make_shared<Watching>();
  CellFeatures features = FeaturesOfCell(scene, RobotsOf(scene), task, {});
  EXPECT_THAT(NamesOf(features), IsSupersetOf({"objects/chosen/pose", "objects/b/pose",
                                               "robots/rc7/arm/qpos", "task/height"}));
  EXPECT_EQ(First(features, "task/height"), 0.25);
  EXPECT_THAT(NamesOf(FeaturesOfCell(scene, RobotsOf(scene), nullptr, {})),
              Not(Contains("task/height")));
}

TEST(TaskFeatures, ANameFollowsTheObjectThatItStandsFor) {
  const Scene scene = TwoCubes();
  const auto task = std::make_shared<Watching>();
  CellFeatures features = FeaturesOfCell(scene, RobotsOf(scene), task, {});
  EXPECT_EQ(First(features, "objects/chosen/pose"), 1);
  task->chosen = "b";
  CellFeatures others = FeaturesOfCell(scene, RobotsOf(scene), task, {});
  EXPECT_EQ(First(others, "objects/chosen/pose"), 2);
}

TEST(TaskFeatures, NamesOfObjectsAreInTheScene) {
  const Scene scene = TwoCubes();
  Watching task;
  EXPECT_THAT(ObjectsOf(task, scene), ElementsAre("chosen", "b"));
  task.chosen = "aa";
  ExpectThrow<HookError>([&] { ObjectsOf(task, scene); }, "mine.cc:7, in objects");
  const auto lost = std::make_shared<Watching>(task);
  ExpectThrow<HookError>([&] { ObjectOfNameIn(lost)(scene, "chosen"); }, "mine.cc:7, in object_of");
  EXPECT_FALSE(ObjectOfNameIn(nullptr));
}

TEST(TaskFeatures, EachObjectIsNamedOnce) {
  Watching task;
  task.names = {"a", "b", "a"};
  ExpectThrow<HookError>([&] { ObjectsOf(task, TwoCubes()); },
                         "objects() names 'a' twice: a, b, a; name each object once");
}

}  // namespace
}  // namespace robocell
