// Inverse kinematics from C++, for rows P1, P3 and P4 of RESULTS.md: the same questions that
// ik_side.py puts to Python.
//
//   build/release/ik_bench ROBOT.yaml CALLS ASKED ANSWERED
//
// ASKED: doubles: the numbers of targets and joints, a 4x4 matrix for each target, a seed for each.
// CALLS with all targets at once, without seeds; 0: one by one, from the seeds. ANSWERED: doubles:
// joint values for each target, NaN where there are none, then the seconds of each call (for each
// target, or per target).
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include "bench.h"
#include "numbers.h"
#include "robocell/kinematics/ik_batch.h"

namespace robocell {
namespace {

constexpr double kTolerance = 1e-5;

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

// From the matrices, as Python has them: what comes of them is looked at within the call.
void SolveTogether(const Chain& chain, std::span<const double> matrices, int calls,
                   std::vector<double>* answers) {
  std::vector<double> seconds;
  IkBatchResult found;
  for (int k = 0; k < calls; ++k) {
    const Stopwatch watch;
    found =
        IkBatch(chain, IkTargets::FromMatrices(matrices), {}, {.ik = {.tolerance = kTolerance}});
    seconds.push_back(watch.seconds() / found.size);
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

void Run(const std::string& robot_file, int calls, const std::string& asked,
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
  if (calls > 0) {
    SolveTogether(chain, matrices, calls, &answers);
  } else {
    SolveOneByOne(chain, targets, std::span(numbers).subspan(2 + 16 * count), &answers);
  }
  bench::WriteNumbers(answered, answers);
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: ik_bench ROBOT.yaml CALLS ASKED ANSWERED\n");
    return 2;
  }
  try {
    robocell::Run(argv[1], std::stoi(argv[2]), argv[3], argv[4]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
