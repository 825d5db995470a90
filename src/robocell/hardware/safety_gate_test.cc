#include "robocell/hardware/safety_gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr double kPeriod = 0.01;

ArmLimits Limits(size_t n) {
  return {.lower = std::vector<double>(n, -1),
          .upper = std::vector<double>(n, 1),
          .velocity = std::vector<double>(n, 2),
          .acceleration = std::vector<double>(n, 5),
          .force = std::vector<double>(n, 50)};
}

// A gate in front of an arm that goes where it is commanded.
struct Gated {
  explicit Gated(const SafetyOptions& options = {}, size_t n = 1)
      : gate(std::vector<std::string>(n, "elbow"), Limits(n), options, kPeriod) {
    arm.pos.assign(n, 0);
    arm.vel.assign(n, 0);
    arm.force.assign(n, 0);
  }
  // Returns what was sent in one tick.
  const ArmCommand* Tick(const std::vector<double>& wanted) {
    now += kPeriod;
    arm.time += kPeriod;
    if (hears) gate.Accept(arm, now);
    const ArmCommand* sent = gate.Next(wanted, kNoOpening, now);
    if (sent && moves) arm.pos = sent->pos;
    return sent;
  }

  SafetyGate gate;
  ArmMeasurement arm;
  double now = 100;
  bool hears = true, moves = true;
};

TEST(SafetyGate, KeepsEveryLimitWhateverIsWanted) {
  Rng rng = Rng::Stream(7, "safety gate");
  for (int run = 0; run < 20; ++run) {
    const double slow_start = run % 2 == 0 ? 0 : 0.5;
    Gated arm({.speed = rng.Uniform(0.2, 1), .slow_start = slow_start, .max_lead = 5}, 2);
    std::vector<double> wanted(2), before = arm.arm.pos, speed(2);
    for (int tick = 0; tick < 400; ++tick) {
      if (rng.Uniform(0, 1) < 0.1) {
        for (double& w : wanted) w = rng.Uniform(-1, 1) * (rng.Uniform(0, 1) < 0.3 ? 1e6 : 1.5);
      }
      const ArmCommand* sent = arm.Tick(wanted);
      ASSERT_NE(sent, nullptr);
      for (size_t i = 0; i < 2; ++i) {
        const double v = (sent->pos[i] - before[i]) / kPeriod;
        EXPECT_LE(std::abs(sent->pos[i]), 1);
        EXPECT_LE(std::abs(v), 2 + 1e-9);
        EXPECT_LE(std::abs(v - speed[i]), 5 * kPeriod + 1e-6) << "run " << run << " tick " << tick;
        speed[i] = v;
      }
      before = sent->pos;
    }
  }
}

TEST(SafetyGate, ArrivesWithoutOvershootAndInGoodTime) {
  Gated arm({.slow_start = 0, .max_lead = 5});
  double farthest = 0;
  int tick = 0;
  for (; tick < 400 && std::abs(arm.arm.pos[0] - 0.8) > 1e-6; ++tick) {
    arm.Tick({0.8});
    farthest = std::max(farthest, arm.arm.pos[0]);
  }
  EXPECT_LE(farthest, 0.8 + 1e-9);
  EXPECT_LT(tick * kPeriod, 1.2 * 2 * std::sqrt(0.8 / 5)) << "the fastest motion, and a fifth more";
}

TEST(SafetyGate, StartsSlowlyAndLeadsABlockedArmByLittle) {
  Gated slow({.slow_start = 2, .max_lead = 5}), blocked({.slow_start = 0, .max_lead = 0.05});
  for (int tick = 0; tick < 10; ++tick) slow.Tick({1});
  EXPECT_LT(slow.arm.pos[0], 0.1 * 0.35 * 2);
  blocked.moves = false;
  for (int tick = 0; tick < 200; ++tick) blocked.Tick({1});
  EXPECT_LE(blocked.gate.command().pos[0], 0.05 + 1e-9);
  EXPECT_GT(blocked.gate.counts().limited, 0);
}

// Lets the arm move, then does something to it; expects that it brakes, and stops for this reason.
void ExpectStop(Gated& arm, const std::function<void()>& happens, const std::string& reason) {
  for (int tick = 0; tick < 20; ++tick) ASSERT_NE(arm.Tick({1}), nullptr);
  ASSERT_EQ(arm.gate.state(), ArmState::kRunning) << arm.gate.reason();
  happens();
  const ArmCommand* sent = nullptr;
  std::vector<double> last = arm.gate.command().pos;
  double speed = arm.gate.command().vel[0];
  for (int tick = 0; tick < 200; ++tick) {
    sent = arm.Tick({1});
    if (!sent) break;
    EXPECT_LE(std::abs(sent->vel[0] - speed), 5 * kPeriod + 1e-9);
    speed = sent->vel[0];
  }
  EXPECT_EQ(arm.gate.state(), ArmState::kStopped);
  EXPECT_NE(arm.gate.reason().find(reason), std::string::npos) << arm.gate.reason();
  EXPECT_TRUE(arm.gate.is_at_rest());
  const std::vector<double> rest = arm.gate.command().pos;
  arm.hears = true;
  for (int tick = 0; tick < 20; ++tick) arm.Tick({-1});
  EXPECT_EQ(arm.gate.command().pos, rest) << "a stop is final";
}

TEST(SafetyGate, StopsWhenNothingGoodIsMeasured) {
  const SafetyOptions fast{.watchdog = 0.1, .slow_start = 0, .max_lead = 5};
  Gated silent(fast), frozen(fast), damaged(fast), jumping(fast), slow(fast), late(fast);
  ExpectStop(
      silent, [&] { silent.hears = false; }, "no good measurement");
  ExpectStop(
      frozen, [&] { frozen.arm.time = -1e9; }, "too old");
  ExpectStop(
      damaged, [&] { damaged.arm.vel[0] = std::nan(""); }, "damaged");
  ExpectStop(
      jumping, [&] { jumping.moves = false, jumping.arm.pos[0] = 9; }, "damaged");
  ExpectStop(
      slow, [&] { slow.arm.time += 1e3; }, "too old");
  ExpectStop(
      late, [&] { late.now += 0.2; }, "no good measurement");
}

TEST(SafetyGate, StopsAtForcesAndAtCommandsThatAreNotFinite) {
  const SafetyOptions fast{.slow_start = 0, .max_lead = 5};
  Gated pressed(fast), wrong(fast), few(fast);
  ExpectStop(
      wrong, [&] { (void)wrong.gate.Next(std::vector{std::nan("")}, 0, wrong.now); },
      "commanded nan to joint 'elbow'");
  ExpectStop(
      few, [&] { (void)few.gate.Next({}, 0, few.now); }, "commanded 0 joints");
  for (int tick = 0; tick < 20; ++tick) pressed.Tick({1});
  const double at = pressed.arm.pos[0];
  pressed.moves = false;
  pressed.arm.force[0] = -60;
  pressed.Tick({1});
  EXPECT_NE(pressed.gate.reason().find("beyond its limit of 50.0"), std::string::npos);
  for (int tick = 0; tick < 300; ++tick) pressed.Tick({1});
  EXPECT_NEAR(pressed.gate.command().pos[0], at, 1e-6) << "it presses no more";
}

TEST(SafetyGate, HoldsWhileTheDeadMansSwitchIsReleased) {
  Gated arm({.slow_start = 0, .dead_man = 0.05, .max_lead = 5});
  for (int tick = 0; tick < 20; ++tick) arm.Tick({1});
  EXPECT_EQ(arm.gate.state(), ArmState::kHolding);
  EXPECT_EQ(arm.arm.pos[0], 0);
  for (int tick = 0; tick < 20; ++tick) arm.gate.Renew(arm.now), arm.Tick({1});
  EXPECT_EQ(arm.gate.state(), ArmState::kRunning);
  for (int tick = 0; tick < 40; ++tick) arm.Tick({1});
  EXPECT_EQ(arm.gate.state(), ArmState::kHolding);
  EXPECT_TRUE(arm.gate.is_at_rest());
  EXPECT_LT(arm.arm.pos[0], 0.9);
  for (int tick = 0; tick < 200; ++tick) arm.gate.Renew(arm.now), arm.Tick({1});
  EXPECT_NEAR(arm.arm.pos[0], 1, 1e-6);
}

TEST(SafetyGate, SendsNothingInADryRun) {
  Gated arm({.slow_start = 0, .dry_run = true});
  for (int tick = 0; tick < 100; ++tick) EXPECT_EQ(arm.Tick({0.5}), nullptr);
  EXPECT_NEAR(arm.gate.command().pos[0], 0.5, 0.05) << "what would be sent";
  EXPECT_EQ(arm.gate.counts().sent, 0);
}

TEST(SafetyGate, RefusesToBeginOutsideTheLimits) {
  Gated arm;
  arm.arm.pos[0] = 1.5;
  EXPECT_EQ(arm.Tick({0}), nullptr);
  EXPECT_NE(arm.gate.reason().find("joint 'elbow' is at 1.500, outside its limits -1.000 to 1.000"),
            std::string::npos);
}

TEST(SafetyGate, BeginsWhereTheArmIsBeforeTheFirstTick) {
  Gated arm({.slow_start = 0});
  arm.gate.Accept(arm.arm, arm.now);
  arm.now += 5, arm.arm.time += 5, arm.arm.pos[0] = 0.6;  // moved by hand
  const ArmCommand* sent = arm.Tick({0.6});
  ASSERT_NE(sent, nullptr) << arm.gate.reason();
  EXPECT_EQ(sent->pos[0], 0.6);
}

TEST(SafetyGate, StopsFarBeyondTheLimitsAlsoLater) {
  Gated arm({.slow_start = 0});
  for (int tick = 0; tick < 10; ++tick) ASSERT_NE(arm.Tick({0}), nullptr);
  arm.moves = false;
  for (int tick = 0; tick < 20 && arm.gate.state() != ArmState::kStopped; ++tick) {
    arm.arm.pos[0] += 0.06;  // a servo that runs away
    arm.Tick({0});
  }
  EXPECT_NE(arm.gate.reason().find("outside its limits -1.000 to 1.000"), std::string::npos)
      << arm.gate.reason();
}

TEST(SafetyGate, RejectsOptionsThatGuardNothing) {
  const auto make = [](const SafetyOptions& options) { return [options] { Gated{options}; }; };
  ExpectThrow<ArgumentError>(make({.speed = 1.5}), "speed is 1.5");
  ExpectThrow<ArgumentError>(make({.watchdog = 0}), "watchdog is 0");
  ExpectThrow<ArgumentError>(make({.watchdog = std::numeric_limits<double>::infinity()}),
                             "watchdog");
  ExpectThrow<ArgumentError>(make({.max_lead = std::nan("")}), "max_lead is nan");
  ExpectThrow<ArgumentError>(make({.limits = {.velocity = {1, 2}}}), "`velocity`");
  ExpectThrow<ArgumentError>(make({.limits = {.lower = {3}}}),
                             "joint 'elbow' has the limits 3 to 1");
}

// Forces that push an arm of mass 1 without gravity.
struct Pushed : Gated {
  explicit Pushed(const SafetyOptions& options = {.slow_start = 0}) : Gated(options) {}
  const ArmCommand* Push(double force) {
    now += kPeriod;
    arm.time += kPeriod;
    gate.Accept(arm, now);
    const ArmCommand* sent = gate.NextForces(std::vector<double>{force}, kNoOpening, now);
    if (!sent) return sent;
    if (sent->force.empty()) {
      speed = (sent->pos[0] - arm.pos[0]) / kPeriod;
      arm.pos = sent->pos;
    } else {
      speed += sent->force[0] * kPeriod;
      arm.pos[0] += speed * kPeriod;
    }
    arm.vel[0] = has_velocities ? speed : 0;
    return sent;
  }

  double speed = 0;
  bool has_velocities = true;
};

TEST(SafetyGate, ForcesStayWithinTheirLimits) {
  Pushed arm;
  const ArmCommand* sent = arm.Push(1e6);
  ASSERT_NE(sent, nullptr);
  EXPECT_EQ(sent->force, std::vector<double>{50});
  EXPECT_EQ(arm.gate.counts().limited, 1);
  EXPECT_EQ(arm.Push(-0.25)->force, std::vector<double>{-0.25});
}

TEST(SafetyGate, AnArmThatForcesCarryAwayBrakesBeforeItsLimits) {
  Rng rng = Rng::Stream(3, "forces");
  for (int run = 0; run < 50; ++run) {
    Pushed arm;
    const double force = rng.Uniform(0.2, 20) * (run % 2 == 0 ? 1 : -1);
    for (int tick = 0; tick < 2000; ++tick) {
      if (!arm.Push(force)) break;
      EXPECT_LT(std::abs(arm.arm.pos[0]), 1 + 0.02) << "force " << force;
      EXPECT_LT(std::abs(arm.arm.vel[0]), 2 + 0.05 + std::abs(force) * kPeriod);
    }
    EXPECT_EQ(arm.gate.state(), ArmState::kStopped);
    EXPECT_NE(arm.gate.reason().find("under torques"), std::string::npos) << arm.gate.reason();
    EXPECT_TRUE(arm.gate.is_at_rest());
  }
}

TEST(SafetyGate, ForcesNeedMeasuredVelocities) {
  for (const double force : {0.2, -3.0, 20.0}) {
    Pushed arm;
    arm.has_velocities = false;
    for (int tick = 0; tick < 2000 && arm.Push(force); ++tick) {
      EXPECT_LT(std::abs(arm.arm.pos[0]), 0.05 + 2 * std::abs(arm.speed) * kPeriod);
    }
    EXPECT_EQ(arm.gate.state(), ArmState::kStopped);
    EXPECT_NE(arm.gate.reason().find("must measure its velocities"), std::string::npos)
        << arm.gate.reason();
  }
}

TEST(SafetyGate, ADryRunOfForcesFollowsWhoeverMovesTheArm) {
  Pushed arm({.dry_run = true});
  for (int tick = 0; tick < 400; ++tick) {
    arm.arm.pos[0] = 1.05 * std::sin(tick * kPeriod * 3.5);  // faster and farther than allowed
    arm.arm.vel[0] = 3.7 * std::cos(tick * kPeriod * 3.5);
    EXPECT_EQ(arm.Push(5), nullptr);
    ASSERT_EQ(arm.gate.state(), ArmState::kRunning) << arm.gate.reason();
  }
}

TEST(SafetyGate, ForcesNeedALimitAndFiniteValues) {
  Pushed arm;
  arm.Push(std::numeric_limits<double>::quiet_NaN());
  EXPECT_NE(arm.gate.reason().find("commanded nan"), std::string::npos) << arm.gate.reason();
  ArmLimits limits = Limits(1);
  limits.force[0] = std::numeric_limits<double>::infinity();
  SafetyGate gate({"elbow"}, limits, {}, kPeriod);
  gate.Accept({.time = 1, .pos = {0}, .vel = {0}, .force = {0}}, 1);
  const ArmCommand* sent = gate.NextForces(std::vector<double>{1}, kNoOpening, 1);
  EXPECT_TRUE(!sent || sent->force.empty());
  EXPECT_NE(gate.reason().find("no limit of force"), std::string::npos) << gate.reason();
}

TEST(SafetyGate, SilenceAndTheDeadMansSwitchEndForces) {
  Pushed arm({.slow_start = 0, .dead_man = 0.05});
  arm.gate.Renew(arm.now);
  EXPECT_FALSE(arm.Push(0.1)->force.empty());
  for (int tick = 0; tick < 10; ++tick) arm.Push(0.1);
  EXPECT_EQ(arm.gate.state(), ArmState::kHolding);
  EXPECT_TRUE(arm.Push(0.1)->force.empty());
  arm.gate.Renew(arm.now);
  EXPECT_FALSE(arm.Push(0.1)->force.empty()) << "it goes on";
  arm.gate.Renew(arm.now + 10);
  arm.now += 1;
  const ArmCommand* sent = arm.gate.NextForces(std::vector<double>{0.1}, kNoOpening, arm.now);
  EXPECT_TRUE(!sent || sent->force.empty());
  EXPECT_EQ(arm.gate.state(), ArmState::kStopped);
}

}  // namespace
}  // namespace robocell
