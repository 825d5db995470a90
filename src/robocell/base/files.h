// Durable files and folders: written data is complete or absent, also after a power cut.
//
//   AtomicWrite(folder / "episode.json", text);  // the old text or the new one, never half
//
//   const fs::path work = MakeTempDirectory(dataset, "ep_17");  // .ep_17.<process>.<n>.partial
//   ... write files into `work` ...
//   CommitDirectory(work, dataset / "ep_17");  // all of it, or nothing
//
// Every failure is an IoError with the path and the system's reason; for a full disk also with the
// bytes needed and free. Interrupted and partial writes are continued. Temporary names are hidden
// and end in ".partial"; a crash may leave some behind, and IsTemporaryName finds them. All
// functions may be called from any thread.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/io_error.h"

namespace robocell {

// Returns the whole content of a regular file.
std::string ReadFile(const std::filesystem::path& path);

// Calls f(bytes) for every block of a file of any size. Throws IoError if it cannot be read.
//
//   ReadBlocks(path, [&](std::string_view block) { hash.Update(block); });
void ReadBlocks(const std::filesystem::path& path, const std::function<void(std::string_view)>& f);

// Reads an open file from its present position; `path` is for the message.
void ReadBlocks(int descriptor, const std::filesystem::path& path,
                const std::function<void(std::string_view)>& f);

// Replaces or creates the file in one step: written under a temporary name in the same folder,
// flushed to the disk, renamed, and the folder flushed. If a step up to the renaming fails, the
// former file is unchanged and the temporary one is removed. The folder must exist. A symbolic link
// at `path` is replaced, not followed.
void AtomicWrite(const std::filesystem::path& path, std::string_view bytes);

// Writes all bytes to an open descriptor; `path` is for the message only. Blocks on pipes until all
// bytes are accepted.
void WriteAll(int descriptor, std::string_view bytes, const std::filesystem::path& path);

// Flushes a file's content, or a folder's entries, to the disk.
void FsyncFile(const std::filesystem::path& path);
void FsyncDirectory(const std::filesystem::path& path);

// Returns a hidden temporary name in `parent` made from `name`, a different one with each call of
// this process. A process with the same number on another machine or in another container may use
// it: a caller that finds it taken requests the next one.
std::filesystem::path TemporaryPath(const std::filesystem::path& parent, std::string_view name);

// Creates an empty folder with a hidden temporary name made from `name` in `parent`, which must
// exist.
std::filesystem::path MakeTempDirectory(const std::filesystem::path& parent, std::string_view name);

// Creates an empty file with a hidden temporary name beside `target`, made from its name.
std::filesystem::path MakeTempFile(const std::filesystem::path& target);

// Returns true for the names that these functions and AtomicWrite give: leftovers of a crash, or
// files that another process is writing now.
bool IsTemporaryName(std::string_view file_name);

// Flushes everything in `temporary`, gives it its final name and flushes the parent. Both must be
// on one file system. An existing `final` is an IoError and stays unchanged; after any failure
// before the rename `temporary` stays unchanged; if only the last flush fails, `final` is in place
// and the message says so. `temporary` may contain regular files and folders only (IoError
// otherwise).
void CommitDirectory(const std::filesystem::path& temporary, const std::filesystem::path& final);

// Returns the names in a folder, sorted. Throws IoError if it cannot be listed completely.
std::vector<std::string> FolderNames(const std::filesystem::path& folder);

// Returns the names that can be listed, none without a folder: for hints in messages, and for
// optional folders.
std::vector<std::string> FolderNamesIfAny(const std::filesystem::path& folder);

}  // namespace robocell
