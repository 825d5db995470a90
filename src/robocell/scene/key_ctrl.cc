#include "robocell/scene/key_ctrl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// An actuator's pull at one degree of freedom.
struct Moment {
  int dof = -1;
  double value = 0;
};

std::vector<Moment> MomentsOf(const mjModel* m, const mjData* d, int actuator) {
  std::vector<Moment> moments;
  const int output = m->actuator_outadr[actuator];
  const int begin = d->moment_rowadr[output], end = begin + d->moment_rownnz[output];
  for (int i = begin; i < end; ++i) {
    if (d->actuator_moment[i] != 0) moments.push_back({d->moment_colind[i], d->actuator_moment[i]});
  }
  return moments;
}

double SlackOf(const mjModel* m, int dof) {
  return m->jnt_type[m->dof_jntid[dof]] == mjJNT_SLIDE ? kKeySlackSlide : kKeySlackTurn;
}

}  // namespace

KeyCtrl::KeyCtrl(const mjModel* model, const mjData* data, const PartKey& part, std::string key,
                 const std::vector<RobotRecord>& robots)
    : m_(model), d_(data), part_(part), key_(std::move(key)) {
  for (const RobotRecord& robot : robots) {
    for (const auto& [name, group] : robot.config.move_groups.entries()) {
      if (group->kind == MoveGroupKind::kGripper) {
        for (const std::string& actuator : group->actuators)
          gripping_.insert(robot.prefix + actuator);
      } else if (group->kind == MoveGroupKind::kArm) {
        for (const std::string& joint : group->joints) arms_.insert(robot.prefix + joint);
      }
    }
  }
}

bool KeyCtrl::IsOfPart(int actuator) const {
  return part_.actuator_sources.contains(ElementName(m_, mjOBJ_ACTUATOR, actuator));
}

// Returns the part's inputs of an actuator that can hold; an omitted number follows from the other
// one.
std::optional<HoldingInputs> KeyCtrl::OwnInputs(int actuator) const {
  const std::string name = ElementName(m_, mjOBJ_ACTUATOR, actuator);
  const auto ctrl = part_.ctrl.find(name);
  const auto act = part_.act.find(name);
  if (act != part_.act.end() && act->second.size() == 1) {
    const bool filtered = IsFiltered(m_, actuator);
    const double given = ctrl != part_.ctrl.end() ? ctrl->second[0] : filtered ? act->second[0] : 0;
    return HoldingInputs{given, act->second[0]};
  }
  if (ctrl == part_.ctrl.end()) return std::nullopt;
  if (IsFiltered(m_, actuator)) return HoldingInputs{ctrl->second[0], ctrl->second[0]};
  return HoldingInputs{ctrl->second[0], {}};
}

void KeyCtrl::Set(int actuator, bool own, mjtNum* ctrl, mjtNum* act) {
  const std::string name = ElementName(m_, mjOBJ_ACTUATOR, actuator);
  const int input = m_->actuator_ctrladr[actuator], first_act = m_->actuator_actadr[actuator];
  const auto write = [&](const HoldingInputs& inputs) {
    ctrl[input] = inputs.ctrl;
    if (inputs.act && first_act >= 0) act[first_act] = *inputs.act;
  };
  if (const auto holding = FindHoldingInputs(m_, d_, actuator)) {
    const auto given = own ? OwnInputs(actuator) : std::nullopt;
    const bool grips = gripping_.contains(name);
    if (given && (grips || Holds(actuator, *given))) return write(*given);
    write(*holding);
    if (!own || grips) return;
    if (!Holds(actuator, *holding)) return NoteOutOfReach(actuator, *holding);
    if (given) NoteReplaced(actuator, *given, *holding);
    return;
  }
  if (!own) return;
  const auto copy = [&](const PartKey::Values& values, int count, mjtNum* out) {
    std::fill_n(out, count, 0.0);
    const auto given = values.find(name);
    if (given != values.end() && static_cast<int>(given->second.size()) == count)
      std::copy(given->second.begin(), given->second.end(), out);
  };
  copy(part_.ctrl, m_->actuator_ctrlnum[actuator], ctrl + input);
  if (first_act >= 0) copy(part_.act, m_->actuator_actnum[actuator], act + first_act);
}

// A servo that integrates its control drifts with any other than 0, and a filtered one goes from
// its activation to its control.
bool KeyCtrl::Holds(int actuator, const HoldingInputs& inputs) const {
  const bool integrates = m_->actuator_dyntype[actuator] == mjDYN_INTEGRATOR;
  if (integrates && (inputs.ctrl != 0 || !inputs.act)) return false;
  const double length = d_->actuator_length[m_->actuator_outadr[actuator]];
  const auto rests = [&](const HoldingInputs& at) {
    const double off = std::abs(RestingLength(m_, actuator, at) - length);
    const std::vector<Moment> moments = MomentsOf(m_, d_, actuator);
    const auto most = std::max_element(
        moments.begin(), moments.end(),
        [](const Moment& a, const Moment& b) { return std::abs(a.value) < std::abs(b.value); });
    if (most == moments.end()) return true;  // moves no joint
    return off <= SlackOf(m_, most->dof) * std::abs(most->value) || CarriesWeight(actuator, at);
  };
  if (!rests(inputs)) return false;
  return integrates || !inputs.act || rests({*inputs.act, inputs.act});
}

// Returns true if it pushes against the weight at its joints, by at most twice the weight: then it
// holds at least as well as without a force there.
bool KeyCtrl::CarriesWeight(int actuator, const HoldingInputs& inputs) const {
  const double length = d_->actuator_length[m_->actuator_outadr[actuator]];
  const double stiffness = -m_->actuator_biasprm[mjNBIAS * actuator + 1];
  const double force = stiffness * (RestingLength(m_, actuator, inputs) - length);
  const std::vector<Moment> moments = MomentsOf(m_, d_, actuator);
  return std::all_of(moments.begin(), moments.end(), [&](const Moment& moment) {
    const double needed = d_->qfrc_bias[moment.dof] - d_->qfrc_passive[moment.dof];
    return std::abs(moment.value * force - needed) <= std::abs(needed);
  });
}

void KeyCtrl::NoteReplaced(int actuator, const HoldingInputs& own, const HoldingInputs& holding) {
  const auto source = part_.actuator_sources.find(ElementName(m_, mjOBJ_ACTUATOR, actuator));
  if (source == part_.actuator_sources.end()) return;
  auto& [from, texts] = replaced_[source->second.file + source->second.place];
  from = source->second;
  const bool by_act = m_->actuator_dyntype[actuator] == mjDYN_INTEGRATOR;
  texts.push_back(
      by_act ? fmt::format("'{}' ctrl {:.4g}, act {:.4g} ({:.4g} and {:.4g} hold)", from.name,
                           own.ctrl, own.act.value_or(0), holding.ctrl, holding.act.value_or(0))
             : fmt::format("'{}' {:.4g} ({:.4g} holds)", from.name, own.ctrl, holding.ctrl));
}

// diagnose/servos.cc reports it for an arm's home.
void KeyCtrl::NoteOutOfReach(int actuator, const HoldingInputs& holding) {
  const auto source = part_.actuator_sources.find(ElementName(m_, mjOBJ_ACTUATOR, actuator));
  if (source == part_.actuator_sources.end()) return;
  if (key_ == "home" && ActsOnJoint(m_, actuator) &&
      arms_.contains(ElementName(m_, mjOBJ_JOINT, m_->actuator_trnid[2 * actuator])))
    return;
  auto& [from, texts] = short_[source->second.file + source->second.place];
  from = source->second;
  texts.push_back(fmt::format("'{}' {:.4g}", from.name, holding.act.value_or(holding.ctrl)));
}

void KeyCtrl::Warn(CompileLog& log) const {
  for (const auto& [file, entry] : replaced_) {
    log.WarnAt(entry.first.file, entry.first.place,
               fmt::format("keyframe '{}': controls do not hold its positions: {}. Without "
                           "`update` the joints would swing away, so a reset sets the controls "
                           "that hold. To say so in the file, write them into the keyframe",
                           entry.first.key, ListNames(entry.second, 40)));
  }
  for (const auto& [file, entry] : short_) {
    log.WarnAt(entry.first.file, entry.first.place,
               fmt::format("keyframe '{}': no control in its range (ctrlrange, actrange) holds "
                           "its positions; the nearest: {}. The joints swing away after a reset",
                           entry.first.key, ListNames(entry.second, 40)));
  }
}

}  // namespace robocell::internal
