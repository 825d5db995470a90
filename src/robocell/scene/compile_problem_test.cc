// Tests that the engine's compile errors are reported with the affected file and element.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/robot_files.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

using CompileProblems = RobotFiles;

TEST_F(CompileProblems, ABodyWithoutMass) {
  folder.Write("light", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body name="finger"><joint/><geom size="0.1" mass="0"/></body></body></worldbody>)");
  const std::string file = File("light.yaml", "name: arm\nmodel: light.xml\n");
  const std::string message = ExpectThrow<SpecError>(
      [&] { BuildRobot(file); },
      file + ":2:8: robot 'left': " + (folder.path() / "light.xml").string() +
          ":2: body 'finger': mass and inertia of moving bodies must be larger than mjMINVAL. A "
          "body "
          "that moves needs a mass: ");
  EXPECT_THAT(message, HasSubstr("edits: [{geom: {body: finger, index: 0}, mass: 0.05}]"));
  folder.Write("same", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body name="thumb"><joint name="thumb"/><geom size="0.1" mass="0"/></body></body></worldbody>)");
  ExpectThrow<SpecError>([&] { BuildRobot(File("same.yaml", "name: arm\nmodel: same.xml\n")); },
                         ":2: element 'thumb': mass and inertia of moving bodies");
  BuildRobot(File("heavy.yaml",
                  "name: arm\nmodel: light.xml\n"
                  "edits: [{geom: {body: finger, index: 0}, mass: 0.05}]\n"));
}

TEST_F(CompileProblems, EngineErrorsHaveTheLineOfTheModel) {
  folder.Write("flat", R"(<worldbody><body name="base">
      <geom type="sphere" size="-1"/></body></worldbody>)");
  const std::string file = File("flat.yaml", "name: arm\nmodel: flat.xml\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file + ":2:8: robot 'left': " + (folder.path() / "flat.xml").string() +
                             ":2: size 0 must be positive in geom");
  folder.Write("tool", R"(<worldbody><body name="t"><geom name="ball" type="sphere" size="-1"/>
      </body></worldbody>)");
  const std::string with_tool =
      RobotFile("attachments: [{mjcf_path: tool.xml, prefix: t_, attach_to: {site: flange}}]\n");
  ExpectThrow<SpecError>([&] { BuildRobot(with_tool); },
                         with_tool +
                             ":2:8: robot 'left': " + (folder.path() / "tool.xml").string() +
                             ":1: geom 't_ball': size 0 must be positive in geom");
}

// The same words are used for a robot or an object.
TEST_F(CompileProblems, EngineErrorsInTheBaseOfAScene) {
  const auto message = [&](const std::string& model) {
    SceneSpec spec = EmptyScene();
    spec.base = folder.Write("room", model);
    spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.1}));
    return ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                                  "scene 'test' / base: " + *spec.base + ":");
  };
  EXPECT_THAT(message("<worldbody><body name=\"table\">\n<geom size=\".1\"/>\n"
                      "<geom type=\"mesh\" mesh=\"top\"/></body></worldbody>"),
              HasSubstr(":3: geom 1 (unnamed, of body 'table'): no mesh 'top', and the model has "
                        "none: put <mesh name=\"top\" .../> into its <asset>"));
  EXPECT_THAT(message("<worldbody><body>\n<geom type=\"sphere\" size=\"-1\"/></body></worldbody>"),
              HasSubstr(":2: size 0 must be positive in geom"));
  EXPECT_THAT(message("<worldbody><body name=\"leaf\"><joint/></body></worldbody>"),
              HasSubstr(":1: body 'leaf': mass and inertia of moving bodies must be larger than"));
}

TEST_F(CompileProblems, ANameUsedByTheBase) {
  SceneSpec spec = EmptyScene();
  spec.base = folder.Write("room", R"(<worldbody><body name="cube"/></worldbody>)");
  spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.1}));
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / object 'cube': body 'cube' is in base already, and the "
                         "object would bring another one; give the object another name");
}

TEST_F(CompileProblems, AMissingAsset) {
  const auto message = [&](const std::string& model) {
    const std::string path = folder.Write("lacking", model);
    const std::string file = File("lacking.yaml", "name: arm\nmodel: lacking.xml\n");
    const std::string text = ExpectThrow<SpecError>([&] { BuildRobot(file); },
                                                    file + ":2:8: robot 'left': " + path + ":");
    return text.substr(text.find(path) + path.size() + 1);
  };
  std::ofstream(folder.path() / "link0.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  EXPECT_EQ(message("<asset><mesh file=\"link0.obj\"/><mesh name=\"cover\" file=\"link0.obj\"/>"
                    "</asset><worldbody><body name=\"base\">\n<geom size=\".1\"/>\n"
                    "<geom type=\"mesh\" mesh=\"lnk0\"/></body></worldbody>"),
            "3: geom 1 (unnamed, of body 'base'): no mesh 'lnk0'. Known meshes: link0, cover. Did "
            "you mean 'link0'?");
  EXPECT_EQ(message("<worldbody><body name=\"base\"><geom name=\"skin\" size=\".1\"\n"
                    "material=\"red\"/></body></worldbody>"),
            "1: geom 'skin': no material 'red', and the model has none: put <material "
            "name=\"red\" .../> into its <asset>");
  EXPECT_EQ(message("<asset><texture name=\"wood\" type=\"2d\" builtin=\"flat\" width=\"8\" "
                    "height=\"8\"/>\n<material name=\"m\" texture=\"wod\"/></asset>"
                    "<worldbody><body name=\"base\"><geom size=\".1\" material=\"m\"/></body>"
                    "</worldbody>"),
            "2: material 'm': no texture 'wod'. Known textures: wood. Did you mean 'wood'?");
  EXPECT_THAT(message("<worldbody><body name=\"base\"><geom size=\".1\"/>"
                      "<site name=\"s\" material=\"red\"/></body></worldbody>"),
              HasSubstr("site 's': no material 'red'"));
  EXPECT_THAT(message("<worldbody><body name=\"base\"><geom type=\"hfield\" hfield=\"hill\"/>"
                      "</body></worldbody>"),
              HasSubstr("geom 0 (unnamed, of body 'base'): no hfield 'hill', and the model"));
}

TEST_F(CompileProblems, AMissingAssetWithTwinRobotsOrTools) {
  const std::string tool = folder.Write(
      "tool", R"(<worldbody><body name="t"><geom type="mesh" mesh="foo"/></body></worldbody>)");
  const std::string with_tool =
      RobotFile("attachments: [{mjcf_path: tool.xml, prefix: t_, attach_to: {site: flange}}]\n");
  ExpectThrow<SpecError>([&] { BuildRobot(with_tool); }, tool + ":1: ");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("box", {1, 1, 1}));
  spec.robots.push_back(
      {.name = "left", .config = RobotConfig::Load(RobotFile("")), .prefix = "l_"});
  spec.objects.push_back({.name = "thing", .mjcf_path = tool});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "object 'thing': " + tool +
                             ":1: geom 0 (unnamed, of body 't'): no mesh "
                             "'foo', and the model has none");
}

TEST_F(CompileProblems, AMissingMeshNamesItsModel) {
  AtomicWrite(folder.path() / "link1.stl", "");
  const std::string model = folder.Write("meshes", R"(<asset>
  <mesh name="link" file="lnik1.stl"/>
  <mesh name="hand" file="visual/hand.stl"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="link"/></body></worldbody>)");
  const std::string file = File("meshes.yaml", "name: arm\nmodel: meshes.xml\n");
  const std::string in = folder.path().string();
  ExpectThrow<NotFoundError>(
      [&] { BuildRobot(file); },
      file + ":2:8: robot 'left': " + model +
          " refers to the file 'lnik1.stl' (mesh 'link', line " + "2), but there is no " + in +
          "/lnik1.stl. Did you mean 'link1.stl'? Also missing: " +
          "visual/hand.stl. Get the model with all its files, or correct `file`, `meshdir` or " +
          "`texturedir` in it");
}

TEST_F(CompileProblems, AMissingMeshWithoutASuggestionEndsWithOneFullStop) {
  folder.Write("meshes", R"(<asset><mesh file="q.stl"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="q"/></body></worldbody>)");
  const std::string in = folder.path().string();
  ExpectThrow<NotFoundError>(
      [&] { BuildRobot(File("meshes.yaml", "name: arm\nmodel: meshes.xml\n")); },
      "(mesh 'q', line 1), but there is no " + in + "/q.stl. Get the model with all its files");
}

TEST_F(CompileProblems, AMissingMeshOfAnObjectAndOfABase) {
  const std::string model = folder.Write("cup", R"(<compiler meshdir="meshes"/>
  <asset><mesh name="cup" file="cup.obj"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="cup"/></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "red", .mjcf_path = model});
  ExpectThrow<NotFoundError>([&] { Scene::Build(spec); },
                             "scene 'test' / object 'red': " + model +
                                 " refers to the file 'cup.obj' (mesh 'cup', line 2), but there is "
                                 "no folder " +
                                 folder.path().string() + "/meshes. Get the model");
  const SceneSpec based{.name = "test", .base = model};
  ExpectThrow<NotFoundError>([&] { Scene::Build(based); }, "scene 'test' / base: " + model);
}

// A clone without `git lfs pull` has pointers in the place of its large files, of any kind.
TEST_F(CompileProblems, ReportsAGitLfsPointerInsteadOfADecoderError) {
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a21\nsize 12345\n";
  const auto body = [](const std::string& of, const std::string& assets = "") {
    return assets + "<worldbody><body name='b'><geom size='.1'/>" + of + "</body></worldbody>";
  };
  const std::string mesh = "<geom type='mesh' mesh='a'/>";
  const std::string image = "<geom size='.1' material='a'/>";
  const struct {
    std::string file, model;
  } cases[] = {{"a.stl", body(mesh, "<asset><mesh name='a' file='a.stl'/></asset>")},
               {"a.obj", body(mesh, "<asset><mesh name='a' file='a.obj'/></asset>")},
               {"a.msh", body(mesh, "<asset><mesh name='a' file='a.msh'/></asset>")},
               {"a.png", body(image,
                              "<asset><texture name='t' type='2d' file='a.png'/>"
                              "<material name='a' texture='t'/></asset>")},
               {"b.png", body(image,
                              "<asset><texture name='t' type='cube' fileright='b.png'/>"
                              "<material name='a' texture='t'/></asset>")},
               {"h.png", body("<geom type='hfield' hfield='h'/>",
                              "<asset><hfield name='h' file='h.png' size='1 1 .1 .1'/></asset>")},
               {"h.bin", body("<geom type='hfield' hfield='h'/>",
                              "<asset><hfield name='h' file='h.bin' size='1 1 .1 .1'/></asset>")},
               {"a.skn", body("", "<deformable><skin file='a.skn'/></deformable>")},
               {"f.obj", body("<flexcomp type='mesh' file='f.obj' name='f' dim='2'/>")},
               {"part.xml", "<include file='part.xml'/>"},
               {"other.xml", body("<attach model='o' body='b' prefix='o'/>",
                                  "<asset><model name='o' file='other.xml'/></asset>")}};
  for (const auto& [file, model] : cases) {
    AtomicWrite(folder.path() / file, pointer);
    const std::string text = (folder.path() / file).string() +
                             ": a pointer of Git LFS, not the file itself: run `git lfs pull` "
                             "where the repository was cloned, or download the file";
    SceneSpec spec = EmptyScene();
    spec.base = folder.Write("room", model);
    ExpectThrow<SpecError>([&] { Scene::Build(spec); }, text);
    spec.base.reset();
    spec.objects.push_back({.name = "thing", .mjcf_path = folder.Write("thing", model)});
    ExpectThrow<SpecError>([&] { Scene::Build(spec); }, "object 'thing': " + text);
  }
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "thing", .mjcf_path = (folder.path() / "part.xml").string()});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); }, "part.xml: a pointer of Git LFS");
  folder.Write("tool", cases[0].model);
  ExpectThrow<SpecError>(
      [&] {
        BuildRobot(RobotFile(
            "attachments: [{mjcf_path: tool.xml, prefix: t_, attach_to: {site: flange}}]\n"));
      },
      "a.stl: a pointer of Git LFS");
}

}  // namespace
}  // namespace robocell::internal
