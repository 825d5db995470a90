// The files that models are made from, found in their text without the engine: the file itself, its
// includes, meshes, textures, height fields, other models. Names are read and looked up like the
// engine does (XML of any suffix; asset folders wherever they are set), in every place where it
// might look.
//
//   const FileSet arm = ModelFileSet("/menagerie/ufactory_xarm7/xarm7.xml");
//   const ModelFiles found = FindModelFiles(stored);   // also what is named and not there
//   RequireOnlyFiles(model);                           // before the engine opens what it names
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/base/file_set.h"

namespace robocell::internal {

// A name without a file. The engine reports it when the model is compiled.
struct MissingFile {
  std::filesystem::path document;  // the document that names it
  std::string name;                // name as written; "" if the document itself cannot be read
  std::string reason;
};

struct ModelFiles {
  std::vector<std::filesystem::path> files;  // absolute, sorted, with the model
  std::vector<MissingFile> missing;
  std::vector<MissingFile> no_files;  // pipes, sockets and devices, which may never end
};

// Throws IoError if `model` cannot be read.
ModelFiles FindModelFiles(const std::filesystem::path& model);

// Throws SpecError if `model`, or a file that it includes, names a pipe, a socket or a device: the
// engine would open it and wait for ever. The engine reports files that cannot be read.
void RequireOnlyFiles(const std::filesystem::path& model);

// Returns what to do about files of `model` that are pointers of Git LFS (base/lfs_pointer.h), for a
// model that the engine cannot read or compile; "" if none is one.
std::string AdviceAboutPointers(const std::filesystem::path& model);

// Returns the existing files, identified by their content.
FileSet ModelFileSet(const std::filesystem::path& model, const Hashing& hashing = {});

}  // namespace robocell::internal
