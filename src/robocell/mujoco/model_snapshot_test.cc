#include "robocell/mujoco/model_snapshot.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstring>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"

namespace robocell::internal {
namespace {

ModelPtr GreyBall() {
  const SpecPtr spec = MakeSpec();
  mjsBody* body = mjs_addBody(mjs_findBody(spec.get(), "world"), nullptr);
  mjs_addFreeJoint(body);
  mjsGeom* geom = mjs_addGeom(body, nullptr);
  geom->type = mjGEOM_SPHERE;
  geom->size[0] = 0.1;
  return Compile(spec.get(), nullptr, "ball");
}

TEST(ModelSnapshot, KeepsItsValuesWhenTheModelChanges) {
  const ModelPtr model = GreyBall();
  ModelSnapshots snapshots(model.get());
  const auto before = snapshots.Take();
  model->geom_rgba[1] = 0.25F;
  model->vis.headlight.active = 0;
  const auto after = snapshots.Take();
  EXPECT_NE(before->model().geom_rgba[1], 0.25F);
  EXPECT_NE(before->model().vis.headlight.active, 0);
  EXPECT_EQ(after->model().geom_rgba[1], 0.25F);
  EXPECT_EQ(after->model().vis.headlight.active, 0);
}

TEST(ModelSnapshot, IsSharedForAnUnchangedModel) {
  const ModelPtr model = GreyBall();
  ModelSnapshots snapshots(model.get());
  const auto first = snapshots.Take();
  EXPECT_EQ(snapshots.Take(), first);
  model->opt.gravity[2] = -1;
  EXPECT_NE(snapshots.Take(), first);
}

TEST(ModelSnapshot, GivesTheSamePosesInTheEngine) {
  const ModelPtr model = GreyBall();
  const ModelSnapshot snapshot(model.get());
  const DataPtr own = MakeData(model.get()), copied = MakeData(&snapshot.model());
  own->qpos[0] = copied->qpos[0] = 0.3;
  mj_forward(model.get(), own.get());
  mj_forward(&snapshot.model(), copied.get());
  EXPECT_EQ(std::memcmp(own->geom_xpos, copied->geom_xpos, 3 * sizeof(mjtNum)), 0);
  EXPECT_EQ(own->signature, copied->signature);
}

// A check of every row: no more than a comparison.
TEST(ModelSnapshot, SharesAssetsWithItsModel) {
  const ModelPtr model = GreyBall();
  const ModelSnapshot snapshot(model.get());
  EXPECT_EQ(snapshot.model().names, model->names);
  EXPECT_EQ(snapshot.model().mesh_vert, model->mesh_vert);
  EXPECT_NE(snapshot.model().geom_rgba, model->geom_rgba);
}

}  // namespace
}  // namespace robocell::internal
