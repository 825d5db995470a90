#include "robocell/spec/scene_source_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ParseError;

const std::string kHead = "run: r\nrobot: {name: a, model: b}\noutput: o\nscenes: ";

SceneSourceSpec ParseScenes(const std::string& scenes) {
  return ParseYaml<RunConfig>(kHead + scenes, "run.yaml", "").scenes;
}

TEST(SceneSourceSpec, IsATabletopByDefault) {
  EXPECT_EQ(SceneSourceSpec().kind(), "tabletop");
  EXPECT_EQ(ParseScenes("{houses: 0..2}").houses.values, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(ParseScenes("{source: tabletop}"), SceneSourceSpec());
}

TEST(SceneSourceSpec, FilesImplyTheKind) {
  const SceneSourceSpec scenes = ParseScenes("{files: [lab.xml], root: cells}");
  EXPECT_EQ(scenes.kind(), "files");
  EXPECT_THAT(scenes.As<FilesScenes>().files, ElementsAre("lab.xml"));
  EXPECT_EQ(scenes.As<FilesScenes>().root, "cells");
  ExpectThrow<SpecError>([&] { (void)scenes.As<TabletopScenes>(); },
                         "scene source: is of kind files, where fields of tabletop are needed");
}

TEST(SceneSourceSpec, EachKindHasItsOwnFields) {
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: files}"),
              HasSubstr("scenes.files: `source: files` needs at least one MJCF file"));
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: tabletop, files: [a]}"),
              HasSubstr("scenes.files: a TabletopScenes: no field 'files'"));
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: tabletop, files: [a]}"),
              HasSubstr("It is a field of `source: files`"));
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: files, fils: [a]}"),
              HasSubstr("Did you mean 'files'?"));
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: files, files: [a], huoses: [0]}"),
              HasSubstr("Did you mean 'houses'?"));
}

TEST(SceneSourceSpec, SuggestsTheNearestKind) {
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: tabletpo}"),
              HasSubstr("f.yaml:4:18: scenes.source: no scene source 'tabletpo'"));
  EXPECT_THAT(ParseError<RunConfig>(kHead + "{source: tabletpo}"),
              HasSubstr("Did you mean 'tabletop'?"));
  EXPECT_THAT(ParseError<RunConfig>(kHead + "tabletop"), HasSubstr("write {source: tabletop}"));
}

TEST(SceneSourceSpec, CopiesAreDeepAndChangingTheKindBringsItsDefaults) {
  SceneSourceSpec a = FilesScenes{.files = {"lab.xml"}};
  SceneSourceSpec b = a;
  b.As<FilesScenes>().files = {"shop.xml"};
  EXPECT_THAT(a.As<FilesScenes>().files, ElementsAre("lab.xml"));
  EXPECT_FALSE(a == b);
  b.SetKind("tabletop");
  EXPECT_EQ(b, SceneSourceSpec());
  ExpectThrow<NotFoundError>([&] { b.SetKind("lab"); }, "no scene source 'lab'");
}

TEST(SceneSourceSpec, HousesAreDistinctIntegers) {
  const auto error = [](const std::string& scenes) {
    return ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\nscenes: " +
                                 scenes);
  };
  EXPECT_EQ(error("{houses: [0..3, 7]}"), "");
  EXPECT_THAT(error("{houses: [0..3, 2]}"),
              HasSubstr("f.yaml:4:18: scenes.houses: 2 is listed twice"));
  EXPECT_THAT(error("{houses: 3..0}"), HasSubstr("rising range like 0..3, found '3..0'"));
  EXPECT_THAT(error("{houses: [-1]}"), HasSubstr("scenes.houses: -1 is negative"));
  EXPECT_THAT(error("{houses: some}"), HasSubstr("expected whole numbers"));
}

}  // namespace
}  // namespace robocell
