// The controller of a driven base (driven_base.h): its target is a pose of the base in the world,
// to which the base moves with limited speed.
#pragma once

#include <memory>

#include "robocell/robot/controller.h"
#include "robocell/robot/driven_base.h"

namespace robocell::internal {

inline constexpr std::string_view kBasePoseController = "base_pose";

// Throws ArgumentError for any other group.
std::unique_ptr<Controller> MakeBasePoseController(MoveGroup& group);

class BasePoseController : public Controller {
 public:
  static constexpr std::string_view kKind = kBasePoseController;
  explicit BasePoseController(DrivenBase& base) : base_(base) {}

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { base_.RequireOpen(); }
  const Scene* scene() const override { return base_.scene(); }
  TargetKind target_kind() const override { return TargetKind::kBasePose; }
  int target_size() const override { return 7; }
  void SetTarget(std::span<const double> numbers) override;
  std::span<const double> target() const override { return base_.target_numbers(); }
  // Returns the position and the quaternion wxyz, in the layout of a free joint.
  std::span<const double> commanded_joint_pos() const override;
  std::span<double> command_port() override { return base_.target_numbers(); }
  void Reset() override { base_.Hold(); }
  void Compute(std::span<double>) override { base_.Advance(); }

 private:
  DrivenBase& base_;
  mutable std::array<double, 7> joint_ = {};
};

}  // namespace robocell::internal
