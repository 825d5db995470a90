// Private to spec: reports tools that are listed twice.
#pragma once

#include "robocell/spec/attachment_spec.h"
#include "robocell/spec/containers.h"

namespace robocell::internal {

// Adds a problem at attachments[i] for the same model at the same place, or under the same prefix,
// as an earlier one.
void ValidateAttachments(const List<AttachmentSpec>& attachments, Problems& problems);

}  // namespace robocell::internal
