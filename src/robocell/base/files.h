// Durable files and folders: what was written is complete or absent, also after a power cut.
//
//   AtomicWrite(folder / "episode.json", text);  // the old text or the new one, never half
//
//   const fs::path work = MakeTempDirectory(dataset, "ep_17");  // .ep_17.<process>.<n>.partial
//   ... write files into `work` ...
//   CommitDirectory(work, dataset / "ep_17");  // all of it, or nothing
//
// Every failure is an IoError with the path and the system's reason; on a full disk with the bytes
// needed and free. Interrupted and partial writes are continued. Temporary names are hidden and end
// in ".partial"; a crash may leave some behind, and IsTemporaryName finds them. All functions may
// be called from any thread.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/io_error.h"

namespace robocell {

// The whole content of a regular file.
std::string ReadFile(const std::filesystem::path& path);

// Calls f(bytes) for every block of a file until the end: its size does not matter. IoError when it
// cannot be read.
//
//   ReadBlocks(path, [&](std::string_view block) { hash.Update(block); });
void ReadBlocks(const std::filesystem::path& path, const std::function<void(std::string_view)>& f);

// The same of an open file, from where it stands; `path` is for the message.
void ReadBlocks(int descriptor, const std::filesystem::path& path,
                const std::function<void(std::string_view)>& f);

// Replaces or creates the file in one step: written under a temporary name in the same folder,
// flushed to the disk, renamed, and the folder flushed. After a failure up to the renaming the
// former file is unchanged and the temporary one is gone. The folder must exist. A symbolic link at
// `path` is replaced, not followed.
void AtomicWrite(const std::filesystem::path& path, std::string_view bytes);

// Writes all bytes to an open descriptor; `path` is for the message only. Blocks on pipes until all
// is taken.
void WriteAll(int descriptor, std::string_view bytes, const std::filesystem::path& path);

// Flushes a file's content, or a folder's entries, to the disk.
void FsyncFile(const std::filesystem::path& path);
void FsyncDirectory(const std::filesystem::path& path);

// A hidden temporary name in `parent` made from `name`, another one with each call of this process.
// A process of the same number on another machine or in another container may have it: whoever
// finds it taken asks for the next one.
std::filesystem::path TemporaryPath(const std::filesystem::path& parent, std::string_view name);

// Creates an empty folder with a hidden temporary name made from `name` in `parent`, which must
// exist.
std::filesystem::path MakeTempDirectory(const std::filesystem::path& parent, std::string_view name);

// Creates an empty file with a hidden temporary name beside `target`, made from its name.
std::filesystem::path MakeTempFile(const std::filesystem::path& target);

// True for the names that these functions and AtomicWrite give: what a crash left behind, or
// another process is writing now.
bool IsTemporaryName(std::string_view file_name);

// Flushes everything in `temporary`, gives it its final name and flushes the parent. Both must be
// on one file system. An existing `final` is an IoError and stays as it is; after any failure
// before the rename `temporary` stays as it is; when only the last flush fails, `final` is in place
// and the message says so. Holds regular files and folders only (IoError
// otherwise).
void CommitDirectory(const std::filesystem::path& temporary, const std::filesystem::path& final);

// Names in a folder, sorted. IoError when it cannot be listed to the end.
std::vector<std::string> FolderNames(const std::filesystem::path& folder);

// The same as far as it can be listed, none where there is no folder: for hints in messages, and
// for places that may be there.
std::vector<std::string> FolderNamesIfAny(const std::filesystem::path& folder);

}  // namespace robocell
