#include "robocell/kinematics/chain.h"

#include <fmt/format.h>

#include <cmath>
#include <mutex>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/kinematics/chain_builder.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/link_table.h"

namespace robocell {

struct Chain::Lazy {
  std::once_flag made;
  std::optional<LaneChain> lanes;
  std::shared_ptr<void> companion;
};

std::shared_ptr<Chain::Lazy> Chain::NewLazy() { return std::make_shared<Lazy>(); }

const LaneChain& Chain::lanes() const {
  std::call_once(lazy_->made, [this] { lazy_->lanes.emplace(model_); });
  return *lazy_->lanes;
}

std::shared_ptr<void>& Chain::companion() const { return lazy_->companion; }

Chain::Chain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
             const ChainOptions& options)
    : base_body_(base_body == "world" ? "world" : options.prefix + std::string(base_body)),
      tip_{tip.kind, options.prefix + tip.name} {
  BuiltChain built = BuildChain(model, base_body_, tip_, options);
  UseModel(built.model);
  joints_ = std::move(built.joints);
}

void Chain::UseModel(const ChainModel& model) {
  model_ = model;
  links_ = std::make_shared<const LinkTable>(Tabulate(model));
}

std::string Chain::description() const {
  return fmt::format("chain '{}' -> {} '{}'", base_body_,
                     tip_.kind == ChainTip::Kind::kSite ? "site" : "body", tip_.name);
}

std::vector<std::string> Chain::joint_names() const {
  std::vector<std::string> names;
  for (const ChainJoint& joint : joints_) names.push_back(joint.name);
  return names;
}

int Chain::joint_index(std::string_view name) const {
  for (int i = 0; i < n_joints(); ++i) {
    if (joints_[i].name == name) return i;
  }
  throw NotFoundError(NoSuchName(description(), "joint", name, joint_names()));
}

void Chain::CheckSize(std::string_view what, std::size_t size) const {
  if (size == joints_.size()) return;
  throw ArgumentError(fmt::format("{}: {}: expected {} joint values, got {}", description(), what,
                                  n_joints(), size));
}

void Chain::CheckJointValues(std::string_view what, std::span<const double> values) const {
  CheckSize(what, values.size());
  double nothing = 0;
  for (const double value : values) nothing += 0 * value;  // NaN for what is not finite
  if (nothing == 0) return;
  for (int i = 0; i < n_joints(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw ArgumentError(fmt::format("{}: {}: joint '{}' is {}; joint values must be finite",
                                    description(), what, joints_[i].name, values[i]));
  }
}

double Chain::moving_mass() const {
  double mass = 0;
  for (int i = 0; i < n_joints(); ++i) mass += model_.joints[i].link.mass;
  return mass;
}

}  // namespace robocell
