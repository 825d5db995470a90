// Tests what is read from URDFs, and that the advice of every error works when it is followed to
// the letter.
#include "robocell/assets/urdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "robocell/assets/testing/urdf_file.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using UrdfFileTest = UrdfFile;

TEST_F(UrdfFileTest, ReadsLinksJointsAndLimits) {
  const Urdf urdf = Read({.inside = "<dynamics damping=\"0.5\" friction=\"0.25\"/>"});
  EXPECT_EQ(urdf.name, "arm");
  EXPECT_EQ(urdf.root, "base");
  ASSERT_EQ(urdf.joints.size(), 1u);
  const UrdfJoint& joint = urdf.joints[0];
  EXPECT_EQ(joint.type, UrdfJointType::kRevolute);
  EXPECT_THAT(*joint.range, ElementsAre(-1, 2));
  EXPECT_EQ(joint.effort, 5);
  EXPECT_EQ(joint.velocity, 3);
  EXPECT_EQ(joint.damping, 0.5);
  EXPECT_EQ(joint.friction, 0.25);
  EXPECT_EQ(joint.line, 4);
  EXPECT_THAT(urdf.notes, IsEmpty());
}

TEST_F(UrdfFileTest, ReadsContinuousJointsWithoutTheirRange) {
  EXPECT_FALSE(Read({.type = "continuous"}).joints[0].range);
}

TEST_F(UrdfFileTest, ReadsMaterialsByName) {
  const std::string shape = "<visual><geometry><sphere radius=\"0.1\"/></geometry>";
  const Urdf urdf = Read({.upper = kMass + shape + "<material name=\"red\"/></visual>",
                          .head = "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material>"});
  EXPECT_THAT(*urdf.link("upper")->geometry.at(0).rgba, ElementsAre(1, 0, 0, 1));
}

TEST_F(UrdfFileTest, MissingMesh) {
  const std::string message = Bad({.upper = kMass + Mesh("../meshes/upper.obj")}, 3,
                                  "link 'upper': there is no mesh file '");
  WriteMesh(root_ / "arm_description/meshes/upper.obj");  // "Put it there"
  EXPECT_THAT(message, HasSubstr((root_ / "arm_description/meshes/upper.obj").string()));
  EXPECT_EQ(Read({.upper = kMass + Mesh("../meshes/upper.obj")}).links[1].geometry[0].mesh,
            root_ / "arm_description/meshes/upper.obj");
  EXPECT_THAT(Bad({.upper = kMass + Mesh("../meshes/uper.obj")}, 3, "no mesh file"),
              HasSubstr("Did you mean 'upper.obj'?"));
}

TEST_F(UrdfFileTest, ColladaMeshes) {
  const fs::path meshes = file_.parent_path().parent_path() / "meshes";
  WriteMesh(meshes / "visual/upper.dae");
  WriteMesh(meshes / "lower.dae");
  const Text text{.upper =
                      kMass + Mesh("../meshes/visual/upper.dae") + Mesh("../meshes/lower.dae")};
  const std::string message =
      Bad(text, 3, "2 mesh files in Collada (.dae) cannot be read: lower.dae, upper.dae");
  EXPECT_THAT(message, HasSubstr("pathlib.Path('" + meshes.string() + "').rglob('*.dae')"));
  WriteMesh(meshes / "visual/upper.obj");
  WriteMesh(meshes / "lower.obj");
  EXPECT_EQ(Read(text).links[1].geometry[0].mesh, meshes / "visual/upper.obj");
}

TEST_F(UrdfFileTest, Xacro) {
  EXPECT_THAT(Bad({.rest = "<xacro:include filename=\"x.xacro\"/>"}, 5, "<xacro:include> belongs"),
              HasSubstr("xacro " + file_.string() + " > "));
  Bad({.rest = "<link name=\"${prefix}tool\"/>"}, 5, "name=\"${prefix}tool\" belongs to xacro");
}

TEST_F(UrdfFileTest, UnknownTypeOfJoint) {
  EXPECT_THAT(Bad({.type = "revolut"}, 4, "unknown type 'revolut'"),
              HasSubstr("Did you mean 'revolute'?"));
}

TEST_F(UrdfFileTest, TextsThatAreNoNumbers) {
  Bad({.inside = "<origin xyz=\"0 0\"/>"}, 4,
      "joint 'turn': xyz=\"0 0\" of <origin> is not 3 finite numbers");
  Bad({.inside = "<origin rpy=\"0 nan 0\"/>"}, 4, "is not 3 finite numbers");
  Bad({.inside = "<dynamics damping=\"0,5\"/>"}, 4,
      "damping=\"0,5\" of <dynamics> is not 1 finite");
}

TEST_F(UrdfFileTest, ReportsAllProblemsTogether) {
  const std::string message =
      Bad({.upper = Mesh("a.obj"), .type = "planar"}, 3, "type=\"planar\" is not read");
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
}

TEST_F(UrdfFileTest, TextThatIsNotXml) {
  fs::create_directories(file_.parent_path());
  AtomicWrite(file_, "<robot>\n<link></robot>");
  ExpectThrow<SpecError>([&] { ReadUrdf(file_); }, "arm.urdf:2: not an XML file");
}

TEST_F(UrdfFileTest, RevoluteJointsWithoutARangeAreUnlimited) {
  const Urdf urdf = Read({.rest = "<link name=\"w\">" + std::string(kMass) +
                                  "</link><joint name=\"w\" type=\"revolute\"><parent "
                                  "link=\"base\"/><child link=\"w\"/></joint>"});
  EXPECT_FALSE(urdf.joint("w")->range);
  EXPECT_THAT(urdf.notes, ElementsAre(HasSubstr(":5: joint 'w' has no range")));
}

}  // namespace
}  // namespace robocell::internal
