// Private to scene: the attributes that an edit gives an element of a model that is being written.
#pragma once

#include <string>

#include "robocell/scene/compile_log.h"
#include "robocell/spec/edit.h"

struct mjsElement_;
typedef struct mjsElement_ mjsElement;

namespace robocell {

// Each attribute is in the compiled model as the edit says, or it is a problem at `place`. The name
// is none of them.
void SetEdited(const Edit& edit, mjsElement* element, const std::string& place, CompileLog& log);

}  // namespace robocell
