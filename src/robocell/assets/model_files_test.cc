#include "robocell/assets/model_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <set>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::Pair;

std::vector<std::string> Names(const fs::path& model) {
  std::vector<std::string> names;
  for (const auto& [name, path] : ModelFiles(model)) names.push_back(name);
  return names;
}

TEST(ModelFiles, IncludesMeshesAndTexturesAreFoundWithTheirFolders) {
  TempDir temp;
  const fs::path folder = temp / "arm";
  fs::create_directories(folder / "meshes");
  fs::create_directories(folder / "parts");
  AtomicWrite(folder / "arm.xml",
              "<mujoco><compiler meshdir = 'meshes' texturedir=\"skins\"/>\n"
              "<include\n file=\"parts/hand.xml\"/><asset><mesh file='a.stl'/></asset></mujoco>");
  AtomicWrite(folder / "parts/hand.xml",
              "<mujoco><mesh file=\"somewhere/b.stl\"/><texture fileright='none.png'/></mujoco>");
  AtomicWrite(folder / "meshes/a.stl", "a");
  AtomicWrite(folder / "meshes/b.stl", "b");
  AtomicWrite(folder / "meshes/unused.stl", "c");
  EXPECT_THAT(Names(folder / "arm.xml"), ElementsAre("arm/arm.xml", "arm/meshes/a.stl",
                                                     "arm/meshes/b.stl", "arm/parts/hand.xml"));
}

// They are copied into datasets: what only a comment names stays where it is.
TEST(ModelFiles, FilesInCommentsAreNone) {
  TempDir temp;
  AtomicWrite(temp / "secret", "");
  AtomicWrite(temp / "a.xml", "<mujoco><!-- <mesh file='secret'/> --></mujoco><!-- file='secret'");
  EXPECT_EQ(Names(temp / "a.xml").size(), 1u);
}

TEST(ModelFiles, ModelsThatIncludeEachOtherEnd) {
  TempDir temp;
  AtomicWrite(temp / "a.xml", "<mujoco><include file='b.xml'/></mujoco>");
  AtomicWrite(temp / "b.xml", "<mujoco><include file='a.xml'/></mujoco>");
  EXPECT_EQ(Names(temp / "a.xml").size(), 2u);
}

TEST(ModelFiles, AMissingModelIsNamed) {
  ExpectThrow<IoError>([] { ModelFiles("/no/such.xml"); }, "/no/such.xml");
}

// The engine is the oracle: whatever mesh it opens is in the list.
TEST(ModelFiles, AreAllThatTheEngineOpens) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const fs::path model = MenagerieModel("ufactory_xarm7", "xarm7.xml");
  mjSpec* spec = mj_parseXML(model.c_str(), nullptr, nullptr, 0);
  ASSERT_NE(spec, nullptr);
  std::set<std::string> meshes;
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_MESH); e; e = mjs_nextElement(spec, e))
    meshes.insert(fs::path(mjs_getString(mjs_asMesh(e)->file)).filename());
  mj_deleteSpec(spec);
  std::set<std::string> found;
  for (const auto& [name, path] : ModelFiles(model)) found.insert(path.filename());
  EXPECT_GT(meshes.size(), 5u);
  EXPECT_THAT(found, IsSupersetOf(meshes));
}

}  // namespace
}  // namespace robocell
