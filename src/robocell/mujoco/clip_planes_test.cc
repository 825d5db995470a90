#include "robocell/mujoco/clip_planes.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

TEST(ClipPlanes, OfASpecArePlanesOfItsModelInMetres) {
  const SpecPtr spec = MakeSpec();
  SetClipPlanes(spec.get(), 2, 0.02, 40);
  const ModelPtr model = Compile(spec.get());
  const ClipPlanes planes = GetClipPlanes(model.get());
  EXPECT_NEAR(planes.near_m, 0.02, 1e-6);
  EXPECT_NEAR(planes.far_m, 40, 1e-3);
  // The engine stores them as multiples of the extent.
  EXPECT_DOUBLE_EQ(model->stat.extent, 2);
  EXPECT_NEAR(static_cast<double>(model->vis.map.znear) * model->stat.extent, 0.02, 1e-6);
  EXPECT_NEAR(static_cast<double>(model->vis.map.zfar) * model->stat.extent, 40, 1e-3);
}

TEST(ClipPlanes, OfAModelKeepItsExtent) {
  const SpecPtr spec = MakeSpec();
  SetClipPlanes(spec.get(), 3, 0.02, 40);
  const ModelPtr model = Compile(spec.get());
  SetClipPlanes(model.get(), 0.1, 5);
  EXPECT_DOUBLE_EQ(model->stat.extent, 3);
  EXPECT_NEAR(GetClipPlanes(model.get()).near_m, 0.1, 1e-6);
  EXPECT_NEAR(GetClipPlanes(model.get()).far_m, 5, 1e-5);
}

TEST(ClipPlanes, MustBeInTheirOrder) {
  const SpecPtr spec = MakeSpec();
  const ModelPtr model = Compile(spec.get());
  for (const auto& [near_m, far_m] : {std::pair{0.0, 1.0}, {1.0, 1.0}, {2.0, 1.0}, {-1.0, 1.0}}) {
    EXPECT_THROW(SetClipPlanes(model.get(), near_m, far_m), ArgumentError) << near_m;
  }
}

}  // namespace
}  // namespace robocell::internal
