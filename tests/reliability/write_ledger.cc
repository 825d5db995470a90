// Writes episodes and says of each, once it is committed, that it is there: the ledger against
// which tests hold the disk after a fault.
//
//   write_ledger DATASET COUNT      episodes e0, e1, ...; those that are there already are skipped
//
// Exit codes: 0 all there, 3 writing failed (the message is on standard error).
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "robocell/data/dataset.h"
#include "robocell/data/testing/sample_episode.h"

namespace {

// The last one has a video.
void WriteOne(const std::string& dataset, int number, bool with_camera) {
  const std::string id = "e" + std::to_string(number);
  if (robocell::Dataset(dataset).Contains(id)) return;
  robocell::SampleEpisode(static_cast<uint64_t>(number), with_camera).Write(dataset, id);
  const std::string line = id + "\n";
  if (write(STDOUT_FILENO, line.data(), line.size()) < 0) std::exit(4);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: write_ledger DATASET COUNT\n", stderr), 2;
  const int count = std::stoi(argv[2]);
  for (int i = 0; i < count; ++i) WriteOne(argv[1], i, i == count - 1);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
