#include "robocell/mujoco/couplings.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

// A constraint of the model as it is written.
struct OneCoupling {
  int follower, leader;  // -1: held in place
  JointPolynomial of_leader;
};

std::vector<OneCoupling> ActiveCouplings(const mjModel* m) {
  std::vector<OneCoupling> out;
  if ((m->opt.disableflags & (mjDSBL_EQUALITY | mjDSBL_CONSTRAINT)) != 0) return out;
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_type[e] != mjEQ_JOINT || !m->eq_active0[e]) continue;
    const int follower = m->eq_obj1id[e], leader = m->eq_obj2id[e];
    const mjtNum* data = m->eq_data + mjNEQDATA * e;
    OneCoupling c{follower, leader, {}};
    const double reference = m->qpos0[m->jnt_qposadr[follower]];
    c.of_leader.c = {reference + data[0], 0, 0, 0, 0};
    if (leader >= 0) {
      c.of_leader.from = m->qpos0[m->jnt_qposadr[leader]];
      for (std::size_t p = 1; p < 5; ++p) c.of_leader.c[p] = data[p];
    }
    out.push_back(c);
  }
  return out;
}

// Composes the constraints of one model.
class Composer {
 public:
  Composer(const mjModel* m, std::vector<OneCoupling> couplings)
      : m_(m), couplings_(std::move(couplings)) {}

  ModelCouplings Run() {
    RefuseTwoLeaders();
    for (const OneCoupling& c : couplings_) {
      if (!out_.ProblemOf(c.follower) && !out_.Of(c.follower)) Follow(c);
    }
    std::sort(out_.followers.begin(), out_.followers.end(),
              [](const CoupledJoint& a, const CoupledJoint& b) { return a.joint < b.joint; });
    return std::move(out_);
  }

 private:
  std::string Name(int joint) const {
    const std::string name = ElementName(m_, mjOBJ_JOINT, joint);
    return fmt::format("'{}'", name.empty() ? fmt::format("#{}", joint) : name);
  }

  const OneCoupling* CouplingOf(int joint) const {
    for (const OneCoupling& c : couplings_) {
      if (c.follower == joint) return &c;
    }
    return nullptr;
  }

  void RefuseTwoLeaders() {
    for (std::size_t i = 0; i < couplings_.size(); ++i) {
      for (std::size_t k = i + 1; k < couplings_.size(); ++k) {
        const OneCoupling &a = couplings_[i], &b = couplings_[k];
        if (a.follower != b.follower) continue;
        if (a.leader == b.leader && a.of_leader == b.of_leader) continue;  // said twice
        std::vector<int> joints = {a.follower};
        for (const int leader : {a.leader, b.leader}) {
          if (leader >= 0) joints.push_back(leader);
        }
        const auto leads = [&](const OneCoupling& c) {
          return c.leader < 0 ? std::string("a constant") : Name(c.leader);
        };
        out_.problems.push_back(
            {std::move(joints),
             fmt::format("joint {} follows both {} and {} by equality constraints; leave out one "
                         "of them, or let one of its leaders follow the other",
                         Name(a.follower), leads(a), leads(b))});
      }
    }
  }

  // Adds a follower with all that is between it and the joint that leads them.
  void Follow(const OneCoupling& first) {
    CoupledJoint joint{first.follower, first.leader, first.of_leader};
    std::vector<int> path = {first.follower};
    while (joint.leader >= 0) {
      if (std::find(path.begin(), path.end(), joint.leader) != path.end())
        return AddProblem(path,
                          "follow each other in a circle; leave out one of their constraints");
      path.push_back(joint.leader);
      const OneCoupling* next = CouplingOf(joint.leader);
      if (!next) break;
      if (out_.ProblemOf(joint.leader)) {
        return out_.problems.push_back({path, out_.ProblemOf(joint.leader)->why});
      }
      if (!joint.of_leader.affine() && !next->of_leader.affine()) {
        if (next->leader >= 0)
          return AddProblem(path,
                            "follow one another by polynomials of which more than one bends; let "
                            "each follow the first joint");
      }
      joint.of_leader = Compose(joint.of_leader, next->of_leader);
      joint.leader = next->leader;
    }
    out_.followers.push_back(joint);
  }

  void AddProblem(const std::vector<int>& joints, std::string_view why) {
    std::vector<std::string> names;
    for (const int joint : joints) names.push_back(Name(joint));
    out_.problems.push_back({joints, fmt::format("joints {} {}", fmt::join(names, ", "), why)});
  }

  const mjModel* m_;
  std::vector<OneCoupling> couplings_;
  ModelCouplings out_;
};

}  // namespace

JointPolynomial Compose(const JointPolynomial& outer, const JointPolynomial& inner) {
  if (inner.affine() && inner.c[1] != 0) {
    // outer's argument less outer.from, as c[1] times the new argument less a new origin.
    JointPolynomial out;
    out.from = inner.from + (outer.from - inner.c[0]) / inner.c[1];
    double power = 1;
    for (std::size_t p = 0; p < 5; ++p, power *= inner.c[1]) out.c[p] = outer.c[p] * power;
    return out;
  }
  if (inner.affine()) return {0, {outer.at(inner.c[0]), 0, 0, 0, 0}};
  JointPolynomial out = inner;
  for (std::size_t p = 0; p < 5; ++p) out.c[p] *= outer.c[1];
  out.c[0] = outer.c[0] + outer.c[1] * (inner.c[0] - outer.from);
  return out;
}

JointPolynomial Inverse(const JointPolynomial& affine) {
  return {affine.c[0], {affine.from, 1 / affine.c[1], 0, 0, 0}};
}

const CoupledJoint* ModelCouplings::Of(int joint) const {
  for (const CoupledJoint& f : followers) {
    if (f.joint == joint) return &f;
  }
  return nullptr;
}

const ModelCouplings::Problem* ModelCouplings::ProblemOf(int joint) const {
  for (const Problem& problem : problems) {
    if (std::find(problem.joints.begin(), problem.joints.end(), joint) != problem.joints.end())
      return &problem;
  }
  return nullptr;
}

int ModelCouplings::LeaderOf(int joint) const {
  const CoupledJoint* follower = Of(joint);
  return follower ? follower->leader : joint;
}

ModelCouplings FindCouplings(const mjModel* model) {
  return Composer(model, ActiveCouplings(model)).Run();
}

}  // namespace robocell
