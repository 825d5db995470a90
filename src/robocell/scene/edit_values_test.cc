#include "robocell/scene/edit_values.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/edited_arm.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

class EditValues : public EditedArm {};

// The gains of force = gain * ctrl + a + b * length + c * velocity.
TEST_F(EditValues, ChangeServoGainsLikeOverrides) {
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

TEST_F(EditValues, RejectGainsThatAnActuatorDoesNotHave) {
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

class EditedMass : public EditedArm {
 protected:
  // Returns the weight of the body that contains `inside`, with the edits.
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

TEST_F(EditedMass, OfABodySetsTheCompiledMassAndScalesInertia) {
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

TEST_F(EditedMass, RespectsInertiaFromGeom) {
  EXPECT_NEAR(Of(kInertial, kHeavy, "inertiafromgeom='true'").mass, 7, 1e-12);
  EXPECT_NEAR(
      Of(kInertial, "{geom: {body: link, index: 0}, mass: 6}", "inertiafromgeom='true'").mass, 6,
      1e-12);
  EXPECT_NEAR(Of(R"(<geom size="0.1" mass="1"/><geom size="0.1" mass="9" group="3"/>)", kHeavy,
                 "inertiagrouprange='0 2'")
                  .mass,
              7, 1e-12);
}

TEST_F(EditedMass, RejectsValuesThatTheEngineRejects) {
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
      "body 'link' has neither an <inertial> nor geoms with a mass, so nothing in it can carry its "
      "mass; write an <inertial> into the file, or give a geom a mass: {geom: {body: 'link', "
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

class EditedShape : public EditedArm {
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

// The oracle is the engine's own result for an element stretched between two points.
TEST_F(EditedShape, MovesFromtoGeomsAndSites) {
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

TEST_F(EditedShape, SetsTheWholeSizeOfFromtoGeoms) {
  model = folder.Write("stretched", kStretched);
  const Scene scene = Build("{geom: rod, size: [0.2, 0.3, 0]}");
  const int rod = Id(scene, mjOBJ_GEOM, "r_rod");
  EXPECT_EQ(scene.model()->geom_size[3 * rod], 0.2);
  EXPECT_EQ(scene.model()->geom_size[3 * rod + 1], 0.3);
  EXPECT_NEAR(scene.model()->geom_pos[3 * rod + 1], 0.2, 1e-12) << "its middle stays";
}

TEST_F(EditedShape, IsInTheParentBodyDespiteFrames) {
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

}  // namespace
}  // namespace robocell::internal
