#include "robocell/task/grasp_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/npz.h"
#include "robocell/task/testing/random_hands.h"
#include "robocell/testing/random_values.h"
#include "robocell/testing/scoped_env.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using internal::NpzArray;
using internal::WriteNpz;
using testing::HasSubstr;

std::vector<double> Identity() { return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }

// A random hand beside a random object.
struct HandScene {
  explicit HandScene(const std::string& name)
      : rng(Rng::Stream(4, "library", name)),
        object(RandomPrimitive(rng)),
        scene(HandBeside(WriteRandomHand(rng, folder), object)),
        robot(Robot::Of(scene, "hand")) {}

  TempDir folder;
  Rng rng;
  SceneObject object;
  Scene scene;
  Robot robot;
};

std::string ErrorOf(const Robot& robot, const fs::path& path) {
  try {
    LoadGrasps(path, robot, "thing");
  } catch (const IoError& error) {
    return error.what();
  }
  return "";
}

TEST(GraspLibrary, ReadsTheGraspsThatItWrote) {
  const TempDir folder;
  Rng rng = Rng::Stream(3, "library");
  std::vector<Grasp> grasps;
  for (const auto& [kind, name] : kGraspKinds) {
    grasps.push_back({.tcp_in_body = RandomPose(rng),
                      .kind = kind,
                      .opening = rng.Uniform(),
                      .width = rng.Uniform(),
                      .aside = rng.Uniform(),
                      .approach = RandomDirection(rng),
                      .approach_length = rng.Uniform(),
                      .score = rng.Uniform()});
  }
  SaveGrasps(folder / "new/folder/grasps.npz", grasps);
  const HandScene hand("written");
  const GraspSet set = LoadGrasps(folder / "new/folder/grasps.npz", hand.robot, "thing");
  EXPECT_EQ(set.robot, "hand");
  EXPECT_EQ(set.body, hand.scene.compiled()->object("thing").root_body);
  const std::vector<Grasp>& read = set.grasps;
  ASSERT_EQ(read.size(), grasps.size());
  std::ranges::stable_sort(grasps, std::ranges::greater(), &Grasp::score);
  for (size_t i = 0; i < read.size(); ++i) {
    EXPECT_TRUE(read[i].tcp_in_body.is_close(grasps[i].tcp_in_body, 1e-9, 1e-12));
    EXPECT_EQ(read[i].kind, grasps[i].kind);
    EXPECT_EQ(read[i].opening, grasps[i].opening);
    EXPECT_EQ(read[i].width, grasps[i].width);
    EXPECT_LT((read[i].approach - grasps[i].approach).norm(), 1e-12);
    EXPECT_EQ(read[i].score, grasps[i].score);
  }
}

TEST(GraspLibrary, BadFilesGetErrorsThatNameTheRow) {
  const TempDir folder;
  const fs::path path = folder / "g.npz";
  const HandScene hand("bad");
  const Robot& robot = hand.robot;
  const auto with = [&](std::vector<double> numbers, std::vector<size_t> shape = {1, 4, 4}) {
    WriteNpz(path, {{"transforms", NpzArray::Numbers(std::move(shape), std::move(numbers))}});
    return ErrorOf(robot, path);
  };
  EXPECT_EQ(with(Identity()), "");
  WriteNpz(path, {{"poses", NpzArray::Numbers({1}, {1})}});
  EXPECT_THAT(ErrorOf(robot, path), HasSubstr("has no array 'transforms'"));
  EXPECT_THAT(ErrorOf(robot, path), HasSubstr("Its arrays: poses"));
  EXPECT_THAT(with(Identity(), {4, 4}), HasSubstr("must be (N, 4, 4) numbers, got (4, 4)"));
  std::vector<double> bad = Identity();
  bad[0] = 2;
  EXPECT_THAT(with(bad), HasSubstr("transforms[0] is not a rigid transform"));
  bad[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(with(bad), HasSubstr("transforms[0] has numbers that are not finite"));
  bad = Identity();
  bad[12] = 1;
  EXPECT_THAT(with(bad), HasSubstr("its last row is not 0 0 0 1"));
  WriteNpz(path, {{"transforms", NpzArray::Numbers({1, 4, 4}, Identity())},
                  {"kinds", NpzArray::Texts({"rimm"})}});
  EXPECT_THAT(ErrorOf(robot, path), HasSubstr("Did you mean 'rim'?"));
  AtomicWrite(path, "no zip");
  EXPECT_THAT(ErrorOf(robot, path), HasSubstr("no .npz file"));
}

TEST(GraspLibrary, ARegisteredFileComesBeforeGeneratedGrasps) {
  const TempDir folder;
  Rng rng = Rng::Stream(4, "registered");
  const std::string hand = WriteRandomHand(rng, folder);
  const Scene scene = HandBeside(hand, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  fs::create_directories(folder / "library/thing/hand");
  WriteNpz(folder / "library/thing/hand/grasps.npz",
           {{"transforms", NpzArray::Numbers({1, 4, 4}, Identity())}});
  RegisterGraspLibrary("mine", folder / "library");
  EXPECT_THAT(GraspLibraryNames(), testing::Contains("mine"));
  const GraspSet set = GraspsOf(robot, "thing");
  ASSERT_EQ(set.grasps.size(), 1u);
  EXPECT_EQ(set.body, scene.compiled()->object("thing").root_body);
  EXPECT_GT(set.grasps[0].opening, 0) << "the hand opens fully";
  EXPECT_NEAR(set.grasps[0].approach.norm(), 1, 1e-9);
  UnregisterGraspLibrary("mine");
  EXPECT_THROW(UnregisterGraspLibrary("mine"), NotFoundError);
  EXPECT_THROW(RegisterGraspLibrary("mine", folder / "nothing"), NotFoundError);
}

TEST(GraspLibrary, GeneratedGraspsAreStoredOnceForEachGeometry) {
  const TempDir folder;
  const ScopedEnv cache("ROBOCELL_CACHE_DIR", folder.path().string());
  Rng rng = Rng::Stream(9, "stored");
  const std::string hand = WriteRandomHand(rng, folder);
  const SceneObject object = RandomPrimitive(rng);
  const GraspOptions options{.samples = 60, .most = 5};
  const Scene scene = HandBeside(hand, object);
  const Robot robot = Robot::Of(scene, "hand");
  const GraspSet made = GraspsOf(robot, "thing", options);
  const fs::path file = GraspCacheFolder() / (GraspKey(robot, "thing", options) + ".npz");
  ASSERT_TRUE(fs::exists(file));
  EXPECT_EQ(LoadGrasps(file, robot, "thing").grasps.size(), made.grasps.size());
  GraspOptions other = options;
  other.seed = 1;
  EXPECT_NE(GraspKey(robot, "thing", other), GraspKey(robot, "thing", options));
  SceneObject larger = object;
  (*larger.size)[0] += 1e-4;
  const Scene next = HandBeside(hand, larger);
  EXPECT_NE(GraspKey(Robot::Of(next, "hand"), "thing", options), GraspKey(robot, "thing", options));
}

// The memory of the process has no grasps for these options, so that the file must have been read.
TEST(GraspLibrary, TheCacheIsReadAndADamagedFileIsReplaced) {
  const TempDir folder;
  const ScopedEnv cache("ROBOCELL_CACHE_DIR", folder.path().string());
  const HandScene hand("cache");
  GraspOptions options{.samples = 60, .most = 5, .seed = 17};
  const auto file = [&] {
    return GraspCacheFolder() / (GraspKey(hand.robot, "thing", options) + ".npz");
  };
  SaveGrasps(file(), {{.opening = 0.0123}});
  const GraspSet read = GraspsOf(hand.robot, "thing", options);
  ASSERT_EQ(read.grasps.size(), 1u);
  EXPECT_EQ(read.grasps[0].opening, 0.0123);
  options.seed = 18;
  AtomicWrite(file(), "no zip");
  const GraspSet made = GraspsOf(hand.robot, "thing", options);
  EXPECT_GT(made.grasps.size(), 1u);
  EXPECT_EQ(LoadGrasps(file(), hand.robot, "thing").grasps.size(), made.grasps.size());
}

// The tutorial's files have poses only.
TEST(GraspLibrary, FilesWithoutKindsGetThoseOfHandAndDirection) {
  const HandScene hand("kinds");
  const auto shape =
      GripperShape::Of(hand.robot.config(), hand.scene.spec().options, hand.scene.timestep());
  // The hand comes from above, then from the side.
  const std::vector<Eigen::Vector3d> ways = {{0, 0, -1}, {1, 0, 0}};
  std::vector<double> numbers;
  for (const Eigen::Vector3d& way : ways) {
    // Turns the approach of the hand into the way: half a turn about the middle of both.
    const Eigen::Vector3d approach = shape->grasp_in_tcp().rotation().col(2);
    const Eigen::Vector3d middle =
        (approach + way).norm() > 1e-6 ? (approach + way).normalized() : approach.unitOrthogonal();
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> x =
        Pose(Eigen::Vector3d(0, 0, 0.1), Quaternion{middle.x(), middle.y(), middle.z(), 0})
            .matrix();
    numbers.insert(numbers.end(), x.data(), x.data() + 16);
  }
  const fs::path file = hand.folder / "library/thing/grasps.npz";
  fs::create_directories(file.parent_path());
  WriteNpz(file, {{"transforms", NpzArray::Numbers({2, 4, 4}, numbers)}});
  const std::vector<Grasp> read = LoadGrasps(file, hand.robot, "thing").grasps;
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].kind, GraspKind::kTop);
  EXPECT_EQ(read[1].kind, GraspKind::kSide);
  for (size_t i = 0; i < 2; ++i) EXPECT_LT((read[i].approach - ways[i]).norm(), 1e-9);

  RegisterGraspLibrary("kinds", hand.folder / "library");
  const auto of = [&](std::vector<GraspKind> kinds) {
    return GraspsOf(hand.robot, "thing", {.kinds = std::move(kinds), .samples = 100, .most = 5},
                    false)
        .grasps;
  };
  EXPECT_EQ(of({GraspKind::kSide}).size(), 1u);
  EXPECT_EQ(of({}).size(), 2u);
  // The file has no oblique grasps: they are generated.
  const std::vector<Grasp> generated = of({GraspKind::kAntipodal});
  EXPECT_FALSE(generated.empty());
  for (const Grasp& grasp : generated) EXPECT_EQ(grasp.kind, GraspKind::kAntipodal);
  // Pushes are read for those who ask for them only.
  std::vector<Grasp> pushes = read;
  for (Grasp& grasp : pushes) grasp.kind = GraspKind::kPush;
  pushes.push_back(read[0]);
  SaveGrasps(file, pushes);
  EXPECT_EQ(of({}).size(), 1u);
  EXPECT_EQ(of({GraspKind::kPush}).size(), 2u);
  UnregisterGraspLibrary("kinds");
}

// Names of objects' models lead to folders of the library only.
TEST(GraspLibrary, NoFileOutsideOfTheFolderIsRead) {
  Rng rng = Rng::Stream(13, "outside");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  fs::create_directories(folder / "library/inside");
  fs::create_directories(folder / "models/inner");
  AtomicWrite(folder / "models/part.xml", R"(<mujoco><worldbody><body name="part"><freejoint/>
    <geom type="box" size=".012 .012 .03" mass=".05"/></body></worldbody></mujoco>)");
  WriteNpz(folder / "grasps.npz", {{"transforms", NpzArray::Numbers({1, 4, 4}, Identity())}});
  SceneObject object{.name = "thing", .pos = Vec3{0.6, 0, 0.3}};
  object.mjcf_path = (folder / "models/inner").string() + "/../part.xml";
  const Scene scene = HandBeside(hand, object);
  RegisterGraspLibrary("outside", folder / "library");
  const GraspSet set =
      GraspsOf(Robot::Of(scene, "hand"), "thing", {.samples = 100, .most = 5}, false);
  UnregisterGraspLibrary("outside");
  EXPECT_GT(set.grasps.size(), 1u) << "grasps.npz beside the library was read";
}

}  // namespace
}  // namespace robocell
