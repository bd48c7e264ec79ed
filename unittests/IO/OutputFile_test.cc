// SPDX-License-Identifier: BSD-3-Clause
#include "IO/OutputFile.hh"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <iterator>

#include "HalfFace/Errors.hh"
#include "IO/InputFile.hh"
#include "IO/MeshDataSamples.hh"

namespace hfr::io {
namespace {

using samples::TemporaryFolder;
namespace fs = std::filesystem;

std::ptrdiff_t files_in(const TemporaryFolder& folder) {
  return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator());
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OutputFile, CommitReplacesTheTargetAndLeavesNoTemporaryFile) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.txt", "old");
  OutputFile file(folder / "a.txt");
  file.text("n = ").number(std::int64_t{-7}).text(" ").number(0.1).raw('!');
  EXPECT_EQ(samples::read_bytes(folder / "a.txt"), "old") << "the old file stays until commit()";
  file.commit();
  EXPECT_EQ(samples::read_bytes(folder / "a.txt"), "n = -7 0.1!");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(OutputFile, WithoutCommitNothingChanges) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.txt", "old");
  { OutputFile(folder / "a.txt").text("new"); }
  EXPECT_EQ(samples::read_bytes(folder / "a.txt"), "old");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(OutputFile, TextLongerThanTheBufferKeepsItsOrder) {
  const TemporaryFolder folder;
  std::string expected;
  OutputFile file(folder / "a.txt");
  for (const std::size_t length : {10, 3'000'000, 5, 1'048'576, 1'048'570, 20}) {
    const std::string piece(length, static_cast<char>('a' + expected.size() % 26));
    file.text(piece);
    expected += piece;
  }
  file.commit();
  EXPECT_TRUE(samples::read_bytes(folder / "a.txt") == expected);
}

TEST(OutputFile, PermissionsOfTheTargetAreKept) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.txt", "old");
  ::chmod((folder / "a.txt").c_str(), 0640);
  OutputFile file(folder / "a.txt");
  file.commit();
  EXPECT_EQ(static_cast<int>(fs::status(folder / "a.txt").permissions()), 0640);
}

TEST(OutputFile, ASymbolicLinkStaysALink) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "real.txt", "old");
  fs::create_symlink("real.txt", folder / "link.txt");
  OutputFile file(folder / "link.txt");
  file.text("new").commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(samples::read_bytes(folder / "real.txt"), "new");
}

TEST(OutputFile, ADeviceIsWrittenToAndNotReplaced) {
  OutputFile file("/dev/null");
  file.text("gone").commit();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(OutputFile, AFullDeviceIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  EXPECT_EQ(message_of([] { OutputFile("/dev/full").text("x").commit(); }),
            "/dev/full: cannot be written: No space left on device");
}

TEST(OutputFile, AMissingFolderOrAFolderAsTargetIsReported) {
  const TemporaryFolder folder;
  const std::string missing = (folder / "none/a.txt").string();
  EXPECT_EQ(message_of([&] { OutputFile file(missing); }),
            missing + ": cannot be written: No such file or directory");
  EXPECT_EQ(message_of([&] { OutputFile file(folder.path()); }),
            folder.path().string() + ": cannot be written: Is a directory");
}

TEST(InputFile, MissingFileFolderAndEmptyFile) {
  const TemporaryFolder folder;
  const std::string missing = (folder / "none").string();
  EXPECT_EQ(message_of([&] { InputFile file(missing); }),
            missing + ": cannot be opened: No such file or directory");
  EXPECT_EQ(message_of([&] { InputFile file(folder.path()); }),
            folder.path().string() + ": cannot be opened: Is a directory");
  EXPECT_EQ(message_of([] { InputFile file("/dev/null"); }),
            "/dev/null: cannot be opened: Not a regular file");
  samples::write_bytes(folder / "empty", "");
  EXPECT_TRUE(InputFile(folder / "empty").bytes().empty());
}

}  // namespace
}  // namespace hfr::io
