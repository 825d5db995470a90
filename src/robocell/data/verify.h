// Checks that every byte of a dataset is as written. Verify finds truncated, changed, missing and
// foreign files, and leftovers of a crash, and names them; Repair moves bad parts aside. Good
// episodes are never touched.
//
//   VerifyResult result = Verify("out/pick_v1");
//   if (!result.ok()) std::cerr << result.Text();  // one line per problem: episode, file, reason
//
// A system error, another format version or a missing decoder says nothing about the bytes: such
// episodes are reported and left alone. episode_verifier.h lists the checks of each episode.
#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace robocell {

// A problem with one file of a dataset.
enum class ProblemKind {
  kDamage,      // it differs from what was written, or is missing
  kForeign,     // it does not belong there; the rest is complete
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

// Classifies an exception: a system error does not concern the bytes, any other error does.
ProblemKind KindOf(const std::exception& error);

struct VerifyResult {
  std::vector<std::string> good;        // ids of intact episodes
  std::vector<std::string> bad;         // ids of damaged ones
  std::vector<std::string> unjudged;    // ids of those not judged here, e.g. without access
  std::vector<std::string> foreign;     // entries that do not belong there, in intact episodes or
                                        // the dataset
  std::vector<std::string> bad_parts;   // damaged parts of the dataset itself, by name
  std::vector<std::string> unlisted;    // complete models without the list of their files
  std::vector<VerifyProblem> problems;  // problems of damaged episodes and of the dataset
  // Temporary folders and files, which are no problem.
  std::vector<std::string> leftovers;  // leftovers of a crash
  std::vector<std::string>
      being_written;  // episodes whose writer lives, on this machine or another
  // Files and folders that do not belong to a dataset: logs, notes. No problem either.
  std::vector<std::string> others;

  // True if the episodes belong to a run and dataset.json is missing. Recordings do not need it: no
  // problem.
  bool lost_manifest = false;

  bool ok() const { return problems.empty(); }
  // Returns true if there are problems, and all of them concern this machine or version.
  bool only_unreadable() const;
  // Returns one line per problem and leftover, then a summary line.
  std::string Text() const;
};

struct VerifyOptions {
  bool decode_videos = false;  // decodes every frame: slow, and hashes find damage without it
  // Called after each episode with the number of finished episodes and of all; may be empty.
  std::function<void(size_t done, size_t total)> progress;
};

// Throws ArgumentError for a folder that is not a dataset: it has neither a dataset.json nor an
// episode, nor any leftover of these. Throws IoError if it cannot be listed, or if videos are to be
// decoded and there is no ffmpeg.
VerifyResult Verify(const std::filesystem::path& dataset, const VerifyOptions& options = {});

struct RepairResult {
  VerifyResult found;
  std::vector<VerifyProblem> remaining = {};  // those that moving files aside did not solve
  std::vector<std::string> moved;             // new names of what now lies in <dataset>/.quarantine
};

// Moves bad episodes, foreign files in good ones, damaged models, a damaged dataset.json or result,
// and leftovers without a writer into <dataset>/.quarantine; restores the lost list of a model's
// files. Deletes nothing, and leaves what cannot be judged in place. Holds the dataset's lock
// (dataset_lock.h): throws IoError that names a process that is generating into it.
RepairResult Repair(const std::filesystem::path& dataset, const VerifyOptions& options = {});

}  // namespace robocell
