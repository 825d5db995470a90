// Private to scene: default classes of parts that are attached without a prefix.
#pragma once

#include <string>

#include "robocell/scene/part.h"

namespace robocell {

// Gives the part's default classes other names where `parent` has classes of the same name: an
// attachment with an empty prefix would leave two classes of one name, which the engine saves to an
// XML file that it cannot read. Classes matter only for saving; elements keep their values.
void MakeClassNamesUnique(const Part& part, const mjSpec* parent);

}  // namespace robocell
