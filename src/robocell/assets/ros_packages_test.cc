// Tests where the meshes of URDFs are found, and that the advice of errors works when it is followed
// to the letter.
#include "robocell/assets/ros_packages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/assets/model_files.h"
#include "robocell/assets/testing/urdf_file.h"
#include "robocell/testing/scoped_env.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using RosPackagesOfUrdf = UrdfFile;

TEST_F(RosPackagesOfUrdf, UnknownPackage) {
  const Text text{.upper = kMass + Mesh("package://arm_meshes/upper.obj")};
  const fs::path package = root_ / "far/away/meshes";
  WriteMesh(package / "upper.obj");
  const std::string message = Bad(text, 3, "no package 'arm_meshes' for 'package://arm_meshes/");
  EXPECT_THAT(message,
              AllOf(HasSubstr("export ROBOCELL_PACKAGES=arm_meshes=FOLDER"),
                    HasSubstr("--package arm_meshes=FOLDER"), HasSubstr("ROS_PACKAGE_PATH")));
  {
    const ScopedEnv other("ROBOCELL_PACKAGES", "arm_mesh=" + package.string());
    EXPECT_THAT(Bad(text, 3, "given: arm_mesh"), HasSubstr("Did you mean 'arm_mesh'?"));
  }
  {
    const ScopedEnv given("ROBOCELL_PACKAGES", "arm_meshes=" + package.string());
    EXPECT_EQ(Read(text).links[1].geometry[0].mesh, package / "upper.obj");
  }
  fs::rename(package, root_ / "far/away/arm_meshes");
  const ScopedEnv path("ROS_PACKAGE_PATH", (root_ / "far/away").string());
  EXPECT_EQ(Read(text).links[1].geometry[0].mesh, root_ / "far/away/arm_meshes/upper.obj");
}

TEST_F(RosPackagesOfUrdf, FindsItsOwnPackageAndItsNeighbours) {
  WriteMesh(root_ / "arm_description/meshes/upper.obj");
  const Text text{.upper = kMass + Mesh("package://arm_description/meshes/upper.obj")};
  EXPECT_EQ(Read(text).links[1].geometry[0].mesh, root_ / "arm_description/meshes/upper.obj");
  WriteMesh(root_ / "gripper/upper.obj");
  EXPECT_EQ(Read({.upper = kMass + Mesh("package://gripper/upper.obj")}).links[1].geometry[0].mesh,
            root_ / "gripper/upper.obj");
}

TEST_F(RosPackagesOfUrdf, FindsAPackageByItsManifest) {
  WriteMesh(root_ / "src/checkout/meshes/upper.obj");
  AtomicWrite(root_ / "src/checkout/package.xml", "<package><name>named</name></package>");
  const ScopedEnv path("ROS_PACKAGE_PATH", (root_ / "src").string());
  const Text text{.upper = kMass + Mesh("package://named/meshes/upper.obj")};
  EXPECT_EQ(Read(text).links[1].geometry[0].mesh, root_ / "src/checkout/meshes/upper.obj");
  EXPECT_THAT(FindModelFiles(file_).files,
              ElementsAre(file_, root_ / "src/checkout/meshes/upper.obj",
                          root_ / "src/checkout/package.xml"))
      << "a copy finds the same";
}

TEST_F(RosPackagesOfUrdf, MeshesOutsideOfTheirRoots) {
  WriteMesh(root_ / "secret.obj");
  WriteMesh(root_ / "arm_description/secret.obj");
  const std::string out = "package://arm_description/../secret.obj";
  const std::string message = Bad({.upper = kMass + Mesh(out)}, 3, "' leads out of '");
  EXPECT_THAT(message, HasSubstr("put the file there"));
  EXPECT_NO_THROW(Read({.upper = kMass + Mesh("package://arm_description/secret.obj")}));
  const std::string secret = (root_ / "secret.obj").string();
  for (const std::string& name : {std::string("../../secret.obj"), secret, "file://" + secret}) {
    const std::string absolute =
        Bad({.upper = kMass + Mesh(name)}, 3, "' is outside the URDF's folders");
    EXPECT_THAT(absolute, HasSubstr("export ROBOCELL_PACKAGES=NAME=" + root_.string()));
    const ScopedEnv given("ROBOCELL_PACKAGES", "NAME=" + root_.string());
    EXPECT_NO_THROW(Read({.upper = kMass + Mesh(name)}));
    EXPECT_NO_THROW(Read({.upper = kMass + Mesh("package://NAME/secret.obj")}));
  }
}

// A dataset keeps the files that were read in this form.
TEST_F(RosPackagesOfUrdf, ACopyOfTheFilesInAnotherFolder) {
  WriteMesh(root_ / "arm_description/meshes/upper.obj");
  EXPECT_EQ(Read({.upper = kMass + Mesh("package://elsewhere/meshes/upper.dae")})
                .links[1]
                .geometry[0]
                .mesh,
            root_ / "arm_description/meshes/upper.obj");
}

TEST_F(RosPackagesOfUrdf, LinksThatLeadOut) {
  WriteMesh(root_ / "secret.obj");
  fs::create_directories(file_.parent_path());
  fs::create_symlink(root_ / "secret.obj", file_.parent_path() / "mesh.obj");
  Bad({.upper = kMass + Mesh("mesh.obj")}, 3, "leads out of");
}

TEST(ParsePackage, RejectsOtherTexts) {
  for (const char* text : {"arm", "=folder", "a/b=folder", "arm="})
    ExpectThrow<ArgumentError>([&] { ParsePackage(text); }, "arm_description=../arm_description");
  ExpectThrow<ArgumentError>([] { ParsePackage("arm=/no/such"); }, "there is no folder '/no/such'");
}

}  // namespace
}  // namespace robocell::internal
