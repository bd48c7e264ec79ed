// SPDX-License-Identifier: BSD-3-Clause
#include "Tool.hh"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace hfr::app::test {

namespace fs = std::filesystem;

Tool::Tool() {
  std::string pattern = (fs::temp_directory_path() / "hfremesh-test-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  folder_ = pattern;
}

Tool::~Tool() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

pid_t Tool::spawn(const std::vector<std::string>& words) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child > 0) return child;
  // Fresh files, here and in write(): some file systems wait for the disk when a file is cut to nothing.
  unlink(".out");
  unlink(".err");
  const auto redirect = [](const char* file, int flags, int to) {
    const int from = open(file, flags, 0644);
    if (from < 0 || dup2(from, to) < 0) _exit(126);
  };
  if (chdir(folder_.c_str()) != 0) _exit(126);
  redirect("/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(".out", O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  redirect(".err", O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  alarm(limit_seconds_);  // outlives execv
  execv(argv[0], argv.data());
  _exit(127);
}

pid_t Tool::start(const std::string& arguments) {
  std::vector<std::string> words = {HFR_TOOL_PATH};
  std::istringstream stream(arguments);
  for (std::string word; stream >> word;) words.push_back(word);
  return spawn(words);
}

Outcome Tool::finish(pid_t child) {
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, content(".out"), content(".err")};
}

Outcome Tool::run(const std::string& arguments) { return finish(start(arguments)); }

Outcome Tool::shell(const std::string& command) {
  return finish(spawn({"/bin/sh", "-c", "TOOL='" HFR_TOOL_PATH "'; " + command}));
}

void Tool::write(const std::string& name, const std::string& text) const {
  fs::remove(path(name));
  std::ofstream(path(name), std::ios::binary) << text;
}

std::string Tool::content(const std::string& name) const {
  std::ifstream file(path(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> Tool::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (name != ".out" && name != ".err") names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace hfr::app::test
