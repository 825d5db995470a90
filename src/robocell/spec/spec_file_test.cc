#include "robocell/spec/spec_file.h"

#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::ParseError;

TEST(SpecFile, AMissingFileErrorListsTheFilesInTheFolder) {
  const TempDir folder;
  const std::string in = folder.path().string();
  AtomicWrite(folder.path() / "xarm7.yaml", "name: a\n");
  AtomicWrite(folder.path() / "notes.txt", "");
  ExpectThrow<IoError>([&] { RobotConfig::Load(in + "/xarm.yaml"); },
                       "no robot file '" + in + "/xarm.yaml'. In " + in +
                           ": xarm7.yaml. Did you mean '" + in +
                           "/xarm7.yaml'? How to write a robot file: docs/robots.md");
  EXPECT_THAT(MissingSpecFile(in + "/none/a.yaml", "RunConfig"),
              AllOf(HasSubstr("no run file"), HasSubstr("there is no folder '" + in + "/none'"),
                    HasSubstr("docs/generate.md")));
  EXPECT_THAT(MissingSpecFile(in, "RunConfig"),
              HasSubstr("'" + in + "' is a folder; give a run file. In " + in + ": xarm7.yaml."));
  EXPECT_EQ(MissingSpecFile(in + "/xarm7.yaml", "RobotConfig"), "");
}

TEST(SpecFile, ReportsAFolderWithoutSpecFiles) {
  const TempDir folder;
  EXPECT_THAT(MissingSpecFile((folder.path() / "a.yaml").string(), "RobotConfig"),
              HasSubstr("There are no robot files in " + folder.path().string()));
}

// Its only field is one of scenes and environments.
TEST(SpecFile, DoesNotSuggestFilesWithAFieldOfOtherKinds) {
  const TempDir folder;
  const std::string in = folder.path().string();
  AtomicWrite(folder.path() / "nop.yaml", "# a cell\nrobots:\n  a: arm.yaml\n  b: arm.yaml\n");
  AtomicWrite(folder.path() / "arm.yaml", "name: a\nmodel: b.xml\n");
  for (const char* type : {"RobotConfig", "RunConfig"})
    EXPECT_THAT(MissingSpecFile(in + "/nope.yaml", type), Not(HasSubstr("nop.yaml."))) << type;
  EXPECT_THAT(MissingSpecFile(in + "/nope.yaml", "EnvConfig"), HasSubstr("Did you mean"));
}

TEST(SpecFile, DoesNotSuggestFilesOfOtherKinds) {
  const TempDir folder;
  const std::string in = folder.path().string();
  AtomicWrite(folder.path() / "arm.yaml", "name: a\nmodel: b.xml\nmove_groups: {\n");
  AtomicWrite(folder.path() / "arm_pick.yaml", "# a run\nrun: a\nrobot: arm.yaml\nworkers: 2\n");
  AtomicWrite(folder.path() / "notes.yaml", "some: thing\n");
  EXPECT_THAT(
      MissingSpecFile(in + "/arm_pik.yaml", "RobotConfig"),
      HasSubstr("In " + in + ": arm.yaml, notes.yaml. Did you mean '" + in + "/arm.yaml'?"));
  EXPECT_THAT(MissingSpecFile(in + "/am_pick.yaml", "RunConfig"),
              HasSubstr("In " + in + ": arm_pick.yaml, notes.yaml. Did you mean '" + in +
                        "/arm_pick.yaml'?"));
}

TEST(SpecFile, DoesNotSuggestBinaryFiles) {
  const TempDir folder;
  const std::string in = folder.path().string();
  AtomicWrite(folder.path() / "arm.yaml", "name: a\nmodel: b.xml\n# \xC3\xA4\n");
  AtomicWrite(folder.path() / "garbage.yaml", std::string("\0\1\2binary", 9));
  AtomicWrite(folder.path() / "latin1.yaml", "name: \xE4rm\n");
  // The inspected beginning of the file cuts a character in two.
  AtomicWrite(folder.path() / "long.yaml",
              "name: a\n#" + std::string((1 << 16) - 10, '-') + "\xC3\xA4\n");
  EXPECT_THAT(MissingSpecFile(in + "/nope.yaml", "RobotConfig"),
              HasSubstr("In " + in + ": arm.yaml, long.yaml. Did you mean"));
}

TEST(SpecFile, SaysHowToNameABuiltInRobot) {
  EXPECT_THAT(MissingSpecFile("rc7", "RobotConfig"),
              HasSubstr("If 'rc7' is a built-in robot, give the path of its file, which `python3 "
                        "-c \"import robocell; print(robocell.models.robot_file('rc7'))\"` "
                        "prints (C++: BuiltinRobotFile)."));
}

// They would never end, or wait for ever; so would a listing that looked into them.
TEST(SpecFile, DoesNotOpenPipesAndDevices) {
  const TempDir folder;
  const std::string in = folder.path().string(), pipe = in + "/pipe.yaml";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder / "endless.yaml");
  const std::string wanted =
      "; give a robot file. What a pipe brings is written to a file first. How to write a robot "
      "file: docs/robots.md";
  ExpectThrow<IoError>([&] { RobotConfig::Load(pipe); }, "'" + pipe + "' is a pipe" + wanted);
  ExpectThrow<IoError>([&] { RobotConfig::Load("/dev/zero"); }, "'/dev/zero' is a device" + wanted);
  ExpectThrow<IoError>([&] { RobotConfig::Load(in + "/endless.yaml"); },
                       "'" + in + "/endless.yaml' is a link to '/dev/zero'" + wanted);
  EXPECT_THAT(MissingSpecFile(in + "/pip.yaml", "RunConfig"),
              HasSubstr("There are no run files in " + in));
}

TEST(SpecFile, DoesNotReadAHugeFile) {
  const TempDir folder;
  const std::string file = folder / "mesh.yaml";
  AtomicWrite(file, "name: a\n");
  std::filesystem::resize_file(file, uint64_t{1} << 40);
  ExpectThrow<IoError>([&] { RobotConfig::Load(file); },
                       "'" + file +
                           "' has 1048576 MiB; a robot file has a few kB, and 16 MiB are "
                           "the most that is read. Is it the right file?");
}

TEST(SpecFile, NamesAPointerOfGitLfs) {
  const TempDir folder;
  const std::string file = folder / "arm.yaml", run = folder / "run.yaml";
  AtomicWrite(file, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 700\n");
  const std::string wanted =
      file +
      ": a pointer of Git LFS, not the file itself: run `git lfs pull` where "
      "the repository was cloned, or download the file";
  ExpectThrow<IoError>([&] { RobotConfig::Load(file); }, wanted);
  ExpectThrow<IoError>([&] { RunConfig::Load(file); }, wanted);
  ExpectThrow<IoError>([&] { SceneSpec::Load(file); }, wanted);
  ExpectThrow<IoError>([&] { EnvConfig::Load(file); }, wanted);
  AtomicWrite(run, "run: r\nrobot: arm.yaml\ntask: {kind: pick}\nscenes: {source: tabletop}\n");
  ExpectThrow<SpecError>([&] { RunConfig::Load(run); }, wanted);
}

TEST(SpecFile, RejectsNulBytesWithTheirPlace) {
  const std::string text = std::string("name: a\nmodel: b") + '\0' + "c\n";
  EXPECT_EQ(ParseError<RobotConfig>(text),
            "f.yaml:2:9: byte 0x00 at offset 16 cannot stand in a text; a spec file is text in "
            "UTF-8. Is it the right file? If so, save it as UTF-8");
}

TEST(SpecFile, RejectsInvalidUtf8WithItsPlace) {
  EXPECT_THAT(ParseError<RobotConfig>("name: caf\xe9\n"),
              HasSubstr("f.yaml:1:10: byte 0xe9 at offset 9 is not UTF-8"));
  const std::vector<std::string> wrong = {
      "\x80",     "\xc0\xaf",         "\xed\xa0\x80",     "\xf4\x90\x80\x80",
      "\xff\xfe", "\xe0\x80\x80",     "\xf0\x80\x80\x80", "\xc3",
      "\xe2\x82", "\xf5\x80\x80\x80", "\xf0\x9f\x98",
  };
  for (const std::string& bytes : wrong) {
    EXPECT_THAT(ParseError<RobotConfig>("a: " + bytes), HasSubstr("at offset 3 is not UTF-8"));
  }
}

TEST(SpecFile, AcceptsTextInAnyLanguage) {
  for (const std::string name : {"caf\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\xa4\x96"}) {
    EXPECT_EQ(ParseYaml<RobotConfig>("name: " + name + "\nmodel: b\n").name, name);
  }
}

}  // namespace
}  // namespace robocell
