#include "robocell/spec/validate_attachments.h"

#include <fmt/format.h>

namespace robocell::internal {

void ValidateAttachments(const List<AttachmentSpec>& attachments, Problems& problems) {
  Problems::Scope list(problems, "attachments");
  for (size_t i = 0; i < attachments.size(); ++i) {
    const AttachmentSpec& late = attachments[i];
    for (size_t j = 0; j < i; ++j) {
      const AttachmentSpec& early = attachments[j];
      if (early.mjcf_path != late.mjcf_path) continue;
      const bool same_place = early.attach_to == late.attach_to && early.pos == late.pos &&
                              early.euler == late.euler && early.quat == late.quat;
      if (!same_place && early.prefix != late.prefix) continue;
      Problems::Scope item(problems, i);
      problems.Add(fmt::format(
          "'{}' is attachments[{}] too, {}: is it listed twice? {}", late.mjcf_path, j,
          same_place ? "at the same place" : "with the same prefix '" + late.prefix + "'",
          same_place ? "Remove one of them" : "Each needs a prefix of its own"));
      break;
    }
  }
}

}  // namespace robocell::internal
