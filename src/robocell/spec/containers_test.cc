#include "robocell/spec/containers.h"

#include <gtest/gtest.h>

#include "robocell/spec/scene_spec.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(List, ElementsKeepTheirAddressWhenItGrows) {
  List<RobotSpec> robots;
  RobotSpec* first = &robots.push_back({.path = "a.xml"});
  for (int i = 0; i < 100; ++i) robots.push_back({.path = "b.xml"});
  EXPECT_EQ(first, &robots[0]);
  EXPECT_EQ(first->path, "a.xml");
}

TEST(List, CopyIsDeep) {
  List<RobotSpec> robots = {{.path = "a.xml"}};
  const List<RobotSpec> copy = robots;
  robots[0].path = "b.xml";
  EXPECT_EQ(copy[0].path, "a.xml");
  EXPECT_FALSE(copy == robots);
}

TEST(List, AssigningItToItselfChangesNothing) {
  List<RobotSpec> robots = {{.path = "a.xml"}};
  const List<RobotSpec>& same = robots;
  robots = same;
  ASSERT_EQ(robots.size(), 1u);
  EXPECT_EQ(robots[0].path, "a.xml");
}

TEST(List, IteratesInOrderAndInPlace) {
  List<BaseConfig> bases = {{.kind = BaseKind::kFree}, {.kind = BaseKind::kPlanar}};
  for (BaseConfig& base : bases) base.size = Vec3{1, 2, 3};
  EXPECT_EQ(bases[0].size, (Vec3{1, 2, 3}));
  EXPECT_EQ(bases.back().kind, BaseKind::kPlanar);
}

TEST(Map, KeepsTheOrderOfInsertion) {
  Map<BaseConfig> map;
  map["z"];
  map["a"];
  map["z"].kind = BaseKind::kFree;
  EXPECT_EQ(map.keys(), (std::vector<std::string>{"z", "a"}));
  EXPECT_EQ(map.at("z").kind, BaseKind::kFree);
}

TEST(Map, CopyIsDeep) {
  Map<BaseConfig> map = {{"a", {}}};
  const Map<BaseConfig> copy = map;
  map["a"].kind = BaseKind::kFree;
  EXPECT_EQ(copy.at("a").kind, BaseKind::kFixed);
  EXPECT_FALSE(copy == map);
}

TEST(Map, SuggestsTheNearestKey) {
  Map<BaseConfig> map = {{"arm", {}}, {"gripper", {}}};
  ExpectThrow<NotFoundError>([&] { map.at("griper"); },
                             "no entry 'griper'. Known entries: arm, gripper. Did you mean "
                             "'gripper'?");
}

TEST(Maybe, HoldsAnOptionalValue) {
  Maybe<BaseConfig> base;
  EXPECT_FALSE(base.has_value());
  EXPECT_EQ(base.value_or({.kind = BaseKind::kFree}).kind, BaseKind::kFree);
  base = BaseConfig{.kind = BaseKind::kMocap};
  const Maybe<BaseConfig> copy = base;
  EXPECT_TRUE(copy == base);
  base->kind = BaseKind::kPlanar;
  EXPECT_EQ(copy->kind, BaseKind::kMocap);
  EXPECT_FALSE(copy == base);
  base = std::nullopt;
  EXPECT_FALSE(base);
  EXPECT_FALSE(copy == base);
}

TEST(NameList, ExpandsNumberedRanges) {
  EXPECT_EQ(NameList::Expand("joint1..joint3"), (NameList{"joint1", "joint2", "joint3"}));
  EXPECT_EQ(NameList::Expand("a9..a11"), (NameList{"a9", "a10", "a11"}));
  EXPECT_EQ(NameList::Expand("j1..j1"), (NameList{"j1"}));
  EXPECT_EQ(NameList::Expand("wrist.joint"), (NameList{"wrist.joint"}));
}

TEST(NameList, AcceptsTheNumberAnywhereInNames) {
  EXPECT_EQ(NameList::Expand("arm_1_joint..arm_3_joint"),
            (NameList{"arm_1_joint", "arm_2_joint", "arm_3_joint"}));
  EXPECT_EQ(NameList::Expand("r2_j1..r2_j3"), (NameList{"r2_j1", "r2_j2", "r2_j3"}));
  EXPECT_EQ(NameList::Expand("r2_j1..r3_j1"), (NameList{"r2_j1", "r3_j1"}));
  EXPECT_EQ(NameList::Expand("j09x..j10x"), (NameList{"j09x", "j10x"}));
}

TEST(NameList, KeepsLeadingZeros) {
  EXPECT_EQ(NameList::Expand("j08..j10"), (NameList{"j08", "j09", "j10"}));
}

TEST(NameList, RejectsInvalidRanges) {
  for (const char* text :
       {"joint1..act7", "joint7..joint1", "joint..joint7", "..", "a1..", "..a2", "a1..a99999",
        "a1x..a3y", "a1x..b3x", "r1_j1..r2_j2", "a1..a99999999999999999999", "a01..a1"}) {
    ExpectThrow<ArgumentError>(
        [&] { NameList::Expand(text); },
        "'" + std::string(text) + "' is not a range of names: write it like joint1..joint7");
  }
}

}  // namespace
}  // namespace robocell
