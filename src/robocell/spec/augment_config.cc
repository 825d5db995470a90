#include "robocell/spec/augment_config.h"

#include "robocell/spec/validate.h"

namespace robocell {

void AugmentConfig::Validate(Problems& problems) const {
  ValidateNotEmpty(dataset, "dataset", "the dataset with the source episodes", problems);
}

}  // namespace robocell
