// Private to scene: finds problems in a part's own model file that would be lost when the part is
// put into a scene: the engine drops elements that refer to nothing, and keyframes are read by
// name.
#pragma once

#include "robocell/scene/compile_log.h"
#include "robocell/scene/part.h"

namespace robocell::internal {

// Reports a robot's configuration that is given in place of its model.
void ValidateIsModel(const std::string& file, const std::string& place, const std::string& field,
                     CompileLog& log);

// Reports each actuator whose joint, tendon, site or body is not in the model.
void ValidateActuatorTargets(const Part& part, CompileLog& log);

// Reports a problem if the keyframe `home` has more numbers than the model's joints, like the
// engine; a warning if it has fewer.
void ValidateHomeKeyLength(const Part& part, CompileLog& log);

// Warns if it has fewer controls than there are actuators.
void ValidateHomeKeyControls(const Part& part, CompileLog& log);

// Warns of each other keyframe with the wrong count of numbers in qpos, and leaves it out.
void ValidatePresetSizes(Part& part, CompileLog& log);

// Reports joints and tendons of a whole scene with a negative damping, armature or friction loss,
// which the engine accepts and which adds energy until the state diverges.
void ValidateResistances(mjSpec* scene, CompileLog& log);

// Returns a remark about a robot whose keyframes all have other names; "" if there is a `home` or
// no keyframe at all.
std::string OtherKeys(const Part& part);

}  // namespace robocell::internal
