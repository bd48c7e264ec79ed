// SPDX-License-Identifier: BSD-3-Clause
// Runs random meshes with random options and holds the promises of docs/ against what comes out. Each case is
// named by a number and can be run again by it. Usage:
//   hfr_fuzz --case N [--shrink] [--write FOLDER]     one case, in this process (for a debugger)
//   hfr_fuzz --from N --count N | --minutes M         cases in worker processes that may crash or hang
//   hfr_fuzz --seeds FILE                             the numbers in a file, one a line, # begins a comment
// with --jobs N workers, --limit S seconds (120) after which a case counts as hanging, --slow S seconds after
// which it is reported. Both are seconds of the processor, so that a busy machine makes no findings; a case
// that sleeps hangs after twenty times the limit. Exit code 1 where there are findings, or the cases were not
// worth running.
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <system_error>
#include <thread>

#include "Fuzz/Case.hh"
#include "IO/MeshFile.hh"
#include "ScratchFolder.hh"

namespace hfr::fuzz {
namespace {

struct CommandLine {
  bool one = false, shrinks = false;
  std::uint64_t number = 0;
  std::uint64_t from = 1, count = std::numeric_limits<std::uint64_t>::max();
  double minutes = std::numeric_limits<double>::infinity();
  double limit = 120, slow = std::numeric_limits<double>::infinity();
  int jobs = 1;
  std::string write, seeds;
};

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds of the processor that a process has taken; 0 where it is no more.
double processor_seconds(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// What a worker tells; in memory that it shares with the one who watches.
struct Worker {
  std::atomic<std::uint64_t> at{0};  ///< place in the list of cases
  std::atomic<double> since{0};      ///< when it began with it
  std::atomic<double> spent{0};      ///< processor seconds that it had taken then
  std::atomic<std::uint64_t> run{0}, refused{0}, changed{0}, invalid{0}, pinched{0}, findings{0}, large{0};
};

io::MeshData data_of(const Complex& complex) {
  io::MeshData data;
  data.points = complex.points;
  data.cells = complex.cells;
  data.regions = complex.regions;
  for (const auto& f : complex.faces)
    data.triangles.push_back(f.vertices), data.triangle_labels.push_back(f.label);
  for (const auto& e : complex.edges) data.edges.push_back(e.vertices), data.edge_labels.push_back(e.label);
  data.vertex_labels = complex.vertex_labels;
  data.fixed_vertices = complex.fixed;
  return data;
}

std::string line_of(const Case& c, const Finding& finding) {
  return fmt::format("case {}: {}: {} | {} cells: {} | {}\n", c.number, finding.promise, finding.detail,
                     c.complex.cells.size(), c.complex.made_of, c.options.command_line());
}

void say(const std::string& text) {  // in one piece, so that lines of workers do not mix
  if (write(STDOUT_FILENO, text.data(), text.size()) < 0) std::exit(2);
}

/// A file for the tool, and how to call it.
void write_case(const Case& c, const std::string& folder, const std::string& name) {
  std::filesystem::create_directories(folder);
  const bool labelled = !c.complex.faces.empty() || !c.complex.edges.empty() || !c.complex.fixed.empty() ||
                        !c.complex.vertex_labels.empty();
  const std::string path = folder + "/" + name + (labelled ? ".mesh" : ".vtu");
  try {
    io::write_mesh(path, data_of(c.complex));
    say(fmt::format("  hfremesh {} -o out.vtu {}\n", path, c.options.command_line()));
  } catch (const std::exception& error) {
    say(fmt::format("  {} cannot be written: {}\n", path, error.what()));
  }
}

int run_one(const CommandLine& line) {
  const test::ScratchFolder scratch;
  const Case wanted = make_case(line.number);
  say(fmt::format("case {}: {} cells: {} | {}\n", wanted.number, wanted.complex.cells.size(),
                  wanted.complex.made_of, wanted.options.command_line()));
  if (!line.write.empty()) write_case(wanted, line.write, fmt::format("case{}", line.number));
  const Outcome outcome = run_case(wanted, scratch.path().string());
  say(fmt::format("  {} -> {} cells, {:.3f} s{}{}\n", outcome.cells_before, outcome.cells_after,
                  outcome.seconds, outcome.refused ? ", refused " + outcome.refusal : "",
                  outcome.changed ? ", changed" : ""));
  std::set<std::string> done;
  for (const Finding& finding : outcome.findings) {
    say(line_of(wanted, finding));
    if (!line.shrinks || !done.insert(finding.promise).second) continue;
    const Case small = shrink(wanted, finding.promise, scratch.path().string());
    say(fmt::format("  shrunk to {} cells, {}\n", small.complex.cells.size(), small.options.command_line()));
    for (const Finding& left : run_case(small, scratch.path().string()).findings)
      say("  " + line_of(small, left));
    std::string name = fmt::format("case{}-{}", line.number, finding.promise);
    std::replace(name.begin(), name.end(), ' ', '-');
    if (!line.write.empty()) write_case(small, line.write, name);
  }
  return outcome.findings.empty() ? 0 : 1;
}

/// The numbers to be run: a list, or all from one on.
struct Numbers {
  std::vector<std::uint64_t> list;
  std::uint64_t from = 1, count = 0;
  std::uint64_t size() const { return list.empty() ? count : list.size(); }
  std::uint64_t operator[](std::uint64_t at) const { return list.empty() ? from + at : list[at]; }
};

Numbers numbers_of(const CommandLine& line) {
  Numbers numbers;
  numbers.from = line.from;
  numbers.count = line.count;
  if (line.seeds.empty()) return numbers;
  std::ifstream file(line.seeds);
  for (std::string text; std::getline(file, text);) {
    const std::string number = text.substr(0, text.find('#'));
    if (number.find_first_of("0123456789") != std::string::npos) numbers.list.push_back(std::stoull(number));
  }
  if (numbers.list.empty()) throw std::runtime_error(line.seeds + ": no numbers in it");
  return numbers;
}

[[noreturn]] void work(const CommandLine& line, const Numbers& numbers, Worker& me, const std::string& folder,
                       double end) {
  for (std::uint64_t at = me.at; at < numbers.size() && now() < end;
       at = me.at += static_cast<std::uint64_t>(line.jobs)) {
    me.spent = processor_seconds(getpid());
    me.since = now();
    const Case wanted = make_case(numbers[at]);
    const Outcome outcome = run_case(wanted, folder);
    ++me.run;
    me.refused += outcome.refused ? 1 : 0;
    me.changed += outcome.changed ? 1 : 0;
    me.invalid += outcome.was_invalid ? 1 : 0;
    me.pinched += outcome.was_pinched ? 1 : 0;
    me.large += outcome.cells_before > 256 ? 1 : 0;
    for (const Finding& finding : outcome.findings) say(line_of(wanted, finding));
    if (outcome.seconds > line.slow)
      say(line_of(wanted, {"slow", fmt::format("{:.1f} s, {} -> {} cells", outcome.seconds,
                                               outcome.cells_before, outcome.cells_after)}));
    me.findings += outcome.findings.size() + (outcome.seconds > line.slow ? 1 : 0);
  }
  me.since = -1;
  std::_Exit(0);
}

/// Starts workers, and new ones in place of those that crash or hang.
class Watch {
 public:
  Watch(const CommandLine& line, Numbers numbers)
      : line_(line),
        numbers_(std::move(numbers)),
        end_(now() + 60 * line.minutes),
        n_(static_cast<std::size_t>(line.jobs)) {
    void* memory =
        mmap(nullptr, n_ * sizeof(Worker), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    workers_ = static_cast<Worker*>(memory);
    for (std::size_t i = 0; i < n_; ++i) new (workers_ + i) Worker;
  }

  int run() {
    pids_.resize(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      workers_[i].at = i;
      start(i);
    }
    for (bool any = true; any;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      any = false;
      for (std::size_t i = 0; i < n_; ++i) any = look_after(i) || any;
    }
    return report();
  }

 private:
  void start(std::size_t i) {
    workers_[i].since = now();
    workers_[i].spent = 0;
    pids_[i] = fork();
    if (pids_[i] < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (pids_[i] != 0) return;
    const std::string folder = (scratch_.path() / std::to_string(i)).string();
    std::filesystem::create_directories(folder);
    work(line_, numbers_, workers_[i], folder, end_);
  }

  bool has_no_end(const Worker& worker, pid_t process) const {
    constexpr double kAsleep = 20;  // times the limit, for one that takes no time of the processor
    const double spent = worker.spent;
    return processor_seconds(process) - spent > line_.limit || now() - worker.since > kAsleep * line_.limit;
  }

  /// True while the worker has something to do.
  bool look_after(std::size_t i) {
    if (pids_[i] == 0) return false;
    Worker& worker = workers_[i];
    int status = 0;
    const bool ended = waitpid(pids_[i], &status, WNOHANG) == pids_[i];
    const bool hangs = !ended && worker.since > 0 && has_no_end(worker, pids_[i]);
    if (!ended && !hangs) return true;
    if (ended && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
      pids_[i] = 0;
      return false;
    }
    if (hangs) {
      kill(pids_[i], SIGKILL);
      waitpid(pids_[i], &status, 0);
    }
    const Case lost = make_case(numbers_[worker.at]);
    say(line_of(lost, {hangs ? "hang" : "crash",
                       hangs ? fmt::format("more than {} s", line_.limit)
                             : fmt::format("signal {}", WIFSIGNALED(status) ? WTERMSIG(status) : 0)}));
    ++worker.findings;
    ++worker.run;
    worker.at += static_cast<std::uint64_t>(line_.jobs);
    start(i);
    return true;
  }

  int report() const {
    std::uint64_t run = 0, refused = 0, changed = 0, invalid = 0, pinched = 0, findings = 0, large = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      run += workers_[i].run;
      refused += workers_[i].refused;
      changed += workers_[i].changed;
      invalid += workers_[i].invalid;
      pinched += workers_[i].pinched;
      findings += workers_[i].findings;
      large += workers_[i].large;
    }
    say(fmt::format(
        "{} cases, {} refused, {} changed, {} with invalid cells, {} pinched, {} of more than 256 cells: {} "
        "findings\n",
        run, refused, changed, invalid, pinched, large, findings));
    const bool dull =
        numbers_.list.empty() && run >= 200 &&
        (changed < run / 3 || refused > run / 3 || invalid < run / 5 || pinched < run / 10 || large == 0);
    if (dull) say("these cases are not worth running: too few of a kind\n");
    return findings == 0 && !dull ? 0 : 1;
  }

  const CommandLine& line_;
  Numbers numbers_;
  double end_;
  std::size_t n_;
  Worker* workers_ = nullptr;
  std::vector<pid_t> pids_;
  test::ScratchFolder scratch_;
};

CommandLine parse(int argc, char** argv) {
  CommandLine line;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--shrink") {
      line.shrinks = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument(name + " is unknown or wants a value");
    const std::string value = argv[++i];
    if (name == "--case")
      line.one = true, line.number = std::stoull(value);
    else if (name == "--from")
      line.from = std::stoull(value);
    else if (name == "--count")
      line.count = std::stoull(value);
    else if (name == "--minutes")
      line.minutes = std::stod(value);
    else if (name == "--limit")
      line.limit = std::stod(value);
    else if (name == "--slow")
      line.slow = std::stod(value);
    else if (name == "--jobs")
      line.jobs = std::max(1, std::stoi(value));
    else if (name == "--write")
      line.write = value;
    else if (name == "--seeds")
      line.seeds = value;
    else
      throw std::invalid_argument(name + " is unknown");
  }
  return line;
}

/// More threads than cores are the rule here: the OpenMP library, which reads this before main(), must not
/// let them spin.
void wait_passively(char** argv) {
  if (getenv("OMP_WAIT_POLICY") || setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) execv(self.c_str(), argv);  // returns only on failure: go on as we are
}

}  // namespace
}  // namespace hfr::fuzz

int main(int argc, char** argv) {
  using namespace hfr::fuzz;
  wait_passively(argv);
  try {
    const CommandLine line = parse(argc, argv);
    if (line.one) return run_one(line);
    return Watch(line, numbers_of(line)).run();
  } catch (const std::exception& error) {
    fmt::print(stderr, "hfr_fuzz: {}\n", error.what());
    return 2;
  }
}
