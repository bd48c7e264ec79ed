// SPDX-License-Identifier: BSD-3-Clause
// Operations of the kernel and single operators at random on random complexes, with a check in full after
// each; docs/fuzzing.md. Usage: hfr_soak [--operations N] [--from NUMBER] [--each N]
//   --operations N  in all (20,000)
//   --from NUMBER   of the first complex (1)
//   --each N        operations on one complex (200)
// Exit code 1 where something is wrong, or an operation never succeeded.
#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "Fuzz/Walk.hh"

namespace hfr::fuzz {
namespace {

struct CommandLine {
  std::uint64_t operations = 20000, from = 1, each = 200;
};

CommandLine parse(int argc, char** argv) {
  CommandLine line;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const std::uint64_t value = std::stoull(argv[i + 1]);
    if (name == "--operations")
      line.operations = value;
    else if (name == "--from")
      line.from = value;
    else if (name == "--each")
      line.each = value;
    else
      throw std::invalid_argument(name + " is unknown");
  }
  if (argc % 2 == 0) throw std::invalid_argument("an option wants a value");
  return line;
}

/// Returns what is wrong, empty where nothing is.
std::string walk(std::uint64_t number, std::uint64_t n_operations, WalkCounts& counts) {
  constexpr std::uint64_t kCompareEvery = 25;
  Walk one(number);
  for (std::uint64_t step = 0; one.has_mesh() && step < n_operations; ++step) {
    std::string wrong = one.step(counts);
    if (wrong.empty() && step % kCompareEvery == 0) {
      wrong = one.compare();
      ++counts.compared;
    }
    if (!wrong.empty()) return fmt::format("complex {}, operation {}: {}", number, step, wrong);
  }
  return "";
}

std::uint64_t sum(const std::array<std::uint64_t, kOperations>& counts) {
  std::uint64_t all = 0;
  for (const std::uint64_t n : counts) all += n;
  return all;
}

int run(const CommandLine& line) {
  WalkCounts counts;
  std::uint64_t number = line.from;
  int n_wrong = 0;
  for (; sum(counts.done) + sum(counts.refused) < line.operations && n_wrong < 20; ++number) {
    const std::string wrong = walk(number, line.each, counts);
    if (wrong.empty()) continue;
    fmt::print("{}\n", wrong);
    ++n_wrong;
  }
  bool any_never = false;
  for (std::size_t i = 0; i < kOperations; ++i) {
    fmt::print("{:20} {:8} done {:8} refused\n", operation_name(static_cast<Operation>(i)), counts.done[i],
               counts.refused[i]);
    any_never = any_never || counts.done[i] == 0;
  }
  fmt::print("{} operations on complexes {} to {}, {} of them changed a mesh; {} meshes compared; {} wrong\n",
             sum(counts.done) + sum(counts.refused), line.from, number - 1, sum(counts.done), counts.compared,
             n_wrong);
  if (any_never) fmt::print("an operation never succeeded\n");
  return n_wrong == 0 && !any_never ? 0 : 1;
}

}  // namespace
}  // namespace hfr::fuzz

int main(int argc, char** argv) {
  try {
    return hfr::fuzz::run(hfr::fuzz::parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "hfr_soak: {}\n", error.what());
    return 2;
  }
}
