// The kind of expert of all tasks whose goals are relations (skill_expert.h).
#pragma once

#include <memory>

#include "robocell/expert/expert_kind.h"

namespace robocell::internal {

std::shared_ptr<const ExpertKind> MakeSkillExpertKind();

}  // namespace robocell::internal
