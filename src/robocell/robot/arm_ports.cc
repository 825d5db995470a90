#include "robocell/robot/arm_ports.h"

#include <algorithm>
#include <utility>

namespace robocell::internal {

int ArmPorts::Index(TargetKind kind) {
  switch (kind) {
    case TargetKind::kJointPositions:
      return 0;
    case TargetKind::kJointVelocities:
      return 1;
    case TargetKind::kJointTorques:
      return 2;
    default:
      return kNone;
  }
}

void ArmPorts::Leave(Port& port) {
  port.seen = port.values;
  port.commanded = false;
}

void ArmPorts::Resize(int nq, int nv) {
  for (size_t i = 0; i < ports_.size(); ++i) {
    ports_[i].values.resize(static_cast<size_t>(i == 0 ? nq : nv));
    Leave(ports_[i]);
  }
}

std::span<double> ArmPorts::of(TargetKind kind) {
  return ports_.at(static_cast<size_t>(Index(kind))).values;
}

void ArmPorts::SetCommanded(TargetKind kind) {
  const int i = Index(kind);
  if (i != in_use_) ports_.at(static_cast<size_t>(i)).commanded = true;
}

void ArmPorts::Connect(Controller& controller) {
  const int next = Index(controller.port_kind());
  const int last = std::exchange(in_use_, kNone);
  if (last != kNone) Leave(ports_[static_cast<size_t>(last)]);
  if (next == kNone) return;
  Port& port = ports_[static_cast<size_t>(next)];
  const std::span<double> own = controller.command_port();
  if (own.size() != port.values.size()) return;
  std::vector<double> target(own.begin(), own.end());
  for (size_t i = 0; i < target.size(); ++i) {
    if (port.commanded || port.values[i] != port.seen[i]) target[i] = port.values[i];
  }
  if (!controller.UsePort(port.values)) return;
  std::copy(target.begin(), target.end(), port.values.begin());
  in_use_ = next;
}

void ArmPorts::PutBack(const ArmPorts& before, Controller* controller) {
  in_use_ = before.in_use_;
  if (in_use_ != kNone) controller->UsePort(ports_[static_cast<size_t>(in_use_)].values);
  for (size_t i = 0; i < ports_.size(); ++i) {
    const Port& was = before.ports_[i];
    std::copy(was.values.begin(), was.values.end(), ports_[i].values.begin());  // where it is
    ports_[i].seen = was.seen;
    ports_[i].commanded = was.commanded;
  }
}

void ArmPorts::Reseed(const MoveGroup& arm) {
  for (size_t i = 0; i < ports_.size(); ++i) {
    Port& port = ports_[i];
    if (port.values.empty() || static_cast<int>(i) == in_use_) continue;
    if (i == 0) {
      arm.GetJointPos(port.values);
    } else {
      std::fill(port.values.begin(), port.values.end(), 0.0);
    }
    Leave(port);
  }
}

}  // namespace robocell::internal
