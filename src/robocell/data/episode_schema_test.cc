#include "robocell/data/episode_schema.h"

#include <gtest/gtest.h>

#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(EpisodeSchema, ColumnsOfOtherTablesAreInTheirFolder) {
  EpisodeSchema schema;
  const TableId control = schema.AddTable("control");
  const ColumnId time = schema.AddColumn({.name = "time"});
  const ColumnId ctrl = schema.AddColumn({.name = "left/ctrl", .shape = {8}}, control);
  EXPECT_EQ(schema.column(time).name, "time");
  EXPECT_EQ(schema.column(ctrl).name, "control/left/ctrl");
  EXPECT_EQ(schema.FindColumn("control/left/ctrl"), ctrl);
}

TEST(EpisodeSchema, SuggestsTheNearestName) {
  EpisodeSchema schema;
  schema.AddColumn({.name = "robots/arm/qpos"});
  schema.AddCamera({.name = "wrist", .width = 2, .height = 2});
  ExpectThrow<NotFoundError>([&] { schema.FindColumn("robots/arm/qpso"); },
                             "Did you mean 'robots/arm/qpos'?");
  ExpectThrow<NotFoundError>([&] { schema.FindCamera("wirst"); }, "Did you mean 'wrist'?");
}

TEST(EpisodeSchema, RejectsConflictingNames) {
  EpisodeSchema schema;
  schema.AddColumn({.name = "arm/qpos"});
  const TableId control = schema.AddTable("control");
  ExpectThrow<ArgumentError>([&] { schema.AddColumn({.name = "arm/qpos"}); },
                             "'arm/qpos' is declared twice");
  ExpectThrow<ArgumentError>(
      [&] { schema.AddColumn({.name = "arm"}); },
      "'arm/qpos' and 'arm' cannot both exist: one name is a folder of the other");
  ExpectThrow<ArgumentError>([&] { schema.AddColumn({.name = "control/x"}); },
                             "belongs to table 'control'");
  ExpectThrow<ArgumentError>([&] { schema.AddConstant({.name = "control/x"}, std::vector{1.0}); },
                             "belongs to table 'control'");
  ExpectThrow<ArgumentError>([&] { schema.AddTable("control"); },
                             "table 'control' is declared twice");
  ExpectThrow<ArgumentError>([&] { schema.AddTable("arm"); },
                             "'arm/qpos' already uses that folder");
  schema.AddColumn({.name = "arm/qpos"}, control);  // control/arm/qpos is another one
}

TEST(EpisodeSchema, RejectsInvalidPaths) {
  EpisodeSchema schema;
  for (const char* name : {"", "/qpos", "a//b", "a/", "..", "a/../b", "tab\t"}) {
    ExpectThrow<ArgumentError>([&] { schema.AddColumn({.name = name}); },
                               "is not a valid part of a path");
  }
  ExpectThrow<ArgumentError>([&] { schema.AddCamera({.name = "a/b", .width = 2, .height = 2}); },
                             "camera name 'a/b'");
  ExpectThrow<ArgumentError>([&] { schema.AddTable("../x"); }, "table name '../x'");
}

TEST(EpisodeSchema, ShapesAndComponentNamesMustMatch) {
  EpisodeSchema schema;
  ExpectThrow<ArgumentError>(
      [&] {
        schema.AddColumn({.name = "q", .shape = {3, 0}});
      },
      "column 'q': shape (3, 0) has an axis shorter than 1");
  ExpectThrow<ArgumentError>(
      [&] {
        schema.AddColumn({.name = "q", .shape = {7}, .names = {"x", "y"}});
      },
      "column 'q': 2 names (x, y) for a last axis of length 7");
  ExpectThrow<ArgumentError>([&] { schema.AddColumn({.name = "q", .values = {"open"}}); },
                             "names of values need an integer type, not float64");
  ExpectThrow<ArgumentError>(
      [&] {
        schema.AddConstant({.name = "k", .shape = {3, 3}}, std::vector{1.0});
      },
      "constant 'k': expected 9 values of shape (3, 3), got 1");
}

TEST(EpisodeSchema, RejectsAnOddVideoSizeAtDeclaration) {
  EpisodeSchema schema;
  ExpectThrow<ArgumentError>(
      [&] { schema.AddCamera({.name = "wrist", .width = 321, .height = 240}); },
      "camera 'wrist': 321x240 px cannot be encoded");
  schema.AddCamera({.name = "wrist", .width = 320, .height = 240});
  ExpectThrow<ArgumentError>([&] { schema.AddCamera({.name = "wrist", .width = 2, .height = 2}); },
                             "camera 'wrist' is declared twice");
}

TEST(EpisodeSchema, RejectsAHandleOfAnotherSchema) {
  EpisodeSchema schema;
  ExpectThrow<ArgumentError>([&] { schema.AddColumn({.name = "q"}, TableId{3}); },
                             "there is no table number 3");
}

}  // namespace
}  // namespace robocell
