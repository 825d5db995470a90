// Chain: the serial kinematics between two frames of a compiled model, with forward kinematics,
// Jacobian and dynamics.
//
// A chain is read from the simulated model: fixed transforms, joint anchors, axes, reference
// positions, limits, and the inertia of everything that hangs on the chain (tools, gripper, side
// branches). It is a snapshot: it keeps no pointer to the model, and changes to the model need a
// new chain. ik.h has inverse kinematics.
//
// Frames and units: everything is expressed in the frame of the base body, wherever that body is
// and however it moves. Joint values are in chain order, radians for hinges and metres for slides,
// like in mjData.qpos. Six-vectors have the linear rows first.
//
// Joints in side branches (a gripper's fingers) do not move: they are frozen at the model's
// reference position, or at ChainOptions.qpos.
//
// Joints that follow others by equality constraints (mjEQ_JOINT: parallelograms, telescopes, mimic
// joints) are no joints of the chain of their own. All joint values are those of its degrees of
// freedom, the leaders: q, limits, columns of the Jacobian, torques and masses. followers() has the
// others and Expand() their values. Couplings that cannot be reduced like that are rejected.
//
// Errors: NotFoundError for a missing body or site, ArgumentError for a chain that cannot be made
// and for a wrong number of joint values. Threads: a Chain is immutable, its functions are const,
// do not allocate and may run in parallel; data for solvers is made once, on first use. Copies
// share all data: a copy is cheap, and stays valid when the original is destroyed.
//
// Jacobian and dynamics are computed in vector registers, of AVX2 at most (link_kernel.h):
// instruction sets differ by rounding. For many configurations at once use chain_batch.h.
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

// The end of a chain.
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
  // A body that must hang on the chain behind its first joint (the inertia of its subtree is then
  // part of the chain, like that of every such body); otherwise the constructor throws
  // ArgumentError. Empty: not checked.
  std::string tool_body{};
  // Positions of the whole model (nq values), for the joints that hang on the chain but do not
  // belong to it. Empty: the model's reference positions.
  std::span<const double> qpos{};
};

enum class ChainJointType { kHinge, kSlide };

// The data of a joint of a chain.
struct ChainJoint {
  std::string name{};  // full name in the model; "<body>:joint<k>" for an unnamed one
  std::string body{};  // the body that it moves
  ChainJointType type = ChainJointType::kHinge;
  bool limited = false;
  double lower = 0, upper = 0;  // rad or m; +-infinity without limits
  // Joint id, and addresses in mjData.qpos and mjData.qvel; -1 unless the chain was read from a
  // model.
  int id = -1;
  int qpos_address = -1;
  int dof_address = -1;
};

// A joint of a chain that follows another one by an equality constraint of the model.
struct ChainFollower {
  ChainJoint joint;
  int leader = -1;  // index of the joint of the chain that it follows; -1 if it is held in place
  JointPolynomial of_leader;
};

struct KdlSegment;
struct LinkTable;
namespace internal {
class LaneChain;
}

class Chain {
 public:
  // Makes the chain of the joints between `base_body` and `tip`. The base may be any body, also a
  // moving one; "world" is allowed. 1 to kMaxChainJoints hinges and slides; a ball or free joint on
  // the way is rejected by name.
  Chain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
        const ChainOptions& options = {});

  int n_joints() const { return parts_->model.n; }
  const std::vector<ChainJoint>& joints() const { return parts_->joints; }
  std::vector<std::string> joint_names() const;
  // Returns the joints that follow those of the chain, in the order of the links.
  const std::vector<ChainFollower>& followers() const { return parts_->followers; }
  // Returns all joints in the order of the links: joints() and followers().
  const std::vector<ChainJoint>& link_joints() const {
    return coupled_ ? parts_->link_joints : parts_->joints;
  }
  // Returns the values of link_joints().
  JointVector Expand(std::span<const double> q) const;
  const std::string& base_body() const { return parts_->base_body; }
  const ChainTip& tip() const { return parts_->tip; }
  // Returns the index of a joint by its full name. Throws NotFoundError that lists the names.
  int joint_index(std::string_view name) const;

  // Returns the pose of the tip in the base frame.
  Pose Fk(std::span<const double> q) const;
  // Computes, for every joint, the pose of the body that it moves, in the base frame (between the
  // joints of a body with several: the pose if only the first of them moved it). `bodies` has n
  // entries; bodies of followers are left out. Returns the tip.
  Pose FkAll(std::span<const double> q, std::span<Pose> bodies) const;
  // Computes the 6 x n Jacobian at the tip point, axes of the base frame, linear rows first: twist
  // = J * qdot. Returns the tip's pose.
  Pose Jacobian(std::span<const double> q,
                Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const;

  // Computes torques (N m or N) that hold the chain still in a uniform field, e.g. the world's (0,
  // 0, -9.81) rotated into the base frame, m/s^2. Each body weighs mass * (1 - gravcomp), so that
  // compensation is never applied twice.
  void GravityTorques(std::span<const double> q, const Eigen::Vector3d& gravity_in_base,
                      std::span<double> out) const;
  // Computes the n x n joint-space inertia with armature, including that of fixed tendons, for a
  // fixed base. That of spatial tendons, which changes with the pose, is left out.
  void MassMatrix(std::span<const double> q, Eigen::Ref<Eigen::MatrixXd> out) const;
  // Computes the torques caused by moving at `qd` (Coriolis and centrifugal), N m or N.
  void CoriolisTorques(std::span<const double> q, std::span<const double> qd,
                       std::span<double> out) const;
  // Computes the torques of a given motion, including gravity (as above) and armature, without
  // friction, damping or contact.
  void InverseDynamics(std::span<const double> q, std::span<const double> qd,
                       std::span<const double> qdd, const Eigen::Vector3d& gravity_in_base,
                       std::span<double> out) const;
  // Returns the mass of everything that the chain moves, kg.
  double moving_mass() const;

  // Throws ArgumentError, with the argument and the joint, unless `values` are one finite number
  // for each joint. Forward kinematics and Jacobian check that; the dynamics, which control loops
  // call, only check the number of values.
  void RequireJointValues(std::string_view what, std::span<const double> values) const;

  // Returns the folded numbers, for solvers.
  const ChainModel& model() const { return parts_->model; }
  // The table has all joints; with followers use internal::ComputeChain (link_answer.h).
  const LinkTable& links() const { return *links_; }
  // Returns null if no joint follows another one.
  const CoupledLinks* coupled() const { return coupled_; }
  // Returns inertia that neither the joints' own values nor model() contain. Empty with followers,
  // whose links have it.
  std::span<const JointCoupling> couplings() const { return parts_->couplings; }
  const internal::LaneChain& lanes() const;
  // An object that all copies of this chain keep: its form in another library, which lives as long
  // as one of them. Null until it is set; not for several threads at once.
  std::shared_ptr<void>& companion() const;
  // Returns "chain 'link_base' -> site 'link_tcp'", for messages.
  std::string description() const;

 private:
  friend Chain ChainFromSegments(const std::vector<KdlSegment>& segments,
                                 std::span<const std::array<double, 2>> limits);
  struct Lazy;
  struct Parts {
    ChainModel model;
    std::vector<ChainJoint> joints;
    std::vector<JointCoupling> couplings{};
    std::vector<ChainFollower> followers{};
    std::vector<ChainJoint> link_joints{};  // with followers
    std::string base_body;
    ChainTip tip;
    std::shared_ptr<const LinkTable> links{};
    std::shared_ptr<Lazy> lazy{};
  };
  explicit Chain(Parts parts);  // without links and lazy
  static std::shared_ptr<const Parts> Complete(Parts parts);
  void RequireSize(std::string_view what, std::size_t size) const;

  std::shared_ptr<const Parts> parts_;
  const LinkTable* links_;       // parts_->links, cached for control loops
  const CoupledLinks* coupled_;  // parts_->model.coupled
};

}  // namespace robocell
