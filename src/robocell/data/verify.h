// Is every byte of a dataset what was written? Verify finds truncated and changed files, missing
// and foreign ones, and what a crash left behind, and names them; Repair moves what is bad aside.
// Good episodes are never touched.
//
//   VerifyResult result = Verify("out/pick_v1");
//   if (!result.ok()) std::cerr << result.Text();  // one line per problem: episode, file, reason
//
// What an error of the system, another format version or a missing decoder says is nothing about
// what was written: such episodes are told and left alone. See episode_verifier.h for what is asked of
// each.
#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace robocell {

// A problem with one file of a dataset.
enum class ProblemKind {
  kDamage,      // it is not what was written, or not there
  kForeign,     // it does not belong there; what does is whole
  kUnreadable,  // this machine or version cannot judge it: access, a broken disk, a missing decoder
};

struct VerifyProblem {
  std::string episode;  // its id; "" for the dataset itself
  std::string file;     // within the episode, or within the dataset
  std::string reason;
  ProblemKind kind = ProblemKind::kDamage;
  // "pick-000017/steps.h5: 4096 of 9216 bytes are there".
  std::string Text() const;
};

// An error of the system says nothing about what was written; any other is about the bytes.
ProblemKind KindOf(const std::exception& error);

struct VerifyResult {
  std::vector<std::string> good;       // ids of intact episodes
  std::vector<std::string> bad;        // ids of damaged ones
  std::vector<std::string> unjudged;   // ids of those that cannot be judged here, as without access
  std::vector<std::string> foreign;    // things that do not belong there, in intact episodes or
                                       // the dataset
  std::vector<std::string> bad_parts;  // damaged parts of the dataset itself, by name
  std::vector<std::string> unlisted;   // models that are whole but for the list of their files
  std::vector<VerifyProblem> problems;  // of the bad ones, and of the dataset
  // Temporary folders and files. No problem.
  std::vector<std::string> leftovers;  // what a crash left behind
  std::vector<std::string>
      being_written;  // episodes whose writer lives, on this machine or another
  // Files and folders that are no part of a dataset: logs, notes. No problem either.
  std::vector<std::string> others;

  // The episodes are of a run, and dataset.json is gone. Recordings may do without: no problem.
  bool lost_manifest = false;

  bool ok() const { return problems.empty(); }
  // Whether there are problems, and all of them are this machine's or version's.
  bool only_unreadable() const;
  // One line per problem and leftover, then a summary line.
  std::string Text() const;
};

struct VerifyOptions {
  bool decode_videos = false;  // also decode every frame: slow, and hashes find damage without it
  // Called after each episode with how many are done and how many there are; may be empty.
  std::function<void(size_t done, size_t total)> progress;
};

// ArgumentError for a folder that is no dataset: neither a dataset.json nor an episode, and nothing
// that either leaves behind. IoError if it cannot be listed, or videos shall be decoded and no
// ffmpeg is there.
VerifyResult Verify(const std::filesystem::path& dataset, const VerifyOptions& options = {});

struct RepairResult {
  VerifyResult found;
  std::vector<VerifyProblem> remaining = {};  // what could not be mended by moving things aside
  std::vector<std::string> moved;  // what now lies in <dataset>/.quarantine, by its new name
};

// Moves bad episodes, foreign things in good ones, damaged models, a damaged dataset.json or
// result, and leftovers that nobody is writing, into <dataset>/.quarantine; writes the list of
// files of a model anew that lost it. Nothing is deleted, and what cannot be judged stays where it
// is. Holds the dataset's lock (dataset_lock.h): IoError names who is generating into it.
RepairResult Repair(const std::filesystem::path& dataset, const VerifyOptions& options = {});

}  // namespace robocell
