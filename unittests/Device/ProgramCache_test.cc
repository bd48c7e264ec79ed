// SPDX-License-Identifier: BSD-3-Clause
#include "Device/ProgramCache.hh"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "Device/Scratch.hh"

namespace hfr::detail {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

class ProgramCache : public testing::Test {
 protected:
  test::ScratchFolder folder_;
  test::ScopedVariable variable_{"HFR_CACHE_DIR", folder_.path().c_str()};

  std::vector<fs::path> files() const {
    return {fs::directory_iterator(folder_.path()), fs::directory_iterator()};
  }
};

TEST_F(ProgramCache, GivesBackWhatWasStoredUnderTheSameKeyOnly) {
  EXPECT_FALSE(load_binary("key"));
  save_binary("key", {1, 2, 3});
  save_binary("another", {});
  EXPECT_EQ(load_binary("key"), (Bytes{1, 2, 3}));
  EXPECT_EQ(load_binary("another"), Bytes{});
  EXPECT_FALSE(load_binary("key "));
  EXPECT_EQ(files().size(), 2U) << "no temporary file is left";
}

TEST_F(ProgramCache, KeyOfTheSameHashIsToldApart) {
  save_binary("key", {1, 2, 3});
  ASSERT_EQ(files().size(), 1U);
  std::fstream file(files()[0], std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(32);
  file.write("kez", 3);
  file.close();
  EXPECT_FALSE(load_binary("key"));
}

TEST_F(ProgramCache, FileCutAtAnyLengthIsNoProgram) {
  save_binary("key", {1, 2, 3});
  const fs::path file = files().at(0);
  for (std::uintmax_t size = fs::file_size(file); size-- > 0;) {
    fs::resize_file(file, size);
    EXPECT_FALSE(load_binary("key")) << size;
  }
}

TEST_F(ProgramCache, FolderThatCannotBeMadeIsPassedOver) {
  const fs::path file = folder_.path() / "file";
  std::ofstream(file) << "not a folder";
  EXPECT_FALSE(is_writable_folder(file / "below"));
  const test::ScopedVariable first("HFR_CACHE_DIR", (file / "below").c_str());
  const test::ScopedVariable second("XDG_CACHE_HOME", folder_.path().c_str());
  EXPECT_EQ(cache_folder(), folder_.path() / "hfremesh");
}

/// What the cache falls back to when nothing else can be written.
class TemporaryCache : public testing::Test {
 protected:
  test::ScratchFolder scratch_;
  test::ScopedVariable named_{"HFR_CACHE_DIR", nullptr};
  test::ScopedVariable cache_{"XDG_CACHE_HOME", nullptr};
  test::ScopedVariable home_{"HOME", nullptr};
  test::ScopedVariable temporary_{"TMPDIR", scratch_.path().c_str()};
  fs::path folder_ = scratch_.path() / ("hfremesh-" + std::to_string(geteuid()));
};

TEST_F(TemporaryCache, IsMadeForTheUserAlone) {
  const mode_t mask = umask(0);
  EXPECT_EQ(cache_folder(), folder_);
  umask(mask);
  EXPECT_EQ(fs::status(folder_).permissions(), fs::perms::owner_all);
  EXPECT_EQ(cache_folder(), folder_) << "and taken again";
}

TEST_F(TemporaryCache, IsNotAFolderThatOthersMayWriteTo) {
  fs::create_directory(folder_);
  fs::permissions(folder_, fs::perms::all);
  EXPECT_EQ(cache_folder(), fs::path());
  save_binary("key", {1, 2, 3});
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(TemporaryCache, IsNotALinkToAFolderEvenOfTheUsers) {
  fs::create_directory(scratch_.path() / "elsewhere");
  fs::permissions(scratch_.path() / "elsewhere", fs::perms::owner_all);
  fs::create_directory_symlink("elsewhere", folder_);
  EXPECT_EQ(cache_folder(), fs::path());
}

TEST_F(TemporaryCache, IsNotAFolderOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  fs::create_directory(folder_);
  fs::permissions(folder_, fs::perms::owner_all);
  ASSERT_EQ(chown(folder_.c_str(), 65534, 65534), 0);
  EXPECT_EQ(cache_folder(), fs::path());
}

TEST_F(TemporaryCache, IsNotWhereOthersCouldPutAnotherFolderInItsPlace) {
  fs::permissions(scratch_.path(), fs::perms::all);
  EXPECT_EQ(cache_folder(), fs::path());
  fs::permissions(scratch_.path(), fs::perms::all | fs::perms::sticky_bit);
  EXPECT_EQ(cache_folder(), folder_) << "as in /tmp";
}

}  // namespace
}  // namespace hfr::detail
