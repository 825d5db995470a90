#include "robocell/expert/demonstration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "robocell/expert/skill.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

constexpr double kStep = 0.02;  // m of the TCP in a row

// A demonstration that is written like a script: the hand goes somewhere row by row, with what it
// holds.
class Script {
 public:
  Script(Eigen::Vector3d tcp, std::map<std::string, Eigen::Vector3d> bodies)
      : tcp_(std::move(tcp)), bodies_(std::move(bodies)) {}

  Script& Phase(const std::string& name) {
    const auto at = std::ranges::find(demo.phases, name);
    phase_ = static_cast<int>(at - demo.phases.begin());
    if (at == demo.phases.end()) demo.phases.push_back(name);
    return *this;
  }
  Script& Hold(std::vector<std::string> names) { return held_ = std::move(names), *this; }
  Script& Go(const Eigen::Vector3d& to) {
    while ((to - tcp_).norm() > 1e-9) {
      const Eigen::Vector3d by = (to - tcp_).normalized() * std::min(kStep, (to - tcp_).norm());
      Row(tcp_ + by);
      tcp_ += by;
      for (const std::string& name : held_) bodies_.at(name) += by;
    }
    return *this;
  }
  Script& Open(double opening) {
    for (int i = 0; i < 4; ++i) {
      opening_ += (opening - opening_) / (4 - i);
      Row(tcp_);
    }
    return *this;
  }

  Demonstration demo;

 private:
  void Row(const Eigen::Vector3d& target) {
    demo.tcp_in_world.emplace_back(tcp_);
    demo.target_in_world.emplace_back(target);
    demo.opening.push_back(opening_);
    demo.phase.push_back(phase_);
    for (const auto& [name, place] : bodies_) demo.bodies[name].emplace_back(place);
  }

  Eigen::Vector3d tcp_;
  std::map<std::string, Eigen::Vector3d> bodies_;
  std::vector<std::string> held_;
  double opening_ = 1;
  int phase_ = 0;
};

// Puts the red cube on the blue one; a third one stands nearer to where the red one lay.
Script Stack() {
  Script script({0, 0, 0.4},
                {{"red", {0.3, 0.2, 0}}, {"blue", {0.3, -0.2, 0}}, {"green", {0.2, 0.2, 0}}});
  script.Phase("open").Open(1).Phase("pregrasp").Go({0.3, 0.2, 0.15});
  script.Phase("grasp").Go({0.3, 0.2, 0}).Phase("close").Open(0);
  script.Hold({"red"}).Phase("lift").Go({0.3, 0.2, 0.15});
  script.Phase("transfer").Go({0.3, -0.2, 0.15});
  script.Phase("lower").Go({0.3, -0.2, 0.05}).Phase("release").Open(1).Hold({});
  script.Phase("retreat").Go({0.3, -0.2, 0.2}).Phase("done").Open(1);
  return script;
}

void ExpectStack(const std::vector<DemoSegment>& segments) {
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(segments[0].reference, "red");
  EXPECT_EQ(segments[0].held, "");
  EXPECT_EQ(segments[1].reference, "blue");
  EXPECT_EQ(segments[1].held, "red");
  EXPECT_LT(segments[0].end, segments[1].first);
}

TEST(DemonstrationTest, PhasesOfContactAreSegmentsOfTheirObjects) {
  const Demonstration demo = Stack().demo;
  ASSERT_TRUE(HasSegmentLabels(demo));
  const std::vector<DemoSegment> segments = FindSegments(demo);
  ExpectStack(segments);
  for (const DemoSegment& segment : segments) {
    for (int row = 0; row < demo.rows(); ++row) {
      const bool inside = row >= segment.first && row < segment.end;
      const std::string& phase =
          demo.phases[static_cast<size_t>(demo.phase[static_cast<size_t>(row)])];
      if (inside) EXPECT_FALSE(IsFreePhase(phase)) << phase;
    }
  }
}

TEST(DemonstrationTest, EachPhaseOfASkillIsFreeOrGuided) {
  EXPECT_THAT(SkillPhases(), IsSupersetOf(FreeSkillPhases()));
  for (const char* guided :
       {"align", "insert", "wipe", "carry", "pour", "lift", "follow", "press"}) {
    EXPECT_THAT(SkillPhases(), Contains(guided));
    EXPECT_FALSE(IsFreePhase(guided)) << guided;
  }
  for (const std::string& free : FreeSkillPhases()) EXPECT_TRUE(IsFreePhase(free)) << free;
}

// A full vessel is carried upright: that is a part, and not a motion to be planned anew.
TEST(DemonstrationTest, CarryingAVesselBelongsToItsPouring) {
  Script script({0, 0, 0.4}, {{"bottle", {0.3, 0.2, 0}}, {"bowl", {0.3, -0.2, 0}}});
  script.Phase("pregrasp").Go({0.3, 0.2, 0.15}).Phase("grasp").Go({0.3, 0.2, 0});
  script.Phase("close").Open(0).Hold({"bottle"}).Phase("lift").Go({0.3, 0.2, 0.15});
  script.Phase("transfer").Go({0.3, 0.1, 0.2}).Phase("carry").Go({0.3, -0.2, 0.2});
  script.Phase("pour").Go({0.3, -0.2, 0.15}).Phase("release").Open(1).Hold({});
  const std::vector<DemoSegment> segments = FindSegments(script.demo);
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(segments[1].held, "bottle");
  EXPECT_EQ(
      script.demo
          .phases[static_cast<size_t>(script.demo.phase[static_cast<size_t>(segments[1].first)])],
      "carry");
}

TEST(DemonstrationTest, WithoutPhasesTheGripperTellsTheSegments) {
  Demonstration demo = Stack().demo;
  demo.phase.clear();
  demo.phases.clear();
  ASSERT_FALSE(HasSegmentLabels(demo));
  const std::vector<DemoSegment> segments = FindSegments(demo);
  ExpectStack(segments);
  // They begin and end in the air.
  for (const int row : {segments[0].first, segments[0].end - 1, segments[1].end - 1})
    EXPECT_GE(demo.target_in_world[static_cast<size_t>(row)].translation().z(), 0.05);
}

TEST(DemonstrationTest, ASegmentThatMovesNothingIsLeftOut) {
  Script script({0, 0, 0.3}, {{"red", {0.3, 0.2, 0}}});
  script.Phase("pregrasp").Go({0.3, 0.2, 0.15}).Phase("grasp").Go({0.3, 0.2, 0.1});
  script.Phase("close").Open(0).Phase("open").Open(1);
  EXPECT_THAT(FindSegments(script.demo), IsEmpty());
  script.Phase("pregrasp").Go({0.3, 0.2, 0.15}).Phase("grasp").Go({0.3, 0.2, 0});
  script.Phase("close").Open(0).Hold({"red"}).Phase("lift").Go({0.3, 0.2, 0.15});
  const std::vector<DemoSegment> segments = FindSegments(script.demo);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].reference, "red");
}

TEST(DemonstrationTest, AGrippedDrawerIsTheReferenceAndNotWhatLiesInIt) {
  Script script({0, 0, 0.3},
                {{"cabinet", {0.6, 0, 0}}, {"drawer", {0.5, 0, 0.1}}, {"mug", {0.42, 0, 0.1}}});
  script.Phase("reach").Go({0.3, 0, 0.1}).Phase("approach").Go({0.4, 0, 0.1});
  script.Phase("close").Open(0).Hold({"drawer"}).Phase("follow").Go({0.36, 0, 0.1});
  script.Hold({"drawer", "mug"}).Go({0.3, 0, 0.1});  // the mug slides first
  script.Hold({}).Phase("release").Open(1).Phase("retreat").Go({0.2, 0, 0.1});
  const std::vector<DemoSegment> segments = FindSegments(script.demo);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].reference, "drawer");
  EXPECT_EQ(segments[0].held, "");
}

TEST(DemonstrationTest, WhatIsPutDownFarFromEverythingRefersToTheRootFrame) {
  Script script({0, 0, 0.3}, {{"red", {0.3, 0.2, 0}}, {"blue", {0.3, -0.8, 0}}});
  script.Phase("reach").Go({0.3, 0.2, 0.15}).Phase("grasp").Go({0.3, 0.2, 0}).Open(0);
  script.Hold({"red"}).Go({0.3, 0.2, 0.15}).Phase("transfer").Go({0.3, 0, 0.15});
  script.Phase("lower").Go({0.3, 0, 0}).Open(1).Hold({}).Phase("retreat").Go({0.3, 0, 0.2});
  const std::vector<DemoSegment> segments = FindSegments(script.demo);
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(segments[1].held, "red");
  EXPECT_EQ(segments[1].reference, "");
}

TEST(DemonstrationTest, WithoutPhasesAndGripperTheWholeEpisodeIsOneSegment) {
  Script script({0.2, 0, 0}, {{"block", {0.3, 0, 0}}});
  script.Go({0.28, 0, 0}).Hold({"block"}).Go({0.4, 0, 0});
  Demonstration demo = script.demo;
  demo.opening.clear();
  demo.phase.clear();
  demo.phases.clear();
  const std::vector<DemoSegment> segments = FindSegments(demo);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].first, 0);
  EXPECT_EQ(segments[0].end, demo.rows());
  EXPECT_EQ(segments[0].reference, "block");
}

}  // namespace
}  // namespace robocell::internal
