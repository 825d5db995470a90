// Inverse kinematics from C++, for rows P1, P3 and P4 of RESULTS.md: the same questions that
// ik_side.py puts to Python.
//
//   build/release/ik_bench ROBOT.yaml one|turns ASKED ANSWERED
//
// ASKED: doubles: the numbers of targets and joints, a 4x4 matrix for each target, a seed for each.
// `one`: one by one, from the seeds. `turns`: all targets in one call, without seeds, ten times for
// each line on stdin, by turns with who writes them: a line on stdout says that it is their turn.
// ANSWERED: doubles: joint values for each target, NaN where there are none, then the seconds of
// each call (for each target, or per target).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "bench.h"
#include "numbers.h"
#include "robocell/kinematics/ik_batch.h"

namespace robocell {
namespace {

constexpr double kTolerance = 1e-5;
constexpr int kCallsATurn = 10;  // so that the core's caches hold what they need

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

// Whether there is another turn, after those of others.
bool WaitForTurn() {
  std::string line;
  std::cout << std::endl;
  return static_cast<bool>(std::getline(std::cin, line));
}

// From the matrices, as Python has them: whether they are rigid is looked at within the call.
void SolveTogether(const Chain& chain, std::span<const double> matrices,
                   std::vector<double>* answers) {
  std::vector<double> seconds;
  IkBatchResult found;
  while (WaitForTurn()) {
    for (int k = 0; k < kCallsATurn; ++k) {
      const Stopwatch watch;
      found =
          IkBatch(chain, IkTargets::FromMatrices(matrices), {}, {.ik = {.tolerance = kTolerance}});
      seconds.push_back(watch.seconds() / found.size);
    }
  }
  for (int b = 0; b < found.size; ++b) Append(found.row(b), found.success[b], answers);
  answers->insert(answers->end(), seconds.begin(), seconds.end());
}

void SolveOneByOne(const Chain& chain, std::span<const Pose> targets, std::span<const double> seeds,
                   std::vector<double>* answers) {
  std::vector<double> seconds;
  const std::size_t n = chain.n_joints();
  for (std::size_t b = 0; b < targets.size(); ++b) {
    const Stopwatch watch;
    const IkResult found = Ik(
        chain, targets[b], {.tolerance = kTolerance, .seed = JointVector(seeds.subspan(b * n, n))});
    seconds.push_back(watch.seconds());
    Append(found.q, found.success, answers);
  }
  answers->insert(answers->end(), seconds.begin(), seconds.end());
}

void Run(const std::string& robot_file, const std::string& how, const std::string& asked,
         const std::string& answered) {
  const Robot robot = Robot::Of(bench::SceneWith(RobotConfig::Load(robot_file)), "robot");
  const Chain& chain = robot.chain();
  const std::vector<double> numbers = bench::ReadNumbers(asked);
  const auto count = static_cast<std::size_t>(numbers[0]);
  const std::span<const double> matrices = std::span(numbers).subspan(2, 16 * count);
  const IkTargets asked_for = IkTargets::FromMatrices(matrices);
  std::vector<Pose> targets;
  for (std::size_t b = 0; b < count; ++b) targets.push_back(asked_for[b].pose());
  IkBatch(chain, std::span(targets).first(1));  // makes what a chain keeps
  std::vector<double> answers;
  if (how == "turns") {
    SolveTogether(chain, matrices, &answers);
  } else {
    SolveOneByOne(chain, targets, std::span(numbers).subspan(2 + 16 * count), &answers);
  }
  bench::WriteNumbers(answered, answers);
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: ik_bench ROBOT.yaml one|turns ASKED ANSWERED\n");
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
