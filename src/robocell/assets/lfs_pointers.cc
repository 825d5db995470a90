#include "robocell/assets/lfs_pointers.h"

#include "robocell/assets/model_files.h"

namespace robocell::assets {

std::string AdviceAboutPointers(const std::string& model) {
  return internal::AdviceAboutPointers(model);
}

}  // namespace robocell::assets
