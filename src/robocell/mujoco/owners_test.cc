#include "robocell/mujoco/owners.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <span>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr const char* kSwing =
    "<mujoco><worldbody><body><joint name='hinge' ref='0.3'/><geom size='.1' pos='0 0 1'/></body>"
    "</worldbody></mujoco>";

ModelPtr Swing() { return Compile(ParseXmlString(kSwing).get()); }

std::span<const mjtNum> Qpos(const mjModel* model, const mjData* data) {
  return {data->qpos, static_cast<size_t>(model->nq)};
}

TEST(Owners, AnEmptySpecCountsAnglesInRadians) {
  const SpecPtr spec = MakeSpec();
  mjsJoint* joint = mjs_addJoint(mjs_addBody(mjs_findBody(spec.get(), "world"), nullptr), nullptr);
  joint->type = mjJNT_HINGE;
  joint->limited = mjLIMITED_TRUE;
  joint->range[0] = -1;
  joint->range[1] = 2;
  mjs_addGeom(mjs_findBody(spec.get(), "world"), nullptr)->size[0] = 0.1;
  mjs_addGeom(mjs_getParent(joint->element), nullptr)->size[0] = 0.1;
  const ModelPtr model = Compile(spec.get());
  EXPECT_EQ(model->jnt_range[0], -1);
  EXPECT_EQ(model->jnt_range[1], 2);
}

TEST(Owners, DataBeginInTheReferenceConfiguration) {
  const ModelPtr model = Swing();
  const DataPtr data = MakeData(model.get());
  EXPECT_EQ(data->qpos[0], model->qpos0[0]);
  EXPECT_EQ(data->time, 0);
}

TEST(Owners, CopiesAreEqualAndTheirOwn) {
  const ModelPtr model = Swing();
  const ModelPtr same = CopyModel(model.get());
  same->body_mass[1] += 1;
  EXPECT_NE(same->body_mass[1], model->body_mass[1]);

  const DataPtr data = MakeData(model.get());
  data->qpos[0] = 0.7;
  data->qvel[0] = -2;
  const DataPtr copy = CopyData(model.get(), data.get());
  EXPECT_EQ(copy->qvel[0], -2);
  for (int i = 0; i < 100; ++i) {
    mj_step(model.get(), data.get());
    mj_step(model.get(), copy.get());
  }
  EXPECT_TRUE(std::ranges::equal(Qpos(model.get(), data.get()), Qpos(model.get(), copy.get())));
  copy->qpos[0] = 9;
  EXPECT_NE(data->qpos[0], 9);
}

TEST(Owners, ACopiedSpecCompilesToTheSameModel) {
  const SpecPtr spec = ParseXmlString(kSwing);
  const SpecPtr copy = CopySpec(spec.get());
  const ModelPtr model = Compile(spec.get()), same = Compile(copy.get());
  EXPECT_EQ(mj_sizeModel(model.get()), mj_sizeModel(same.get()));
  EXPECT_EQ(model->body_mass[1], same->body_mass[1]);
}

TEST(Owners, AMovedFileSystemStillHasItsFiles) {
  VfsPtr vfs = MakeVfs();
  AddBuffer(vfs.get(), "part.xml", kSwing);
  const VfsPtr moved = std::move(vfs);
  ExpectThrow<ArgumentError>([&] { AddBuffer(moved.get(), "part.xml", "<mujoco/>"); },
                             "virtual file system: there is already a file 'part.xml'");
}

}  // namespace
}  // namespace robocell
