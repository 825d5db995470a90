#include "robocell/mujoco/compile.h"

#include <sys/stat.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <fstream>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/step.h"
#include "robocell/testing/leaks_of_others.h"

namespace robocell {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr char kPendulum[] = R"(<mujoco model="pendulum">
  <worldbody><body name="rod"><joint name="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 .1" size=".01"/>
  </body></worldbody></mujoco>)";

template <class Expected, class Function>
std::string MessageOf(Function fn) {
  try {
    fn();
  } catch (const Expected& error) {
    return error.what();
  }
  return "no error";
}

class Compiling : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("robocell_compile_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

void ExpectSameMotion(const mjModel* a, const mjModel* b, double tolerance) {
  DataPtr da = MakeData(a), db = MakeData(b);
  ASSERT_TRUE(Step(a, da.get(), 100).ok());
  ASSERT_TRUE(Step(b, db.get(), 100).ok());
  EXPECT_NE(da->qpos[0], 0);
  EXPECT_NEAR(da->qpos[0], db->qpos[0], tolerance);
}

TEST_F(Compiling, TextThatIsNotXmlIsASpecErrorWithTheEnginesReason) {
  EXPECT_THAT(
      MessageOf<SpecError>([] { ParseXmlString("<mujoco><wrldbody/></mujoco>", "robot 'left'"); }),
      AllOf(HasSubstr("robot 'left': model text: "), HasSubstr("wrldbody")));
}

// The engine's library throws in another C++ runtime than ours.
TEST_F(Compiling, AnEngineExceptionBecomesAnEngineErrorWithAPlace) {
  constexpr char kTooLarge[] =
      R"(<mujoco><asset><mesh name="m" builtin="plate" params="100000 100000"/></asset></mujoco>)";
  const auto file = folder_ / "large.xml";
  std::ofstream(file) << kTooLarge;
  const LeaksOfOthers leaks;  // the engine leaks its objects when it throws
  const auto where = HasSubstr("look at the sizes of its hfield, texture, mesh, ");
  EXPECT_THAT(MessageOf<EngineError>([&] { ParseXmlFile(file, "robot 'left'"); }),
              AllOf(HasSubstr("robot 'left': model file '" + file.string() +
                              "': the engine threw a C++ exception"),
                    where));
  EXPECT_THAT(MessageOf<EngineError>([&] { ParseXmlString(kTooLarge); }),
              AllOf(HasSubstr("model text: the engine threw a C++ exception"), where));
}

TEST_F(Compiling, AMissingFileIsAnIoErrorThatNamesIt) {
  EXPECT_EQ(MessageOf<IoError>([] { ParseXmlFile("/no/such/arm.xml", "robot 'left'"); }),
            "robot 'left': cannot read model file '/no/such/arm.xml': No such file or directory");
  std::ofstream(folder_ / "cell.xml") << "<mujoco/>";
  EXPECT_THAT(MessageOf<IoError>([&] { ParseXmlFile(folder_ / "cel.xml"); }),
              AllOf(HasSubstr("cel.xml': No such file or directory. Models in '" +
                              folder_.string() + "': "),
                    HasSubstr(". Did you mean 'cell.xml'?")));
  EXPECT_THAT(MessageOf<IoError>([&] { ParseXmlFile(folder_); }),
              HasSubstr("is a folder, not a model file"));
  EXPECT_THAT(MessageOf<IoError>([&] { ParseXmlFile("/dev/zero"); }),
              HasSubstr("'/dev/zero' is a device, not a model file"));
}

TEST_F(Compiling, AMissingMeshIsASpecErrorThatNamesTheMesh) {
  SpecPtr spec = ParseXmlString(
      "<mujoco><asset><mesh name='hull' file='gone.obj'/></asset>"
      "<worldbody><geom type='mesh' mesh='hull'/></worldbody></mujoco>");
  EXPECT_THAT(MessageOf<SpecError>([&] { Compile(spec.get(), nullptr, "scene 'pick'"); }),
              AllOf(HasSubstr("scene 'pick': building the model: "), HasSubstr("gone.obj")));
}

TEST_F(Compiling, AFailedSpecCanBeFixedAndCompiledAgain) {
  SpecPtr spec = ParseXmlString(kPendulum);
  mjsJoint* joint = mjs_asJoint(mjs_findElement(spec.get(), mjOBJ_JOINT, "hinge"));
  joint->range[0] = 1;
  joint->range[1] = -1;
  joint->limited = mjLIMITED_TRUE;
  EXPECT_THROW(Compile(spec.get()), SpecError);
  joint->range[1] = 2;
  EXPECT_NE(Compile(spec.get()), nullptr);
}

TEST_F(Compiling, AutomaticResetIsOffInTheModelAndInSavedFiles) {
  SpecPtr spec = ParseXmlString(kPendulum);
  ModelPtr model = Compile(spec.get());
  EXPECT_TRUE(model->opt.disableflags & mjDSBL_AUTORESET);
  EXPECT_THAT(SaveXmlString(spec.get()), HasSubstr("autoreset=\"disable\""));
}

TEST_F(Compiling, WarningsOfTheBuildAreReturnedOrLoggedOnce) {
  const std::string xml =
      "<mujoco><option integrator='Euler'/><worldbody><frame name='here'/></worldbody></mujoco>";
  const std::string child =
      "<mujoco><option integrator='RK4'/><worldbody><body name='b'/></worldbody></mujoco>";
  auto attached = [&] {
    SpecPtr parent = ParseXmlString(xml), part = ParseXmlString(child);
    mjs_setDeepCopy(parent.get(), 1);
    internal::WarningCapture quiet;
    mjs_attach(mjs_findFrame(parent.get(), "here")->element, mjs_findBody(part.get(), "b")->element,
               "x_", "");
    return parent;
  };
  std::vector<std::string> lines, warnings;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { lines.emplace_back(text); });
  SpecPtr first = attached();
  Compile(first.get(), nullptr, "scene 'pick'", &warnings);
  EXPECT_TRUE(lines.empty());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("integrator"));
  SpecPtr second = attached();
  Compile(second.get(), nullptr, "scene 'pick'");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0], "scene 'pick': MuJoCo: " + warnings[0]);
}

TEST_F(Compiling, RejectsANanInAModelWithItsPlace) {
  const std::filesystem::path file = folder_ / "arm.xml";
  std::ofstream(file) << "<mujoco><!-- pos='nan' -->\n<worldbody>\n"
                         "<body name='nan'><geom size='.1' mass='NaN'/></body>"
                         "</worldbody></mujoco>";
  EXPECT_EQ(MessageOf<SpecError>([&] { (void)ParseXmlFile(file, "robot 'left'"); }),
            "robot 'left': " + file.string() +
                ":3: mass=\"NaN\" is not a number. Correct it there, or leave the attribute out to "
                "have what MuJoCo takes without it");
  const std::filesystem::path around = folder_ / "cell.xml";
  std::ofstream(around) << "<mujoco><include file='arm.xml'/></mujoco>";
  EXPECT_THAT(MessageOf<SpecError>([&] { (void)ParseXmlFile(around); }),
              AllOf(HasSubstr("cell.xml: a number of the model, or of a file that it includes"),
                    HasSubstr("is NaN. Correct it there")));
  EXPECT_THAT(MessageOf<SpecError>([&] {
                (void)ParseXmlString(
                    "<mujoco><worldbody><body pos='0 nan 0'/></worldbody></mujoco>", "scene 'x'");
              }),
              HasSubstr("scene 'x': model text: a number of the model"));
  std::ofstream(file) << "<mujoco><worldbody><body name='nan'/></worldbody></mujoco>";
  EXPECT_NE(ParseXmlFile(file), nullptr) << "a name";
}

TEST_F(Compiling, RejectsInfiniteValuesByElement) {
  const auto message = [](const std::string& body) {
    const SpecPtr spec = ParseXmlString("<mujoco><worldbody>" + body + "</worldbody></mujoco>");
    return MessageOf<SpecError>([&] { Compile(spec.get(), nullptr, "scene 'x'"); });
  };
  EXPECT_EQ(message("<body name='b' pos='0 inf 1'/>"),
            "scene 'x': building the model: Error: pos is 0 inf 1; it must be finite. Correct it "
            "there\nElement name 'b', id 1");
  EXPECT_THAT(message("<body><joint name='j' damping='inf'/><geom size='.1'/></body>"),
              HasSubstr("damping is inf; it must be finite. Correct it there\nElement name 'j'"));
  EXPECT_EQ(message("<body><joint range='-inf inf' limited='false'/><geom size='.1'/></body>"),
            "no error");
}

TEST_F(Compiling, FindsFilesInAVirtualFileSystem) {
  VfsPtr vfs = MakeVfs();
  AddBuffer(vfs.get(), "tetra.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  EXPECT_EQ(MessageOf<ArgumentError>([&] { AddBuffer(vfs.get(), "tetra.obj", "x"); }),
            "virtual file system: there is already a file 'tetra.obj'");
  SpecPtr spec = ParseXmlString(
      "<mujoco><asset><mesh name='t' file='tetra.obj'/></asset>"
      "<worldbody><geom type='mesh' mesh='t'/></worldbody></mujoco>",
      "", vfs.get());
  EXPECT_EQ(Compile(spec.get(), vfs.get())->nmeshvert, 4);
}

TEST_F(Compiling, ASavedXmlFileLoadsAndSimulatesAlike) {
  SpecPtr spec = ParseXmlString(kPendulum);
  ModelPtr model = Compile(spec.get());
  SaveXml(spec.get(), folder_ / "out.xml");
  SpecPtr again = ParseXmlFile(folder_ / "out.xml");
  ExpectSameMotion(model.get(), Compile(again.get()).get(), 1e-4);
}

TEST_F(Compiling, ASavedBinaryFileLoadsAndSimulatesBitwiseAlike) {
  ModelPtr model = Compile(ParseXmlString(kPendulum).get());
  SaveBinary(model.get(), folder_ / "out.mjb");
  ExpectSameMotion(model.get(), LoadBinary(folder_ / "out.mjb").get(), 0);
}

TEST_F(Compiling, ATruncatedBinaryFileIsAnErrorThatNamesTheFile) {
  ModelPtr model = Compile(ParseXmlString(kPendulum).get());
  const std::string bytes = SaveBinaryString(model.get());
  std::ofstream(folder_ / "cut.mjb", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_THAT(MessageOf<SpecError>([&] { LoadBinary(folder_ / "cut.mjb"); }),
              HasSubstr("cut.mjb': loading a binary"));
  EXPECT_THROW(LoadBinaryString("not a model"), SpecError);
  EXPECT_THROW(LoadBinaryString(""), SpecError);
}

TEST_F(Compiling, RejectsPipesAndHugeFilesAsBinaries) {
  ASSERT_EQ(mkfifo((folder_ / "pipe.mjb").c_str(), 0600), 0);
  EXPECT_THAT(
      MessageOf<IoError>([&] { LoadBinary(folder_ / "pipe.mjb", "scene 'pick'"); }),
      AllOf(HasSubstr("scene 'pick': cannot read '"), HasSubstr("it is a pipe, not a file")));
  std::ofstream(folder_ / "endless.mjb") << "";
  std::filesystem::resize_file(folder_ / "endless.mjb", uint64_t{9} << 30);  // of holes
  EXPECT_THAT(MessageOf<IoError>([&] { LoadBinary(folder_ / "endless.mjb"); }),
              HasSubstr("it has 9663676416 bytes, 8589934592 are the most that is read"));
}

TEST_F(Compiling, AnUnwritablePlaceIsAnIoErrorWithPathAndReason) {
  ModelPtr model = Compile(ParseXmlString(kPendulum).get());
  EXPECT_EQ(
      MessageOf<IoError>([&] { SaveBinary(model.get(), "/no/such/folder/a.mjb", "scene 'pick'"); }),
      "scene 'pick': cannot write '/no/such/folder/a.mjb': No such file or directory");
}

TEST_F(Compiling, NewSpecsUseRadians) { EXPECT_FALSE(MakeSpec()->compiler.degree); }

}  // namespace
}  // namespace robocell
