#include "robocell/kinematics/chain.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/base/small_arrays.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/chain_builder.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/link_table.h"

namespace robocell {

struct Chain::Lazy {
  std::once_flag made;
  std::optional<internal::LaneChain> lanes;
  std::atomic<const internal::LaneChain*> ready = nullptr;  // faster to read than the flag
  std::shared_ptr<void> companion;
};

const internal::LaneChain& Chain::lanes() const {
  Lazy& lazy = *parts_->lazy;
  if (const internal::LaneChain* ready = lazy.ready.load(std::memory_order_acquire)) return *ready;
  std::call_once(lazy.made, [&] {
    lazy.ready.store(&lazy.lanes.emplace(model()), std::memory_order_release);
  });
  return *lazy.lanes;
}

std::shared_ptr<void>& Chain::companion() const { return parts_->lazy->companion; }

Chain::Chain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
             const ChainOptions& options)
    : Chain([&] {
        Parts parts{
            .base_body = base_body == "world" ? "world" : options.prefix + std::string(base_body),
            .tip = {tip.kind, options.prefix + tip.name}};
        internal::BuiltChain built =
            internal::BuildChain(model, parts.base_body, parts.tip, options);
        parts.model = built.model;
        parts.joints = std::move(built.joints);
        parts.couplings = std::move(built.couplings);
        parts.followers = std::move(built.followers);
        parts.link_joints = std::move(built.link_joints);
        return parts;
      }()) {}

Chain::Chain(Parts parts)
    : parts_(Complete(std::move(parts))),
      links_(parts_->links.get()),
      coupled_(parts_->model.coupled.get()) {}

std::shared_ptr<const Chain::Parts> Chain::Complete(Parts parts) {
  parts.links = std::make_shared<const LinkTable>(Tabulate(LinksOf(parts.model)));
  parts.lazy = std::make_shared<Lazy>();
  return std::make_shared<const Parts>(std::move(parts));
}

std::string Chain::description() const {
  return fmt::format("chain '{}' -> {} '{}'", base_body(),
                     tip().kind == ChainTip::Kind::kSite ? "site" : "body", tip().name);
}

std::vector<std::string> Chain::joint_names() const {
  std::vector<std::string> names;
  for (const ChainJoint& joint : joints()) names.push_back(joint.name);
  return names;
}

int Chain::joint_index(std::string_view name) const {
  for (int i = 0; i < n_joints(); ++i) {
    if (joints()[i].name == name) return i;
  }
  throw NotFoundError(NoSuchName(description(), "joint", name, joint_names()));
}

void Chain::RequireSize(std::string_view what, std::size_t size) const {
  if (size == joints().size()) return;
  throw ArgumentError(fmt::format("{}: {}: expected {}, got {}", description(), what,
                                  Counted(n_joints(), "joint value"), size));
}

void Chain::RequireJointValues(std::string_view what, std::span<const double> values) const {
  RequireSize(what, values.size());
  if (AllFinite(values.data(), values.size())) return;
  for (int i = 0; i < n_joints(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw ArgumentError(fmt::format("{}: {}: joint '{}' is {}; joint values must be finite",
                                    description(), what, joints()[i].name, values[i]));
  }
}

JointVector Chain::Expand(std::span<const double> q) const {
  RequireJointValues("q", q);
  if (!coupled_) return JointVector(q);
  JointVector all(coupled_->links.n);
  coupled_->Expand(q.data(), all.data());
  return all;
}

double Chain::moving_mass() const {
  double mass = 0;
  const ChainModel& links = LinksOf(model());
  for (int i = 0; i < links.n; ++i) mass += links.joints[i].link.mass;
  return mass;
}

}  // namespace robocell
