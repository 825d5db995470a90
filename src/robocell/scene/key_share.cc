#include "robocell/scene/key_share.h"

#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// The robots that share one model, with what belongs to them.
class KeyOwners {
 public:
  KeyOwners(const CompiledScene& compiled, std::vector<const RobotRecord*> robots, int host)
      : m_(compiled.model()), robots_(std::move(robots)), host_(host) {
    mark_.assign(static_cast<size_t>(m_->nbody), -1);
    listed_.assign(static_cast<size_t>(m_->nactuator), -1);
    for (size_t i = robots_.size(); i-- > 0;) {  // the first of several robots with one root has it
      const int root = FindId(m_, mjOBJ_BODY, robots_[i]->root_body);
      if (root >= 0) mark_[root] = static_cast<int>(i);
    }
    for (size_t i = 0; i < robots_.size(); ++i) MarkGroups(*robots_[i], static_cast<int>(i));
  }

  int OfBody(int body) const {
    for (; body > 0; body = m_->body_parentid[body]) {
      if (mark_[body] >= 0) return mark_[body];
    }
    return host_;
  }

  int OfActuator(int actuator) const {
    if (listed_[actuator] >= 0) return listed_[actuator];
    const int moved = m_->actuator_trnid[2 * actuator];
    switch (m_->actuator_trntype[actuator]) {
      case mjTRN_JOINT:
      case mjTRN_JOINTINPARENT:
        return OfBody(m_->jnt_bodyid[moved]);
      case mjTRN_TENDON:
        return OfTendon(moved);
      case mjTRN_SITE:
      case mjTRN_SLIDERCRANK:
        return OfBody(m_->site_bodyid[moved]);
      case mjTRN_BODY:
        return OfBody(moved);
      default:
        return host_;
    }
  }

 private:
  void MarkGroups(const RobotRecord& robot, int index) {
    for (const auto& [name, group] : robot.config.move_groups.entries()) {
      for (const std::string& joint : group->joints) {
        const int id = FindId(m_, mjOBJ_JOINT, robot.prefix + joint);
        if (id >= 0) mark_[m_->jnt_bodyid[id]] = index;
      }
      for (const std::string& actuator : group->actuators) {
        const int id = FindId(m_, mjOBJ_ACTUATOR, robot.prefix + actuator);
        if (id >= 0) listed_[id] = index;
      }
    }
  }

  int OfTendon(int tendon) const {
    const int first = m_->tendon_adr[tendon];
    for (int wrap = first; wrap < first + m_->tendon_num[tendon]; ++wrap) {
      const int id = m_->wrap_objid[wrap];
      if (m_->wrap_type[wrap] == mjWRAP_JOINT) return OfBody(m_->jnt_bodyid[id]);
      if (m_->wrap_type[wrap] == mjWRAP_SITE) return OfBody(m_->site_bodyid[id]);
    }
    return host_;
  }

  const mjModel* m_;
  std::vector<const RobotRecord*> robots_;
  int host_;
  std::vector<int> mark_;    // per body: the robot that it and what hangs on it belong to, or -1
  std::vector<int> listed_;  // per actuator: the robot that lists it, or -1
};

void Fill(std::vector<bool>& out, int begin, int end) {
  for (int i = begin; i < end; ++i) out[i] = true;
}

}  // namespace

std::string HostOfPart(const CompiledScene& compiled, const std::string& part) {
  const List<RobotSpec>& specs = compiled.spec().robots;
  for (size_t i = 0; i < specs.size() && i < compiled.robots().size(); ++i) {
    if (compiled.robots()[i].name == part && !specs[i].part_of.empty()) return specs[i].part_of;
  }
  return part;
}

KeyShare ShareOfKeys(const CompiledScene& compiled, const std::string& part) {
  const std::string host = HostOfPart(compiled, part);
  std::vector<const RobotRecord*> robots;
  int own = -1, first = -1;
  for (const RobotRecord& robot : compiled.robots()) {
    if (HostOfPart(compiled, robot.name) != host) continue;
    if (robot.name == part) own = static_cast<int>(robots.size());
    if (robot.name == host) first = static_cast<int>(robots.size());
    robots.push_back(&robot);
  }
  if (robots.size() < 2) return {};
  const KeyOwners owners(compiled, robots, first);
  const mjModel* m = compiled.model();
  KeyShare share{std::vector<bool>(m->nq), std::vector<bool>(m->nv), std::vector<bool>(m->na),
                 std::vector<bool>(m->nu), std::vector<bool>(m->nmocap)};
  for (int joint = 0; joint < m->njnt; ++joint) {
    if (owners.OfBody(m->jnt_bodyid[joint]) != own) continue;
    const bool last = joint + 1 == m->njnt;
    Fill(share.qpos, m->jnt_qposadr[joint], last ? int(m->nq) : m->jnt_qposadr[joint + 1]);
    Fill(share.qvel, m->jnt_dofadr[joint], last ? int(m->nv) : m->jnt_dofadr[joint + 1]);
  }
  for (int actuator = 0; actuator < m->nactuator; ++actuator) {
    if (owners.OfActuator(actuator) != own) continue;
    const int ctrl = m->actuator_ctrladr[actuator], act = m->actuator_actadr[actuator];
    Fill(share.ctrl, ctrl, ctrl + m->actuator_ctrlnum[actuator]);
    if (act >= 0) Fill(share.act, act, act + m->actuator_actnum[actuator]);
  }
  for (int body = 1; body < m->nbody; ++body) {
    if (m->body_mocapid[body] >= 0 && owners.OfBody(body) == own)
      share.mocap[m->body_mocapid[body]] = true;
  }
  return share;
}

}  // namespace robocell::internal
