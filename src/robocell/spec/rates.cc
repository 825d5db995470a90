#include "robocell/spec/rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/timestep.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

constexpr double kPolicyMs = 66, kControlMs = 2, kSimMs = 2;  // defaults

// With more steps than these, one action takes longer than anybody waits.
constexpr double kMostStepsPerAction = 1e6;
constexpr double kMostTicks = 1e9;

// A time as it was given: in ms or in Hz.
struct GivenTime {
  const char* ms_field;
  const char* hz_field;
  const std::optional<double>& ms;
  const std::optional<double>& hz;
  double default_ms;

  bool is_given() const { return ms || hz; }
  const char* field() const { return hz ? hz_field : ms_field; }
  double period_ms() const { return hz ? 1000 / *hz : ms.value_or(default_ms); }
  // Formats "33.3 ms" or "30 Hz".
  std::string Text() const {
    return hz ? fmt::format("{:g} Hz", *hz) : fmt::format("{:g} ms", ms.value_or(default_ms));
  }
  // Formats "control_ms (2 ms)".
  std::string Named() const { return fmt::format("{} ({})", field(), Text()); }
  bool is_positive() const { return period_ms() > 0 && std::isfinite(period_ms()); }
};

GivenTime PolicyOf(const Rates& rates) {
  return {"policy_ms", "policy_hz", rates.policy_ms, rates.policy_hz, kPolicyMs};
}
GivenTime SimOf(const Rates& rates) {
  return {"sim_ms", "sim_hz", rates.sim_ms, rates.sim_hz, kSimMs};
}
// Without a given value, controllers run at every step if 2 ms are not a whole number of steps.
GivenTime ControlOf(const Rates& rates) {
  const double step = SimOf(rates).period_ms();
  return {"control_ms", "control_hz", rates.control_ms, rates.control_hz,
          TimesIn(kControlMs, step) > 0 ? kControlMs : step};
}

int Ticks(double whole_ms, double part_ms) {
  const int64_t times = TimesIn(whole_ms, part_ms);
  return times <= kMostTicks ? static_cast<int>(times) : 0;
}

// Formats a number exactly: "31.25", "500/17". A file may contain fractions.
std::string Exactly(double value) {
  constexpr int64_t kLargest = 1'000'000;  // longer fractions do not help a reader
  std::string digits = fmt::format("{:.6g}", value);
  double read = 0;  // std::stod would follow the locale of the program
  std::from_chars(digits.data(), digits.data() + digits.size(), read);
  if (read == value) return digits;
  if (!(value > 0) || value > kLargest) return fmt::format("{}", value);
  const Ratio ratio = RatioOf(value);
  return ratio.num <= kLargest && ratio.den <= kLargest ? ratio.Text() : fmt::format("{}", value);
}

// Formats the time of `count` parts in the unit that the user chose, with the other one behind it:
// "32 ms (31.25 Hz)".
std::string Nearest(double ms, bool in_hz) {
  const double hz = 1000 / ms;
  return in_hz ? fmt::format("{} Hz ({} ms)", Exactly(hz), Exactly(ms))
               : fmt::format("{} ms ({} Hz)", Exactly(ms), Exactly(hz));
}

// Returns the rate that the user probably means: the given one, or a whole number near the time. 0
// if there is none.
double MeantHz(const GivenTime& time) {
  if (time.hz) return *time.hz;
  const double hz = 1000 / time.period_ms(), whole = std::round(hz);
  const bool is_close = whole >= 1 && whole <= 1000 && std::abs(hz - whole) < 0.002 * whole;
  return is_close ? whole : 0;
}

// Returns a number of steps per second that `hz` divides: near the present one, and divisible by
// two as often as possible.
double SuitableSimHz(double hz, double now_hz) {
  const auto twos = [](int n) {
    int count = 0;
    for (; n % 2 == 0; n /= 2) ++count;
    return count;
  };
  const double times = now_hz / hz;
  const double fewest = std::min(std::ceil(1 / (internal::kLongestTimestep * hz)), 1e6);
  const int least = std::max(1, static_cast<int>(fewest));
  const int middle = std::max(least, static_cast<int>(std::lround(std::min(times, 1e6))));
  int best = middle;
  for (int n = std::max(least, static_cast<int>(std::ceil(0.8 * middle))); n <= 1.25 * middle;
       ++n) {
    const bool nearer = std::abs(n - times) < std::abs(best - times);
    if (twos(n) > twos(best) || (twos(n) == twos(best) && nearer)) best = n;
  }
  return hz * best;
}

// Returns true if these rates are valid: advice must be.
bool IsTaken(const Rates& rates) {
  constexpr int64_t kMost = std::numeric_limits<int>::max();
  if (!internal::TimestepProblem(SimOf(rates).period_ms(), 1000).empty()) return false;
  if (rates.sim_steps() <= 0 || rates.control_ticks() <= 0) return false;
  try {
    const Ratio rate = rates.policy_rate();
    return rate.num <= kMost && rate.den <= kMost;
  } catch (const ArgumentError&) {
    return false;
  }
}

// Returns ". For exactly 30 Hz set policy_hz: 30 and sim_hz: 480"; "" if no round rate was meant or
// no timestep gives it. Numbers are exact, as digits or fractions, so that they can be copied.
std::string HowToGet(const GivenTime& time, const Rates& rates) {
  const double hz = MeantHz(time);
  if (hz == 0) return "";
  const double sim_hz = SuitableSimHz(hz, 1000 / SimOf(rates).period_ms());
  if (!IsTaken({.policy_hz = hz, .sim_hz = sim_hz})) return "";
  std::string text = fmt::format(". For exactly {} Hz set ", Exactly(hz));
  if (!time.hz) text += fmt::format("{}: {} and ", time.hz_field, Exactly(hz));
  text += fmt::format("sim_hz: {}", Exactly(sim_hz));
  const GivenTime control = ControlOf(rates), sim = SimOf(rates);
  if (sim.ms) text += ", without sim_ms";
  if (control.is_given() && time.hz_field != control.hz_field)
    text += fmt::format(", without {}", control.field());
  return text;
}

void ValidateMultiple(const GivenTime& whole, const GivenTime& part, const char* parts,
                      const Rates& rates, Problems& problems) {
  if (!whole.is_positive() || !part.is_positive()) return;
  const double ms = whole.period_ms(), step = part.period_ms();
  if (Ticks(ms, step) > 0) return;
  const double below = std::max(1.0, std::floor(ms / step)) * step;
  const bool in_hz = whole.hz.has_value();
  const std::string what =
      in_hz ? fmt::format("is not a whole number of {} of {:.6g} ms", parts, step)
            : fmt::format("is not a multiple of {}", part.Named());
  const bool seconds = !in_hz && ms < 1 && ms < step;
  problems.AddAt(
      whole.field(),
      fmt::format("{} {}; the nearest are {} and {}{}", whole.Text(), what, Nearest(below, in_hz),
                  Nearest(below + step, in_hz),
                  seconds ? fmt::format(". Are these seconds? Then write {:.6g}", 1000 * ms)
                          : HowToGet(whole, rates)));
}

void ValidateOneUnit(const GivenTime& time, Problems& problems) {
  if (!time.ms || !time.hz) return;
  problems.AddAt(time.hz_field, fmt::format("{} is given too; keep one of them", time.ms_field));
}

void ValidateStepsPerAction(const GivenTime& policy, const GivenTime& sim, Problems& problems) {
  const double steps = policy.period_ms() / sim.period_ms();
  if (!policy.is_positive() || steps <= kMostStepsPerAction) return;
  problems.AddAt(policy.field(),
                 fmt::format("{} are {:.0f} steps of the engine of {:g} ms for every action, at "
                             "most {:.0f}; 66 ms is usual",
                             policy.Text(), steps, sim.period_ms(), kMostStepsPerAction));
}

// A video stores its rate as a ratio of two 31-bit numbers.
void ValidateRatio(const Rates& rates, Problems& problems) {
  constexpr int64_t kMost = std::numeric_limits<int>::max();
  std::string text = "more digits than fit";
  try {
    const Ratio rate = rates.policy_rate();
    if (rate.num <= kMost && rate.den <= kMost) return;
    text = rate.Text();
  } catch (const ArgumentError&) {
  }
  problems.AddAt(SimOf(rates).field(),
                 fmt::format("makes {} rows per second, a ratio that no video holds exactly; give "
                             "the timestep with fewer digits, or as sim_hz",
                             text));
}

// Throws ArgumentError with the problems that Validate finds.
void RequireWhole(const Rates& rates) {
  if (rates.sim_steps() > 0 && rates.control_ticks() > 0) return;
  Problems problems;
  ValidateFields(rates, problems);
  throw ArgumentError(problems.Text("a policy rate of these rates"));
}

}  // namespace

int Rates::sim_steps() const {
  return Ticks(ControlOf(*this).period_ms(), SimOf(*this).period_ms());
}

int Rates::control_ticks() const {
  return Ticks(PolicyOf(*this).period_ms(), ControlOf(*this).period_ms());
}

bool Rates::HasTimestep(double of_scene) const {
  const double own = timestep().value();
  return std::abs(of_scene - own) <= 1e-12 * own;  // the last digits of a user's quotient
}

Ratio Rates::timestep() const {
  return sim_hz ? RatioOf(*sim_hz).inverse() : RatioOf(sim_ms.value_or(kSimMs)) / 1000;
}

Ratio Rates::policy_rate() const {
  RequireWhole(*this);
  return (timestep() * sim_steps() * control_ticks()).inverse();
}

double Rates::policy_period() const { return policy_rate().inverse().value(); }

double Rates::control_period() const {
  RequireWhole(*this);
  return (timestep() * sim_steps()).value();
}

void Rates::Validate(Problems& problems) const {
  const GivenTime policy = PolicyOf(*this), control = ControlOf(*this), sim = SimOf(*this);
  for (const GivenTime& time : {policy, control, sim}) ValidateOneUnit(time, problems);
  const size_t before = problems.list().size();
  if (sim.is_positive()) internal::ValidateTimestep(sim.period_ms(), 1000, sim.field(), problems);
  if (sim.period_ms() >= internal::kShortestTimestep * 1000)
    ValidateStepsPerAction(policy, sim, problems);
  ValidateMultiple(policy, control, "control ticks", *this, problems);
  ValidateMultiple(control, sim, "steps of the engine", *this, problems);
  if (problems.list().size() == before && sim_steps() > 0 && control_ticks() > 0)
    ValidateRatio(*this, problems);
}

}  // namespace robocell
