#include "robocell/scene/scene_cache.h"

#include <sys/stat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <typeinfo>

#include "robocell/assets/resolve.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/compile.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/as_nobody.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

SceneSpec RichScene() {
  SceneSpec spec = EmptyScene();
  const RobotConfig rc7 = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
  spec.robots.push_back({.config = rc7, .prefix = "left/"});
  spec.robots.push_back({.config = rc7, .prefix = "right/", .pos = {0, 1, 0}});
  spec.objects.push_back(
      {.name = "mug", .mjcf_path = "mug", .pos = Vec3{0.5, 0, 0.2}, .fixed = false});
  spec.objects.push_back(BoxObject("cube", {0.4, 0.1, 0.1}));
  return spec;
}

std::vector<fs::path> Entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  return entries;
}

ino_t Inode(const fs::path& file) {
  struct stat status = {};
  EXPECT_EQ(stat(file.c_str(), &status), 0);
  return status.st_ino;
}

TEST(SceneCache, ACachedSceneEqualsTheCompiledOneBitwise) {
  const TempDir folder;
  const SceneSpec spec = RichScene();
  const auto compiled = CompileScene(spec);
  EXPECT_EQ(SaveBinaryString(CompileSceneCached(spec, folder.path())->model()),
            SaveBinaryString(compiled->model()));
  ASSERT_EQ(Entries(folder.path()).size(), 1);
  const ino_t written = Inode(Entries(folder.path())[0]);

  const auto read = CompileSceneCached(spec, folder.path());
  EXPECT_EQ(Inode(Entries(folder.path())[0]), written) << "it was written again, not read";
  EXPECT_EQ(SaveBinaryString(read->model()), SaveBinaryString(compiled->model()));
  EXPECT_EQ(read->warnings(), compiled->warnings());
  EXPECT_EQ(read->notes(), compiled->notes());
  EXPECT_EQ(read->home_key(), compiled->home_key());
  EXPECT_NE(read->generation(), compiled->generation());
}

TEST(SceneCache, RecordsRoundTrip) {
  const TempDir folder;
  SceneSpec spec = RichScene();
  spec.robots[1].config->base.kind = BaseKind::kMocap;
  spec.robots[1].config->base.size = Vec3{0.2, 0.2, 0.3};
  const auto compiled = CompileSceneCached(spec, folder.path());
  const auto read = CompileSceneCached(spec, folder.path());
  ASSERT_EQ(read->robots().size(), 2);
  for (size_t i = 0; i < 2; ++i) {
    const RobotRecord &a = compiled->robots()[i], &b = read->robots()[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.prefix, b.prefix);
    EXPECT_EQ(a.config.source_dir, b.config.source_dir);
    EXPECT_EQ(ToYaml(a.config), ToYaml(b.config));
    EXPECT_EQ(a.base.kind, b.base.kind);
    EXPECT_EQ(a.top_body, b.top_body);
    EXPECT_EQ(a.root_body, b.root_body);
    EXPECT_EQ(a.mocap_body, b.mocap_body);
    EXPECT_EQ(a.pedestal_height, b.pedestal_height);
    EXPECT_EQ(a.attachment_site, b.attachment_site);
    EXPECT_EQ(a.tcp_site, b.tcp_site);
    EXPECT_EQ(a.base_body, b.base_body);
  }
  EXPECT_EQ(read->robots()[1].pedestal_height, 0.3);
  EXPECT_EQ(read->object("mug").root_body, compiled->object("mug").root_body);
  EXPECT_EQ(read->object("mug").free_joint, compiled->object("mug").free_joint);
}

TEST(SceneCache, CameraHousingsArePartOfTheKey) {
  ModelFolder here, there;
  const auto housing = [](double size) {
    return "<worldbody><body><geom size=\"" + std::to_string(size) +
           "\"/><camera/></body></worldbody>";
  };
  const auto key = [](const std::string& model, bool of_robot) {
    SceneSpec spec = RichScene();
    List<CameraSpec>& cameras = of_robot ? spec.robots[0].config->cameras : spec.cameras;
    cameras.push_back({.name = "eye", .mjcf_path = model});
    return SceneKey(spec);
  };
  for (const bool of_robot : {false, true}) {
    const std::string small = key(here.Write("housing", housing(0.1)), of_robot);
    EXPECT_EQ(key(there.Write("housing", housing(0.1)), of_robot), small);
    EXPECT_NE(key(here.Write("housing", housing(0.2)), of_robot), small);
  }
}

TEST(SceneCache, ACachedSceneBehavesLikeACompiledOne) {
  const TempDir folder;
  const SceneSpec spec = RichScene();
  Scene compiled = Scene::Build(spec);
  CompileSceneCached(spec, folder.path());
  Scene read = Scene::FromCompiled(CompileSceneCached(spec, folder.path()));
  for (Scene* scene : {&compiled, &read}) {
    scene->Reset({.seed = 3});
    EXPECT_TRUE(scene->StepN(200).ok());
  }
  EXPECT_EQ(read.state(), compiled.state());
  EXPECT_EQ(read.ToXml(), compiled.ToXml());
}

TEST(SceneCache, TheKeyDependsOnContentsAndNotOnPaths) {
  ModelFolder here, there;
  const auto scene = [](const std::string& file) {
    SceneSpec spec = EmptyScene();
    spec.objects.push_back({.name = "thing", .mjcf_path = file, .fixed = true});
    return spec;
  };
  const std::string one = "<worldbody><body name='b'><geom size='.1'/></body></worldbody>";
  const std::string two = "<worldbody><body name='b'><geom size='.2'/></body></worldbody>";
  const std::string key = SceneKey(scene(here.Write("thing", one)));
  EXPECT_EQ(key, SceneKey(scene(there.Write("thing", one))));
  EXPECT_NE(key, SceneKey(scene(here.Write("thing", two))));
  SceneSpec other = scene(there.Write("thing", one));
  other.timestep = 0.001;
  EXPECT_NE(key, SceneKey(other));
}

TEST(SceneCache, WarningsNameTheCurrentFiles) {
  const TempDir cache;
  ModelFolder here, there;
  const auto compile = [&](ModelFolder& folder, const std::string& above) {
    folder.Write("arm", kTwoJointArm);
    const std::filesystem::path file = folder.path() / "arm.yaml";
    std::ofstream(file) << above << "name: arm\nmodel: arm.xml\n"
                        << "move_groups: {arm: {kind: arm, joints: [shoulder, elbow]}}\n"
                        << "home: {arm: [0, 0]}\nhome_noise: {arm: 3}\n";
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.config = RobotConfig::Load(file.string())});
    return CompileSceneCached(spec, cache.path())->warnings();
  };
  const std::vector<std::string> warnings = compile(here, "");
  ASSERT_THAT(warnings, Not(IsEmpty()));
  EXPECT_THAT(warnings[0], HasSubstr(here.path().string() + "/arm.yaml:5:"));
  EXPECT_EQ(compile(here, ""), warnings);
  EXPECT_THAT(compile(here, "# a line more\n")[0], HasSubstr("/arm.yaml:6:"));
  EXPECT_THAT(compile(there, "")[0], HasSubstr(there.path().string() + "/arm.yaml:5:"));
}

TEST(SceneCache, ErrorsMatchThoseOfTheCompiler) {
  const TempDir cache;
  for (const char* name : {"menagerie:../x.xml", "no_such_model", "/no/such/file.xml"}) {
    SceneSpec spec = EmptyScene();
    spec.objects.push_back({.name = "thing", .mjcf_path = name, .fixed = true});
    std::string without, with;
    try {
      CompileScene(spec);
    } catch (const std::exception& error) {
      without = std::string(typeid(error).name()) + error.what();
    }
    try {
      CompileSceneCached(spec, cache.path());
    } catch (const std::exception& error) {
      with = std::string(typeid(error).name()) + error.what();
    }
    EXPECT_NE(without, "");
    EXPECT_EQ(with, without);
  }
}

TEST(SceneCache, DetectsChangesOfEveryModelFile) {
  ModelFolder folder;
  const std::string thing = folder.Write(
      "thing", "<include file='more.xml'/><asset><texture file='skin.png' type='2d'/></asset>");
  const std::map<std::string, std::string> files = {
      {"more.xml", "<mujoco><asset><mesh file='part.stl'/></asset></mujoco>"},
      {"part.stl", "mesh"},
      {"skin.png", "texture"}};
  for (const auto& [name, bytes] : files) AtomicWrite(folder.path() / name, bytes);
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "thing", .mjcf_path = thing, .fixed = true});
  const std::string key = SceneKey(spec);
  for (const auto& [name, bytes] : files) {
    std::string changed = bytes;
    changed.replace(1, 1, "X");  // of the same size
    AtomicWrite(folder.path() / name, changed);
    EXPECT_NE(SceneKey(spec), key) << name;
    AtomicWrite(folder.path() / name, bytes);
    EXPECT_EQ(SceneKey(spec), key) << name;
  }
}

TEST(SceneCache, ReportsAndReplacesADamagedEntry) {
  const TempDir folder;
  const SceneSpec spec = RichScene();
  const std::string good = SaveBinaryString(CompileSceneCached(spec, folder.path())->model());
  const fs::path file = Entries(folder.path())[0];
  const std::string whole = ReadFile(file);
  for (int percent = 0; percent < 100; percent += 9) {
    const size_t at = whole.size() * static_cast<size_t>(percent) / 100;
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 1);
    for (const std::string& damaged : {flipped, whole.substr(0, at)}) {
      AtomicWrite(file, damaged);
      std::vector<std::string> logged;
      const ScopedLogSink capture(
          [&](LogLevel, std::string_view text) { logged.emplace_back(text); });
      EXPECT_EQ(SaveBinaryString(CompileSceneCached(spec, folder.path())->model()), good);
      EXPECT_THAT(logged, ElementsAre(HasSubstr("is damaged; the scene is compiled again")));
      EXPECT_EQ(ReadFile(file), whole);
    }
  }
}

TEST(SceneCache, AnUnwritableFolderOnlyGivesAWarning) {
  const TempDir folder;
  AtomicWrite(folder / "file", "not a folder");
  std::vector<std::string> logged;
  const ScopedLogSink capture([&](LogLevel, std::string_view text) { logged.emplace_back(text); });
  EXPECT_NE(CompileSceneCached(EmptyScene(), folder / "file")->model(), nullptr);
  EXPECT_THAT(logged,
              ElementsAre(HasSubstr("scene 'test' is not kept for later processes: cannot")));
}

TEST(SceneCache, TreatsAnUnreadableEntryAsMissing) {
  const TempDir folder;
  CompileSceneCached(EmptyScene(), folder.path());
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(Entries(folder.path())[0], fs::perms::none);
  EXPECT_EQ(MessageAsNobody([&] { CompileSceneCached(EmptyScene(), folder.path()); }),
            "nothing was thrown");
}

TEST(SceneCache, AnInvalidSpecGivesTheErrorOfTheCompiler) {
  const TempDir folder;
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "thing", .mjcf_path = "no_such_thing.xml", .fixed = true});
  const auto message = [](const auto& function) -> std::string {
    try {
      function();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  const std::string expected = message([&] { CompileScene(spec); });
  EXPECT_THAT(expected, HasSubstr("no_such_thing.xml"));
  EXPECT_EQ(message([&] { CompileSceneCached(spec, folder.path()); }), expected);
  EXPECT_THAT(Entries(folder.path()), IsEmpty());
}

TEST(SceneCache, PruningKeepsTheMostRecentEntries) {
  const TempDir folder;
  const auto now = fs::file_time_type::clock::now();
  for (const int age : {3, 1, 2}) {
    const fs::path file = folder / (std::to_string(age) + ".scene");
    AtomicWrite(file, std::string(100, 'x'));
    fs::last_write_time(file, now - std::chrono::hours(age));
  }
  AtomicWrite(folder / "notes.txt", "not ours");
  PruneSceneCache(folder.path(), 200);
  EXPECT_TRUE(fs::exists(folder / "1.scene"));
  EXPECT_TRUE(fs::exists(folder / "2.scene"));
  EXPECT_FALSE(fs::exists(folder / "3.scene"));
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
}

}  // namespace
}  // namespace robocell
