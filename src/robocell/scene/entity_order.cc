#include "robocell/scene/entity_order.h"

#include <fmt/format.h>

#include <optional>

#include "robocell/base/suggestions.h"
#include "robocell/scene/placement.h"

namespace robocell::internal {
namespace {

using ElementSet = std::set<std::pair<AttachKind, std::string>>;

constexpr int kNone = -1;     // needs no other entity
constexpr int kMissing = -2;  // needs a missing entity

bool IsElement(AttachKind kind) { return ElementKindOf(kind) != mjOBJ_UNKNOWN; }
bool IsRobot(AttachKind kind) {
  return kind == AttachKind::kRobotBase || kind == AttachKind::kAttachment;
}

void AddNames(const ElementSet& elements, AttachKind kind, std::vector<std::string>& names) {
  for (const auto& [k, name] : elements) {
    if (k == kind) names.push_back(name);
  }
}

class Order {
 public:
  Order(const std::vector<Entity>& entities, const ElementSet& base, CompileLog& log)
      : entities_(entities),
        base_(base),
        log_(log),
        needs_(entities.size()),
        state_(entities.size(), kUnseen) {}

  std::vector<size_t> Build() {
    for (size_t i = 0; i < entities_.size(); ++i) needs_[i] = Need(i);
    for (size_t i = 0; i < entities_.size(); ++i) Visit(i);
    return out_;
  }

 private:
  enum State { kUnseen, kOpen, kDone, kFailed };

  // Returns the entity that i is attached to.
  int Need(size_t i) {
    const AttachTarget& target = entities_[i].target;
    const int owner = FindOwner(i, target);
    if (owner == kMissing) {
      ReportMissing(i, target);
    } else if (owner > static_cast<int>(i) && entities_[owner].list == entities_[i].list) {
      log_.Problem(
          entities_[i].place,
          fmt::format("is attached to {} of {}, which is declared later; move {} before it",
                      DescribeTarget(target), entities_[owner].place, entities_[owner].place),
          "attach_to");
      return kMissing;
    }
    return owner;
  }

  int FindOwner(size_t i, const AttachTarget& target) const {
    if (!IsElement(target.kind) && !IsRobot(target.kind)) return kNone;
    if (base_.contains({target.kind, target.name})) return kNone;
    for (size_t k = 0; k < entities_.size(); ++k) {
      const bool owns = IsRobot(target.kind)
                            ? !target.name.empty() && entities_[k].robot == target.name
                            : entities_[k].elements.contains({target.kind, target.name});
      if (owns && k == i) return static_cast<int>(i);
      if (owns) return static_cast<int>(k);
    }
    return kMissing;
  }

  void ReportMissing(size_t i, const AttachTarget& target) {
    std::vector<std::string> names;
    for (const Entity& entity : entities_) {
      if (IsRobot(target.kind) && !entity.robot.empty()) names.push_back(entity.robot);
      if (IsElement(target.kind) && &entity != &entities_[i])
        AddNames(entity.elements, target.kind, names);
    }
    AddNames(base_, target.kind, names);
    const std::string kind = IsRobot(target.kind) ? "robot" : ToString(target.kind);
    log_.Missing(entities_[i].place,
                 "attach_to: " + NoSuchName("the scene", kind, target.name, names), "attach_to");
  }

  bool Visit(size_t i) {
    if (state_[i] == kDone || state_[i] == kFailed) return state_[i] == kDone;
    if (state_[i] == kOpen) return ReportCycle(i), false;
    state_[i] = kOpen;
    path_.push_back(i);
    const bool good =
        needs_[i] == kNone || (needs_[i] >= 0 && Visit(static_cast<size_t>(needs_[i])));
    path_.pop_back();
    if (good) out_.push_back(i);
    state_[i] = good ? kDone : kFailed;
    return good;
  }

  void ReportCycle(size_t i) {
    std::string chain;
    bool inside = false;
    for (const size_t k : path_) {
      inside = inside || k == i;
      if (inside) chain += entities_[k].place + " -> ";
    }
    log_.Problem("",
                 "entities are attached to each other in a circle: " + chain + entities_[i].place);
  }

  const std::vector<Entity>& entities_;
  const ElementSet& base_;
  CompileLog& log_;
  std::vector<int> needs_;
  std::vector<State> state_;
  std::vector<size_t> path_, out_;
};

}  // namespace

std::vector<size_t> BuildOrder(const std::vector<Entity>& entities, const ElementSet& base,
                               CompileLog& log) {
  return Order(entities, base, log).Build();
}

}  // namespace robocell::internal
