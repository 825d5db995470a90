// Edits of a robot's model, each checked in the compiled model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr const char* kHinge = R"(<worldbody><body name="base"><geom size="0.1"/><body>
  <joint name="hinge" axis="0 0 1"/><geom size="0.1"/></body></body></worldbody>)";
constexpr const char* kNoEdit = "{body: base, pos: [0, 0, 0]}";

class Edits : public ::testing::Test {
 protected:
  // The two-joint arm with these edits, written as YAML.
  Scene Build(const std::string& edits) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.config = ParseYaml<RobotConfig>("{name: arm, model: " + model +
                                                            ", edits: [" + edits + "]}"),
                           .prefix = "r_"});
    return Scene::Build(spec);
  }
  int Id(const Scene& scene, mjtObj kind, const char* name) {
    return RequireId(scene.model(), kind, name, "test");
  }

  ModelFolder folder;
  std::string model = folder.Write("arm", kTwoJointArm);
};

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

TEST_F(Edits, TakeAxesForAnOrientation) {
  const Scene scene = Build("{site: flange, xyaxes: [-1, 0, 0, 0, -1, 0]}");
  const Pose turned = scene.body_pose("r_fore") * Pose::FromRpy({0, 0, 0.2}, {0, 0, M_PI});
  EXPECT_TRUE(scene.site_pose("r_flange").is_close(turned, 1e-9, 1e-9));
}

TEST_F(Edits, ChangeJointsInRadiansWhateverTheModelIsWrittenIn) {
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

// The gains of force = gain * ctrl + a + b * length + c * velocity.
TEST_F(Edits, ChangeTheGainsOfServosAsTheOverridesDo) {
  model = folder.Write("scaled", std::string(kHinge) + R"(<actuator>
    <general name="scaled" joint="hinge" gainprm="0.5" biastype="affine" biasprm="-2 -4 -1"/>
    <velocity name="velocity" joint="hinge" kv="3"/>
    <intvelocity name="integrating" joint="hinge" kp="5" actrange="-1 1"/></actuator>)");
  const Scene scene = Build(
      "{actuator: scaled, kp: 40, kv: 3}, {actuator: velocity, kv: 8}, "
      "{actuator: integrating, kp: 9}");
  const mjModel* m = scene.model();
  const auto gain = [&](int a) { return m->actuator_gainprm[mjNGAIN * a]; };
  const auto bias = [&](int a, int i) { return m->actuator_biasprm[mjNBIAS * a + i]; };
  EXPECT_DOUBLE_EQ(gain(0), 5) << "a control still means the same length";
  EXPECT_DOUBLE_EQ(bias(0, 0), -20);
  EXPECT_EQ(bias(0, 1), -40);
  EXPECT_EQ(bias(0, 2), -3);
  EXPECT_EQ(gain(1), 8);
  EXPECT_EQ(bias(1, 2), -8);
  EXPECT_EQ(gain(2), 9);
  EXPECT_EQ(bias(2, 1), -9);
}

TEST_F(Edits, RefuseGainsThatAnActuatorDoesNotHave) {
  model = folder.Write("motor", std::string(kHinge) + R"(<actuator>
    <motor name="motor" joint="hinge"/><velocity name="velocity" joint="hinge" kv="3"/></actuator>)");
  ExpectThrow<SpecError>(
      [&] { Build("{actuator: motor, kp: 700}"); },
      "edits[0]: actuator 'motor' is a motor: kp is a gain of position servos, kv of these and of "
      "velocity servos; leave it out, or write the actuator as <position> or <velocity> in the "
      "file");
  ExpectThrow<SpecError>([&] { Build("{actuator: motor, kv: 7}"); }, "'motor' is a motor: kp is");
  ExpectThrow<SpecError>([&] { Build("{actuator: velocity, kp: 7}"); },
                         "'velocity' is a velocity servo: kp is");
}

// The mass and inertia of a body in the compiled model.
struct Weight {
  double mass;
  double inertia;
};

class EditedMass : public Edits {
 protected:
  // Weight of the body that contains `inside`, with the edits.
  Weight Of(const std::string& inside, const std::string& edits, const std::string& compiler = "") {
    model = folder.Write("weighed", "<compiler " + compiler + R"(/><worldbody><body name="base">
      <geom size="0.1"/><body name="link"><joint/>)" +
                                        inside + "</body></body></worldbody>");
    const Scene scene = Build(edits);
    const int link = Id(scene, mjOBJ_BODY, "r_link");
    return {scene.model()->body_mass[link], scene.model()->body_inertia[3 * link]};
  }

  static constexpr const char* kInertial =
      R"(<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.2 0.2"/><geom size="0.1"/>)";
  static constexpr const char* kGeom = R"(<geom size="0.1" density="300"/>)";
  static constexpr const char* kGeoms =
      R"(<geom size="0.1" mass="1"/><geom size="0.1" mass="3"/><geom size="0.1" mass="0"/>)";
  static constexpr const char* kHeavy = "{body: link, mass: 7}";
};

TEST_F(EditedMass, OfABodyIsThatOfTheCompiledBodyAndItsInertiaGoesWithIt) {
  for (const char* inside : {kInertial, kGeom, kGeoms}) {
    const Weight before = Of(inside, kNoEdit), after = Of(inside, kHeavy);
    EXPECT_NEAR(after.mass, 7, 1e-12) << inside;
    EXPECT_NEAR(after.inertia / before.inertia, 7 / before.mass, 1e-9) << inside;
  }
}

TEST_F(EditedMass, OfABodyWithAFullInertiaScalesIt) {
  const std::string inside =
      R"(<inertial pos="0 0 0" mass="2" fullinertia="0.1 0.2 0.2 0.01 0 0"/><geom size="0.1"/>)";
  const Weight before = Of(inside, kNoEdit), after = Of(inside, kHeavy);
  EXPECT_NEAR(after.mass, 7, 1e-12);
  EXPECT_NEAR(after.inertia / before.inertia, 3.5, 1e-9);
}

TEST_F(EditedMass, GoesWhereTheFileSaysThatMassesComeFrom) {
  EXPECT_NEAR(Of(kInertial, kHeavy, "inertiafromgeom='true'").mass, 7, 1e-12);
  EXPECT_NEAR(
      Of(kInertial, "{geom: {body: link, index: 0}, mass: 6}", "inertiafromgeom='true'").mass, 6,
      1e-12);
  EXPECT_NEAR(Of(R"(<geom size="0.1" mass="1"/><geom size="0.1" mass="9" group="3"/>)", kHeavy,
                 "inertiagrouprange='0 2'")
                  .mass,
              7, 1e-12);
}

TEST_F(EditedMass, ThatTheEngineWouldNotTakeIsAProblem) {
  ExpectThrow<SpecError>([&] { Of(kInertial, "{geom: {body: link, index: 0}, mass: 7}"); },
                         "edits[0]: the mass of geom 0 (unnamed, of body 'link') does not count, "
                         "that of its body is written as <inertial>; write {body: 'link', mass: "
                         "...}");
  ExpectThrow<SpecError>(
      [&] { Of(R"(<geom size="0.1"/><geom size="0.2" mass="1"/>)", kHeavy); },
      "edits[0]: body 'link' has no <inertial>: its mass is that of its 2 geoms, of which not all "
      "say theirs; write it geom by geom: {geom: {body: 'link', index: 0}, mass: ...}, or an "
      "<inertial> into the file");
  ExpectThrow<SpecError>(
      [&] { Of(R"(<geom size="0.1" mass="0"/>)", kHeavy); },
      "body 'link' has neither an <inertial> nor geoms with a mass, so its mass can be that of "
      "nothing; write an <inertial> into the file, or give a geom a mass: {geom: {body: 'link', "
      "index: 0}, mass: ...}");
  ExpectThrow<SpecError>(
      [&] { Of(kGeom, kHeavy, "boundmass='8'"); },
      "the file's <compiler boundmass=\"8\"> raises all masses below it, that of "
      "body 'link' too; write at least 8, or change boundmass in the file");
  ExpectThrow<SpecError>(
      [&] {
        Of(R"(<geom size="0.1"/><geom size="0.1" group="3"/>)",
           "{geom: {body: link, index: 1}, mass: 7}", "inertiagrouprange='0 2'");
      },
      "geom 1 (unnamed, of body 'link') is in group 3, and the file's <compiler "
      "inertiagrouprange=\"0 2\"> counts other geoms only; give the mass to one of these");
}

class EditedShape : public Edits {
 protected:
  static constexpr const char* kStretched = R"(<worldbody><body name="base">
    <geom name="rod" type="capsule" fromto="0 0 0 0.3 0.4 0" size="0.1"/>
    <geom name="bar" type="box" fromto="0 0 0 0 0.4 0.3" size="0.1"/>
    <site name="mark" type="cylinder" fromto="0 0 0 0.4 0 0.3" size="0.1"/></body></worldbody>)";
  static constexpr const char* kFramed = R"(<worldbody><body name="base"><geom size="0.1"/>
    <frame pos="1 0 0" euler="0 0 90"><frame pos="0 0 1"><body name="link" euler="20 0 0">
    <joint name="own"/><geom size="0.1"/></body>
    <geom name="ball" size="0.1" euler="20 0 0"/><site name="mark"/>
    <camera name="view"/></frame></frame></body></worldbody>)";
};

// The engine itself says what an element stretched between two points becomes.
TEST_F(EditedShape, MovesWhatIsStretchedBetweenTwoPoints) {
  model = folder.Write("stretched", kStretched);
  const Scene as_written = Build("{geom: rod, rgba: [1, 0, 0, 1]}");
  const Scene scene = Build(
      "{geom: rod, pos: [5, 6, 7]}, {geom: bar, pos: [1, 2, 3]}, {site: mark, pos: [0, 0, 9]}");
  const mjModel *before = as_written.model(), *m = scene.model();
  EXPECT_EQ(m->geom_pos[3 * Id(scene, mjOBJ_GEOM, "r_rod") + 1], 6);
  EXPECT_EQ(m->geom_pos[3 * Id(scene, mjOBJ_GEOM, "r_bar") + 2], 3);
  EXPECT_EQ(m->site_pos[3 * Id(scene, mjOBJ_SITE, "r_mark") + 2], 9);
  const int rod = Id(scene, mjOBJ_GEOM, "r_rod"), bar = Id(scene, mjOBJ_GEOM, "r_bar");
  for (const int geom : {rod, bar}) {
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(m->geom_quat[4 * geom + i], before->geom_quat[4 * geom + i], 1e-12);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(m->geom_size[3 * geom + i], before->geom_size[3 * geom + i], 1e-12);
  }
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(m->site_quat[i], before->site_quat[i], 1e-12);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(m->site_size[i], before->site_size[i], 1e-12);
}

TEST_F(EditedShape, GivesWhatIsStretchedBetweenTwoPointsItsWholeSize) {
  model = folder.Write("stretched", kStretched);
  const Scene scene = Build("{geom: rod, size: [0.2, 0.3, 0]}");
  const int rod = Id(scene, mjOBJ_GEOM, "r_rod");
  EXPECT_EQ(scene.model()->geom_size[3 * rod], 0.2);
  EXPECT_EQ(scene.model()->geom_size[3 * rod + 1], 0.3);
  EXPECT_NEAR(scene.model()->geom_pos[3 * rod + 1], 0.2, 1e-12) << "its middle stays";
}

TEST_F(EditedShape, IsInTheParentBodyWhateverFramesTheFileHas) {
  model = folder.Write("framed", kFramed);
  const Scene scene = Build(
      "{body: link, pos: [3, 0, 0]}, {geom: ball, euler: [0, 0, 10]}, {camera: view, pos: [0, 4, "
      "0]}, "
      "{site: mark, pos: [1, 2, 3], quat: [0, 0, 0, 1]}, {joint: own, pos: [0, 0, 0.5]}");
  const mjModel* m = scene.model();
  const auto pose = [](const double* pos, const double* quat) { return Pose::FromWxyz(pos, quat); };
  const int link = Id(scene, mjOBJ_BODY, "r_link"), ball = Id(scene, mjOBJ_GEOM, "r_ball");
  const int mark = Id(scene, mjOBJ_SITE, "r_mark"), view = Id(scene, mjOBJ_CAMERA, "r_view");
  const Pose turned = Pose::FromRpy({0, 0, 0}, {0, 0, M_PI / 2});
  const Pose tilted = turned * Pose::FromRpy({0, 0, 0}, {20 * M_PI / 180, 0, 0});
  const Eigen::Vector3d in_frame(1, 0, 1);
  EXPECT_TRUE(pose(m->body_pos + 3 * link, m->body_quat + 4 * link)
                  .is_close(Pose({3, 0, 0}, tilted.quaternion()), 1e-9, 1e-9));
  EXPECT_TRUE(pose(m->geom_pos + 3 * ball, m->geom_quat + 4 * ball)
                  .is_close(Pose::FromRpy(in_frame, {0, 0, M_PI / 18}), 1e-9, 1e-9));
  EXPECT_TRUE(pose(m->site_pos + 3 * mark, m->site_quat + 4 * mark)
                  .is_close(Pose(Eigen::Vector3d(1, 2, 3)), 1e-9, 1e-9));
  EXPECT_TRUE(pose(m->cam_pos + 3 * view, m->cam_quat + 4 * view)
                  .is_close(Pose({0, 4, 0}, turned.quaternion()), 1e-9, 1e-9));
  EXPECT_EQ(m->jnt_pos[2], 0.5);
}

TEST_F(Edits, WithoutEffectInTheCompiledModelAreProblems) {
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

TEST_F(Edits, ComeOneAfterTheOther) {
  const Scene scene = Build(
      "{add_site: tool, body: fore}, {site: tool, pos: [0, 0, 0.5]}, {site: tool, name: tip}");
  EXPECT_TRUE(scene.site_pose("r_tip").is_close(
      scene.body_pose("r_fore") * Pose(Eigen::Vector3d(0, 0, 0.5)), 1e-9, 1e-9));
}

TEST_F(Edits, SayWhatTheyDoNotFind) {
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
