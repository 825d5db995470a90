#include "robocell/assets/model_files.h"

#include <sys/stat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <map>
#include <set>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

void Write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  AtomicWrite(path, text);
}

std::string MeshModel(const std::string& file, const std::string& compiler = "") {
  return "<mujoco>" + compiler + "<asset><mesh name='s' file='" + file +
         "'/></asset><worldbody><geom type='mesh' mesh='s'/></worldbody></mujoco>";
}

// Returns names within the folder of the model.
std::vector<std::string> Names(const fs::path& model) {
  std::vector<std::string> names;
  for (const fs::path& file : FindModelFiles(model).files)
    names.push_back(file.lexically_relative(model.parent_path()).generic_string());
  return names;
}

std::vector<std::string> Missing(const fs::path& model) {
  std::vector<std::string> names;
  for (const MissingFile& each : FindModelFiles(model).missing) names.push_back(each.name);
  return names;
}

// Returns "" if the engine compiles it.
std::string EngineError(const fs::path& model) {
  char error[1000] = "";
  mjModel* compiled = mj_loadXML(model.c_str(), nullptr, error, sizeof error);
  if (!compiled) return error;
  mj_deleteModel(compiled);
  return "";
}

TEST(ModelFiles, IncludesMeshesAndTexturesAreFoundWithTheirFolders) {
  TempDir temp;
  Write(temp / "arm/arm.xml",
        "<mujoco><compiler meshdir = 'meshes' texturedir=\"skins\" strippath='true'/>\n"
        "<include\n file=\"parts/hand.xml\"/><asset><mesh file='a.stl'/></asset></mujoco>");
  Write(temp / "arm/parts/hand.xml",
        "<mujoco><mesh file=\"somewhere/b.stl\"/><texture fileright='none.png'/></mujoco>");
  for (const char* name : {"a.stl", "b.stl", "unused.stl"}) Write(temp / "arm/meshes" / name, name);
  EXPECT_THAT(Names(temp / "arm/arm.xml"),
              ElementsAre("arm.xml", "meshes/a.stl", "meshes/b.stl", "parts/hand.xml"));
  EXPECT_THAT(Missing(temp / "arm/arm.xml"), ElementsAre("none.png"));
}

// The engine would open them and wait.
TEST(ModelFiles, RejectsPipesAndDevices) {
  TempDir temp;
  const fs::path arm = temp / "arm/arm.xml";
  const auto expect_refused = [&](const std::string& text, const std::string& message) {
    Write(arm, text);
    EXPECT_THAT(ExpectThrow<SpecError>([&] { RequireOnlyFiles(arm); }, "model file '"),
                HasSubstr(message));
  };
  fs::create_directories(temp / "arm/meshes");
  ASSERT_EQ(mkfifo((temp / "arm/hand.xml").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((temp / "arm/meshes/a.obj").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", temp / "arm/zero.png");
  expect_refused("<mujoco><include file='hand.xml'/></mujoco>",
                 "arm.xml' names the file 'hand.xml', and '" + (temp / "arm/hand.xml").string() +
                     "' is a pipe, not a file. Write its content to a file first");
  expect_refused(MeshModel("a.obj", "<compiler meshdir='meshes'/>"), "meshes/a.obj' is a pipe");
  expect_refused("<mujoco><asset><texture type='2d' file='zero.png'/></asset></mujoco>",
                 "zero.png' is a link to '/dev/zero', not a file");
  expect_refused("<mujoco><asset><model file='hand.xml'/></asset></mujoco>", "is a pipe");
  Write(temp / "arm/part.xml", "<mujoco><include file='hand.xml'/></mujoco>");
  expect_refused("<mujoco><include file='part.xml'/></mujoco>", "part.xml' names the file 'hand");
  Write(arm, "<mujoco><include file='gone.xml'/></mujoco>");  // the engine's message is better
  EXPECT_NO_THROW(RequireOnlyFiles(arm));
  EXPECT_NO_THROW(RequireOnlyFiles(temp / "none.xml"));
}

// robocell must find the mesh where the engine alone finds it.
TEST(ModelFiles, AreFoundWhereTheEngineFindsThem) {
  const std::string includes = "<mujoco><include file='a.xml'/><include file='b.xml'/></mujoco>";
  const std::string folder = "<mujoco><compiler meshdir='meshes'/></mujoco>";
  const auto expect_found = [](const std::map<std::string, std::string>& texts,
                               const std::string& mesh) {
    TempDir temp;
    for (const auto& [name, text] : texts) Write(temp / name, text);
    Write(temp / mesh, kTetrahedron);
    EXPECT_EQ(EngineError(temp / "main.xml"), "") << mesh;
    EXPECT_THAT(Names(temp / "main.xml"), ::testing::Contains(mesh));
    EXPECT_THAT(Missing(temp / "main.xml"), IsEmpty());
  };
  // The asset folder is set after the names, and in another file.
  expect_found({{"main.xml", includes}, {"a.xml", MeshModel("s.obj")}, {"b.xml", folder}},
               "meshes/s.obj");
  expect_found({{"main.xml", "<mujoco><include file='in/a.xml'/></mujoco>"},
                {"in/a.xml", "<mujoco><include file='deep/b.xml'/></mujoco>"},
                {"in/deep/b.xml", MeshModel("s.obj")}},
               "in/deep/s.obj");
  expect_found(
      {{"main.xml", MeshModel("s.obj", "<compiler assetdir='x'/><compiler meshdir='y'/>")}},
      "y/s.obj");
  expect_found({{"main.xml", MeshModel("/none/s.obj", "<compiler strippath='true'/>")}}, "s.obj");
  expect_found({{"main.xml", MeshModel("x\\s.obj", "<compiler meshdir='m'/>")}}, "m/x/s.obj");
  // Names are XML: with entities, and comments that are not comments.
  expect_found({{"main.xml", MeshModel("&#115;.obj")}}, "s.obj");
  expect_found({{"main.xml",
                 "<mujoco model='&lt;!--'><compiler meshdir='m'/>" + MeshModel("s.obj").substr(8)}},
               "m/s.obj");
  expect_found({{"main.xml", "<mujoco model='<!--'>" + MeshModel("s.obj").substr(8)}}, "s.obj");
  expect_found({{"main.xml", "<mujoco><include file='part.txt'/></mujoco>"},
                {"part.txt", MeshModel("s.obj")}},
               "s.obj");
  // Models within models have asset folders of their own.
  expect_found({{"main.xml",
                 "<mujoco><compiler meshdir='m'/><asset><model name='c' file='sub/c.xml'/></asset>"
                 "<worldbody><frame><attach model='c' body='b' prefix='c_'/></frame></worldbody>"
                 "</mujoco>"},
                {"sub/c.xml",
                 "<mujoco><compiler meshdir='own'/><asset><mesh name='s' file='s.obj'/></asset>"
                 "<worldbody><body name='b'><geom type='mesh' mesh='s'/></body></worldbody>"
                 "</mujoco>"}},
               "sub/own/s.obj");
}

// The files are copied into datasets: a file that only a comment names stays where it is.
TEST(ModelFiles, IgnoresFilesInComments) {
  TempDir temp;
  AtomicWrite(temp / "secret", "");
  AtomicWrite(temp / "a.xml",
              "<mujoco><!-- <mesh file='secret'/> --></mujoco><!-- file='secret' -->");
  EXPECT_THAT(Names(temp / "a.xml"), ElementsAre("a.xml"));
}

TEST(ModelFiles, CyclicIncludesTerminate) {
  TempDir temp;
  AtomicWrite(temp / "a.xml", "<mujoco><include file='b.xml'/></mujoco>");
  AtomicWrite(temp / "b.xml", "<mujoco><include file='a.xml'/><model file='a.xml'/></mujoco>");
  EXPECT_EQ(Names(temp / "a.xml").size(), 2u);
}

TEST(ModelFiles, NamesMissingAndUnreadableFiles) {
  ExpectThrow<IoError>([] { FindModelFiles("/no/such.xml"); }, "/no/such.xml");
  TempDir temp;
  AtomicWrite(temp / "bad.xml", "<mujoco><mesh file='../s.obj'");
  AtomicWrite(temp / "a.xml",
              "<mujoco><include file='bad.xml'/><mesh file='../no.obj'/>"
              "<include file='LoadModelFromString:x'/></mujoco>");
  EXPECT_THAT(Missing(temp / "a.xml"), ElementsAre("", "LoadModelFromString:x", "../no.obj"));
  EXPECT_THAT(FindModelFiles(temp / "a.xml").missing[0].reason, Not(IsEmpty()));
}

// ---- oracle: the files that the engine's own reader finds --------------------------------------

std::string Folder(const mjSpec* spec, bool textures) {
  return mjs_getString(textures ? spec->compiler.texturedir : spec->compiler.meshdir);
}

// Adds a file as the compiled spec names it, in its asset folder.
void Add(const mjSpec* spec, const std::string& folder, std::string file,
         std::set<fs::path>& files) {
  if (file.empty()) return;
  if (spec->strippath) file = fs::path(file).filename().string();
  const fs::path root = mjs_getString(spec->modelfiledir);
  const fs::path path = (root / folder / file).lexically_normal();
  files.insert(fs::exists(path) ? path : (root / file).lexically_normal());
}

std::set<fs::path> AssetsOfSpec(const fs::path& model) {
  mjSpec* spec = mj_parseXML(model.c_str(), nullptr, nullptr, 0);
  std::set<fs::path> files;
  if (!spec) return files;
  const auto each = [&](mjtObj type, auto&& f) {
    for (mjsElement* e = mjs_firstElement(spec, type); e; e = mjs_nextElement(spec, e)) f(e);
  };
  const std::string meshes = Folder(spec, false), textures = Folder(spec, true);
  each(mjOBJ_MESH,
       [&](mjsElement* e) { Add(spec, meshes, mjs_getString(mjs_asMesh(e)->file), files); });
  each(mjOBJ_HFIELD,
       [&](mjsElement* e) { Add(spec, meshes, mjs_getString(mjs_asHField(e)->file), files); });
  each(mjOBJ_SKIN,
       [&](mjsElement* e) { Add(spec, meshes, mjs_getString(mjs_asSkin(e)->file), files); });
  each(mjOBJ_TEXTURE,
       [&](mjsElement* e) { Add(spec, textures, mjs_getString(mjs_asTexture(e)->file), files); });
  mj_deleteSpec(spec);
  return files;
}

// Checks all models in the folder that the engine reads by themselves; returns their number of
// assets.
size_t ExpectTheSpecsAssets(const fs::path& folder) {
  size_t assets = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".xml") continue;
    const std::set<fs::path> expected = AssetsOfSpec(entry.path());
    std::set<fs::path> found;
    for (const fs::path& file : FindModelFiles(entry.path()).files) {
      if (file.extension() != ".xml") found.insert(file);
    }
    assets += expected.size();
    if (expected.empty()) continue;
    EXPECT_EQ(found, expected) << entry.path();
  }
  return assets;
}

TEST(ModelFiles, MatchTheAssetsOfShippedModels) {
  ExpectTheSpecsAssets(fs::path(SourceDir()) / "models");
}

TEST(ModelFiles, MatchTheAssetsOfTheMenagerie) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  EXPECT_GT(ExpectTheSpecsAssets(fs::path(MenagerieModel("ufactory_xarm7")).parent_path()), 20u);
}

}  // namespace
}  // namespace robocell::internal
