#include "robocell/kinematics/chain_builder.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/chain_reduction.h"
#include "robocell/math/rotation.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/gravity.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string BodyName(const mjModel* m, int body) {
  const std::string name = ElementName(m, mjOBJ_BODY, body);
  return name.empty() ? fmt::format("#{}", body) : name;
}

std::string JointName(const mjModel* m, int joint) {
  const std::string name = ElementName(m, mjOBJ_JOINT, joint);
  if (!name.empty()) return name;
  const int body = m->jnt_bodyid[joint];
  return fmt::format("{}:joint{}", BodyName(m, body), joint - m->body_jntadr[body]);
}

Eigen::Vector3d Vector(const mjtNum* v) { return {v[0], v[1], v[2]}; }

// Accepts quaternions of any length, like the engine.
Eigen::Matrix3d Rotation(const mjtNum* engine_quat) {
  mjtNum unit[4];
  mju_copy4(unit, engine_quat);
  mju_normalize4(unit);
  return MatrixFromQuaternion(QuaternionFromWxyz(unit));
}

Transform Frame(const mjtNum* position, const mjtNum* engine_quat) {
  return {Rotation(engine_quat), Vector(position)};
}

Transform BodyInParent(const mjModel* m, int body) {
  return Frame(m->body_pos + 3 * body, m->body_quat + 4 * body);
}

// Returns a right-handed frame at the joint's anchor whose z axis is the joint's axis, in the
// body's frame.
Transform JointInBody(const mjModel* m, int joint) {
  const Eigen::Vector3d z = Vector(m->jnt_axis + 3 * joint).normalized();
  const Eigen::Vector3d x = z.unitOrthogonal();
  Transform frame;
  frame.rotation << x, z.cross(x), z;
  frame.translation = Vector(m->jnt_pos + 3 * joint);
  return frame;
}

// Returns the inertia of rotors: that of the joint, and those of actuators that act on it directly,
// behind their gears.
double Armature(const mjModel* m, int joint) {
  double sum = m->dof_armature[m->jnt_dofadr[joint]];
  for (int a = 0; a < m->nactuator; ++a) {
    if (!ActsOnJoint(m, a) || m->actuator_trnid[2 * a] != joint) continue;
    const double gear = Gear(m, a);
    sum += gear * gear * m->actuator_armature[a];
  }
  return sum;
}

// Returns how a fixed tendon's length changes with each joint of the chain; others do not move.
std::vector<double> TendonCoefficients(const mjModel* m, int tendon, const BuiltChain& chain) {
  std::vector<double> coefficients(chain.joints.size());
  const int first = m->tendon_adr[tendon];
  for (int w = first; w < first + m->tendon_num[tendon]; ++w) {
    if (m->wrap_type[w] != mjWRAP_JOINT) continue;  // spatial: changes with the pose
    for (size_t i = 0; i < coefficients.size(); ++i) {
      if (chain.joints[i].id == m->wrap_objid[w]) coefficients[i] += m->wrap_prm[w];
    }
  }
  return coefficients;
}

void AddTendons(const mjModel* m, BuiltChain* chain) {
  for (int tendon = 0; tendon < m->ntendon; ++tendon) {
    const double armature = TendonArmature(m, tendon);
    if (armature == 0) continue;
    const std::vector<double> coefficients = TendonCoefficients(m, tendon, *chain);
    for (int i = 0; i < chain->model.n; ++i) {
      chain->model.joints[i].armature += armature * coefficients[i] * coefficients[i];
      for (int k = i + 1; k < chain->model.n; ++k) {
        const double inertia = armature * coefficients[i] * coefficients[k];
        if (inertia != 0) chain->couplings.push_back({i, k, inertia});
      }
    }
  }
}

bool IsScalar(const mjModel* m, int joint) {
  return m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
}

// Follows the engine (mj_kinematics): the joints of a body act one after the other on its frame.
Transform MovedBodyInParent(const mjModel* m, int body, const mjtNum* qpos) {
  Transform frame = BodyInParent(m, body);
  for (int k = 0; k < m->body_jntnum[body]; ++k) {
    const int joint = m->body_jntadr[body] + k, address = m->jnt_qposadr[joint];
    Transform motion;
    if (m->jnt_type[joint] == mjJNT_SLIDE) {
      motion.translation = Vector(m->jnt_axis + 3 * joint) * (qpos[address] - m->qpos0[address]);
    } else {
      motion.rotation = m->jnt_type[joint] == mjJNT_BALL
                            ? Rotation(qpos + address)
                            : Eigen::AngleAxisd(qpos[address] - m->qpos0[address],
                                                Vector(m->jnt_axis + 3 * joint))
                                  .toRotationMatrix();
      const Eigen::Vector3d anchor = Vector(m->jnt_pos + 3 * joint);
      motion.translation = anchor - motion.rotation * anchor;
    }
    frame = frame * motion;
  }
  return frame;
}

// Returns the bodies after `base` down to `tip`, in order.
std::vector<int> PathBetween(const mjModel* m, int base, int tip, const std::string& place) {
  std::vector<int> path, ancestors;
  int body = tip;
  for (; body != base && body != 0; body = m->body_parentid[body]) path.insert(path.begin(), body);
  if (body == base) return path;
  std::vector<std::string> names;
  for (int b : path) names.push_back(BodyName(m, b));
  throw ArgumentError(
      fmt::format("{}: body '{}' does not hang on '{}'. The bodies from the world to the tip: {}. "
                  "Choose the base among them.",
                  place, BodyName(m, tip), BodyName(m, base), ListNames(names)));
}

void RefuseMocap(const mjModel* m, int body, const std::string& place) {
  if (m->body_mocapid[body] < 0) return;
  throw ArgumentError(
      fmt::format("{}: body '{}' on the way is a mocap body, which no joint moves. Start the chain "
                  "at '{}' or below it.",
                  place, BodyName(m, body), BodyName(m, body)));
}

void RefuseNonScalar(const mjModel* m, int joint, const std::string& place) {
  if (IsScalar(m, joint)) return;
  const int body = m->jnt_bodyid[joint];
  throw ArgumentError(
      fmt::format("{}: joint '{}' on the way is a {} joint; a chain has hinges and slides only. "
                  "Start the chain at body '{}', which "
                  "that joint moves, or end it before.",
                  place, JointName(m, joint), m->jnt_type[joint] == mjJNT_BALL ? "ball" : "free",
                  BodyName(m, body)));
}

// Returns true if only hinges and slides, at least one, are between `base` and a body of its
// subtree.
bool MayEndAt(const mjModel* m, int base, int body) {
  int joints = 0;
  for (; body != base; body = m->body_parentid[body]) {
    if (m->body_mocapid[body] >= 0) return false;
    for (int k = 0; k < m->body_jntnum[body]; ++k, ++joints) {
      if (!IsScalar(m, m->body_jntadr[body] + k)) return false;
    }
  }
  return joints > 0;
}

std::string WhereToEnd(const mjModel* m, int base) {
  std::vector<std::string> ends;
  for (int body = base + 1; body < m->nbody; ++body) {
    if (IsInSubtree(m, body, base) && MayEndAt(m, base, body)) ends.push_back(BodyName(m, body));
  }
  if (ends.empty())
    return fmt::format("No hinge or slide moves a body on '{}'; choose another base.",
                       BodyName(m, base));
  return fmt::format(
      "End it at one of the bodies that move with respect to '{}', or at a site "
      "there: {}.",
      BodyName(m, base), ListNames(ends));
}

ChainJoint Describe(const mjModel* m, int id) {
  ChainJoint joint;
  joint.id = id;
  joint.name = JointName(m, id);
  joint.body = BodyName(m, m->jnt_bodyid[id]);
  joint.type = m->jnt_type[id] == mjJNT_SLIDE ? ChainJointType::kSlide : ChainJointType::kHinge;
  joint.limited = m->jnt_limited[id];
  joint.lower = joint.limited ? m->jnt_range[2 * id] : -kInfinity;
  joint.upper = joint.limited ? m->jnt_range[2 * id + 1] : kInfinity;
  joint.qpos_address = m->jnt_qposadr[id];
  joint.dof_address = m->jnt_dofadr[id];
  return joint;
}

class Builder {
 public:
  Builder(const mjModel* m, std::string place) : m_(m), place_(std::move(place)) {}

  BuiltChain Build(int base, int tip_body, const Transform& tip_in_body) {
    for (int body : PathBetween(m_, base, tip_body, place_)) AddBody(body);
    if (out_.model.n == 0) {
      throw ArgumentError(
          fmt::format("{}: there is no joint between base and tip, so nothing moves. {}", place_,
                      WhereToEnd(m_, base)));
    }
    out_.model.last_to_tip = frame_ * tip_in_body;
    return std::move(out_);
  }

  // Returns, for each body of the model, the index of the joint behind which it hangs; -1 for
  // others.
  std::vector<int> LinkOfBodies() const {
    std::vector<int> link(m_->nbody, -1);
    for (int body = 1; body < m_->nbody; ++body) {
      link[body] = link[m_->body_parentid[body]];
      for (int i = 0; i < static_cast<int>(link_bodies_.size()); ++i) {
        if (link_bodies_[i] == body) link[body] = i;
      }
    }
    return link;
  }

 private:
  void AddBody(int body) {
    RefuseMocap(m_, body, place_);
    frame_ = frame_ * BodyInParent(m_, body);
    for (int k = 0; k < m_->body_jntnum[body]; ++k) AddJoint(m_->body_jntadr[body] + k, body);
  }

  void AddJoint(int id, int body) {
    RefuseNonScalar(m_, id, place_);
    if (out_.model.n == kMaxChainJoints) RefuseTooLong(id);
    const ChainJoint description = Describe(m_, id);
    const Transform joint_in_body = JointInBody(m_, id);
    JointModel& joint = out_.model.joints[out_.model.n++];
    joint.fixed = frame_ * joint_in_body;
    joint.joint_to_body = frame_ = joint_in_body.inverse();
    joint.slide = description.type == ChainJointType::kSlide;
    joint.reference = m_->qpos0[description.qpos_address];
    joint.lower = description.lower;
    joint.upper = description.upper;
    joint.armature = Armature(m_, id);
    out_.joints.push_back(description);
    link_bodies_.push_back(body);
  }

  [[noreturn]] void RefuseTooLong(int next) const {
    std::vector<std::string> names;
    for (const ChainJoint& joint : out_.joints) names.push_back(joint.name);
    throw ArgumentError(fmt::format(
        "{}: a chain has at most {} joints, this one has more: {}, '{}', ... Start it nearer to "
        "the tip.",
        place_, kMaxChainJoints, ListNames(names, kMaxChainJoints), JointName(m_, next)));
  }

  const mjModel* m_;
  std::string place_;
  Transform
      frame_;  // current body in the moved frame of the last joint (before the first: in the base)
  std::vector<int> link_bodies_;
  BuiltChain out_;
};

void AddInertia(const mjModel* m, int body, const Transform& body_in_joint, LinkInertia* link) {
  const double mass = m->body_mass[body];
  const double weight = CompensatesGravity(m) ? mass * (1 - m->body_gravcomp[body]) : mass;
  const Transform principal =
      body_in_joint * Frame(m->body_ipos + 3 * body, m->body_iquat + 4 * body);
  const Eigen::Vector3d& com = principal.translation;
  const Eigen::Matrix3d& r = principal.rotation;
  link->mass += mass;
  link->moment += mass * com;
  link->weight_mass += weight;
  link->weight_moment += weight * com;
  link->inertia += r * Vector(m->body_inertia + 3 * body).asDiagonal() * r.transpose();
  link->inertia += mass * (com.squaredNorm() * Eigen::Matrix3d::Identity() - com * com.transpose());
}

// Lumps every body that hangs on the chain into the link that carries it.
void AddInertias(const mjModel* m, const std::vector<int>& link_of_body, const mjtNum* qpos,
                 BuiltChain* chain) {
  std::vector<Transform> in_joint(
      m->nbody);  // body in the moved frame of the joint that carries it
  for (int body = 1; body < m->nbody; ++body) {
    const int link = link_of_body[body], parent = m->body_parentid[body];
    if (link < 0) continue;
    JointModel& joint = chain->model.joints[link];
    in_joint[body] = link_of_body[parent] == link
                         ? in_joint[parent] * MovedBodyInParent(m, body, qpos)
                         : joint.joint_to_body;
    AddInertia(m, body, in_joint[body], &joint.link);
  }
}

void RequireTool(const mjModel* m, const ChainOptions& options, const BuiltChain& chain,
                 const std::vector<int>& link_of_body, const std::string& place) {
  if (options.tool_body.empty()) return;
  const std::string name = options.prefix + options.tool_body;
  const int tool = RequireId(m, mjOBJ_BODY, name, place);
  // Only the last link may be the tool.
  for (size_t i = 0; i + 1 < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    if (!IsInSubtree(m, m->jnt_bodyid[joint.id], tool)) continue;
    throw ArgumentError(
        fmt::format("{}: tool body '{}' is a link of the chain itself, at or before its joint "
                    "'{}'. Name a body at its end or beyond, or leave tool_body out: what hangs on "
                    "the chain counts anyway.",
                    place, name, joint.name));
  }
  if (link_of_body[tool] >= 0) return;
  throw ArgumentError(
      fmt::format("{}: tool body '{}' does not hang on the chain. Attach the tool behind the "
                  "chain's first joint, or leave "
                  "tool_body out.",
                  place, name));
}

}  // namespace

void MeasureLength(ChainModel* chain) {
  double parts = chain->last_to_tip.translation.norm(), travel = 0;
  for (int i = 0; i < chain->n; ++i) {
    const JointModel& joint = chain->joints[i];
    if (i > 0) parts += joint.fixed.translation.norm();
    if (joint.slide)
      travel += std::max(joint.upper - joint.reference, joint.reference - joint.lower);
  }
  chain->reach_bound = parts + travel;
  chain->length = parts > 1e-6 ? parts : 1;
}

BuiltChain BuildChain(const mjModel* m, std::string_view base_body, const ChainTip& tip,
                      const ChainOptions& options) {
  const bool site = tip.kind == ChainTip::Kind::kSite;
  const std::string place =
      fmt::format("kinematic chain '{}' -> {} '{}'", base_body, site ? "site" : "body", tip.name);
  if (!m) throw ArgumentError(place + ": there is no model (a null pointer)");
  if (!options.qpos.empty() && static_cast<int>(options.qpos.size()) != m->nq) {
    throw ArgumentError(fmt::format("{}: qpos has {}, the model's has {}.", place,
                                    Counted(std::ssize(options.qpos), "value"), m->nq));
  }
  const int base = RequireId(m, mjOBJ_BODY, base_body, place);
  const int tip_id =
      site ? RequireId(m, mjOBJ_SITE, tip.name, place) : RequireId(m, mjOBJ_BODY, tip.name, place);
  const int tip_body = site ? m->site_bodyid[tip_id] : tip_id;
  const Transform tip_in_body =
      site ? Frame(m->site_pos + 3 * tip_id, m->site_quat + 4 * tip_id) : Transform{};

  Builder builder(m, place);
  BuiltChain chain = builder.Build(base, tip_body, tip_in_body);
  MeasureLength(&chain.model);
  AddTendons(m, &chain);
  const std::vector<int> link_of_body = builder.LinkOfBodies();
  RequireTool(m, options, chain, link_of_body, place);
  AddInertias(m, link_of_body, options.qpos.empty() ? m->qpos0 : options.qpos.data(), &chain);
  ReduceChain(m, place, &chain);
  return chain;
}

}  // namespace robocell::internal
