// Chain: the serial kinematics between two places of a compiled model, with forward kinematics,
// Jacobian and dynamics.
//
// A chain is read from the model that is simulated: fixed transforms, joint anchors, axes,
// reference positions, limits, and the inertia of everything that hangs on the chain (tools,
// gripper, side branches). It is a snapshot: it keeps no pointer to the model, and changes to the
// model need a new chain. Inverse kinematics is in ik.h.
//
// Frames and units: everything is expressed in the frame of the base body, wherever that body
// stands or moves. Joint values are in chain order, radians for hinges and metres for slides, as
// they stand in mjData.qpos. Six-vectors have the linear rows first.
//
// Joints that lie in side branches (a gripper's fingers) do not move: they are frozen at the
// model's reference position, or where ChainOptions.qpos has them.
//
// Errors: NotFoundError for a missing body or site, ArgumentError for a chain that cannot be made
// and for a wrong number of joint values. Threads: a Chain is immutable, its functions are const,
// allocate nothing and may run in parallel; what solvers need is made once, when first asked for.
// Copies share all that they know: a copy is cheap, and is good for as long as it is kept, whatever
// becomes of the chain that it was made of.
//
// Jacobian and dynamics are computed in vector registers, of AVX2 at most (link_kernel.h):
// between instruction sets they differ by rounding. For many configurations at once there is
// chain_batch.h.
//
//   Chain chain(model, "link_base", ChainTip::Site("link_tcp"));
//   Pose tip_in_base = chain.Fk(q);
//   Eigen::Matrix<double, 6, 7> jacobian;
//   chain.Jacobian(q, jacobian);
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/joint_vector.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/forward.h"

namespace robocell {

// Where a chain ends.
struct ChainTip {
  enum class Kind { kBody, kSite };

  static ChainTip Body(std::string_view name) { return {Kind::kBody, std::string(name)}; }
  static ChainTip Site(std::string_view name) { return {Kind::kSite, std::string(name)}; }

  Kind kind = Kind::kBody;
  std::string name{};
};

struct ChainOptions {
  // Names in the model's own scope are looked up as prefix + name.
  std::string prefix{};
  // A body that must hang on the chain behind its first joint (its subtree's inertia is then part
  // of the chain, as is that of every body that does); an ArgumentError says if it does not. Empty:
  // not checked.
  std::string tool_body{};
  // Positions of the whole model (nq values), for the joints that hang on the chain but are not in
  // it. Empty: the model's reference positions.
  std::span<const double> qpos{};
};

enum class ChainJointType { kHinge, kSlide };

// What a chain knows of one of its joints.
struct ChainJoint {
  std::string name{};  // full name in the model; "<body>:joint<k>" for an unnamed one
  std::string body{};  // the body that it moves
  ChainJointType type = ChainJointType::kHinge;
  bool limited = false;
  double lower = 0, upper = 0;  // rad or m; +-infinity when not limited
  // Of a chain that was read from a model, else -1: the joint's id there, and its places in
  // mjData.qpos and mjData.qvel.
  int id = -1;
  int qpos_address = -1;
  int dof_address = -1;
};

// Inertia that couples two joints of a chain, wherever they are: rotors behind tendons. Accelerating
// one of them takes this much of the other, kg m^2, kg m or kg. What a joint feels of it alone is
// part of its armature.
struct JointCoupling {
  int first = 0, second = 0;  // joints of the chain, first < second
  double inertia = 0;
};

struct KdlSegment;
struct LinkTable;
namespace internal {
class LaneChain;
}

class Chain {
 public:
  // The joints between `base_body` and `tip`. The base may be any body, also one that moves;
  // "world" is allowed. 1 to kMaxChainJoints hinges and slides; a ball or free joint on the way is
  // refused by name.
  Chain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
        const ChainOptions& options = {});

  int n_joints() const { return parts_->model.n; }
  const std::vector<ChainJoint>& joints() const { return parts_->joints; }
  std::vector<std::string> joint_names() const;
  const std::string& base_body() const { return parts_->base_body; }
  const ChainTip& tip() const { return parts_->tip; }
  // The index of a joint by its full name; NotFoundError lists the names.
  int joint_index(std::string_view name) const;

  // Pose of the tip in the base frame.
  Pose Fk(std::span<const double> q) const;
  // For every joint the pose of the body that it moves, in the base frame (between the joints of a
  // body with several: where the first of them alone would put it). `bodies` has n entries. Returns
  // the tip.
  Pose FkAll(std::span<const double> q, std::span<Pose> bodies) const;
  // 6 x n at the tip point, axes of the base frame, linear rows first: twist = J * qdot. Returns
  // the tip's pose.
  Pose Jacobian(std::span<const double> q,
                Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const;

  // Torques (N m or N) that hold the chain still in a uniform field, e.g. the world's (0, 0, -9.81)
  // rotated into the base frame, m/s^2. Each body weighs mass * (1 - gravcomp), so that
  // compensation is never done twice.
  void GravityTorques(std::span<const double> q, const Eigen::Vector3d& gravity_in_base,
                      std::span<double> out) const;
  // n x n joint-space inertia with armature, that of fixed tendons included, base held still. That
  // of spatial tendons, which changes with the pose, is left out.
  void MassMatrix(std::span<const double> q, Eigen::Ref<Eigen::MatrixXd> out) const;
  // The part of the torques that comes from moving at `qd` (Coriolis and centrifugal), N m or N.
  void CoriolisTorques(std::span<const double> q, std::span<const double> qd,
                       std::span<double> out) const;
  // Torques for a given motion, gravity (as above) and armature included; no friction, damping or
  // contact.
  void InverseDynamics(std::span<const double> q, std::span<const double> qd,
                       std::span<const double> qdd, const Eigen::Vector3d& gravity_in_base,
                       std::span<double> out) const;
  // Mass of everything that the chain moves, kg.
  double moving_mass() const;

  // ArgumentError, naming the argument and the joint, unless `values` are one finite number for
  // each joint. Forward kinematics and Jacobian check; the dynamics, which control loops call,
  // check the number of values only.
  void RequireJointValues(std::string_view what, std::span<const double> values) const;

  // The folded numbers, for solvers.
  const ChainModel& model() const { return parts_->model; }
  const LinkTable& links() const { return *links_; }
  // What their inertia, and model(), say nothing of.
  std::span<const JointCoupling> couplings() const { return parts_->couplings; }
  const internal::LaneChain& lanes() const;
  // What somebody keeps with this chain, all copies alike: its form in another library, which lives
  // as long as one of them. Null until it is set; not for several threads at once.
  std::shared_ptr<void>& companion() const;
  // "chain 'link_base' -> site 'link_tcp'", for messages.
  std::string description() const;

 private:
  friend Chain ChainFromSegments(const std::vector<KdlSegment>& segments,
                                 std::span<const std::array<double, 2>> limits);
  struct Lazy;
  struct Parts {
    ChainModel model;
    std::vector<ChainJoint> joints;
    std::vector<JointCoupling> couplings{};
    std::string base_body;
    ChainTip tip;
    std::shared_ptr<const LinkTable> links{};
    std::shared_ptr<Lazy> lazy{};
  };
  explicit Chain(Parts parts);  // without links and lazy
  static std::shared_ptr<const Parts> Complete(Parts parts);
  void RequireSize(std::string_view what, std::size_t size) const;

  std::shared_ptr<const Parts> parts_;
  const LinkTable* links_;  // of the parts: what control loops ask for is one step away
};

}  // namespace robocell
