#include "robocell/assets/resolve.h"

#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "robocell/assets/roots.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::assets {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Resolving : public ::testing::Test {
 protected:
  Resolving() {
    std::string name = (fs::temp_directory_path() / "resolve_test_XXXXXX").string();
    folder_ = fs::canonical(mkdtemp(name.data()));
  }
  ~Resolving() override { fs::remove_all(folder_); }

  std::string Write(const std::string& file) {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << "<mujoco/>";
    return (folder_ / file).string();
  }
  std::string At(const std::string& file) const { return (folder_ / file).string(); }

  fs::path folder_;
};

TEST(UserCacheFolder, IsInTheHomeOfTheListOfUsersWithoutTheVariable) {
  const ScopedEnv cache("XDG_CACHE_HOME", "");
  {
    const ScopedEnv home("HOME", "/nowhere/somebody");
    EXPECT_EQ(internal::UserCacheFolder(), "/nowhere/somebody/.cache");
  }
  const ScopedEnv home("HOME", "");
  EXPECT_TRUE(internal::UserCacheFolder().is_absolute());
  EXPECT_NE(internal::UserCacheFolder(), "/.cache");
}

TEST_F(Resolving, AnAbsolutePathIsThatFile) {
  const std::string file = Write("a/arm.xml");
  EXPECT_EQ(Resolve(file), file);
  ExpectThrow<NotFoundError>(
      [&] { Resolve(At("a/leg.xml")); },
      "model file '" + At("a/leg.xml") + "' not found. Looked for: " + At("a/leg.xml"));
}

TEST_F(Resolving, RejectsAPathThatIsNotAFile) {
  ASSERT_EQ(mkfifo(At("arm.xml").c_str(), 0600), 0);
  for (const std::string& name : {At("arm.xml"), std::string("arm.xml")}) {
    ExpectThrow<NotFoundError>([&] { Resolve(name, folder_.string()); },
                               "Looked for: " + At("arm.xml") + " (a pipe)");
  }
}

TEST_F(Resolving, ARelativePathStartsAtTheReferringFile) {
  const std::string file = Write("robots/arm.xml");
  Write("scenes/lab.xml");
  EXPECT_EQ(Resolve("arm.xml", At("robots")), file);
  EXPECT_EQ(Resolve("../robots/arm.xml", At("scenes")), file);
}

TEST_F(Resolving, TheModelPathIsSearchedRootByRoot) {
  const std::string first = Write("one/arm.xml"), second = Write("two/hand.xml");
  Write("two/arm.xml");
  const ScopedEnv env("ROBOCELL_MODEL_PATH", At("one") + "::" + At("two"));
  EXPECT_EQ(Resolve("arm.xml"), first);
  EXPECT_EQ(Resolve("hand.xml"), second);
}

TEST_F(Resolving, AMissingFileErrorListsTheSearchedPlaces) {
  const ScopedEnv env("ROBOCELL_MODEL_PATH", At("one"));
  const std::string message =
      ExpectThrow<NotFoundError>([&] { Resolve("arms/leg.xml", At("robots")); },
                                 "model file 'arms/leg.xml' not found. Looked for: ");
  EXPECT_THAT(message, HasSubstr(At("robots/arms/leg.xml")));
  EXPECT_THAT(message, HasSubstr(At("one/arms/leg.xml")));
  EXPECT_THAT(message, HasSubstr("ROBOCELL_MODEL_PATH"));
}

TEST_F(Resolving, SuggestsTheNearestFile) {
  Write("robots/models/stork.xml");
  Write("robots/models/stork.yaml");
  Write("robots/models/crane.urdf");
  for (const auto& [name, near] :
       {std::pair<std::string, std::string>{"models/storck.xml", "models/stork.xml"},
        {"models/cranne.urdf", "models/crane.urdf"},
        {At("robots/models/storck.xml"), At("robots/models/stork.xml")}}) {
    ExpectThrow<NotFoundError>([&, &name = name] { Resolve(name, At("robots")); },
                               "Did you mean '" + near + "'?");
  }
  EXPECT_THAT(ExpectThrow<NotFoundError>([&] { Resolve("models/heron.xml", At("robots")); }, ""),
              Not(HasSubstr("stork")));
}

TEST_F(Resolving, NamesBelowARootStayInside) {
  Write("secret.xml");
  fs::create_directories(folder_ / "root");
  fs::create_symlink(folder_ / "secret.xml", folder_ / "root" / "link.xml");
  const ScopedEnv env("ROBOCELL_MODEL_PATH", At("root"));
  ExpectThrow<ArgumentError>(
      [] { Resolve("../secret.xml"); },
      "path '../secret.xml' contains '..'; it must lead to a place inside '" + At("root"));
  ExpectThrow<ArgumentError>([] { Resolve("link.xml"); }, "through a symbolic link");
}

TEST_F(Resolving, RejectsANulByteInAName) {
  Write("arm.xml");
  for (const std::string& name : {At("arm.xml"), std::string("arm.xml")}) {
    ExpectThrow<ArgumentError>([&] { Resolve(name + '\0' + "../../etc", folder_); },
                               name + "\\0../../etc' contains a NUL byte");
  }
}

TEST_F(Resolving, BuiltInModelsAreFoundByName) {
  EXPECT_THAT(BuiltinRobots(), Contains("rc7"));
  EXPECT_EQ(Resolve("rc7"), ModelsRoot() + "/robots/rc7/rc7.xml");
  EXPECT_EQ(BuiltinRobotFile("rc7"), ModelsRoot() + "/robots/rc7/rc7.yaml");
  ExpectThrow<NotFoundError>([] { Resolve("rc8"); }, "Did you mean 'rc7'?");
  ExpectThrow<NotFoundError>([] { BuiltinRobotFile("rc8"); },
                             "no robot 'rc8'. Its robots: cart, mobile_base, rc7, rc7_mobile");
}

TEST_F(Resolving, ReadyMadeEnvironmentsAreFoundByName) {
  EXPECT_THAT(BuiltinCells(),
              ::testing::ElementsAre("fr3", "fr3_duo", "gen3_2f85", "panda", "rc7", "xarm7"));
  EXPECT_TRUE(fs::exists(BuiltinCellFile("fr3_duo")));
  ExpectThrow<NotFoundError>([] { BuiltinCellFile("fr3_dou"); },
                             "ready-made environments: no cell 'fr3_dou'. Its cells: fr3, fr3_duo, "
                             "gen3_2f85, panda, rc7, xarm7. Did you mean 'fr3_duo'?");
  Write("robots/mine/mine.xml");
  const ScopedEnv env("ROBOCELL_MODELS", folder_.string());
  EXPECT_TRUE(BuiltinCells().empty()) << "none beside models of one's own";
}

TEST_F(Resolving, AVariableOverridesAModelFile) {
  const std::string mine = Write("my table.xml"), arm = Write("arm.xml");
  const ScopedEnv root("MENAGERIE_ROOT", At("none")), cache("MENAGERIE_CACHE_DIR", At("none"));
  const ScopedEnv table("ROBOCELL_OVERRIDE_TABLE", mine);
  const ScopedEnv gen3("ROBOCELL_OVERRIDE_KINOVA_GEN3", arm);
  const ScopedEnv file("ROBOCELL_OVERRIDE_FRANKA_FR3_FR3_XML", arm);
  EXPECT_EQ(Resolve("table"), mine);
  EXPECT_EQ(Resolve("menagerie:kinova_gen3"), arm);
  EXPECT_EQ(menagerie::ModelPath("kinova_gen3"), arm);
  EXPECT_EQ(Resolve("menagerie:franka_fr3/fr3.xml"), arm);
  EXPECT_EQ(Resolve(At("arm.xml")), arm);
  EXPECT_NE(Resolve("cabinet"), mine) << "the others stay";
  const ScopedEnv wrong("ROBOCELL_OVERRIDE_TABLE", At("nowhere.xml"));
  ExpectThrow<NotFoundError>(
      [] { Resolve("table"); },
      "ROBOCELL_OVERRIDE_TABLE is '" + At("nowhere.xml") +
          "', which is not a file; it replaces the model 'table': correct the variable or "
          "unset it");
}

TEST_F(Resolving, EquipmentIsFoundByNameAndIsNotPickable) {
  EXPECT_THAT(
      BuiltinEquipment(),
      ::testing::ElementsAre("button_panel", "cabinet", "cupboard", "d405", "drawer_unit", "faucet",
                             "fr3_duo_mount", "ft_sensor", "green_cube", "laptop", "lid_box",
                             "microwave", "open_bottle", "parallel_hand", "plug", "receiver",
                             "region", "robotiq_d405_mount", "round_hole", "socket", "square_hole",
                             "studio", "table", "tray", "wiping_area"));
  EXPECT_EQ(Resolve("cabinet"), ModelsRoot() + "/equipment/cabinet/cabinet.xml");
  EXPECT_THAT(BuiltinObjects(), ::testing::Not(Contains("cabinet")));
  EXPECT_THAT(BuiltinModels(), ::testing::IsSupersetOf({"rc7", "mug", "cabinet", "tabletop"}));
}

TEST_F(Resolving, AUsersObjectIsFoundByNameBeforeBuiltInOnes) {
  const std::string mine = Write("root/objects/my_mug/my_mug.xml");
  const std::string bottle = Write("root/objects/bottle/bottle.xml");
  Write("root/objects/no_model/readme.txt");
  {
    const ScopedEnv env("ROBOCELL_MODEL_PATH", At("root"));
    EXPECT_EQ(Resolve("my_mug"), mine);
    EXPECT_EQ(Resolve("bottle"), bottle);
    EXPECT_EQ(PortableName(mine), std::nullopt) << "only this machine has it";
    const std::map<std::string, std::string> folders = ObjectFolders();
    EXPECT_EQ(folders.at("my_mug"), At("root/objects/my_mug"));
    EXPECT_EQ(folders.at("bottle"), At("root/objects/bottle"));
    EXPECT_EQ(folders.at("mug"), ModelsRoot() + "/objects/mug");
    EXPECT_FALSE(folders.contains("no_model"));
    ExpectThrow<NotFoundError>([] { Resolve("my_mgu"); }, At("root/objects/my_mgu/my_mgu.xml"));
  }
  EXPECT_THROW(Resolve("my_mug"), NotFoundError);
  EXPECT_EQ(PortableName(Resolve("bottle")), "bottle");
}

TEST_F(Resolving, AUsersObjectHidesNoRobotEquipmentOrScene) {
  const std::string mug = Write("root/objects/mug/mug.xml");
  const std::vector<std::string> taken = {"rc7", "table", "tabletop"};
  for (const std::string& name : taken) Write("root/objects/" + name + "/" + name + ".xml");
  const std::map<std::string, std::string> before = ObjectFolders();
  std::vector<std::string> paths;
  for (const std::string& name : taken) paths.push_back(Resolve(name));
  const ScopedEnv env("ROBOCELL_MODEL_PATH", At("root"));
  std::vector<std::string> warnings;
  const ScopedLogSink capture(
      [&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
  const std::map<std::string, std::string> folders = ObjectFolders();
  EXPECT_EQ(folders.size(), before.size());
  for (size_t i = 0; i < taken.size(); ++i) {
    EXPECT_EQ(Resolve(taken[i]), paths[i]);
    EXPECT_FALSE(folders.contains(taken[i]));
    EXPECT_EQ(ObjectFolder(taken[i]), std::nullopt);
    EXPECT_THAT(warnings, Contains(::testing::HasSubstr(
                              At("root/objects/" + taken[i]) + " is no object for tasks: '" +
                              taken[i] + "' is a built-in model that is no object. Rename")));
  }
  EXPECT_EQ(Resolve("mug"), mug);
  for (const auto& [name, folder] : folders) EXPECT_EQ(ObjectFolder(name), folder);
  for (const char* none : {"", ".", "..", "mug/../mug", "no_such"})
    EXPECT_EQ(ObjectFolder(none), std::nullopt) << none;
  ObjectFolders();
  EXPECT_EQ(warnings.size(), taken.size()) << "each once";
}

// Both must raise an Error: an earlier version let a foreign exception escape.
TEST_F(Resolving, LinkCyclesAndUnknownRobotsAreNotFoundErrors) {
  Write("robots/mine/mine.xml");
  fs::create_symlink("circle", folder_ / "robots/circle");
  fs::create_symlink("arm.xml", folder_ / "arm.xml");
  fs::create_directories(folder_ / "robocell");
  std::ofstream(folder_ / "robocell/menagerie.json") << R"({"robots": {}})";
  const ScopedEnv models("ROBOCELL_MODELS", folder_.string());
  const ScopedEnv root("MENAGERIE_ROOT", ""), cache("MENAGERIE_CACHE_DIR", folder_.string());
  const ScopedEnv user("XDG_CACHE_HOME", folder_.string());
  EXPECT_THAT(BuiltinRobots(), ElementsAre("mine"));
  ExpectThrow<NotFoundError>([] { Resolve("mien"); }, "Built-in models: mine.");
  ExpectThrow<ArgumentError>([] { Resolve("circle"); }, "goes through too many symbolic links");
  ExpectThrow<NotFoundError>([&] { Resolve("arm.xml", folder_.string()); },
                             "model file 'arm.xml' not found. Looked for: " + At("arm.xml"));
  ExpectThrow<NotFoundError>([] { Resolve("menagerie:franka~fr3"); },
                             "menagerie robot 'franka~fr3' not found");
}

TEST_F(Resolving, BuiltInModelsCanBeMoved) {
  const std::string file = Write("robots/mine/mine.xml");
  const ScopedEnv env("ROBOCELL_MODELS", folder_.string());
  EXPECT_EQ(Resolve("mine"), file);
  EXPECT_THAT(BuiltinRobots(), ::testing::ElementsAre("mine"));
  const ScopedEnv wrong("ROBOCELL_MODELS", At("robots"));
  ExpectThrow<NotFoundError>([] { Resolve("mine"); }, "ROBOCELL_MODELS is " + At("robots"));
}

TEST_F(Resolving, TheMenagerieRootTakesPrecedence) {
  const std::string file = Write("kinova_gen3/gen3.xml");
  Write("kinova_gen3/scene.xml");
  const ScopedEnv env("MENAGERIE_ROOT", folder_.string());
  EXPECT_EQ(Resolve("menagerie:kinova_gen3/gen3.xml"), file);
  EXPECT_EQ(Resolve("menagerie:kinova_gen3"), file);
  EXPECT_EQ(menagerie::ModelPath("kinova_gen3"), file);
  ExpectThrow<NotFoundError>([] { Resolve("menagerie:kinova_gen3/gen4.xml"); },
                             "Did you mean 'gen3.xml'?");
  ExpectThrow<ArgumentError>([] { Resolve("menagerie:kinova_gen3/../../etc/passwd"); },
                             "it must lead to a place inside");
  ExpectThrow<ArgumentError>([] { Resolve("menagerie:../x"); }, "names no robot");
}

TEST_F(Resolving, TheMenagerieCacheHoldsCompleteVersionsOnly) {
  const std::string done = "models/franka_fr3-0123456789abcdef/";
  const std::string file = Write(done + "fr3.xml");
  const ScopedEnv root("MENAGERIE_ROOT", ""), cache("MENAGERIE_CACHE_DIR", folder_.string());
  const std::string message = ExpectThrow<NotFoundError>([] { Resolve("menagerie:franka_fr3"); },
                                                         "menagerie robot 'franka_fr3' not found");
  EXPECT_THAT(message, HasSubstr(At("models/franka_fr3-*")));
  EXPECT_THAT(message, HasSubstr("Fetch it with: robocell fetch franka_fr3"));
  Write(done + ".complete");
  Write("models/franka_fr3_v2-0123456789abcdef/.complete");
  EXPECT_EQ(Resolve("menagerie:franka_fr3"), file);
}

// Otherwise a run would silently use another robot than before.
TEST_F(Resolving, WarnsOnceAboutARecordedVersionMissingFromTheCache) {
  const std::string other = "models/franka_fr3-0123456789abcdef/";
  const std::string file = Write(other + "fr3.xml");
  Write(other + ".complete");
  fs::create_directories(folder_ / "robocell");
  std::ofstream(folder_ / "robocell/menagerie.json")
      << R"({"robots": {"franka_fr3": {"tree": "fedcba9876543210fedcba98"}}})";
  const ScopedEnv root("MENAGERIE_ROOT", ""), cache("MENAGERIE_CACHE_DIR", folder_.string());
  const ScopedEnv user("XDG_CACHE_HOME", folder_.string());
  std::vector<std::string> lines;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { lines.emplace_back(text); });
  EXPECT_EQ(Resolve("menagerie:franka_fr3"), file);
  EXPECT_EQ(Resolve("menagerie:franka_fr3/fr3.xml"), file);
  EXPECT_THAT(
      lines, ElementsAre("menagerie robot 'franka_fr3': the version that `robocell fetch` recorded "
                         "is not in the cache ('" +
                         At("models/franka_fr3-fedcba9876543210") +
                         "'), and 'franka_fr3-0123456789abcdef' is taken in its place. `robocell "
                         "fetch franka_fr3` gets the recorded one or says how; with --update the "
                         "package's version is recorded"));
  lines.clear();
  const std::string recorded = Write("models/franka_fr3-fedcba9876543210/fr3.xml");
  Write("models/franka_fr3-fedcba9876543210/.complete");
  EXPECT_EQ(Resolve("menagerie:franka_fr3"), recorded);
  EXPECT_THAT(lines, ElementsAre());
}

TEST_F(Resolving, SuggestsTheNearestLocalRobotOfTheMenagerie) {
  Write("franka_emika_panda/panda.xml");
  Write("kinova_gen3/gen3.xml");
  const ScopedEnv root("MENAGERIE_ROOT", folder_.string());
  const ScopedEnv cache("MENAGERIE_CACHE_DIR", At("none"));
  ExpectThrow<NotFoundError>([] { Resolve("menagerie:franka_emika_pnada/panda.xml"); },
                             ". Did you mean 'franka_emika_panda'? Else fetch it with: "
                             "robocell fetch franka_emika_pnada");
  ExpectThrow<NotFoundError>([] { Resolve("menagerie:spot"); },
                             "On this machine: franka_emika_panda, kinova_gen3. Fetch it with: "
                             "robocell fetch spot");
  ExpectThrow<NotFoundError>([] { Resolve("franka_emika_panda/panda.xml"); },
                             "Did you mean 'menagerie:franka_emika_panda/panda.xml'?");
  ExpectThrow<NotFoundError>([] { Resolve("panda"); },
                             "Did you mean 'menagerie:franka_emika_panda'?");
}

TEST_F(Resolving, ARobotWithSeveralModelsIsNotGuessed) {
  Write("leap_hand/left_hand.xml");
  Write("leap_hand/right_hand.xml");
  const ScopedEnv env("MENAGERIE_ROOT", folder_.string());
  ExpectThrow<ArgumentError>([] { Resolve("menagerie:leap_hand"); },
                             "name one, for example menagerie:leap_hand/left_hand.xml");
}

}  // namespace

namespace {

TEST(PortableName, OfABuiltInModelIsItsName) {
  for (const std::string& name : BuiltinModels()) EXPECT_EQ(PortableName(Resolve(name)), name);
}

TEST(PortableName, OfAMenagerieModelHasItsPrefix) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const std::string name = "menagerie:ufactory_xarm7/xarm7.xml";
  EXPECT_EQ(PortableName(Resolve(name)), name);
}

TEST(PortableName, IsEmptyForACustomFile) {
  TempDir temp;
  AtomicWrite(temp / "arm.xml", "<mujoco/>");
  EXPECT_EQ(PortableName(temp / "arm.xml"), std::nullopt);
  std::filesystem::create_directory(temp / "rc7");
  AtomicWrite(temp / "rc7/rc7.xml", "<mujoco/>");  // named like a built-in one
  EXPECT_EQ(PortableName(temp / "rc7/rc7.xml"), std::nullopt);
}

TEST(PortableName, IsEmptyForAnOverriddenModel) {
  const TempDir temp;
  const std::string mine = temp / "table.xml";
  AtomicWrite(mine, "<mujoco/>");
  const std::string original = Resolve("table");
  const ScopedEnv env("ROBOCELL_OVERRIDE_TABLE", mine);
  EXPECT_EQ(PortableName(mine), std::nullopt);
  EXPECT_EQ(PortableName(original), std::nullopt) << "the name means another file here";
}

}  // namespace
}  // namespace robocell::assets
