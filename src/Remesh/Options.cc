// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Options.hh"

#include <array>
#include <sstream>
#include <utility>

#include "HalfFace/Errors.hh"
#include "Remesh/Result.hh"

namespace hfr {
namespace {

constexpr std::array<std::pair<const char*, Ops>, 6> kOpNames = {{{"edge", Ops::kEdge},
                                                                  {"face", Ops::kFace},
                                                                  {"node", Ops::kNode},
                                                                  {"smooth", Ops::kSmooth},
                                                                  {"insert", Ops::kInsert},
                                                                  {"cluster", Ops::kCluster}}};
constexpr std::array<std::pair<const char*, Smoother>, 4> kSmootherNames = {
    {{"newton", Smoother::kNewton},
     {"candidates", Smoother::kCandidates},
     {"laplacian", Smoother::kLaplacian},
     {"taubin", Smoother::kTaubin}}};

constexpr std::array<std::pair<const char*, Rounds>, 3> kRoundsNames = {
    {{"auto", Rounds::kAuto}, {"by-kind", Rounds::kByKind}, {"mixed", Rounds::kMixed}}};

template <class Table>
std::string names_of(const Table& table) {
  std::string names;
  for (const auto& entry : table) names += (names.empty() ? "" : ", ") + std::string(entry.first);
  return names;
}

}  // namespace

Ops ops_from_list(const std::string& list) {
  Ops ops = Ops::kNone;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    bool known = false;
    for (const auto& [name, op] : kOpNames) {
      if (word != name) continue;
      ops = ops | op;
      known = true;
    }
    HFR_REQUIRE(known, "no operator is called '" + word + "'; there are " + names_of(kOpNames));
  }
  HFR_REQUIRE(ops != Ops::kNone, "the list of operators is empty; there are " + names_of(kOpNames));
  return ops;
}

std::string ops_to_list(Ops ops) {
  std::string list;
  for (const auto& [name, op] : kOpNames)
    if (has(ops, op)) list += (list.empty() ? "" : ",") + std::string(name);
  return list;
}

Smoother smoother_from_name(const std::string& name) {
  for (const auto& [known, smoother] : kSmootherNames)
    if (name == known) return smoother;
  throw InvalidInput("no smoother is called '" + name + "'; there are " + names_of(kSmootherNames));
}

Rounds rounds_from_name(const std::string& name) {
  for (const auto& [known, rounds] : kRoundsNames)
    if (name == known) return rounds;
  throw InvalidInput("no kind of rounds is called '" + name + "'; there are " + names_of(kRoundsNames));
}

const char* stop_name(Stop stop) {
  switch (stop) {
    case Stop::kGoal:
      return "goal";
    case Stop::kNoProgress:
      return "no progress";
    case Stop::kIterations:
      return "iterations";
    case Stop::kTimeLimit:
      return "time limit";
    case Stop::kCancelled:
      return "cancelled";
    case Stop::kDeviceLost:
      return "device lost";
  }
  return "unknown";
}

}  // namespace hfr
