#include "robocell/spec/attachment_spec.h"

#include <fmt/format.h>

#include "robocell/spec/validate.h"

namespace robocell {

void AttachmentSpec::Validate(Problems& problems) const {
  ValidateNotEmpty(mjcf_path, "mjcf_path", "the model file to attach", problems);
  ValidatePlacement(euler, quat, problems);
  const AttachKind k = attach_to.kind;
  if (k != AttachKind::kBody && k != AttachKind::kSite && k != AttachKind::kFrame) {
    problems.AddAt("attach_to",
                   std::string("an attachment needs a body, site or frame of its robot, not '") +
                       ToString(k) + "'; write for example {site: attachment_site}");
  }
}

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
          same_place ? "Remove one of them" : "Each needs a different prefix"));
      break;
    }
  }
}

}  // namespace robocell
