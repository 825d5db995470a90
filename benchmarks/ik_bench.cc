// Inverse kinematics from C++, for rows P1, P3 and P4 of RESULTS.md: the same queries as in
// ik_side.py for Python, in the same turns.
//
//   build/release/ik_bench ROBOT.yaml one|batch ASKED ANSWERED
//
// ASKED: doubles: the numbers of targets and joints, a 4x4 matrix for each target, a seed for each.
// `one`: one by one, from the seeds. `batch`: all targets in one call, without seeds.
// ANSWERED: doubles: the number of turns; joint values for each target in the fastest of them, NaN
// where there are none; the mean of each turn's calls in seconds (or seconds per target), then
// their median in each turn, then their 99th percentile.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench.h"
#include "numbers.h"
#include "turns.h"
#include "robocell/kinematics/ik_batch.h"

namespace robocell {
namespace {

constexpr double kTolerance = 1e-5;
constexpr double kTurn = 0.05;  // s, at least

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void Append(std::span<const double> q, bool success, std::vector<double>* answers) {
  for (const double v : q)
    answers->push_back(success ? v : std::numeric_limits<double>::quiet_NaN());
}

// The result of one pass over all queries, or of the passes of a turn.
struct Answered {
  std::vector<double> q, seconds;
  double mean() const {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0) /
           static_cast<double>(seconds.size());
  }
  double percentile(double part) const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  }
};

using OnePass = std::function<Answered()>;

Answered TurnOf(const OnePass& one_pass) {
  const Stopwatch watch;
  Answered turn = one_pass();
  while (watch.seconds() < kTurn) {
    Answered pass = one_pass();
    turn.q = std::move(pass.q);
    turn.seconds.insert(turn.seconds.end(), pass.seconds.begin(), pass.seconds.end());
  }
  return turn;
}

// The output after the last turn.
std::vector<double> ByTurns(const OnePass& one_pass) {
  std::vector<double> of_fastest, means, p50s, p99s;
  while (bench::WaitForTurn()) {
    Answered turn = TurnOf(one_pass);
    means.push_back(turn.mean());
    p50s.push_back(turn.percentile(0.5));
    p99s.push_back(turn.percentile(0.99));
    if (means.back() <= *std::min_element(means.begin(), means.end()))
      of_fastest = std::move(turn.q);
  }
  std::vector<double> written{static_cast<double>(means.size())};
  for (const std::vector<double>& part : {of_fastest, means, p50s, p99s})
    written.insert(written.end(), part.begin(), part.end());
  return written;
}

// Uses the matrices, like Python: the call checks whether they are rigid.
Answered Together(const Chain& chain, std::span<const double> matrices) {
  const Stopwatch watch;
  const IkBatchResult found =
      IkBatch(chain, IkTargets::FromMatrices(matrices), {}, {.ik = {.tolerance = kTolerance}});
  Answered pass{.seconds = {watch.seconds() / found.size}};
  for (int b = 0; b < found.size; ++b) Append(found.row(b), found.success[b], &pass.q);
  return pass;
}

Answered OneByOne(const Chain& chain, std::span<const Pose> targets,
                  std::span<const double> seeds) {
  Answered pass;
  const std::size_t n = chain.n_joints();
  for (std::size_t b = 0; b < targets.size(); ++b) {
    const Stopwatch watch;
    const IkResult found = Ik(
        chain, targets[b], {.tolerance = kTolerance, .seed = JointVector(seeds.subspan(b * n, n))});
    pass.seconds.push_back(watch.seconds());
    Append(found.q, found.success, &pass.q);
  }
  return pass;
}

void Run(const std::string& robot_file, const std::string& how, const std::string& asked,
         const std::string& answered) {
  const Robot robot = Robot::Of(bench::SceneWith(RobotConfig::Load(robot_file)), "robot");
  const Chain& chain = robot.chain();
  const std::vector<double> numbers = bench::ReadNumbers(asked);
  const auto count = static_cast<std::size_t>(numbers[0]);
  const std::span<const double> matrices = std::span(numbers).subspan(2, 16 * count);
  const std::span<const double> seeds = std::span(numbers).subspan(2 + 16 * count);
  const IkTargets asked_for = IkTargets::FromMatrices(matrices);
  std::vector<Pose> targets;
  for (std::size_t b = 0; b < count; ++b) targets.push_back(asked_for[b].pose());
  IkBatch(chain, std::span(targets).first(1));  // makes the chain's cached data
  const OnePass one_pass = [&] {
    return how == "batch" ? Together(chain, matrices) : OneByOne(chain, targets, seeds);
  };
  bench::WriteNumbers(answered, ByTurns(one_pass));
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: ik_bench ROBOT.yaml one|batch ASKED ANSWERED\n");
    return 2;
  }
  try {
    robocell::Run(argv[1], argv[2], argv[3], argv[4]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
