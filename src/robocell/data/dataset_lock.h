// Keeps two runs, or a run and a repair, from working on the same dataset, by lock files in its
// folder. The whole plan is locked exclusively; the shards of a plan share the folder and lock
// themselves. Shards of different counts make the same episodes: while shards of one count run,
// another count is rejected, and of two that start at once one begins. A program that only adds
// episodes may do so beside a run, but not while another one moves parts of the dataset.
//
//   DatasetLock lock("out/pick_v1");         // IoError names the owner when it is taken
//   DatasetLock shard("out/pick_v1", 0, 8);  // shard 0 of 8
//
// The system frees the locks of a killed process. Your own programs should hold a lock too if they
// write into a dataset while others may.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/data/file_lock.h"

namespace robocell {

class DatasetLock {
 public:
  // Locks one shard, or the whole plan if `count` is 1. `dataset` must exist. Throws IoError if it
  // is locked, or if the folder cannot be written.
  explicit DatasetLock(const std::filesystem::path& dataset, int shard = 0, int count = 1);
  // Locks for a writer of episodes, such as a Runner: any number may write, also beside runs.
  static DatasetLock Writing(const std::filesystem::path& dataset);
  // Locks for a writer that numbers its episodes "<prefix>-000017" and so on: no other one has that
  // prefix. Throws IoError that names its owner if another one has it.
  static DatasetLock Numbering(const std::filesystem::path& dataset, const std::string& prefix);
  // Locks against runs and writers, for changes of existing parts (repair, restart).
  static DatasetLock Alone(const std::filesystem::path& dataset);
  DatasetLock(DatasetLock&&) = default;
  DatasetLock& operator=(DatasetLock&&) = default;

 private:
  DatasetLock() = default;
  std::vector<FileLock> held_;
};

}  // namespace robocell
