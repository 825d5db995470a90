#include "robocell/kinematics/chain_cache.h"

#include <bit>

namespace robocell::internal {
namespace {

class Bits {
 public:
  void Add(double number) { bits_.push_back(std::bit_cast<uint64_t>(number)); }
  void Add(const Transform& frame) {
    for (const double number : frame.rotation.reshaped()) Add(number);
    for (const double number : frame.translation) Add(number);
  }
  std::vector<uint64_t> Take() { return std::move(bits_); }

 private:
  std::vector<uint64_t> bits_;
};

}  // namespace

std::vector<uint64_t> GeometryBits(const ChainModel& chain) {
  Bits bits;
  for (const double number : {double(chain.n), chain.reach_bound, chain.length}) bits.Add(number);
  for (int i = 0; i < chain.n; ++i) {
    const JointModel& joint = chain.joints[i];
    bits.Add(joint.fixed);
    bits.Add(joint.joint_to_body);
    for (const double number : {joint.slide ? 1.0 : 0.0, joint.reference, joint.lower, joint.upper})
      bits.Add(number);
  }
  bits.Add(chain.last_to_tip);
  return bits.Take();
}

}  // namespace robocell::internal
