// Recognises pointers of Git LFS: the short texts that a repository has in the place of large files
// until `git lfs pull` fetches them. Decoders of meshes, images and XML do not name them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell::internal {

// Returns false for a file that cannot be read.
bool IsLfsPointer(const std::filesystem::path& file);

// Returns what to do about the pointers among `files`: "a.stl: a pointer of Git LFS, not the file
// itself, as 3 more files are: run `git lfs pull` ...". "" if none is one.
std::string LfsPointerAdvice(const std::vector<std::filesystem::path>& files);

}  // namespace robocell::internal
