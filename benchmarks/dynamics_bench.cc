// Forward kinematics with the Jacobian, gravity torques and mass matrix of an arm, at random
// configurations: one at a time and as a batch, beside KDL's solvers for the same chain, and beside
// the engine's kinematics and Jacobian. Row P6 of RESULTS.md.
//
// All sides must agree to 1e-8, otherwise the row is an error.
//
//   build/release/dynamics_bench [ROBOT.yaml ...]   default: the built-in rc7
//   build/release/dynamics_bench --ask ARM ROBOT.yaml
//
// The second form writes ARM for a peer in a process of its own (pinocchio_peer.cc describes the
// format).
#include <mujoco/mujoco.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "bench.h"
#include "numbers.h"
#include "robocell/kinematics/kdl_bridge.h"

namespace robocell {
namespace {

constexpr int kPoses = 1000, kRounds = 20;
const Eigen::Vector3d kGravity(0, 0, -9.81);

using bench::Append;
using bench::Numbers;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// KDL has no gravity compensation, and the robots' servos have it.
RobotConfig Uncompensated(const std::string& file) {
  RobotConfig config = RobotConfig::Load(file);
  config.gravcomp = false;
  return config;
}

// One arm at many configurations, for us and for KDL; results row by row in the layout of the
// batches.
class Arm {
 public:
  explicit Arm(const std::string& file)
      : scene_(bench::SceneWith(Uncompensated(file))),
        chain_(Robot::Of(scene_, "robot").chain()),
        base_(scene_.body_pose(chain_.base_body()).rotation()),
        tip_(mj_name2id(scene_.model(), TipIsSite() ? mjOBJ_SITE : mjOBJ_BODY,
                        chain_.tip().name.c_str())),
        all_columns_(6 * scene_.model()->nv),
        kdl_(ToKdl(chain_)),
        kdl_fk_(kdl_),
        kdl_jacobian_(kdl_),
        kdl_dynamics_(kdl_, KDL::Vector(kGravity.x(), kGravity.y(), kGravity.z())),
        jacobian_(6, n()),
        mass_(n(), n()),
        their_jacobian_(n()),
        their_torques_(n()),
        their_mass_(n()) {
    Rng rng = Rng::Stream(1, "dynamics bench");
    for (int k = 0; k < kPoses; ++k) {
      KDL::JntArray theirs(n());
      for (int i = 0; i < n(); ++i) {
        const ChainJoint& joint = chain_.joints()[i];
        theirs(i) = rng.Uniform(std::max(joint.lower, -M_PI), std::min(joint.upper, M_PI));
        q_.push_back(theirs(i));
      }
      their_q_.push_back(theirs);
    }
  }
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  int n() const { return chain_.n_joints(); }
  std::span<const double> at(int k) const { return std::span(q_).subspan(k * n(), n()); }

  void Jacobians(Numbers* out) {
    for (int k = 0; k < kPoses; ++k) {
      const Pose tip = chain_.Jacobian(at(k), jacobian_);
      benchmark::DoNotOptimize(tip.translation().data());
      if (out) Append(jacobian_, out);
    }
  }
  void TheirJacobians(Numbers* out) {
    KDL::Frame tip;
    for (const KDL::JntArray& q : their_q_) {
      kdl_fk_.JntToCart(q, tip);
      kdl_jacobian_.JntToJac(q, their_jacobian_);
      benchmark::DoNotOptimize(tip.p.data);
      if (out) Append(their_jacobian_.data, out);
    }
  }
  // The engine's Jacobians, of the whole robot: its gripper moves too.
  void EngineJacobians(Numbers* out) {
    const mjModel* m = scene_.model();
    mjData* d = scene_.data();
    for (int k = 0; k < kPoses; ++k) {
      for (int i = 0; i < n(); ++i) d->qpos[chain_.joints()[i].qpos_address] = at(k)[i];
      mj_kinematics(m, d);
      mj_comPos(m, d);
      mjtNum *linear = all_columns_.data(), *angular = linear + 3 * m->nv;
      TipIsSite() ? mj_jacSite(m, d, linear, angular, tip_)
                  : mj_jacBody(m, d, linear, angular, tip_);
      if (out) AppendColumns(m->nv, out);
    }
  }
  void JacobianBatches(Numbers* out) {
    answer_.resize(kPoses * 6 * n());
    tips_.resize(kPoses * 16);
    JacobianBatch(chain_, q_, answer_, tips_);
    if (out) *out = answer_;
  }

  void Gravities(Numbers* out) {
    answer_.resize(n());
    for (int k = 0; k < kPoses; ++k) {
      chain_.GravityTorques(at(k), kGravity, answer_);
      if (out) out->insert(out->end(), answer_.begin(), answer_.end());
    }
  }
  void TheirGravities(Numbers* out) {
    for (const KDL::JntArray& q : their_q_) {
      kdl_dynamics_.JntToGravity(q, their_torques_);
      if (out) Append(their_torques_.data, out);
    }
  }
  void GravityBatches(Numbers* out) {
    answer_.resize(kPoses * n());
    GravityTorquesBatch(chain_, q_, std::span(kGravity.data(), 3), answer_);
    if (out) *out = answer_;
  }

  void Masses(Numbers* out) {
    for (int k = 0; k < kPoses; ++k) {
      chain_.MassMatrix(at(k), mass_);
      if (out) Append(mass_, out);
    }
  }
  void TheirMasses(Numbers* out) {
    for (const KDL::JntArray& q : their_q_) {
      kdl_dynamics_.JntToMass(q, their_mass_);
      if (out) Append(their_mass_.data, out);
    }
  }
  void MassBatches(Numbers* out) {
    answer_.resize(kPoses * n() * n());
    MassMatrixBatch(chain_, q_, answer_);
    if (out) *out = answer_;
  }

  // Returns the arm, its configurations and our results.
  Numbers Asked() {
    Numbers out = {double(n()), kPoses};
    Append(kGravity, &out);
    for (int i = 0; i < n(); ++i) AppendJoint(chain_.model().joints[i], &out);
    AppendFrame(chain_.model().last_to_tip, &out);
    out.insert(out.end(), q_.begin(), q_.end());
    for (int k = 0; k < kPoses; ++k) {
      AppendFrame(ToTransform(chain_.Jacobian(at(k), jacobian_)), &out);
      Append(jacobian_, &out);
    }
    Gravities(&out);
    Masses(&out);
    return out;
  }

 private:
  bool TipIsSite() const { return chain_.tip().kind == ChainTip::Kind::kSite; }
  static void AppendFrame(const Transform& frame, Numbers* out) {
    Append(frame.rotation, out);
    Append(frame.translation, out);
  }
  // Appends the joint's frame for joint value 0, and the body that it moves.
  static void AppendJoint(const JointModel& joint, Numbers* out) {
    Transform at_zero = joint.fixed;
    MoveJoint(joint, 0, &at_zero);
    AppendFrame(at_zero, out);
    out->push_back(joint.slide);
    out->push_back(joint.link.mass);
    Append(joint.link.moment, out);
    Append(joint.link.inertia, out);
    out->push_back(joint.armature);
  }
  // Appends the chain's part of the engine's columns, in the axes of the base.
  void AppendColumns(int nv, Numbers* out) {
    using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Rows> all(all_columns_.data(), 6, nv);
    for (int i = 0; i < n(); ++i) {
      const Eigen::Matrix<double, 6, 1> column = all.col(chain_.joints()[i].dof_address);
      jacobian_.col(i) << base_.transpose() * column.head<3>(),
          base_.transpose() * column.tail<3>();
    }
    Append(jacobian_, out);
  }

  Scene scene_;
  Chain chain_;
  Eigen::Matrix3d base_;  // in the world
  int tip_;               // the engine's number
  std::vector<mjtNum> all_columns_;
  KDL::Chain kdl_;
  KDL::ChainFkSolverPos_recursive kdl_fk_;
  KDL::ChainJntToJacSolver kdl_jacobian_;
  KDL::ChainDynParam kdl_dynamics_;
  Jacobian jacobian_;
  Eigen::MatrixXd mass_;
  KDL::Jacobian their_jacobian_;
  KDL::JntArray their_torques_;
  KDL::JntSpaceInertiaMatrix their_mass_;
  Numbers q_, answer_, tips_;
  std::vector<KDL::JntArray> their_q_;
};

using Work = void (Arm::*)(Numbers* out);

std::string Difference(Arm& arm, Work ours, Work theirs) {
  Numbers a, b;
  (arm.*ours)(&a);
  (arm.*theirs)(&b);
  return bench::Difference(a, b, 1e-8);
}

void AddRow(const std::shared_ptr<Arm>& arm, const std::string& row, Work ours, Work theirs,
            Work engines = nullptr) {
  std::string problem = Difference(*arm, ours, theirs);
  if (engines && problem.empty()) problem = Difference(*arm, ours, engines);
  const auto add = [&](const std::string& side, Work work) {
    bench::Add({.row = row,
                .side = side,
                .count = kPoses * kRounds,
                .run =
                    [=] {
                      for (int round = 0; round < kRounds; ++round) ((*arm).*work)(nullptr);
                    },
                .problem = [=] { return problem; }});
  };
  add("robocell", ours);
  add("KDL", theirs);
  if (engines) add("mj_jac", engines);
}

void Register(const std::string& file) {
  const auto arm = std::make_shared<Arm>(file);
  const std::string name = ", " + RobotConfig::Load(file).name;
  AddRow(arm, "tip and Jacobian" + name, &Arm::Jacobians, &Arm::TheirJacobians,
         &Arm::EngineJacobians);
  AddRow(arm, "gravity torques" + name, &Arm::Gravities, &Arm::TheirGravities);
  AddRow(arm, "mass matrix" + name, &Arm::Masses, &Arm::TheirMasses);
  AddRow(arm, "tip and Jacobian, batch" + name, &Arm::JacobianBatches, &Arm::TheirJacobians,
         &Arm::EngineJacobians);
  AddRow(arm, "gravity torques, batch" + name, &Arm::GravityBatches, &Arm::TheirGravities);
  AddRow(arm, "mass matrix, batch" + name, &Arm::MassBatches, &Arm::TheirMasses);
}

int Ask(const std::string& into, const std::string& robot) {
  try {
    bench::WriteNumbers(into, Arm(robot).Asked());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "--ask") return robocell::Ask(argv[2], argv[3]);
  return robocell::bench::Main(argc, argv, robocell::Register,
                               robocell::assets::BuiltinRobotFile("rc7"));
}
