// Tests that batches touch nothing around the arrays of a caller, which lie between forbidden pages
// here.
#include <sys/mman.h>
#include <unistd.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

enum class Edge { kFirst, kLast };

// Numbers that begin or end at the edge of a page; the surrounding pages are forbidden.
class Fenced {
 public:
  Fenced(size_t count, Edge edge) : count_(count) {
    const size_t page = sysconf(_SC_PAGESIZE), bytes = count * sizeof(double);
    const size_t inner = (bytes + page - 1) / page * page;
    size_ = inner + 2 * page;
    all_ = static_cast<std::byte*>(
        mmap(nullptr, size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (all_ == MAP_FAILED || mprotect(all_ + page, inner, PROT_READ | PROT_WRITE) != 0)
      throw std::bad_alloc();
    data_ = reinterpret_cast<double*>(all_ + page + (edge == Edge::kLast ? inner - bytes : 0));
  }
  Fenced(std::span<const double> values, Edge edge) : Fenced(values.size(), edge) {
    std::copy(values.begin(), values.end(), data_);
  }
  ~Fenced() { munmap(all_, size_); }
  Fenced(const Fenced&) = delete;
  Fenced& operator=(const Fenced&) = delete;

  operator std::span<double>() const { return {data_, count_}; }
  operator std::span<const double>() const { return {data_, count_}; }
  std::vector<double> values() const { return {data_, data_ + count_}; }

 private:
  size_t count_, size_ = 0;
  std::byte* all_ = nullptr;
  double* data_ = nullptr;
};

// Returns the results of all batches, with every array at this edge of its memory.
std::vector<std::vector<double>> Answers(const Chain& chain, size_t count, Edge edge) {
  const size_t n = chain.n_joints();
  std::vector<double> some(count * n);
  std::iota(some.begin(), some.end(), -0.1 * static_cast<double>(some.size()));
  const Fenced q(some, edge), qd(some, edge), qdd(some, edge);
  const Fenced gravity(std::vector<double>{1, 2, -9}, edge);
  const Fenced tips(16 * count, edge), jacobians(6 * n * count, edge), beside(16 * count, edge),
      weights(n * count, edge), masses(n * n * count, edge), motion(n * count, edge),
      coriolis(n * count, edge), manipulability(count, edge);
  FkBatch(chain, q, tips);
  JacobianBatch(chain, q, jacobians, beside);
  GravityTorquesBatch(chain, q, gravity, weights);
  MassMatrixBatch(chain, q, masses);
  InverseDynamicsBatch(chain, q, qd, qdd, gravity, motion);
  CoriolisTorquesBatch(chain, q, qd, coriolis);
  ManipulabilityBatch(chain, q, manipulability);
  return {tips.values(),   jacobians.values(), beside.values(),   weights.values(),
          masses.values(), motion.values(),    coriolis.values(), manipulability.values()};
}

TEST(BatchMemory, WritesOnlyInsideTheArrays) {
  for (int joints = 1; joints <= kMaxChainJoints; ++joints) {
    for (const bool square : {false, true}) {
      Rng rng = Rng::Stream(joints, "batch memory");
      const RandomChainOptions options{
          .joints = joints, .slide_share = square ? 0 : 0.3, .square = square};
      const TestModel t = TestModel::FromXml(RandomChainXml(&rng, options).Write());
      const Chain chain(t.model(), "base", ChainTip::Site("tip"));
      OnEveryInstructionSet([&](const std::string& set) {
        for (const size_t count : {1, 2, 3, 4, 5, 7, 8, 9, 16, 19}) {
          EXPECT_EQ(Answers(chain, count, Edge::kFirst), Answers(chain, count, Edge::kLast))
              << set << ", " << joints << " joints, " << count << " configurations";
        }
      });
    }
  }
}

}  // namespace
}  // namespace robocell
