// Groups written in Python, as Python's collector sees them through the handles that keep them.
#pragma once

#include <memory>
#include <vector>

#include "move_group_trampoline.h"
#include "python_owner.h"
#include "robocell/robot/move_group.h"

namespace robocell::python {

// For tp_traverse. `groups` are copies of the pointers that one handle alone keeps alive; a group
// that anybody else keeps too is passed over.
inline int VisitGroups(const std::vector<std::shared_ptr<MoveGroup>>& groups, visitproc visit,
                       void* arg) {
  for (const auto& group : groups) {
    if (group.use_count() != 2) continue;
    const auto* own = dynamic_cast<const WrittenInPython*>(group.get());
    Py_VISIT(own ? own->target() : TargetOf(group));
  }
  return 0;
}

}  // namespace robocell::python
