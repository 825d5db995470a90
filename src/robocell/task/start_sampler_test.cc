// Tests starts of a task that is not built in: two blocks on the table.
#include "robocell/task/start_sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hook_error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

struct BlocksConfig {
  int blocks = 2;
  bool placed = false;
  bool refuses = false;
  bool moves = false, moves_late = false;
  bool fixed = false, unfinished = false;
  bool falls = false, all_rest = false;

  static constexpr const char* kKind = "blocks_of_test";
  static constexpr const char* kTypeName = "BlocksConfig";
  template <class V>
  static void Fields(V&& v) {
    v("blocks", &BlocksConfig::blocks, "How many.", Bound::kNonNegative);
    v("placed", &BlocksConfig::placed, "Whether the last has a pose in the air.");
    v("refuses", &BlocksConfig::refuses, "Whether every start is refused.");
    v("moves", &BlocksConfig::moves, "Whether the first is put at a place of its own.");
    v("moves_late", &BlocksConfig::moves_late, "The same, once the robot stands.");
    v("fixed", &BlocksConfig::fixed, "Whether the last stays where it is.");
    v("unfinished", &BlocksConfig::unfinished, "Whether they have no size.");
    v("falls", &BlocksConfig::falls, "Whether the last falls from high above.");
    v("all_rest", &BlocksConfig::all_rest, "Whether the last has to lie still.");
  }
};

class Blocks final : public Task {
 public:
  static inline const Vec3 kFixedAt = {0.1, 0.25, 0.47}, kPlacedAt = {-0.1, 0.25, 0.4701};
  static inline const Vec3 kHighAbove = {2, 2, 60};  // longer than starts may settle
  static inline const Eigen::Vector3d kMovedTo = {-0.15, -0.3, 0.471};

  explicit Blocks(const BlocksConfig& fields) : fields_(fields) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    for (int i = 0; i < fields_.blocks; ++i) {
      SceneObject block = BoxObject("block_" + std::to_string(i), {0, 0, 0});
      block.size = Vec3{0.02, 0.02, 0.02};
      block.pos.reset();
      if (fields_.unfinished) block.size.reset();
      if (fields_.placed && i == fields_.blocks - 1) block.pos = kPlacedAt;
      if (fields_.falls && i == fields_.blocks - 1) block.pos = kHighAbove;
      if (fields_.fixed && i == fields_.blocks - 1) {
        block.fixed = true;
        block.pos = kFixedAt;
      }
      spec.objects.push_back(block);
    }
  }
  BodyPoses Starts(Rng& /*rng*/) override {
    if (!fields_.moves) return {};
    return {{"block_0", Pose(kMovedTo)}};
  }
  void Bind(const Scene& /*scene*/, const TaskSetting& setting) override { place = setting.place; }
  std::optional<Refusal> Arrange(Scene& scene, Rng& /*rng*/) override {
    if (fields_.moves_late) {
      scene.SetBodyPose("block_0", Pose(kMovedTo));
      scene.Forward();
    }
    if (!fields_.refuses) return {};
    return Refusal{.reason = "a reason of its own"};
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look at the blocks"; }
  std::vector<std::string> objects() const override {
    return fields_.blocks == 0 ? std::vector<std::string>() : std::vector<std::string>{"block_0"};
  }
  std::vector<std::string> resting_objects() const override {
    if (!fields_.all_rest) return {};
    return {"block_" + std::to_string(fields_.blocks - 1)};
  }
  BaseRange base_range() const override { return {.distance = {0.35, 0.4}, .height_offset = -0.2}; }

  std::string place;

 private:
  BlocksConfig fields_;
};

RunConfig BlocksRun(const BlocksConfig& fields = {}) {
  static const bool kRegistered = [] {
    RegisterTask<BlocksConfig>(std::make_shared<TaskKindOf<BlocksConfig, Blocks>>());
    return true;
  }();
  (void)kRegistered;
  RunConfig run = ExampleRun("demo.yaml");
  run.task = fields;
  run.start = {};  // the task's own range
  return run;
}

SampleResult FirstAccepted(TaskSampler& sampler, int episode) {
  SampleResult result;
  for (int attempt = 0; attempt < 20 && !result.start; ++attempt) {
    Rng rng = Rng::Stream(5, episode, attempt);
    result = sampler.Sample({.episode = episode, .attempt = attempt}, rng);
  }
  return result;
}

TEST(StartSampler, PlacesPreparedObjectsOnTheTableAndTheRobotNextToIt) {
  const RunConfig run = BlocksRun();
  const std::shared_ptr<TaskSampler> sampler = FindTaskKind(run.task.kind())->MakeSampler(run);
  const double top = FindSupport(MakeBaseScene(run, 0)).frame_to_world.translation().z();
  for (int episode = 0; episode < 3; ++episode) {
    const SampleResult result = FirstAccepted(*sampler, episode);
    ASSERT_TRUE(result.start.has_value()) << result.refusal.detail;
    const EpisodeStart& start = *result.start;
    EXPECT_EQ(start.target_object, "block_0");
    EXPECT_EQ(dynamic_cast<const Blocks&>(*start.task).place, "run 'demo'");
    const auto at = [&](const char* name) {
      return start.scene.body_pose(start.scene.compiled()->object(name).root_body).translation();
    };
    EXPECT_NEAR(at("block_0").z(), top + 0.02, 0.002) << "at rest on the table";
    EXPECT_GT((at("block_0") - at("block_1")).norm(), 0.04) << "beside each other";
    const double distance = (start.base_in_world.translation() - at("block_0")).head<2>().norm();
    EXPECT_GE(distance, 0.35 - 0.01);
    EXPECT_LE(distance, 0.40 + 0.01);
  }
}

// An environment puts them there too (PreparedObjects).
TEST(StartSampler, PlacesObjectsOnTheFloorWithoutATable) {
  const TempDir folder;
  AtomicWrite(folder / "floor.xml",
              "<mujoco><worldbody><geom type='plane' size='3 3 .1'/></worldbody></mujoco>");
  RunConfig run = BlocksRun();
  run.scenes = FilesScenes{.files = {(folder / "floor.xml").string()}};
  run.start.base_height_offset = 0;
  StartSampler sampler(run);
  for (int episode = 0; episode < 3; ++episode) {
    const SampleResult result = FirstAccepted(sampler, episode);
    ASSERT_TRUE(result.start.has_value()) << result.refusal.counted_as() << result.refusal.detail;
    for (const char* name : {"block_0", "block_1"})
      EXPECT_NEAR(result.start->scene.body_pose(name).translation().z(), 0.02, 0.002) << name;
  }
}

// A planar base stays on the floor, whatever the height that the task asks for, and at rest.
TEST(StartSampler, AMobileRobotStandsOnTheFloorBesideTheTable) {
  RunConfig run = BlocksRun();
  run.robot.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7_mobile"));
  run.start.base_distance = Vec2{0.45, 0.65};
  StartSampler sampler(run);
  for (int episode = 0; episode < 2; ++episode) {
    const SampleResult result = FirstAccepted(sampler, episode);
    ASSERT_TRUE(result.start.has_value()) << result.refusal.counted_as() << result.refusal.detail;
    const EpisodeStart& start = *result.start;
    EXPECT_NEAR(start.base_in_world.translation().z(), 0, 1e-9);
    const Pose block = start.scene.body_pose("block_0");
    EXPECT_NEAR((start.base_in_world.translation() - block.translation()).head<2>().norm(), 0.55,
                0.11);
    const Robot robot = Robot::Of(start.scene, run.robot.config.name);
    EXPECT_FALSE(ValidateBaseReach(robot, block).has_value());
    EXPECT_FALSE(ValidateBaseClearance(start.scene, robot, 0).has_value());
  }
}

TEST(StartSampler, AStartOwnsItsTask) {
  StartSampler sampler(BlocksRun());
  EXPECT_EQ(FirstAccepted(sampler, 0).start->task.use_count(), 1);
}

TEST(StartSampler, TheSameRequestGivesTheSameStart) {
  StartSampler first(BlocksRun()), second(BlocksRun());
  FirstAccepted(second, 4);  // earlier samples do not matter
  const SampleResult a = FirstAccepted(first, 1), b = FirstAccepted(second, 1);
  ASSERT_TRUE(a.start && b.start);
  EXPECT_EQ(a.start->scene.state(), b.start->scene.state());
}

TEST(StartSampler, EachStartHasItsOwnTask) {
  StartSampler sampler(BlocksRun());
  const SampleResult a = FirstAccepted(sampler, 0), b = FirstAccepted(sampler, 1);
  ASSERT_TRUE(a.start && b.start);
  EXPECT_NE(a.start->task, b.start->task);
}

TEST(StartSampler, ATaskCanRefuseWithItsReason) {
  StartSampler sampler(BlocksRun({.refuses = true}));
  Rng rng = Rng::Stream(5, "refused");
  const SampleResult result = sampler.Sample({}, rng);
  EXPECT_FALSE(result.start.has_value());
  EXPECT_TRUE(result.refusal.counted_as() == "task: a reason of its own" ||
              result.refusal.redrawn.contains("task: a reason of its own"));
}

TEST(StartSampler, TheStartOfARunOverridesTheRangeOfTheTask) {
  RunConfig run = BlocksRun();
  run.start.base_distance = {0.45, 0.5};
  StartSampler sampler(run);
  const SampleResult result = FirstAccepted(sampler, 0);
  ASSERT_TRUE(result.start) << result.refusal.detail;
  const Eigen::Vector3d target = result.start->scene.body_pose("block_0").translation();
  const double distance = (target - result.start->base_in_world.translation()).head<2>().norm();
  EXPECT_GE(distance, 0.45 - 0.01);
  EXPECT_LE(distance, 0.50 + 0.01);
}

TEST(StartSampler, RejectsAStartWhoseCameraMissesTheObject) {
  RunConfig run = BlocksRun();
  run.start.visible_from = {"exo_camera"};
  run.start.visible_share = 0.2;
  StartSampler sampler(run);
  EXPECT_TRUE(FirstAccepted(sampler, 0).start);
  // At its home the hand looks straight down beside its own base.
  run.start.visible_from = {"wrist_camera"};
  run.start.visible_share = 1;
  run.cameras.resolution = {16, 2};
  StartSampler blind(run);
  Rng rng = Rng::Stream(5, 0, 0);
  const SampleResult result = blind.Sample({}, rng);
  ASSERT_FALSE(result.start);
  EXPECT_TRUE(result.refusal.counted_as() == "cameras: camera constraint" ||
              result.refusal.redrawn.contains("cameras: camera constraint"))
      << result.refusal.counted_as();
}

// A camera that sees nothing refuses the layout of the objects, not the places of the base.
TEST(StartSampler, TheBaseAvoidsOnlyPlacesWhereItTouchedSomething) {
  RunConfig run = BlocksRun();
  run.start.visible_from = {"wrist_camera"};
  run.start.visible_share = 1;
  run.start.base_separation = 10;  // nowhere else
  run.cameras.resolution = {16, 2};
  StartSampler sampler(run);
  int unseen = 0;
  for (int attempt = 0; attempt < 3; ++attempt) {
    Rng rng = Rng::Stream(5, 0, attempt);
    const RefusalCounts refused = sampler.Sample({.attempt = attempt}, rng).redrawn();
    if (const auto it = refused.find("cameras: camera constraint"); it != refused.end())
      unseen += it->second;
  }
  EXPECT_GT(unseen, 6);  // with the first as the only one of each attempt: 3
}

// The object is where the task puts it when a camera looks.
TEST(StartSampler, CamerasLookAtATargetThatTheTaskMoved) {
  RunConfig run = BlocksRun({.moves_late = true});
  const auto& at = Blocks::kMovedTo;
  run.start.cameras["above"] = {.pos = Vec3{at.x(), at.y() - 0.01, at.z() + 0.2},
                                .look_at = Vec3{at.x(), at.y(), at.z()},
                                .fovy = 30,
                                .sees = {{"block_0", {.pixels = 1}}}};
  StartSampler sampler(run);
  bool is_accepted = false;
  for (int attempt = 0; attempt < 40 && !is_accepted; ++attempt) {
    Rng rng = Rng::Stream(5, 0, attempt);
    const SampleResult result = sampler.Sample({.attempt = attempt}, rng);
    EXPECT_FALSE(result.redrawn().contains("cameras: camera constraint")) << attempt;
    is_accepted = result.start.has_value();
  }
  EXPECT_TRUE(is_accepted);
}

// The base is placed around the object, no matter what placed the object.
TEST(StartSampler, TheBaseIsPlacedAroundAMovedTarget) {
  for (const bool late : {false, true}) {
    const RunConfig run = BlocksRun({.moves = !late, .moves_late = late});
    const std::shared_ptr<TaskSampler> sampler = FindTaskKind(run.task.kind())->MakeSampler(run);
    int accepted = 0;
    for (int episode = 0; episode < (late ? 20 : 3); ++episode) {
      const SampleResult result = FirstAccepted(*sampler, episode);
      if (!result.start) continue;
      ++accepted;
      const Eigen::Vector3d target = result.start->scene.body_pose("block_0").translation();
      EXPECT_LT((target - Blocks::kMovedTo).head<2>().norm(), 0.01);
      const double distance = (target - result.start->base_in_world.translation()).head<2>().norm();
      EXPECT_GE(distance, 0.35 - 0.01) << late;
      EXPECT_LE(distance, 0.40 + 0.01) << late;
    }
    if (!late) {
      EXPECT_EQ(accepted, 3);
    }
  }
}

TEST(StartSampler, FixedObjectsStayAndOthersAvoidThem) {
  const RunConfig run = BlocksRun({.fixed = true});
  const std::shared_ptr<TaskSampler> sampler = FindTaskKind(run.task.kind())->MakeSampler(run);
  for (int episode = 0; episode < 3; ++episode) {
    const SampleResult result = FirstAccepted(*sampler, episode);
    ASSERT_TRUE(result.start) << result.refusal.reason << ": " << result.refusal.detail;
    const Eigen::Vector3d fixed = result.start->scene.body_pose("block_1").translation();
    EXPECT_TRUE(fixed.isApprox(ToEigen(Blocks::kFixedAt), 1e-9));
    const Eigen::Vector3d free = result.start->scene.body_pose("block_0").translation();
    EXPECT_GT((free - fixed).head<2>().norm(), 0.05);
  }
}

TEST(StartSampler, ObjectsWithAPoseStayAndOthersAvoidThem) {
  StartSampler sampler(BlocksRun({.placed = true}));
  for (int episode = 0; episode < 3; ++episode) {
    const SampleResult result = FirstAccepted(sampler, episode);
    ASSERT_TRUE(result.start) << result.refusal.reason << ": " << result.refusal.detail;
    const Eigen::Vector3d placed = result.start->scene.body_pose("block_1").translation();
    EXPECT_LT((placed - ToEigen(Blocks::kPlacedAt)).norm(), 0.002);
    const Eigen::Vector3d other = result.start->scene.body_pose("block_0").translation();
    EXPECT_GT((other - placed).head<2>().norm(), 0.05);
  }
}

TEST(StartSampler, RequiresRestOfTheObjectsThatTheTaskNames) {
  StartSampler sampler(BlocksRun({.falls = true}));
  const SampleResult moving = FirstAccepted(sampler, 0);
  ASSERT_TRUE(moving.start) << moving.refusal.reason << ": " << moving.refusal.detail;
  EXPECT_LT(moving.start->scene.body_pose("block_1").translation().z(), 59.9);

  StartSampler strict(BlocksRun({.falls = true, .all_rest = true}));
  const SampleResult refused = FirstAccepted(strict, 0);
  ASSERT_FALSE(refused.start);
  EXPECT_EQ(refused.refusal.counted_as(), "settling: objects did not come to rest");
  EXPECT_EQ(refused.refusal.detail, "block_1 still moves");
}

// The sources of scenes know more than geometry says.
class Annotated final : public SceneSource {
 public:
  struct Config {
    static constexpr const char* kKind = "annotated_of_test";
    static constexpr const char* kTypeName = "Config";
    bool sound = true;
    template <class V>
    static void Fields(V&& v) {
      v("sound", &Config::sound, "Whether its numbers can be.");
    }
  };
  explicit Annotated(const Config& fields) : fields_(fields) {}
  std::optional<int> size() const override { return 1; }
  SceneSpec Make(int /*index*/) override {
    return {.base = "tabletop", .add_floor = true, .add_skybox = true};
  }

 protected:
  std::optional<SceneAnnotations> KnownAnnotations(int /*index*/) override {
    SceneAnnotations known;
    known.rooms.push_back({.name = "kitchen", .floor_height = fields_.sound ? 0.5 : NAN});
    return known;
  }

 private:
  Config fields_;
};

// Adds a block for each room, and one for the first support.
class InRooms final : public Task {
 public:
  struct Config {
    static constexpr const char* kKind = "in_rooms_of_test";
    static constexpr const char* kTypeName = "Config";
    template <class V>
    static void Fields(V&& /*v*/) {}
  };
  explicit InRooms(const Config& /*fields*/) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    std::vector<std::string> names;
    for (const Room& room : annotations().rooms) names.push_back("in_" + room.name);
    if (!annotations().supports.empty())
      names.push_back("on_" + annotations().supports.front().body);
    for (const std::string& name : names) {
      SceneObject block = BoxObject(name, {0, 0, 0});
      block.pos.reset();
      spec.objects.push_back(block);
    }
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look"; }
};

TEST(StartSampler, ATaskPreparesFromSceneAnnotations) {
  RegisterSceneSource<Annotated::Config>(
      std::make_shared<SceneSourceKindOf<Annotated::Config, Annotated>>());
  RegisterTask<InRooms::Config>(std::make_shared<TaskKindOf<InRooms::Config, InRooms>>());
  RunConfig run = ExampleRun("demo.yaml");
  run.task = InRooms::Config();
  const auto contents = [](const RunConfig& of) {
    StartSampler sampler(of);
    const std::vector<StartContents> possible =
        FindTaskKind(of.task.kind())->PossibleContents(of, 0, {}, [&] {
          return sampler.AnnotationsOf(0);
        });
    std::vector<std::string> names;
    for (const SceneObject& object : possible.front().objects) names.push_back(object.name);
    return names;
  };
  EXPECT_THAT(contents(run), ::testing::ElementsAre("on_table")) << "by its geometry";
  run.scenes = Annotated::Config();
  EXPECT_THAT(contents(run), ::testing::ElementsAre("in_kitchen")) << "by its source";
  run.scenes = Annotated::Config{.sound = false};
  ExpectThrow<HookError>([&] { contents(run); }, "annotations of scene 0");
  InRooms alone({});
  SceneSpec spec;
  Rng rng = Rng::Stream(1, "contents");
  ExpectThrow<Error>([&] { alone.Prepare(spec, rng); }, "in prepare() first");
}

TEST(StartSampler, PreparedObjectsAreValidatedBeforeMeasuring) {
  const RunConfig run = BlocksRun({.unfinished = true});
  const std::shared_ptr<TaskSampler> sampler = FindTaskKind(run.task.kind())->MakeSampler(run);
  Rng rng = Rng::Stream(5, "unfinished");
  ExpectThrow<HookError>([&] { sampler->Sample({}, rng); },
                         "task 'blocks_of_test': prepare added object 'block_0', which is not "
                         "valid: size");
}

TEST(StartSampler, WithoutObjectsTheRobotFacesTheCentreOfTheSupport) {
  RunConfig run = BlocksRun({.blocks = 0});
  run.start.visible_from = {"nobody_looks"};
  StartSampler sampler(run);
  const Support support = FindSupport(MakeBaseScene(run, 0));
  for (int episode = 0; episode < 3; ++episode) {
    const SampleResult result = FirstAccepted(sampler, episode);
    ASSERT_TRUE(result.start.has_value()) << result.refusal.detail;
    EXPECT_EQ(result.start->target_object, "");
    EXPECT_EQ(result.object_kind(), "");
    const Eigen::Vector3d displacement =
        result.start->base_in_world.translation() - support.frame_to_world.translation();
    EXPECT_GE(displacement.head<2>().norm(), 0.35 - 1e-6);
    EXPECT_LE(displacement.head<2>().norm(), 0.40 + 1e-6);
    EXPECT_NEAR(displacement.z(), -0.2, 1e-6);
  }
}

}  // namespace
}  // namespace robocell
