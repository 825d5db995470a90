// Tests the problems of URDFs as a whole, and that their advice works when it is followed to the
// letter.
#include "robocell/assets/urdf_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/assets/testing/urdf_file.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using UrdfChecks = UrdfFile;

TEST_F(UrdfChecks, CyclicMimic) {
  const std::string a = "<mimic joint=\"b\"/>", b = "<mimic joint=\"turn\"/>";
  const std::string message = Bad({.inside = a, .rest = Next("b", b)}, 4,
                                  "the mimic joints turn, b follow each other in a circle");
  EXPECT_THAT(message, HasSubstr("Remove the <mimic> of one of them"));
  EXPECT_NO_THROW(Read({.inside = a, .rest = Next("b", "")}));
  Bad({.inside = "<mimic joint=\"turn\"/>"}, 4, "in a circle");
}

TEST_F(UrdfChecks, MimicOfAnUnknownJoint) {
  const std::string message = Bad({.rest = Next("b", "<mimic joint=\"trun\" multiplier=\"-2\"/>")},
                                  5, "joint 'b': mimic: no joint 'trun'");
  EXPECT_THAT(message, HasSubstr("Did you mean 'turn'?"));
  const Urdf urdf = Read({.rest = Next("b", "<mimic joint=\"turn\" multiplier=\"-2\"/>")});
  EXPECT_EQ(urdf.joint("b")->mimic->multiplier, -2);
}

TEST_F(UrdfChecks, MovingLinksWithoutMass) {
  const std::string message =
      Bad({.upper = ""}, 3, "link 'upper' moves with joint 'turn' and has no mass");
  EXPECT_NO_THROW(Read({.upper = Between(message, "<inertial>", "</inertial>")}));
  const Urdf water =
      Read({.upper = "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>"});
  EXPECT_THAT(water.notes, ElementsAre(HasSubstr("its mass is that of its collision geometry in "
                                                 "water")));
}

TEST_F(UrdfChecks, ImpossibleInertias) {
  const auto inertia = [](const std::string& zz) {
    return "<inertial><mass value=\"2\"/><inertia ixx=\"" + zz + "\" ixy=\"0\" ixz=\"0\" iyy=\"" +
           zz + "\" iyz=\"0\" izz=\"" + (zz == "0" ? "0" : "1") + "\"/></inertial>";
  };
  const std::string uneven = Bad({.upper = inertia("0.1")}, 3, "no body has such an inertia");
  EXPECT_NO_THROW(
      Read({.upper = inertia("0.1"), .head = Between(uneven, "<mujoco>", "</mujoco>")}));
  const std::string none = Bad({.upper = inertia("0")}, 3, "link 'upper': 2 kg without inertia");
  EXPECT_NO_THROW(Read({.upper = "<inertial><mass value=\"2\"/>" +
                                 Between(none, "<inertia ", "/>") + "</inertial>"}));
}

TEST_F(UrdfChecks, FixedLinksMayBePointMasses) {
  EXPECT_NO_THROW(Read({.rest = "<link name=\"tip\"><inertial><mass value=\"1e-9\"/></inertial>"
                                "</link><joint name=\"f\" type=\"fixed\"><parent link=\"upper\"/>"
                                "<child link=\"tip\"/><mimic joint=\"turn\"/></joint>"}));
}

TEST_F(UrdfChecks, PlanarAndFloatingJoints) {
  for (const std::string type : {"planar", "floating"}) {
    // The parent has a shape, so that the joint cannot be that of the whole robot.
    const std::string shape = "<visual><geometry><sphere radius=\"1\"/></geometry></visual>";
    Text text{.rest = "<link name=\"top\">" + shape +
                      "</link><joint name=\"t\" type=\"fixed\"><parent link=\"top\"/><child "
                      "link=\"base\"/></joint>"};
    text.type = type;
    EXPECT_THAT(Bad(text, 4, "joint 'turn': type=\"" + type), HasSubstr("rite type=\"fixed\""));
    text.type = "fixed";
    EXPECT_NO_THROW(Read(text));
  }
  EXPECT_EQ(Read({.type = "floating"}).joints[0].type, UrdfJointType::kFloating)
      << "below a root without shape it is the free joint of the robot";
}

TEST_F(UrdfChecks, SeveralRoots) {
  const std::string message =
      Bad({.rest = "<link name=\"other\"/>"}, 5, "2 links without a parent: base, other");
  EXPECT_NO_THROW(
      Read({.rest = "<link name=\"other\"/>" + Between(message, "<joint ", "</joint>")}));
}

TEST_F(UrdfChecks, UnknownLinks) {
  EXPECT_THAT(Bad({.child = "uper"}, 4, "joint 'turn': no link 'uper'"),
              HasSubstr("Did you mean 'upper'?"));
}

TEST_F(UrdfChecks, RepeatedNames) {
  Bad({.rest = "<link name=\"base\"/>"}, 5, "link 'base' is defined twice, first in line 2");
}

TEST_F(UrdfChecks, CirclesOfLinks) {
  const std::string circle =
      "<link name=\"a\"/><link name=\"b\"/><joint name=\"x\" type=\"fixed\"><parent "
      "link=\"a\"/><child link=\"b\"/></joint><joint name=\"y\" type=\"fixed\"><parent "
      "link=\"b\"/><child link=\"a\"/></joint>";
  Bad({.rest = circle}, 5, "in a circle of joints. Remove the joint that closes it");
}

}  // namespace
}  // namespace robocell::internal
