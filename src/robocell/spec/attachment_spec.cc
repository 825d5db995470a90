#include "robocell/spec/attachment_spec.h"

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

}  // namespace robocell
