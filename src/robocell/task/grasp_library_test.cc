#include "robocell/task/grasp_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

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

std::string ErrorOf(const fs::path& path) {
  try {
    LoadGrasps(path);
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
  const std::vector<Grasp> read = LoadGrasps(folder / "new/folder/grasps.npz");
  ASSERT_EQ(read.size(), grasps.size());
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
  const auto with = [&](std::vector<double> numbers, std::vector<size_t> shape = {1, 4, 4}) {
    WriteNpz(path, {{"transforms", NpzArray::Numbers(std::move(shape), std::move(numbers))}});
    return ErrorOf(path);
  };
  EXPECT_EQ(with(Identity()), "");
  WriteNpz(path, {{"poses", NpzArray::Numbers({1}, {1})}});
  EXPECT_THAT(ErrorOf(path), HasSubstr("has no array 'transforms'"));
  EXPECT_THAT(ErrorOf(path), HasSubstr("Its arrays: poses"));
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
  EXPECT_THAT(ErrorOf(path), HasSubstr("Did you mean 'rim'?"));
  AtomicWrite(path, "no zip");
  EXPECT_THAT(ErrorOf(path), HasSubstr("no .npz file"));
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
  EXPECT_EQ(LoadGrasps(file).size(), made.grasps.size());
  GraspOptions other = options;
  other.seed = 1;
  EXPECT_NE(GraspKey(robot, "thing", other), GraspKey(robot, "thing", options));
  SceneObject larger = object;
  (*larger.size)[0] += 1e-4;
  const Scene next = HandBeside(hand, larger);
  EXPECT_NE(GraspKey(Robot::Of(next, "hand"), "thing", options), GraspKey(robot, "thing", options));
}

}  // namespace
}  // namespace robocell
