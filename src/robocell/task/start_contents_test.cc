#include "robocell/task/start_contents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hook_error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

// Adds a cup or a jug, in turns, and a ball beside it.
class InTurns final : public Task {
 public:
  explicit InTurns(double radius = 0.02) : radius_(radius) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    kind_ = turn().Choose({"cup", "jug"});
    for (const char* name : {"vessel", "ball"}) {
      spec.objects.push_back({.name = name,
                              .shape = Shape::kSphere,
                              .size = Vec3{radius_, 0, 0},
                              .rgba = Vec4{1, 0, 0, 1},
                              .mass = 0.1,
                              .friction = Vec3{0.8, 0.02, 0.001}});
    }
  }
  std::string kind_of(const std::string& object) const override {
    return object == "vessel" ? kind_ : object;
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "pour"; }

 private:
  double radius_;
  std::string kind_;
};

const Task::KnownScene kNothingKnown = [] { return std::make_shared<const SceneAnnotations>(); };

StartContents Prepared(Task& task, int episode) {
  SceneSpec spec{.name = "lab"};
  spec.objects.push_back({.name = "table", .shape = Shape::kBox, .size = Vec3{1, 1, 0.1}});
  Rng rng = Rng::Stream(1, "contents");
  return PrepareContents(
      task, {.known = kNothingKnown, .kind = "pour", .turn = {.episode = episode}}, spec, rng);
}

TEST(StartContents, AreWhatTheTaskAddedWithTheKindsThatItNames) {
  InTurns task;
  const StartContents first = Prepared(task, 0), second = Prepared(task, 1);
  ASSERT_EQ(first.objects.size(), 2u) << "the table is not of the task";
  EXPECT_EQ(first.objects[0].name, "vessel");
  EXPECT_THAT((std::vector{first.kinds[0], second.kinds[0]}), UnorderedElementsAre("cup", "jug"));
  EXPECT_EQ(first.kinds[1], "ball");
}

TEST(StartContents, ObjectsThatNobodyCanHandleAreRejectedWithTheTask) {
  InTurns task(30);
  ExpectThrow<HookError>([&] { Prepared(task, 0); }, "task 'pour': prepare() added an object");
}

TEST(StartContents, ObjectsThatAreNotValidAreErrorsOfPrepare) {
  InTurns task;
  StartContents contents = Prepared(task, 0);
  ObjectSizes sizes;
  EXPECT_NO_THROW(RequireSound(contents, task, "pour", sizes));
  contents.objects[1].size.reset();
  ExpectThrow<HookError>([&] { RequireSound(contents, task, "pour", sizes); },
                         "task 'pour': prepare added object 'ball', which is not valid: size");
}

TEST(StartContents, OneOfEachKindIsNamedByIt) {
  InTurns task;
  const std::vector<SceneObject> objects = OneOfEachKind({Prepared(task, 0), Prepared(task, 1)});
  std::vector<std::string> names;
  for (const SceneObject& object : objects) names.push_back(object.name);
  EXPECT_THAT(names, UnorderedElementsAre("cup", "jug", "ball"));
}

TEST(StartContents, AKindThatCannotBeANameLeavesTheObjectItsOwn) {
  InTurns task;
  StartContents contents = Prepared(task, 0);
  contents.kinds = {"cup/blue", "ball"};
  std::vector<std::string> names;
  for (const SceneObject& object : OneOfEachKind({contents})) names.push_back(object.name);
  EXPECT_THAT(names, ElementsAre("vessel", "ball"));
}

TEST(StartContents, ObjectsThatAreAttachedKeepTheirNames) {
  InTurns task;
  StartContents contents = Prepared(task, 0);
  contents.objects[1].attach_to = Body("vessel");
  std::vector<std::string> names;
  for (const SceneObject& object : OneOfEachKind({contents})) names.push_back(object.name);
  EXPECT_THAT(names, ElementsAre("vessel", "ball"));
}

// Adds a model, at a known line.
class OfAModel final : public Task {
 public:
  explicit OfAModel(std::string model) : model_(std::move(model)) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    spec.objects.push_back({.name = "cup", .mjcf_path = model_});
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "drink"; }
  std::string PlaceOfHook(const char* method) const override {
    return "mine.cc:7, in " + std::string(method);
  }

 private:
  std::string model_;
};

TEST(StartContents, ErrorsOfModelsNameTheLineThatAddedThem) {
  const TempDir folder;
  const std::string broken = folder.path() / "broken.xml";
  AtomicWrite(broken, R"(<mujoco><worldbody><body><geom size="-1"/></body></worldbody></mujoco>)");
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  for (const std::string& model : {std::string("nowhere.xml"), broken}) {
    OfAModel task(model);
    ObjectSizes sizes;
    const StartContents contents = Prepared(task, 0);
    const std::string of_size = message([&] { RequireSound(contents, task, "drink", sizes); });
    EXPECT_THAT(of_size, HasSubstr("mine.cc:7, in prepare"));
    EXPECT_EQ(of_size.find("mine.cc"), of_size.rfind("mine.cc")) << of_size;
    SceneSpec spec{.name = "lab", .timestep = 0.002, .add_floor = false, .add_skybox = false};
    for (const SceneObject& object : contents.objects) spec.objects.push_back(object);
    EXPECT_THAT(message([&] { BuildPrepared(spec, 0, task); }),
                HasSubstr("mine.cc:7, in prepare: object 'cup'"));
    const std::string of_other = message([&] { BuildPrepared(spec, 1, task); });
    EXPECT_THAT(of_other, AllOf(HasSubstr("object 'cup'"), Not(HasSubstr("mine.cc"))));
  }
}

}  // namespace
}  // namespace robocell
