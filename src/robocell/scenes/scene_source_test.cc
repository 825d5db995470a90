#include "robocell/scenes/scene_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A kind of this test's own: a shelf of boards, with annotations.
struct ShelfConfig {
  int boards = 2;
  static constexpr const char* kKind = "shelf_of_test";
  static constexpr const char* kTypeName = "ShelfConfig";
  template <class V>
  static void Fields(V&& v) {
    v("boards", &ShelfConfig::boards, "How many boards there are.", Bound::kPositive);
  }
};

class Shelf final : public SceneSource {
 public:
  explicit Shelf(const ShelfConfig& fields) : boards_(fields.boards) {}
  std::optional<int> size() const override { return 3; }
  SceneSpec Make(int index) override {
    SceneSpec spec{.name = "a name of its own", .add_floor = true, .add_skybox = false};
    for (int i = 0; i < boards_; ++i) {
      SceneObject board{.name = "board" + std::to_string(i),
                        .shape = Shape::kBox,
                        .size = Vec3{0.3, 0.4, 0.01},
                        .rgba = Vec4{0.6, 0.5, 0.4, 1},
                        .mass = 1,
                        .friction = Vec3{1, 0.02, 0.001}};
      board.pos = {0.1 * index, 0, 0.4 * (i + 1)};
      board.fixed = true;
      spec.objects.push_back(board);
    }
    return spec;
  }
  std::optional<SceneAnnotations> KnownAnnotations(int index) override {
    if (index == 2) return std::nullopt;
    SceneAnnotations known;
    known.supports.push_back({.face = {Pose({0.1 * index, 0, 0.41}), 0.3, 0.4, 0.02},
                              .body = "board0",
                              .free_area = 0.48});
    return known;
  }

 private:
  int boards_;
};

RunConfig ShelfRun(const ShelfConfig& fields = {}) {
  static const bool kRegistered = [] {
    RegisterSceneSource<ShelfConfig>(std::make_shared<SceneSourceKindOf<ShelfConfig, Shelf>>());
    return true;
  }();
  (void)kRegistered;
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = fields;
  return run;
}

TEST(SceneSource, ACustomSourceGetsTheSettingsOfTheRun) {
  const RunConfig run = ShelfRun({.boards = 3});
  EXPECT_EQ(run.scenes.kind(), "shelf_of_test");
  EXPECT_THAT(SceneIndices(run), ElementsAre(0, 1, 2));
  const SceneSpec spec = MakeBaseScene(run, 1);
  EXPECT_EQ(spec.objects.size(), 3u);
  EXPECT_EQ(spec.name, "demo");
  EXPECT_EQ(spec.timestep, 0.002);
  const RunConfig back = ParseYaml<RunConfig>(ToYaml(run), "run.yaml", "");
  EXPECT_EQ(back.scenes, run.scenes);
}

TEST(SceneSource, RejectsMissingHouses) {
  RunConfig run = ShelfRun();
  run.scenes.houses.values = {0, 3};
  Problems problems;
  ValidateHouses(run, problems);
  ASSERT_EQ(problems.list().size(), 1u);
  EXPECT_THAT(problems.list()[0].message,
              HasSubstr("3 is outside the 3 scenes of source 'shelf_of_test'"));
}

TEST(SceneSource, AnnotationsOverrideTheGeometry) {
  const RunConfig run = ShelfRun();
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  const std::vector<Support> known = SupportsOf(*source, 1, MakeBaseScene(run, 1));
  ASSERT_EQ(known.size(), 1u);
  EXPECT_NEAR(known[0].frame_to_world.translation().z(), 0.41, 1e-9);
  // It has no annotations of the last scene: the upper board has free space above it.
  EXPECT_NEAR(SupportsOf(*source, 2, MakeBaseScene(run, 2))[0].frame_to_world.translation().z(),
              0.41, 1e-9);
  EXPECT_EQ(source->Annotations(2).supports.size(), 2u);
  EXPECT_EQ(source->Annotations(2).objects.size(), 2u);
}

// Has any number of scenes, and annotations and scenes that its test chooses.
struct OddConfig {
  int count = 1;
  std::string file = "list.txt";
  static constexpr const char* kKind = "odd_of_test";
  static constexpr const char* kTypeName = "OddConfig";
  template <class V>
  static void Fields(V&& v) {
    v("count", &OddConfig::count, "What size() says.");
    v("file", &OddConfig::file, "A file of its own.");
  }
};

class Odd final : public SceneSource {
 public:
  Odd(const OddConfig& fields, const std::string& directory) : fields_(fields) {
    last_directory = directory;
    number_ = made++;
  }
  std::optional<int> size() const override { return fields_.count; }
  SceneSpec Make(int /*index*/) override {
    SceneSpec spec{.base = "tabletop", .add_floor = true};
    if (calls_change_it) spec.objects.push_back({.name = "cube" + std::to_string(calls_++)});
    if (making_changes_it) spec.objects.push_back({.name = "cube" + std::to_string(number_)});
    return spec;
  }
  std::optional<SceneAnnotations> KnownAnnotations(int /*index*/) override { return known; }

  static inline SceneAnnotations known;
  static inline std::string last_directory;
  static inline bool calls_change_it = false, making_changes_it = false;
  static inline int made = 0;

 private:
  OddConfig fields_;
  int calls_ = 0, number_ = 0;
};

RunConfig OddRun(const OddConfig& fields = {}) {
  static const bool kRegistered = [] {
    RegisterSceneSource<OddConfig>(std::make_shared<SceneSourceKindOf<OddConfig, Odd>>());
    return true;
  }();
  (void)kRegistered;
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = fields;
  return run;
}

TEST(SceneSource, ReportsInvalidSizes) {
  const auto problem = [](const RunConfig& run) {
    Problems problems;
    ValidateHouses(run, problems);
    return problems.list().empty() ? "" : problems.list()[0].message;
  };
  const std::string negative = "source 'odd_of_test' says that it has -3 scenes";
  EXPECT_THAT(problem(OddRun({.count = -3})), HasSubstr(negative));
  ExpectThrow<SpecError>([] { SceneIndices(OddRun({.count = -3})); }, negative);
  ExpectThrow<SpecError>([] { SceneIndices(OddRun({.count = 0})); }, "has no scenes");
  RunConfig run = OddRun({.count = 1'000'000'000});
  const std::string many = "has 1000000000 scenes, and a run takes 1000000 at most; name those";
  EXPECT_THAT(problem(run), HasSubstr(many));
  ExpectThrow<SpecError>([&] { SceneIndices(run); }, many);
  run.scenes.houses.values = {7, 999'999'999};
  EXPECT_EQ(problem(run), "");
  EXPECT_THAT(SceneIndices(run), ElementsAre(7, 999'999'999));
}

TEST(SceneSource, RejectsNonFiniteAnnotations) {
  const std::shared_ptr<SceneSource> source = MakeSceneSource(OddRun());
  const std::string expected = "annotations of scene 4: supports[0].face.half_x is -1";
  Odd::known = {.supports = {{.face = {Pose(), -1, 0.4, 0.02}}}};
  ExpectThrow<ArgumentError>([&] { source->CheckedAnnotations(4); }, expected);
  ExpectThrow<ArgumentError>([&] { source->Annotations(4); }, expected);
  ExpectThrow<ArgumentError>([&] { SupportsOf(*source, 4, {}); }, expected);
  Odd::known = {.supports = {{.face = {Pose(), 0.3, 0.4, 0.02}}}};
  EXPECT_EQ(source->Annotations(4).supports.size(), 1u);
}

TEST(SceneSource, GetsTheFolderOfItsPaths) {
  RunConfig run = OddRun();
  run.source_dir = "/somewhere/runs";
  MakeSceneSource(run);
  EXPECT_EQ(Odd::last_directory, "/somewhere/runs");
}

TEST(SceneSource, RejectsAnInconsistentSource) {
  const RunConfig run = OddRun();
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  const auto ask = [&] { RequireSameAgain(run, *source, 0, MakeBaseScene(run, *source, 0)); };
  EXPECT_NO_THROW(ask());
  Odd::making_changes_it = true;
  ExpectThrow<SpecError>(ask, "source 'odd_of_test' gave another scene 0 when it was made again");
  Odd::making_changes_it = false;
  Odd::calls_change_it = true;
  ExpectThrow<SpecError>(ask, "gave another scene 0 when it was asked again; a scene must follow");
  Odd::calls_change_it = false;
}

TEST(SceneSource, RequiresFieldsAndAFactory) {
  ExpectThrow<ArgumentError>(
      [] {
        RegisterSceneSource("bare_of_test", nullptr,
                            std::make_shared<SceneSourceKindOf<ShelfConfig, Shelf>>());
      },
      "scene source 'bare_of_test' is registered without its fields");
  ExpectThrow<ArgumentError>(
      [] {
        RegisterSceneSource("bare_of_test", std::make_shared<KindFieldsOf<ShelfConfig>>(), nullptr);
      },
      "scene source 'bare_of_test' needs a SceneSourceKind");
  ExpectThrow<NotFoundError>([] { FindSceneSourceKind("bare_of_test"); }, "bare_of_test");
}

TEST(SceneSource, RejectsDuplicateAndUnknownNames) {
  ShelfRun();
  ExpectThrow<ArgumentError>(
      [] {
        RegisterSceneSource<ShelfConfig>(std::make_shared<SceneSourceKindOf<ShelfConfig, Shelf>>());
      },
      "scene source 'shelf_of_test' is registered already");
  ExpectThrow<NotFoundError>([] { FindSceneSourceKind("shelf_of_tset"); },
                             "Did you mean 'shelf_of_test'?");
}

}  // namespace
}  // namespace robocell
