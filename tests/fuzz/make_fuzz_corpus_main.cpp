// SPDX-License-Identifier: Apache-2.0
// Writes the seeds of every fuzz target into FOLDER/<target>/<name>. Run it when a format changes.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seeds.h"

int main(int argument_count, char** arguments) {
  constexpr std::size_t kMostBytes = 4096;  // larger seeds make fuzzers slow and the repository fat
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]);
    return 2;
  }
  farfield::fuzz::Seeds seeds;
  farfield::fuzz::add_tile_seeds(seeds);
  farfield::fuzz::add_geometry_seeds(seeds);
  farfield::fuzz::add_wire_seeds(seeds);
  farfield::fuzz::add_model_seeds(seeds);
  farfield::fuzz::add_store_seeds(seeds);
  for (const farfield::fuzz::Seed& seed : seeds) {
    if (seed.bytes.empty() || seed.bytes.size() > kMostBytes) {
      std::fprintf(stderr, "%s/%s: %zu bytes; a seed has 1 to %zu\n", seed.target.c_str(), seed.name.c_str(),
                   seed.bytes.size(), kMostBytes);
      return 1;
    }
    const std::filesystem::path folder = std::filesystem::path(arguments[1]) / seed.target;
    std::filesystem::create_directories(folder);
    std::ofstream file(folder / seed.name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(seed.bytes.data()), static_cast<std::streamsize>(seed.bytes.size()));
    file.close();
    if (!file) {
      std::fprintf(stderr, "%s: cannot be written\n", (folder / seed.name).c_str());
      return 1;
    }
  }
  std::printf("%zu seeds\n", seeds.size());
  return 0;
}
