#include "robocell/scene/element_lookup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

class ElementLookup : public ::testing::Test {
 protected:
  ElementLookup() {
    SceneSpec spec = EmptyScene();
    const RobotConfig arm = ArmConfig(folder.Write("arm", kTwoJointArm));
    spec.robots.push_back(
        {.name = "one", .config = arm, .base = BaseConfig{.kind = BaseKind::kPlanar}});
    spec.robots.push_back({.name = "two", .config = arm, .prefix = "l_", .pos = {0, 2, 0}});
    spec.objects.push_back(
        BoxObject("l", {1, 0, 1}));  // its geom and joint look like those of robot two
    compiled = CompileScene(spec);
    model = compiled->model();
  }

  ModelFolder folder;
  std::shared_ptr<CompiledScene> compiled;
  const mjModel* model = nullptr;
};

TEST_F(ElementLookup, ListsNamesWithoutThePrefix) {
  EXPECT_THAT(RobotElementNames(model, compiled->robot("one"), mjOBJ_JOINT),
              ElementsAre("base_x", "base_y", "base_yaw", "shoulder", "elbow"));
  EXPECT_THAT(RobotElementNames(model, compiled->robot("two"), mjOBJ_JOINT),
              ElementsAre("shoulder", "elbow"));
  EXPECT_THAT(RobotElementNames(model, compiled->robot("two"), mjOBJ_ACTUATOR),
              ElementsAre("servo1", "servo2", "shoulder_torque", "elbow_torque"));
}

TEST_F(ElementLookup, FindsNamedElementsOfTheRobotOnly) {
  EXPECT_EQ(FindElement(model, compiled->robot("two"), mjOBJ_JOINT, "elbow"),
            FindId(model, mjOBJ_JOINT, "l_elbow"));
  ExpectThrow<NotFoundError>(
      [&] { FindElement(model, compiled->robot("two"), mjOBJ_JOINT, "joint"); },
      "robot 'two': no joint 'joint'. Its joints: shoulder, elbow.");
  ExpectThrow<NotFoundError>(
      [&] { FindElement(model, compiled->robot("one"), mjOBJ_JOINT, "l_elbow"); },
      "robot 'one': no joint 'l_elbow'. Its joints: base_x, base_y, base_yaw, shoulder, elbow. Did "
      "you mean 'elbow'?");
}

TEST_F(ElementLookup, TriesKindsInOrder) {
  const RobotRecord& robot = compiled->robot("two");
  const ElementId flange = FindElement(model, robot, {.name = "flange"}, {mjOBJ_BODY, mjOBJ_SITE});
  EXPECT_EQ(flange.kind, mjOBJ_SITE);
  EXPECT_EQ(flange.id, FindId(model, mjOBJ_SITE, "l_flange"));
  ExpectThrow<NotFoundError>(
      [&] {
        FindElement(model, robot, {.name = "flnge"}, {mjOBJ_SITE, mjOBJ_BODY});
      },
      "robot 'two': no site or body 'flnge'.");
}

TEST_F(ElementLookup, CountsUnnamedElementsOfABody) {
  const RobotRecord& robot = compiled->robot("two");
  const ElementId geom = FindElement(
      model, robot, {.kind = ElementKind::kGeom, .body = "fore", .index = 0}, {mjOBJ_GEOM});
  EXPECT_EQ(model->geom_bodyid[geom.id], FindId(model, mjOBJ_BODY, "l_fore"));
  ExpectThrow<NotFoundError>(
      [&] {
        FindElement(model, robot, {.kind = ElementKind::kSite, .body = "base", .index = 0},
                    {mjOBJ_SITE});
      },
      "robot 'two': body 'base' has 0 site(s), so there is none with index 0 (they count from 0)");
}

TEST_F(ElementLookup, ExplainsReferencesToUnnamedElements) {
  const RobotRecord& robot = compiled->robot("two");
  ExpectThrow<NotFoundError>([&] { FindElement(model, robot, mjOBJ_GEOM, "foo"); },
                             "robot 'two': no geom 'foo'. Its geoms: (none). 3 have no name; write "
                             "for example {geom: {body: 'base', index: 0}}");
  ExpectThrow<NotFoundError>([&] { FindElement(model, robot, {.name = "foo"}, {mjOBJ_GEOM}); },
                             "3 have no name; write for example {geom: {body: 'base', index: 0}}");
}

TEST_F(ElementLookup, CountsTheChildrenOfABody) {
  const RobotRecord& robot = compiled->robot("two");
  const ElementId upper =
      FindElement(model, robot, {.kind = ElementKind::kBody, .body = "base"}, {mjOBJ_BODY});
  EXPECT_EQ(upper.id, FindId(model, mjOBJ_BODY, "l_upper"));
  ExpectThrow<NotFoundError>(
      [&] {
        FindElement(model, robot, {.kind = ElementKind::kBody, .body = "fore"}, {mjOBJ_BODY});
      },
      "robot 'two': body 'fore' has 0 body(s), so there is none with index 0");
}

TEST_F(ElementLookup, RejectsUnexpectedKinds) {
  const RobotRecord& robot = compiled->robot("two");
  ExpectThrow<NotFoundError>(
      [&] {
        FindElement(model, robot, {.kind = ElementKind::kJoint, .name = "elbow"},
                    {mjOBJ_SITE, mjOBJ_BODY});
      },
      "robot 'two': joint 'elbow' is given; a site or body is wanted here");
  ExpectThrow<NotFoundError>(
      [&] {
        FindElement(model, robot, {.body = "fore"}, {mjOBJ_GEOM, mjOBJ_BODY});
      },
      "robot 'two': element 0 of body 'fore': of which kind? Write for example {geom: {body: fore, "
      "index: 0}}");
}

}  // namespace
}  // namespace robocell::internal
