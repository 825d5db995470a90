// Is every byte of a dataset what was written? Verify finds truncated and changed files, missing
// and foreign ones, and what a crash left behind, and names them; Repair moves what is bad aside.
// Good episodes are never touched.
//
//   VerifyReport report = Verify("out/pick_v1");
//   if (!report.ok()) std::cerr << report.Text();  // one line per problem: episode, file, reason
//
// A file is parsed only after its hash was found right, so damaged bytes never reach the HDF5
// library or the decoder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace robocell {

struct VerifyProblem {
  std::string episode;  // its id; "" for the dataset itself
  std::string file;     // within the episode, or within the dataset
  std::string reason;
  // "pick-000017/steps.h5: 4096 of 9216 bytes are there".
  std::string Text() const;
};

struct VerifyReport {
  std::vector<std::string> good;        // ids of intact episodes
  std::vector<std::string> bad;         // ids of the others
  std::vector<std::string> bad_parts;   // damaged parts of the dataset itself, by name
  std::vector<std::string> unlisted;    // models that are whole but for the list of their files
  std::vector<VerifyProblem> problems;  // of the bad ones, and of the dataset
  // Temporary folders and files. No problem.
  std::vector<std::string> leftovers;  // what a crash left behind
  std::vector<std::string>
      being_written;  // episodes whose writer lives, on this machine or another
  // Files and folders that are no part of a dataset: logs, notes. No problem either.
  std::vector<std::string> others;

  bool has_manifest = true;  // recordings of other programs may do without: no problem

  bool ok() const { return problems.empty(); }
  // One line per problem and leftover, then a summary line.
  std::string Text() const;
};

struct VerifyOptions {
  bool decode_videos = false;  // also decode every frame: slow, and hashes find damage without it
  // Called after each episode with how many are done and how many there are; may be empty.
  std::function<void(size_t done, size_t total)> progress;
};

// ArgumentError for a folder that is no dataset: neither a dataset.json nor an episode, and nothing
// that either leaves behind. IoError if it cannot be listed.
VerifyReport Verify(const std::filesystem::path& dataset, const VerifyOptions& options = {});

// The problems of one episode's folder.
std::vector<VerifyProblem> VerifyEpisode(const std::filesystem::path& folder,
                                         bool decode_videos = false);

struct RepairResult {
  VerifyReport found;
  std::vector<VerifyProblem> remaining = {};  // what could not be mended by moving things aside
  std::vector<std::string> moved;  // what now lies in <dataset>/.quarantine, by its new name
};

// Moves bad episodes, damaged models, a damaged dataset.json or report, and leftovers that nobody
// is writing, into <dataset>/.quarantine; writes the list of files of a model that lost it. Nothing
// is deleted. Holds the dataset's lock
// (dataset_lock.h): IoError names who is generating into it.
RepairResult Repair(const std::filesystem::path& dataset, const VerifyOptions& options = {});

}  // namespace robocell
