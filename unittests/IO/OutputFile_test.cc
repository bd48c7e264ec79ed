// SPDX-License-Identifier: BSD-3-Clause
#include "IO/OutputFile.hh"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <iterator>
#include <tuple>

#include "HalfFace/Errors.hh"
#include "IO/InputFile.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/MeshFile.hh"

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

TEST(XmlEscaped, MarkupAndControlCharactersAreNoneAnyMore) {
  EXPECT_EQ(xml_escaped("a<b> & \"c\"\n\xc3\xa4"), "a&lt;b&gt; &amp; &quot;c&quot; \xc3\xa4");
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

TEST(OutputFile, ALinkToNothingStaysALinkAndItsTargetIsMade) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "below");
  fs::create_symlink("below/new.txt", folder / "second.txt");
  fs::create_symlink("second.txt", folder / "first.txt");
  OutputFile(folder / "first.txt").text("new").commit();
  EXPECT_TRUE(fs::is_symlink(folder / "first.txt"));
  EXPECT_TRUE(fs::is_symlink(folder / "second.txt"));
  EXPECT_EQ(samples::read_bytes(folder / "below/new.txt"), "new");
}

TEST(OutputFile, LinksInACircleAreReportedAndStay) {
  const TemporaryFolder folder;
  fs::create_symlink("b.txt", folder / "a.txt");
  fs::create_symlink("a.txt", folder / "b.txt");
  EXPECT_EQ(message_of([&] { OutputFile file(folder / "a.txt"); }),
            (folder / "a.txt").string() + ": cannot be written: Too many levels of symbolic links");
  EXPECT_TRUE(fs::is_symlink(folder / "a.txt"));
  EXPECT_EQ(files_in(folder), 2);
}

TEST(OutputFile, TheLongestNameThatAFileMayHaveCanBeWritten) {
  const TemporaryFolder folder;
  const std::string longest(255, 'n');
  OutputFile(folder / longest).text("x").commit();
  EXPECT_EQ(samples::read_bytes(folder / longest), "x");
  const std::string too_long = (folder / std::string(256, 'n')).string();
  EXPECT_EQ(message_of([&] { OutputFile file(too_long); }),
            too_long + ": cannot be written: File name too long");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(OutputFile, ASignalHandlerCanRemoveWhatIsHalfWritten) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.txt", "old");
  OutputFile first(folder / "a.txt");
  OutputFile second(folder / "b.txt");
  OutputFile(folder / "c.txt").text("done").commit();
  EXPECT_EQ(files_in(folder), 4);
  remove_temporary_files();
  EXPECT_EQ(files_in(folder), 2);
  EXPECT_EQ(samples::read_bytes(folder / "a.txt"), "old");
  EXPECT_EQ(samples::read_bytes(folder / "c.txt"), "done");
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

TEST(InputFile, APipeIsRefusedAndNotWaitedFor) {
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(message_of([&] { InputFile file(pipe); }), pipe + ": cannot be opened: Not a regular file");
}

/// The standard streams of the process, put elsewhere until the object goes.
class ScopedDescriptor {
 public:
  ScopedDescriptor(int number, const fs::path& path, int flags) : number_(number), kept_(::dup(number)) {
    const int file = ::open(path.c_str(), flags, 0600);
    ::dup2(file, number);
    ::close(file);
  }
  ~ScopedDescriptor() {
    ::dup2(kept_, number_);
    ::close(kept_);
  }
  ScopedDescriptor(const ScopedDescriptor&) = delete;
  ScopedDescriptor& operator=(const ScopedDescriptor&) = delete;

 private:
  int number_, kept_;
};

/// A bound on the size of files, as long as it lives.
class ScopedFileSize {
 public:
  explicit ScopedFileSize(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit bound = {bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &bound);
  }
  ~ScopedFileSize() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }
  ScopedFileSize(const ScopedFileSize&) = delete;
  ScopedFileSize& operator=(const ScopedFileSize&) = delete;

 private:
  rlimit before_{};
  void (*signal_)(int);
};

TEST(OutputFile, FilesOfOneMeshAreReplacedTogetherOrNotAtAll) {
  const TemporaryFolder folder;
  // The file that is written first has room, the other one has not.
  MeshData cells = samples::two_cells(), fields = cells;
  for (int i = 0; i < 40; ++i) cells.cells.push_back(cells.cells[0]);
  fields.points.resize(4);
  fields.points.insert(fields.points.end(), 40, Vec3{0.25, 0.25, 0.25});
  fields.point_fields.push_back({.name = "p", .values = std::vector<double>(44, 1)});
  fields.cells.resize(1);
  for (const auto& [name, others, mesh, bound] :
       {std::tuple("a.node", std::vector<std::string>{"a.node", "a.ele"}, cells, rlim_t{120}),
        std::tuple("a.mesh", std::vector<std::string>{"a.mesh", "a.sol"}, fields, rlim_t{300})}) {
    for (const std::string& other : others) samples::write_bytes(folder / other, "old");
    {
      const ScopedFileSize room(bound);
      EXPECT_NE(message_of([&, &name = name, &mesh = mesh] { write_mesh(folder / name, mesh); }), "no error");
    }
    for (const std::string& other : others) EXPECT_EQ(samples::read_bytes(folder / other), "old") << other;
    write_mesh(folder / name, mesh);
    std::size_t n_small = 0;
    for (const std::string& other : others) n_small += fs::file_size(folder / other) <= bound ? 1u : 0u;
    EXPECT_EQ(n_small, 1u) << name << ": one of them would have had room";
  }
}

TEST(StandardStreams, AMeshGoesThroughThemInTheNamedFormat) {
  const TemporaryFolder folder;
  const MeshData mesh = samples::full();
  for (const char* format : {"vtu", ".vtk", "MSH", "mesh", "meshb", "ovm"}) {
    {
      const ScopedDescriptor out(STDOUT_FILENO, folder / "stream", O_WRONLY | O_CREAT | O_TRUNC);
      write_mesh(kStandardOutput, mesh, {.format = format});
    }
    const ScopedDescriptor in(STDIN_FILENO, folder / "stream", O_RDONLY);
    const MeshData back = read_mesh(kStandardInput, format);
    EXPECT_TRUE(samples::same_bits(back.points, mesh.points)) << format;
    EXPECT_EQ(back.cells, mesh.cells) << format;
    EXPECT_EQ(files_in(folder), 1) << "nothing beside the stream: " << format;
  }
}

TEST(StandardStreams, AFormatOfSeveralFilesOrNoneIsRefused) {
  const MeshData mesh = samples::two_cells();
  EXPECT_THROW(write_mesh(kStandardOutput, mesh, {.format = "node"}), InvalidInput);
  EXPECT_THROW(write_mesh(kStandardOutput, mesh), InvalidInput);
  EXPECT_THROW(read_mesh(kStandardInput, "ele"), InvalidInput);
  EXPECT_THROW(read_mesh(kStandardInput), InvalidInput);
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
