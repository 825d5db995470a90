// Tests that rates are exact whole multiples of the engine's step, in ms or in Hz: others are
// rejected with the nearest valid ones.
#include "robocell/spec/rates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;
using testing::ValidationError;

TEST(Rates, AreMultiplesOfEachOther) {
  EXPECT_EQ((Rates{.policy_ms = 66, .control_ms = 2, .sim_ms = 1}.control_ticks()), 33);
  EXPECT_EQ((Rates{.policy_ms = 66, .control_ms = 2, .sim_ms = 1}.sim_steps()), 2);
  EXPECT_EQ((Rates{.policy_ms = 0.3, .control_ms = 0.1, .sim_ms = 0.1}.control_ticks()), 3);
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 65}),
            "it is not valid: policy_ms: 65 ms is not a multiple of control_ms (2 ms); the nearest "
            "are 64 ms (15.625 Hz) and 66 ms (500/33 Hz)");
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 0.066}),
            "it is not valid: policy_ms: 0.066 ms is not a multiple of control_ms (2 ms); the "
            "nearest are 2 ms (500 Hz) and 4 ms (250 Hz). Are these seconds? Then write 66");
  EXPECT_THAT(ValidationError(Rates{.policy_ms = 1, .control_ms = 2}), Not(HasSubstr("seconds")));
  EXPECT_THAT(ValidationError(Rates{.policy_ms = 1, .control_ms = 2}),
              HasSubstr("policy_ms: 1 ms is not a multiple of control_ms (2 ms)"));
  EXPECT_THAT(ValidationError(Rates{.sim_ms = 0}), HasSubstr("sim_ms: 0 must be greater than 0"));
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 1000, .control_ms = 500, .sim_ms = 500}),
            "it is not valid: sim_ms: 500 ms is too long for a step of the engine, at most 100 ms; "
            "2 ms is usual");
}

TEST(Rates, HaveDefaults) {
  EXPECT_EQ(ValidationError(Rates{}), "");
  EXPECT_EQ(Rates{}.policy_rate(), (Ratio{500, 33}));
  EXPECT_EQ(Rates{}.timestep().value(), 0.002);
  EXPECT_EQ(Rates{}.control_ticks(), 33);
  EXPECT_EQ(Rates{}.sim_steps(), 1);
  EXPECT_EQ(Rates{}.policy_period(), 0.066);
}

TEST(Rates, InHertzAreExact) {
  const Rates rates{.policy_hz = 30, .sim_hz = 480};
  EXPECT_EQ(ValidationError(rates), "");
  EXPECT_EQ(rates.policy_rate(), (Ratio{30, 1}));
  EXPECT_EQ(rates.timestep(), (Ratio{1, 480}));
  EXPECT_EQ(rates.timestep().value(), 1.0 / 480);
  EXPECT_EQ(rates.control_ticks() * rates.sim_steps(), 16);
  EXPECT_EQ((Rates{.policy_hz = 15, .control_hz = 240, .sim_hz = 480}.sim_steps()), 2);
  EXPECT_EQ((Rates{.policy_hz = 31.25}.policy_rate()), (Ratio{125, 4}));
}

// Returns the number at a position of a message, which may be a fraction.
double NumberAt(const std::string& text, size_t at) {
  size_t end = 0;
  const double number = std::stod(text.substr(at), &end);
  if (text[at + end] != '/') return number;
  return number / std::stod(text.substr(at + end + 1));
}

TEST(Rates, AcceptAnyRationalMultipleOfTheTimestep) {
  for (int steps = 1; steps < 200; ++steps) {
    for (const double sim_hz : {480.0, 500.0, 999.0, 1000.0 / 3}) {
      const Rates rates{.policy_hz = sim_hz / steps, .sim_hz = sim_hz};
      ASSERT_EQ(ValidationError(rates), "") << sim_hz << " / " << steps;
      ASSERT_EQ(rates.control_ticks() * rates.sim_steps(), steps);
      ASSERT_EQ(rates.policy_rate(), RatioOf(sim_hz) / steps);
    }
  }
}

TEST(Rates, SuggestTheNearestValidRates) {
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 33.3}),
            "it is not valid: policy_ms: 33.3 ms is not a multiple of control_ms (2 ms); the "
            "nearest are 32 ms (31.25 Hz) and 34 ms (500/17 Hz). For exactly 30 Hz set "
            "policy_hz: 30 and sim_hz: 480");
  EXPECT_EQ(ValidationError(Rates{.policy_hz = 30}),
            "it is not valid: policy_hz: 30 Hz is not a whole number of control ticks of 2 ms; the "
            "nearest are 31.25 Hz (32 ms) and 500/17 Hz (34 ms). For exactly 30 Hz set sim_hz: "
            "480");
  EXPECT_THAT(ValidationError(Rates{.policy_hz = 15, .control_ms = 2, .sim_ms = 2}),
              HasSubstr("For exactly 15 Hz set sim_hz: 480, without sim_ms, without control_ms"));
  EXPECT_THAT(ValidationError(Rates{.control_hz = 300}),
              HasSubstr("control_hz: 300 Hz is not a whole number of steps of the engine of 2 ms"));
}

TEST(Rates, SuggestedByTheMessageAreValid) {
  for (const double hz : {7.0, 10.0, 12.5, 15.0, 24.0, 29.97, 30.0, 60.0, 72.0, 144.0}) {
    const std::string text = ValidationError(Rates{.policy_hz = hz});
    if (text.empty()) continue;
    const size_t at = text.find("sim_hz: ");
    ASSERT_NE(at, std::string::npos) << text;
    const Rates rates{.policy_hz = hz, .sim_hz = NumberAt(text, at + 8)};
    EXPECT_EQ(ValidationError(rates), "");
    EXPECT_EQ(rates.policy_rate(), RatioOf(hz)) << text;
  }
}

// The suggestions can be used as printed: as fractions where digits are not exact.
TEST(Rates, SuggestedAsTheNearestAreAccepted) {
  int tried = 0;
  for (const double step_ms : {2.0, 1.0, 1000.0 / 480, 1000.0 / 999, 0.7}) {
    for (double hz = 3.1; hz < 200; hz *= 1.07) {
      const Rates by_hz{.policy_hz = hz, .control_ms = step_ms, .sim_ms = step_ms};
      const Rates by_ms{.policy_ms = 1000 / hz, .control_ms = step_ms, .sim_ms = step_ms};
      for (const Rates& rates : {by_hz, by_ms}) {
        const std::string text = ValidationError(rates);
        const size_t first = text.find("the nearest are "), second = text.find(" and ", first);
        if (first == std::string::npos) continue;
        for (const double number : {NumberAt(text, first + 16), NumberAt(text, second + 5)}) {
          Rates advised = rates;
          (rates.policy_hz ? advised.policy_hz : advised.policy_ms) = number;
          ASSERT_EQ(ValidationError(advised), "") << text;
          const double steps = (rates.policy_hz ? 1000 / number : number) / step_ms;
          ASSERT_NEAR(steps, std::round(steps), 1e-9 * steps) << text;
          ++tried;
        }
      }
    }
  }
  EXPECT_GT(tried, 500);
}

TEST(Rates, AreSuggestedOnlyIfApplicable) {
  int advised = 0;
  for (const double hz : {30000.0 / 1001, 24000.0 / 1001, 60000.0 / 1001, 100.0 / 7, 1e9, 1e7, 0.3,
                          29.97003, 1000.0 / 3, 13.0, 17.3, 59.94}) {
    const std::string text = ValidationError(Rates{.policy_hz = hz});
    const size_t at = text.find("sim_hz: ");
    if (at == std::string::npos) continue;
    ++advised;
    const Rates rates{.policy_hz = hz, .sim_hz = NumberAt(text, at + 8)};
    EXPECT_EQ(ValidationError(rates), "") << text;
  }
  EXPECT_GE(advised, 4);
  for (const double hz : {3.0, 7.0, 10.0}) {  // with a timestep that is nearly too long, or is
    for (const double sim_hz : {hz, 1.5 * hz, 9.0, 12.0}) {
      const std::string text =
          ValidationError(Rates{.policy_ms = 1000 / hz + 0.3, .sim_hz = sim_hz});
      const size_t at = text.find("set policy_hz: ");
      if (at == std::string::npos) continue;
      const Rates rates{.policy_hz = NumberAt(text, at + 15),
                        .sim_hz = NumberAt(text, text.find("sim_hz: ", at) + 8)};
      EXPECT_EQ(ValidationError(rates), "") << text;
    }
  }
  EXPECT_THAT(ValidationError(Rates{.policy_hz = 1e9}), Not(HasSubstr("For exactly")));
}

// A ratio has no denominator of 0, and no period is 0 s.
TEST(Rates, ThatAreNotMultiplesHaveNoPeriods) {
  for (const Rates& rates :
       {Rates{.policy_hz = 30, .sim_hz = 479.52}, Rates{.control_hz = 300}, Rates{.policy_ms = 65},
        Rates{.policy_hz = 0}, Rates{.policy_ms = -66}, Rates{.policy_ms = 1e15}}) {
    for (const auto& call : std::initializer_list<std::function<void()>>{
             [&] { rates.policy_rate(); }, [&] { rates.policy_period(); }})
      ExpectThrow<ArgumentError>(call, "is not valid");
  }
  ExpectThrow<ArgumentError>([] { Rates{.control_hz = 300}.control_period(); },
                             "300 Hz is not a whole number of steps of the engine");
  ExpectThrow<ArgumentError>([] { Ratio{}.inverse(); }, "a ratio of 0 has no inverse");
}

TEST(Rates, AreGivenInOneUnit) {
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 66, .policy_hz = 30, .sim_hz = 480}),
            "it is not valid: policy_hz: policy_ms is given too; keep one of them");
}

TEST(Rates, OfControllersFollowATimestepThatDoesNotDivideTheirDefault) {
  EXPECT_EQ((Rates{.policy_hz = 30, .sim_hz = 480}.sim_steps()), 1);
  EXPECT_EQ((Rates{.policy_ms = 66, .sim_ms = 1}.sim_steps()), 2);
  EXPECT_THAT(ValidationError(Rates{.policy_hz = 30, .control_ms = 2, .sim_hz = 480}),
              HasSubstr("control_ms: 2 ms is not a multiple of sim_hz (480 Hz); the nearest are "
                        "25/12 ms (480 Hz) and 25/6 ms (240 Hz)"));
}

std::string ReadError(const std::string& text) {
  try {
    FromYamlUnchecked<Rates>(text);
    return "";
  } catch (const SpecError& error) {
    return error.what();
  }
}

TEST(Rates, AreReadFromYamlAsNumbersAndFractions) {
  const Rates rates = FromYamlUnchecked<Rates>("{policy_hz: 500/33, sim_ms: 1000/500}");
  EXPECT_EQ(rates.policy_rate(), (Ratio{500, 33}));
  EXPECT_EQ(rates.control_ticks(), 33);
  EXPECT_EQ(FromYamlUnchecked<Rates>(ToYaml(rates)), rates);
  EXPECT_EQ((FromYamlUnchecked<Rates>("{policy_hz: 30, sim_ms: 1000/480}").policy_rate()),
            (Ratio{30, 1}));
  EXPECT_THAT(ReadError("{policy_hz: 30/0}"), HasSubstr("policy_hz"));
  EXPECT_THAT(ReadError("{policy_hz: a/b}"), HasSubstr("expected a number"));
}

TEST(Rates, RejectExtremeValues) {
  EXPECT_EQ(ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\n"
                                  "rates: {policy_ms: 66, control_ms: 2, sim_ms: 0.002}"),
            "f.yaml is not valid: f.yaml:4:47: rates.sim_ms: 0.002 ms is too short for a step of "
            "the engine, at least "
            "0.01 ms; 2 ms is usual");
  EXPECT_EQ(ValidationError(Rates{.sim_ms = 0.01}), "");
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 66e6}),
            "it is not valid: policy_ms: 6.6e+07 ms are 33000000 steps of the engine of 2 ms for "
            "every action, at most 1000000; 66 ms is usual");
}

TEST(Rates, ThatNoVideoCanRepresentAreRejected) {
  EXPECT_THAT(ValidationError(Rates{.policy_ms = 2.000000003, .sim_ms = 2.000000003}),
              HasSubstr("a ratio that no video holds exactly"));
}

}  // namespace
}  // namespace robocell
