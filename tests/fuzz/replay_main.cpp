// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target as an ordinary test: over every file of its corpus folder, and over mutations of each that are
// the same on every machine. Any crash, sanitizer report or broken promise ends the process with an error.
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;

constexpr int kMutationsPerSeed = 250;
// Sanitizers reserve terabytes of address space for themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kBoundsMemory = false;
#else
constexpr bool kBoundsMemory = true;
#endif
constexpr rlim_t kMemoryBytes = rlim_t{2} << 30;  // a few bytes of input must not make a decoder take this much

/// Copied to memory of its exact size, so that reading one byte past the end is noticed.
void run(const Input& input) {
  const Input exact(input.begin(), input.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

Input read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Input(std::istreambuf_iterator<char>(file), {});
}

/// One to four changes: a bit, a byte of an interesting value, bytes gone, bytes doubled, or the end cut off.
Input mutated(const Input& seed, std::mt19937& random) {
  constexpr std::uint8_t kTelling[] = {0x00, 0x01, 0x7f, 0x80, 0xff, '-', '"', '[', '}', '9'};
  Input input = seed;
  for (unsigned changes = 1 + random() % 4; changes > 0 && !input.empty(); --changes) {
    const std::size_t at = random() % input.size();
    const std::size_t count = std::min<std::size_t>(1 + random() % 8, input.size() - at);
    const auto from = input.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random() % 6) {
      case 0:
      case 1: input[at] ^= static_cast<std::uint8_t>(1u << (random() % 8)); break;
      case 2: input[at] = kTelling[random() % std::size(kTelling)]; break;
      case 3: input.erase(from, from + static_cast<std::ptrdiff_t>(count)); break;
      case 4: {
        const Input doubled(from, from + static_cast<std::ptrdiff_t>(count));
        input.insert(from, doubled.begin(), doubled.end());
        break;
      }
      default: input.resize(at); break;
    }
  }
  return input;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2 || !std::filesystem::is_directory(arguments[1])) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER\n", arguments[0]);
    return 2;
  }
  if (kBoundsMemory) {
    const rlimit limit{kMemoryBytes, kMemoryBytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(arguments[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());  // folders list in any order
  if (files.empty()) {
    std::fprintf(stderr, "%s: no seeds; make_fuzz_corpus makes them\n", arguments[1]);
    return 1;
  }
  run({});
  std::size_t runs = 1;
  for (const std::filesystem::path& file : files) {
    const Input seed = read(file);
    run(seed);
    std::mt19937 random(static_cast<unsigned>(seed.size()));
    for (int i = 0; i < kMutationsPerSeed; ++i) run(mutated(seed, random));
    runs += 1 + kMutationsPerSeed;
  }
  std::printf("%zu inputs from %zu seeds\n", runs, files.size());
  return 0;
}
