// Checks that every byte of an episode is as written, from the outside in: episode.json, the list
// of files, their bytes, then their content. For Verify (verify.h).
#pragma once

#include <filesystem>
#include <vector>

#include "robocell/data/isolated_reader.h"
#include "robocell/data/verify.h"

namespace robocell::internal {

// A file is parsed only after its hash was found correct, and HDF5 reads in a separate process:
// the author of the hash may be malicious. With `decode` every frame of the videos is decoded.
class EpisodeVerifier {
 public:
  explicit EpisodeVerifier(bool decode);

  std::vector<VerifyProblem> Verify(const std::filesystem::path& folder);

 private:
  bool decode_;
  IsolatedReader columns_;
};

}  // namespace robocell::internal
