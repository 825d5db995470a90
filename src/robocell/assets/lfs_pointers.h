// Pointers of Git LFS among the files of a model: the short texts that a repository has in the place
// of large files until `git lfs pull` fetches them.
//
//   if (const std::string advice = assets::AdviceAboutPointers("arm.xml"); !advice.empty()) ...
#pragma once

#include <string>

namespace robocell::assets {

// Returns which files of a model that cannot be read are pointers, and what to do; "" if none is
// one, or if there is no such model. Scenes report it by themselves. Any thread.
std::string AdviceAboutPointers(const std::string& model);

}  // namespace robocell::assets
