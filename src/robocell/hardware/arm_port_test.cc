#include "robocell/hardware/arm_port.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robocell/base/error.h"

namespace robocell {
namespace {

const std::vector<std::string> kJoints = {"shoulder", "elbow"};

ArmLimits Wide() {
  return {.lower = {-2, -2},
          .upper = {2, 2},
          .velocity = {3, 3},
          .acceleration = {9, 9},
          .force = {80, 80}};
}

TEST(ArmLimits, AreNarrowedValueByValue) {
  const ArmLimits both =
      Narrowed(Wide(), {.lower = {-1, -9}, .upper = {9, 1}, .velocity = {1, 9}}, kJoints, "arm");
  EXPECT_EQ(both.lower, (std::vector<double>{-1, -2}));
  EXPECT_EQ(both.upper, (std::vector<double>{2, 1}));
  EXPECT_EQ(both.velocity, (std::vector<double>{1, 3}));
  EXPECT_EQ(both.force, Wide().force);
}

TEST(ArmLimits, NeverBecomeWiderByValuesThatAreNotNumbers) {
  for (std::vector<double> ArmLimits::*field :
       {&ArmLimits::lower, &ArmLimits::upper, &ArmLimits::velocity, &ArmLimits::acceleration,
        &ArmLimits::force}) {
    ArmLimits own;
    (own.*field) = {1, std::nan("")};
    EXPECT_THROW(Narrowed(Wide(), own, kJoints, "arm"), ArgumentError);
  }
}

TEST(ArmPort, WaitsByItsOwnClock) {
  struct Bare : ArmPort {
    std::string name() const override { return "bare"; }
    std::vector<std::string> joint_names() const override { return {}; }
    ArmLimits limits() const override { return {}; }
    bool Read(ArmMeasurement& /*out*/) override { return false; }
    void Send(const ArmCommand& /*command*/) override {}
    void Hold() override {}
  } port;
  const double begin = port.now();
  port.WaitUntil(begin + 0.003);
  EXPECT_GE(port.now(), begin + 0.003);
  port.WaitUntil(begin - 1e9);
}

}  // namespace
}  // namespace robocell
