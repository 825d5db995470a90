// Is every byte of an episode what was written? From the outside in: episode.json, the list of
// files, their bytes, then what they hold. For Verify (verify.h).
#pragma once

#include <filesystem>
#include <vector>

#include "robocell/data/isolated_reader.h"
#include "robocell/data/verify.h"

namespace robocell::internal {

// A file is parsed only after its hash was found right, and HDF5 reads in a process of its own: who
// hashes a file may also have made it to hurt. With `decode` every frame of the videos is decoded.
class EpisodeVerifier {
 public:
  explicit EpisodeVerifier(bool decode);

  std::vector<VerifyProblem> Verify(const std::filesystem::path& folder);

 private:
  bool decode_;
  IsolatedReader columns_;
};

}  // namespace robocell::internal
