// Pinocchio's side of row P6: forward kinematics with the Jacobian, gravity torques and mass matrix
// of the arms that dynamics_bench writes, at its configurations, one at a time. All results must
// agree with ours to 1e-9, otherwise the row is an error.
//
//   build/bench/pinocchio_peer-march=native ARM ...
//
// dynamics.py compiles it against the headers of PyPI's `pin`. It only uses the headers: the
// wheel's libraries are for any x86-64, and with -march=native the layout of Eigen's types differs.
//
// ARM: doubles: the numbers n of joints and B of configurations, and gravity. For each joint the
// frame that it moves, in the frame of the previous joint, for joint value 0, with z as its axis;
// whether it slides; for the body that it moves, in that frame: mass, mass * centre of mass,
// inertia about the origin; armature. Then the tip in the last joint's frame, B times n joint
// values, and our results: B tips in the base frame, each with its 6 x n Jacobian, B times n
// torques, B matrices n x n. Frames are rotation and translation; everything is row by row.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "numbers.h"
#include "pinocchio/algorithm/crba.hpp"
#include "pinocchio/algorithm/frames.hpp"
#include "pinocchio/algorithm/jacobian.hpp"
#include "pinocchio/algorithm/rnea.hpp"
#include "sides.h"

namespace robocell {
namespace {

constexpr int kRounds = 20;

namespace pin = pinocchio;
using bench::Append;
using bench::Numbers;

class Reader {
 public:
  explicit Reader(const std::string& file) : numbers_(bench::ReadNumbers(file)) {}

  double Number() { return numbers_.at(next_++); }
  int Count() { return static_cast<int>(Number()); }
  Numbers Many(int count) {
    Numbers out(count);
    for (double& number : out) number = Number();
    return out;
  }
  Eigen::Vector3d Vector() { return Eigen::Map<const Eigen::Vector3d>(Many(3).data()); }
  Eigen::Matrix3d Matrix() {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(Many(9).data());
  }
  pin::SE3 Frame() {
    const Eigen::Matrix3d rotation = Matrix();
    return pin::SE3(rotation, Vector());
  }
  pin::Inertia Inertia() {
    const double mass = Number();
    const Eigen::Vector3d moment = Vector();
    const Eigen::Matrix3d about_origin = Matrix();
    if (mass <= 0) return pin::Inertia::Zero();
    const Eigen::Vector3d centre = moment / mass;
    const Eigen::Matrix3d moved =
        centre.squaredNorm() * Eigen::Matrix3d::Identity() - centre * centre.transpose();
    return pin::Inertia(mass, centre, Eigen::Matrix3d(about_origin - mass * moved));
  }

 private:
  Numbers numbers_;
  std::size_t next_ = 0;
};

class Arm {
 public:
  explicit Arm(const std::string& file) {
    Reader in(file);
    const int n = in.Count(), count = in.Count();
    model_.gravity.linear(in.Vector());
    for (int i = 0; i < n; ++i) AddJoint(&in);
    tip_ = model_.addFrame(pin::Frame("tip", n, in.Frame(), pin::OP_FRAME));
    data_ = pin::Data(model_);
    jacobian_.setZero(6, n);
    for (int k = 0; k < count; ++k) {
      const Numbers q = in.Many(n);
      q_.emplace_back(Eigen::Map<const Eigen::VectorXd>(q.data(), n));
    }
    our_jacobians_ = in.Many(count * (12 + 6 * n));
    our_gravities_ = in.Many(count * n);
    our_masses_ = in.Many(count * n * n);
  }

  int count() const { return static_cast<int>(q_.size()); }
  const Numbers& our_jacobians() const { return our_jacobians_; }
  const Numbers& our_gravities() const { return our_gravities_; }
  const Numbers& our_masses() const { return our_masses_; }

  // Includes the tip's frame; as fast as computeJointJacobians and getFrameJacobian.
  void Jacobians(Numbers* out) {
    for (const Eigen::VectorXd& q : q_) {
      pin::computeFrameJacobian(model_, data_, q, tip_, pin::LOCAL_WORLD_ALIGNED, jacobian_);
      Use(data_.oMf[tip_]);
      Use(jacobian_);
      if (!out) continue;
      Append(data_.oMf[tip_].rotation(), out);
      Append(data_.oMf[tip_].translation(), out);
      Append(jacobian_, out);
    }
  }
  void Gravities(Numbers* out) {
    for (const Eigen::VectorXd& q : q_) {
      pin::computeGeneralizedGravity(model_, data_, q);
      Use(data_.g);
      if (out) Append(data_.g, out);
    }
  }
  // Uses the faster of its conventions, and computes the half that it leaves to the caller.
  void Masses(Numbers* out) {
    for (const Eigen::VectorXd& q : q_) {
      pin::crba(model_, data_, q, pin::Convention::LOCAL);
      data_.M.triangularView<Eigen::StrictlyLower>() = data_.M.transpose();
      Use(data_.M);
      if (out) Append(data_.M, out);
    }
  }

 private:
  template <typename Result>
  static void Use(const Result& result) {
    benchmark::DoNotOptimize(&result);
    benchmark::ClobberMemory();
  }

  void AddJoint(Reader* in) {
    const pin::SE3 placement = in->Frame();
    const bool slides = in->Number() != 0;
    const pin::JointIndex parent = model_.njoints - 1;
    const std::string name = "joint" + std::to_string(parent);
    const pin::JointIndex joint =
        slides ? model_.addJoint(parent, pin::JointModelPZ(), placement, name)
               : model_.addJoint(parent, pin::JointModelRZ(), placement, name);
    model_.appendBodyToJoint(joint, in->Inertia());
    model_.armature[model_.idx_vs[joint]] = in->Number();
  }

  pin::Model model_;
  pin::Data data_;
  pin::FrameIndex tip_;
  pin::Data::Matrix6x jacobian_;
  std::vector<Eigen::VectorXd> q_;
  Numbers our_jacobians_, our_gravities_, our_masses_;
};

using Work = void (Arm::*)(Numbers* out);

void AddRow(const std::shared_ptr<Arm>& arm, const std::string& row, Work theirs,
            const Numbers& ours) {
  Numbers answers;
  ((*arm).*theirs)(&answers);
  const std::string problem = bench::Difference(ours, answers, 1e-9);
  bench::Add({.row = row,
              .side = "Pinocchio",
              .count = double(arm->count()) * kRounds,
              .run =
                  [=] {
                    for (int round = 0; round < kRounds; ++round) ((*arm).*theirs)(nullptr);
                  },
              .problem = [=] { return problem; }});
}

void Register(const std::string& file) {
  const auto arm = std::make_shared<Arm>(file);
  const std::string name = ", " + std::filesystem::path(file).stem().string();
  AddRow(arm, "tip and Jacobian" + name, &Arm::Jacobians, arm->our_jacobians());
  AddRow(arm, "gravity torques" + name, &Arm::Gravities, arm->our_gravities());
  AddRow(arm, "mass matrix" + name, &Arm::Masses, arm->our_masses());
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::Main(argc, argv, robocell::Register, "ARM");
}
