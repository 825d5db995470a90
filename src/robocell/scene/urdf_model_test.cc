// Tests the models made of URDFs against the engine's own reader where that is right, and against
// the URDF's numbers where it is not.
#include "robocell/scene/urdf_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/urdf_texts.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using UrdfModel = UrdfTexts;

// The engine's reader is right about this URDF.
TEST_F(UrdfModel, AgreesWithTheEngine) {
  const std::string file = Write(Arm());
  const ModelPtr ours = Model(Arm());
  const SpecPtr theirs_spec = ParseXmlFile(file);
  theirs_spec->compiler.fusestatic = false;
  const ModelPtr theirs = Compile(theirs_spec.get());
  ASSERT_EQ(ours->nbody, theirs->nbody);
  ASSERT_EQ(ours->njnt, theirs->njnt);
  ASSERT_EQ(ours->ngeom, theirs->ngeom);
  const auto compare = [](const char* what, const mjtNum* a, const mjtNum* b, int n) {
    for (int i = 0; i < n; ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << what << " " << i;
  };
  compare("body_pos", ours->body_pos, theirs->body_pos, 3 * ours->nbody);
  compare("body_quat", ours->body_quat, theirs->body_quat, 4 * ours->nbody);
  compare("body_mass", ours->body_mass, theirs->body_mass, ours->nbody);
  compare("body_inertia", ours->body_inertia, theirs->body_inertia, 3 * ours->nbody);
  compare("jnt_axis", ours->jnt_axis, theirs->jnt_axis, 3 * ours->njnt);
  compare("jnt_range", ours->jnt_range, theirs->jnt_range, 2 * ours->njnt);
  compare("jnt_actfrcrange", ours->jnt_actfrcrange, theirs->jnt_actfrcrange, 2 * ours->njnt);
  compare("dof_damping", ours->dof_damping, theirs->dof_damping, ours->nv);
  compare("dof_frictionloss", ours->dof_frictionloss, theirs->dof_frictionloss, ours->nv);
  compare("geom_size", ours->geom_size, theirs->geom_size, 3 * ours->ngeom);
  compare("geom_pos", ours->geom_pos, theirs->geom_pos, 3 * ours->ngeom);
  compare("geom_quat", ours->geom_quat, theirs->geom_quat, 4 * ours->ngeom);
}

TEST_F(UrdfModel, KeepsFixedLinks) {
  const ModelPtr model = Model(Arm());
  for (const char* link : {"base", "upper", "flange", "slider"})
    EXPECT_GT(FindId(model.get(), mjOBJ_BODY, link), 0) << link;
}

// The inertia about the link's axes is R I R^T.
TEST_F(UrdfModel, TurnsTheInertiaWithItsOrigin) {
  const ModelPtr model = Model(Link("base", "") + Link("arm", Inertial(2, "0.3 -0.4 0.5")) +
                               Joint("j", "revolute", "base", "arm"));
  const int body = FindId(model.get(), mjOBJ_BODY, "arm");
  mjtNum r[9];
  mju_quat2Mat(r, model->body_iquat + 4 * body);
  const Eigen::Matrix3d axes = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r);
  const Eigen::Matrix3d own =
      axes * Eigen::Vector3d(model->body_inertia + 3 * body).asDiagonal() * axes.transpose();
  Eigen::Matrix3d given;
  given << 0.02, 0.001, 0.002, 0.001, 0.03, 0.003, 0.002, 0.003, 0.04;
  const Eigen::Matrix3d turn = Pose::FromRpy({0, 0, 0}, {0.3, -0.4, 0.5}).rotation();
  EXPECT_LT((own - turn * given * turn.transpose()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(UrdfModel, MimicJointsAreEqualities) {
  const std::string finger = Joint("right", "prismatic", "base", "r",
                                   "<mimic joint=\"left\" multiplier=\"-0.5\" offset=\"0.2\"/>");
  const ModelPtr model = Model(Link("base", "") + Link("l", Inertial(1)) + Link("r", Inertial(1)) +
                               Joint("left", "prismatic", "base", "l") + finger);
  ASSERT_EQ(model->neq, 1);
  EXPECT_EQ(model->eq_type[0], mjEQ_JOINT);
  EXPECT_EQ(model->eq_obj1id[0], FindId(model.get(), mjOBJ_JOINT, "right"));
  EXPECT_EQ(model->eq_obj2id[0], FindId(model.get(), mjOBJ_JOINT, "left"));
  EXPECT_EQ(model->eq_data[0], 0.2);
  EXPECT_EQ(model->eq_data[1], -0.5);
  for (int i = 2; i < 5; ++i) EXPECT_EQ(model->eq_data[i], 0);
}

TEST_F(UrdfModel, TheWorldLink) {
  const std::string arm = Link("base", "") + Link("arm", Inertial(1));
  const ModelPtr fixed = Model(Link("world", "") + arm + Joint("mount", "fixed", "world", "base") +
                               Joint("j", "revolute", "base", "arm"));
  EXPECT_EQ(fixed->nbody, 3);
  EXPECT_NEAR(fixed->body_pos[3 + 2], 0.3, 1e-12) << "where the file puts it";
  const ModelPtr direct =
      Model(Link("world", "") + Link("arm", Inertial(1)) + Joint("j", "revolute", "world", "arm"));
  EXPECT_EQ(FindId(direct.get(), mjOBJ_BODY, "world_link"), 1) << "the arm begins behind its base";
  const ModelPtr floating = Model(Link("world", "") + Link("base", Inertial(4)) +
                                  Joint("free", "floating", "world", "base"));
  ASSERT_EQ(floating->njnt, 1);
  EXPECT_EQ(floating->jnt_type[0], mjJNT_FREE);
}

TEST_F(UrdfModel, LinksWithoutInertialWeighNothingBesideOnesWithIt) {
  const std::string ball = Collision("<sphere radius=\"0.1\"/>");
  const ModelPtr model =
      Model(Link("base", "") + Link("arm", Inertial(1)) + Link("tool", ball) +
            Joint("j", "revolute", "base", "arm") + Joint("f", "fixed", "arm", "tool"));
  EXPECT_EQ(model->body_mass[FindId(model.get(), mjOBJ_BODY, "tool")], 0);
  const ModelPtr water =
      Model(Link("base", "") + Link("arm", ball) + Joint("j", "revolute", "base", "arm"));
  EXPECT_NEAR(water->body_mass[2], 1000 * 4.0 / 3 * 3.14159265 * 1e-3, 1e-3);
}

TEST_F(UrdfModel, MeshesOfOneNameInTwoFolders) {
  for (const std::string folder : {"visual", "collision"}) {
    std::filesystem::create_directories(folder_.path() / folder);
    const std::string size = folder == "visual" ? "1" : "2";
    AtomicWrite(
        folder_.path() / folder / "arm.obj",
        "v 0 0 0\nv " + size + " 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  }
  const std::string geometry = "<geometry><mesh filename=\"{}/arm.obj\"/></geometry>";
  const ModelPtr model = Model(Link(
      "base", "<visual>" + fmt::format(fmt::runtime(geometry), "visual") + "</visual><collision>" +
                  fmt::format(fmt::runtime(geometry), "collision") + "</collision>"));
  ASSERT_EQ(model->nmesh, 2);
  EXPECT_NE(model->geom_dataid[0], model->geom_dataid[1]);
  EXPECT_EQ(model->geom_group[0], 2);
  EXPECT_EQ(model->geom_contype[0], 0);
  EXPECT_EQ(model->geom_group[1], 3);
}

TEST_F(UrdfModel, CastersGetNoServo) {
  const std::string wheels = Link("base", Inertial(5)) + Link("l", Inertial(1)) +
                             Link("c", Inertial(1)) + Joint("left", "continuous", "base", "l") +
                             Joint("caster", "continuous", "base", "c") +
                             "<transmission name=\"t\"><joint name=\"left\"/></transmission>";
  const Urdf urdf = ReadUrdf(Write(wheels));
  const SpecPtr spec = MakeUrdfSpec(urdf);
  AddUrdfServos(urdf, spec.get());
  const ModelPtr model = Compile(spec.get());
  EXPECT_THAT(ElementNames(model.get(), mjOBJ_ACTUATOR), ElementsAre("left"));
}

TEST_F(UrdfModel, IsARobotInAScene) {
  Write(Arm());
  AtomicWrite(folder_.path() / "arm.yaml",
              "name: arm\nmodel: arm.urdf\nmove_groups:\n"
              "  arm: {kind: arm, joints: [turn, slide], leaf: {body: slider}}\n");
  SceneSpec spec = EmptyScene();
  const std::string file = (folder_.path() / "arm.yaml").string();
  spec.robots.push_back({.name = "arm", .config = RobotConfig::Load(file), .prefix = "a/"});
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.compiled()->notes(),
              Contains(HasSubstr("position servos were made for turn, slide")));
  EXPECT_GE(FindId(scene.model(), mjOBJ_ACTUATOR, "a/turn"), 0);
}

TEST_F(UrdfModel, IsAnObjectInAScene) {
  Write(Link("ball", Inertial(1) + Collision("<sphere radius=\"0.1\"/>")));
  SceneSpec spec = EmptyScene();
  SceneObject object;
  object.name = "ball";
  object.mjcf_path = (folder_.path() / "arm.urdf").string();
  spec.objects.push_back(object);
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.model()->nactuator, 0);
}

TEST_F(UrdfModel, ErrorsNameTheRobotFileAndTheLineOfTheUrdf) {
  Write(
      "<link name=\"base\"/>\n<joint name=\"j\" type=\"planar\"><parent link=\"base\"/><child "
      "link=\"tip\"/></joint>\n<link name=\"tip\"/>");
  AtomicWrite(folder_.path() / "arm.yaml", "name: arm\nmodel: arm.urdf\n");
  SceneSpec spec = EmptyScene();
  const std::string file = (folder_.path() / "arm.yaml").string();
  spec.robots.push_back({.name = "arm", .config = RobotConfig::Load(file)});
  const std::string message =
      ExpectThrow<SpecError>([&] { Scene::Build(spec); }, "arm.urdf:3: joint 'j': type=\"planar\"");
  EXPECT_THAT(message, HasSubstr("arm.yaml:2:8"));
}

}  // namespace
}  // namespace robocell::internal
