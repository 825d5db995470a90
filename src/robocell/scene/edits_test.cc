// Tests edits of a robot's model, each in the compiled model.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/edited_arm.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class Edits : public EditedArm {};

TEST_F(Edits, MoveBodiesAndSites) {
  const Scene scene = Build(
      "{body: base, pos: [0, 0, 0]}, {site: flange, pos: [0.1, 0, 0], euler: [0, 90, 0]}, {body: "
      "fore, quat_wxyz: [0, 0, 0, 1]}");
  EXPECT_TRUE(scene.body_pose("r_base").is_close(Pose(), 1e-9, 1e-9));
  const Pose flange = scene.body_pose("r_fore") * Pose::FromRpy({0.1, 0, 0}, {0, M_PI / 2, 0});
  EXPECT_TRUE(scene.site_pose("r_flange").is_close(flange, 1e-9, 1e-9));
  const int fore = Id(scene, mjOBJ_BODY, "r_fore");
  EXPECT_NEAR(std::abs(scene.model()->body_quat[4 * fore + 3]), 1, 1e-12);
}

TEST_F(Edits, AcceptAxesForAnOrientation) {
  const Scene scene = Build("{site: flange, xyaxes: [-1, 0, 0, 0, -1, 0]}");
  const Pose turned = scene.body_pose("r_fore") * Pose::FromRpy({0, 0, 0.2}, {0, 0, M_PI});
  EXPECT_TRUE(scene.site_pose("r_flange").is_close(turned, 1e-9, 1e-9));
}

TEST_F(Edits, ChangeJointsInRadiansEvenInModelsInDegrees) {
  model = folder.Write("degrees",
                       R"(<compiler angle="degree"/><worldbody><body name="base"><geom size="0.1"/>
      <body><joint name="elbow" range="-90 90"/><geom size="0.1"/></body></body></worldbody>)");
  const Scene scene =
      Build("{joint: elbow, range: [-0.5, 0.5], damping: 3, armature: 0.2, frictionloss: 0.4}");
  const mjModel* m = scene.model();
  EXPECT_NEAR(m->jnt_range[1], 0.5, 1e-12);
  EXPECT_EQ(m->dof_damping[0], 3);
  EXPECT_EQ(m->dof_armature[0], 0.2);
  EXPECT_EQ(m->dof_frictionloss[0], 0.4);
}

TEST_F(Edits, ChangeActuators) {
  const Scene scene =
      Build("{actuator: servo1, ctrlrange: [-1, 1], forcerange: [-9, 9], kp: 77, kv: 6}");
  const mjModel* m = scene.model();
  EXPECT_EQ(m->actuator_ctrlrange[1], 1);
  EXPECT_TRUE(m->actuator_ctrllimited[0]);
  EXPECT_EQ(m->actuator_forcerange[0], -9);
  EXPECT_TRUE(m->actuator_forcelimited[0]);
  EXPECT_EQ(m->actuator_gainprm[0], 77);
  EXPECT_EQ(m->actuator_biasprm[1], -77);
  EXPECT_EQ(m->actuator_biasprm[2], -6);
}

TEST_F(Edits, WithoutEffectAreReported) {
  model =
      folder.Write("odd", R"(<asset><mesh name="wedge" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
    <worldbody><body name="base"><freejoint name="free"/><geom name="mesh" type="mesh" mesh="wedge"/>
    <geom name="fitted" type="box" mesh="wedge"/>
    <camera name="eye" mode="targetbody" target="link"/>
    <camera name="lens" sensorsize="0.01 0.01" focal="0.01 0.01" resolution="99 99"/>
    <body name="link"><joint name="sprung" springdamper="1 1"/><geom size="0.1"/></body>
    </body></worldbody>)");
  ExpectThrow<SpecError>([&] { Build("{geom: mesh, size: [1, 1, 1]}"); },
                         "edits[0]: the size of geom 'mesh' is that of its mesh or height field; "
                         "scale that in the file (<mesh scale=\"...\">)");
  ExpectThrow<SpecError>([&] { Build("{geom: fitted, size: [1, 1, 1]}"); },
                         "the size of geom 'fitted' is that of its mesh");
  ExpectThrow<SpecError>(
      [&] { Build("{joint: free, range: [-1, 1]}"); },
      "joint 'free' is a free joint, which has no range; it moves its body anywhere");
  ExpectThrow<SpecError>([&] { Build("{joint: free, pos: [0, 0, 1]}"); }, "which has no pos");
  ExpectThrow<SpecError>([&] { Build("{joint: sprung, damping: 3}"); },
                         "the engine works the damping of joint 'sprung' out from its "
                         "springdamper; change that in the file");
  ExpectThrow<SpecError>([&] { Build("{camera: eye, euler: [0, 0, 90]}"); },
                         "camera 'eye' always looks at body 'link', so it cannot be turned; add a "
                         "camera of its own with add_camera");
  ExpectThrow<SpecError>([&] { Build("{camera: lens, fovy: 20}"); },
                         "the fovy of camera 'lens' is that of its focal length and sensorsize; "
                         "change these in the file");
}

TEST_F(Edits, DeleteTheHomeOfAModel) {
  EXPECT_EQ(Build(kNoEdit).data()->qpos[0], 0.3);
  EXPECT_EQ(Build("{delete: {key: home}}").data()->qpos[0], 0);
}

TEST_F(Edits, ReachUnnamedGeomsByBodyAndIndex) {
  const Scene scene = Build(
      "{geom: {body: fore, index: 0}, name: forearm, rgba: [0, 1, 0, 1], friction: [1, 0.1, 0.01], "
      "condim: 4, mass: 2}");
  const int geom = Id(scene, mjOBJ_GEOM, "r_forearm");
  EXPECT_EQ(scene.model()->geom_rgba[4 * geom + 1], 1);
  EXPECT_EQ(scene.model()->geom_friction[3 * geom + 1], 0.1);
  EXPECT_EQ(scene.model()->geom_condim[geom], 4);
  EXPECT_NEAR(scene.model()->body_mass[Id(scene, mjOBJ_BODY, "r_fore")], 2, 1e-12);
}

TEST_F(Edits, AddSitesCamerasAndSensors) {
  const Scene scene = Build(
      "{add_site: wrist, body: fore, pos: [0, 0, 0.1]}, {add_camera: eye, body: base, pos: [1, 0, "
      "0], fovy: 71}, "
      "{add_sensor: wrist_force, site: wrist, type: force}");
  EXPECT_TRUE(scene.site_pose("r_wrist").is_close(
      scene.body_pose("r_fore") * Pose(Eigen::Vector3d(0, 0, 0.1)), 1e-9, 1e-9));
  EXPECT_EQ(scene.model()->cam_fovy[Id(scene, mjOBJ_CAMERA, "r_eye")], 71);
  const int sensor = Id(scene, mjOBJ_SENSOR, "r_wrist_force");
  EXPECT_EQ(scene.model()->sensor_type[sensor], mjSENS_FORCE);
  EXPECT_EQ(scene.model()->sensor_objid[sensor], Id(scene, mjOBJ_SITE, "r_wrist"));
}

TEST_F(Edits, DeleteElementsOfAModelWithAKeyframe) {
  const Scene scene = Build(
      "{delete: {actuator: servo2}}, {delete: {sensor: elbow_position}}, {delete: {joint: elbow}}");
  EXPECT_EQ(scene.model()->nq, 1);
  EXPECT_EQ(scene.model()->nu, 1 + 1) << "and its motor";
  EXPECT_EQ(scene.model()->nsensor, 0);
  EXPECT_NEAR(scene.data()->qpos[0], 0.3, 1e-12)
      << "the key's value still belongs to the joint that is left";
}

TEST_F(Edits, AreAppliedInOrder) {
  const Scene scene = Build(
      "{add_site: tool, body: fore}, {site: tool, pos: [0, 0, 0.5]}, {site: tool, name: tip}");
  EXPECT_TRUE(scene.site_pose("r_tip").is_close(
      scene.body_pose("r_fore") * Pose(Eigen::Vector3d(0, 0, 0.5)), 1e-9, 1e-9));
}

TEST_F(Edits, NameMissingElements) {
  ExpectThrow<NotFoundError>([&] { Build("{body: bse, pos: [0, 0, 0]}"); },
                             "yaml:1:63: robot 'r' / edits[0]: the model: no body 'bse'. Its "
                             "bodies: world, base, upper, fore. Did you mean 'base'?");
  ExpectThrow<NotFoundError>(
      [&] { Build("{geom: {body: fore, index: 2}, mass: 1}"); },
      "edits[0]: body 'fore' has 1 geom(s), so there is none with index 2 (they count from 0)");
  ExpectThrow<NotFoundError>([&] { Build("{geom: foo, mass: 1}"); },
                             "edits[0]: the model: no geom 'foo'. Its geoms: (none). 3 have no "
                             "name; write for example {geom: {body: 'base', index: 0}}");
  ExpectThrow<NotFoundError>([&] { Build("{delete: {camera: view}}"); },
                             "edits[0]: the model: no camera 'view'. Its cameras: (none).");
  ExpectThrow<SpecError>([&] { Build("{add_site: flange, body: fore}"); },
                         "edits[0]: the model already has a site 'flange'");
  ExpectThrow<SpecError>(
      [&] {
        Build(
            "{site: flange, name: tip}, {add_site: tip, body: base}, {add_sensor: f, site: tip, "
            "type: forse}");
      },
      "yaml has 2 problems:");
}

}  // namespace
}  // namespace robocell
