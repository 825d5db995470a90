#include "robocell/robot/arm_ik.h"

#include "robocell/robot/task_space.h"

namespace robocell {

IkOptions ForArm(const Robot& robot, IkOptions options) {
  if (!internal::ChoosesPart(options)) internal::TaskSpaceOf(robot).ApplyTo(options);
  return options;
}

}  // namespace robocell
