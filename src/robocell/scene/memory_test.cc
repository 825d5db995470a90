// Tests that memory stays flat: scenes that were built and released, and resets, leave nothing
// behind.
//
// The measured value is the memory that malloc has handed out, after warm-ups that fill the
// engine's asset cache and the like. Sanitizers use an allocator of their own without this figure;
// there the loops are short, and the leak detector judges. The long form
// has more builds.
#include <malloc.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"

namespace robocell {
namespace {

constexpr double kMostBytes = 1000;  // may stay after each build or reset

size_t BytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Returns the bytes that each run of `work` leaves, after as many warm-ups.
double BytesLeft(int times, const std::function<void()>& work) {
  const bool counts = BytesInUse() > 0;
  if (!counts) times = std::max(times / 100, 2);
  for (int i = 0; i < std::min(times, 100); ++i) work();
  const size_t before = BytesInUse();
  for (int i = 0; i < times; ++i) work();
  return (static_cast<double>(BytesInUse()) - static_cast<double>(before)) / times;
}

SceneSpec Primitives() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")),
       .base = BaseConfig{.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.3}}});
  for (int i = 0; i < 4; ++i)
    spec.objects.push_back(BoxObject("cube" + std::to_string(i), {0.5, 0.06 * i, 0.02}));
  return spec;
}

SceneSpec Meshes() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = menagerie::ModelPath("ufactory_xarm7")});
  spec.objects.push_back(
      {.name = "mug", .mjcf_path = "mug", .pos = Vec3{0.5, 0, 0}, .fixed = false});
  return spec;
}

// The measurement detects a loop that leaks.
TEST(Memory, TheMeasurementDetectsALeakOfAKilobyte) {
  if (BytesInUse() == 0) return;  // the leak detector would see it too, and fail
  std::vector<std::unique_ptr<char[]>> kept;
  kept.reserve(2000);
  EXPECT_GT(BytesLeft(1000, [&] { kept.push_back(std::make_unique<char[]>(1024)); }), kMostBytes);
}

TEST(Memory, BuildsOfPrimitivesLeakNothing) {
  const SceneSpec spec = Primitives();
  EXPECT_LT(
      BytesLeft(LongForm() ? 1000 : 100, [&] { EXPECT_TRUE(Scene::Build(spec).Step().ok()); }),
      kMostBytes);
}

TEST(Memory, BuildsWithMeshesLeakNothing) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const SceneSpec spec = Meshes();
  EXPECT_LT(BytesLeft(LongForm() ? 100 : 20, [&] { EXPECT_TRUE(Scene::Build(spec).Step().ok()); }),
            kMostBytes);
}

TEST(Memory, ResetsLeakNothing) {
  Scene scene = Scene::Build(Primitives());
  uint64_t seed = 0;
  EXPECT_LT(BytesLeft(LongForm() ? 10'000 : 1000,
                      [&] {
                        scene.Reset({.seed = ++seed});
                        EXPECT_TRUE(scene.StepN(2).ok());
                      }),
            kMostBytes);
}

TEST(Memory, AddedAndRemovedObjectsLeakNothing) {
  Scene scene = Scene::Build(Primitives());
  const SceneObject mug{
      .name = "mug", .mjcf_path = "mug", .pos = Vec3{0.5, 0.5, 0}, .fixed = false};
  EXPECT_LT(BytesLeft(LongForm() ? 100 : 20,
                      [&] {
                        scene.AddObject(mug);
                        EXPECT_TRUE(scene.Step().ok());
                        scene.RemoveObject("mug");
                      }),
            kMostBytes);
}

TEST(Memory, PoolSwapsLeakNothing) {
  SceneSpec spec = Primitives();
  spec.objects[0].parked = true;
  Scene scene = Scene::Build(spec);
  EXPECT_LT(BytesLeft(1000,
                      [&] {
                        scene.AddObject("cube0");
                        EXPECT_TRUE(scene.Step().ok());
                        scene.RemoveObject("cube0");
                      }),
            kMostBytes / 100);
}

}  // namespace
}  // namespace robocell
