#include "robocell/robot/suction_gripper.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr double kOpenFrom = 0.9;    // opening above which a gripper counts as open
constexpr double kSticksFrom = 0.1;  // share of the full force that counts as sticking

double At(const GripperCtrl& ctrl, double opening) {
  return ctrl.closed + (ctrl.open - ctrl.closed) * opening;
}

}  // namespace

bool SuctionGripper::IsMadeOf(const mjModel* m, const std::vector<std::string>& actuators) {
  return !actuators.empty() && std::ranges::all_of(actuators, [&](const std::string& name) {
    const int a = FindId(m, mjOBJ_ACTUATOR, name);
    return a >= 0 && m->actuator_trntype[a] == mjTRN_BODY;
  });
}

SuctionGripper::SuctionGripper(const Scene& scene, GroupNames names, const MoveGroupConfig& config)
    : JointGroupOf(scene, std::move(names), MoveGroupKind::kGripper),
      base_body_(scene.compiled()->robot(core().names().robot).base_body) {
  if (!config.poses.empty()) {
    throw ArgumentError(place() +
                        ": `poses` are of hands with fingers; a suction cup or magnet has `ctrl`");
  }
  const std::vector<Interval> limits = ctrl_limits();
  for (size_t i = 0; i < limits.size(); ++i) {
    if (config.ctrl) {
      ends_.push_back(*config.ctrl);
    } else if (std::isfinite(limits[i].lower) && std::isfinite(limits[i].upper)) {
      ends_.push_back({.open = limits[i].lower, .closed = limits[i].upper});
    } else {
      throw ArgumentError(fmt::format(
          "{}: actuator '{}' has no control range; give `ctrl: {{open: ..., closed: ...}}`",
          place(), actuator_names()[i]));
    }
  }
}

const std::vector<int>& SuctionGripper::cups() const {
  core().Bind();
  if (generation_ == core().scene().generation()) return cups_;
  cups_.clear();
  for (const int a : core().actuator_ids()) cups_.push_back(core().model()->actuator_trnid[2 * a]);
  generation_ = core().scene().generation();
  return cups_;
}

double SuctionGripper::Checked(double opening) const {
  if (!std::isfinite(opening)) {
    throw ArgumentError(fmt::format(
        "{}: opening cannot be {}; it goes from 0 (sticks) to 1 (releases)", place(), opening));
  }
  return std::clamp(opening, 0.0, 1.0);
}

double SuctionGripper::opening() const {
  core().Bind();
  double sum = 0;
  for (size_t i = 0; i < ends_.size(); ++i) {
    const double ctrl = core().data()->ctrl[core().ctrl_addresses()[i]];
    sum += (ctrl - ends_[i].closed) / (ends_[i].open - ends_[i].closed);
  }
  return std::clamp(sum / static_cast<double>(ends_.size()), 0.0, 1.0);
}

void SuctionGripper::SetOpening(double opening) {
  core().Bind();
  const double share =
      Checked(beyond_.Clamp(opening, {0, 1}, [&] { return place() + ": opening"; }));
  for (size_t i = 0; i < ends_.size(); ++i)
    core().data()->ctrl[core().ctrl_addresses()[i]] = At(ends_[i], share);
}

double SuctionGripper::ctrl_for_opening(double opening) const {
  return At(ends_[0], Checked(opening));
}

void SuctionGripper::CtrlForOpening(double opening, std::span<double> ctrl) const {
  const double share = Checked(opening);
  for (size_t i = 0; i < ctrl.size(); ++i) ctrl[i] = At(ends_[i], share);
}

bool SuctionGripper::is_open() const { return opening() >= kOpenFrom; }

bool SuctionGripper::is_grasping(const std::string& body) const {
  if (opening() > 1 - kSticksFrom) return false;
  const std::vector<int>& sticking = cups();
  const mjModel* m = core().model();
  const mjData* d = core().data();
  const int robot = RequireId(m, mjOBJ_BODY, base_body_, place());
  const int wanted = body.empty() ? -1 : RequireId(m, mjOBJ_BODY, body, place());
  const auto is_held = [&](int touched) {
    if (wanted >= 0) return IsInSubtree(m, touched, wanted);
    return m->body_weldid[touched] != 0 && !IsInSubtree(m, touched, robot);
  };
  // Contacts within a cup's gap pull too, though they do not push.
  return std::any_of(d->contact, d->contact + d->ncon, [&](const mjContact& contact) {
    if (contact.exclude > 1 || contact.geom[0] < 0 || contact.geom[1] < 0) return false;
    const int a = m->geom_bodyid[contact.geom[0]], b = m->geom_bodyid[contact.geom[1]];
    const bool first = std::ranges::find(sticking, a) != sticking.end();
    const bool second = std::ranges::find(sticking, b) != sticking.end();
    return first != second && is_held(first ? b : a);
  });
}

}  // namespace robocell::internal
