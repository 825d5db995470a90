// Writes a dataset like a run does: manifest, lock, models, episodes. Prints each episode once it
// is committed: tests compare the disk with this ledger after a fault.
//
//   write_ledger DATASET MODEL plain filmed ...    episodes e0, e1, ...; those there are skipped
//
// A filmed episode has videos, in colour and of depth.
// Exit codes: 0 all written, 3 writing failed (the message is on standard error).
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "robocell/base/file_set.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/testing/sample_episode.h"

namespace {

constexpr int kRows = 6;

void WriteOne(const std::string& dataset, int number, const std::string& kind,
              const robocell::FileSet& model) {
  const std::string id = "e" + std::to_string(number);
  if (robocell::Dataset(dataset).Contains(id)) return;
  const bool filmed = kind == "filmed";
  const robocell::SampleEpisode sample(static_cast<uint64_t>(number), filmed, filmed);
  robocell::EpisodeWriter episode(dataset, id, sample.schema, sample.Options());
  episode.AddModel("arm", model);
  sample.PutRows(episode, kRows);
  episode.AddFile("notes.txt", "as an episode may have");
  episode.Commit({.success = true, .terminated = true, .end_reason = "success"});
  const std::string line = id + "\n";
  if (write(STDOUT_FILENO, line.data(), line.size()) < 0) std::exit(4);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) return std::fputs("usage: write_ledger DATASET MODEL KIND...\n", stderr), 2;
  const std::string dataset = argv[1];
  const robocell::FileSet model = robocell::MakeFileSet(argv[2], {argv[2]});
  if (!robocell::ReadManifest(dataset)) robocell::WriteManifest(dataset, R"({"run": "ledger"})");
  const robocell::DatasetLock lock(dataset);
  robocell::RemoveLeftovers(dataset);
  for (int i = 3; i < argc; ++i) WriteOne(dataset, i - 3, argv[i], model);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
