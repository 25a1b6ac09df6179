// SPDX-License-Identifier: MIT
// Files that are written whole: what the name leads to gets the content, and the name stays what it was.
#include <fstream>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;
using io::OutputFile, io::write_file;

std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

std::string failure(const fs::path& file, std::string_view text) {
    try {
        write_file(file, text);
    } catch (const IoError& e) {
        return e.what();
    }
    return "none";
}

TEST(OutputFile, IsThereWhenItIsCompleteAndNotBefore) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "file";
    write_file(file, "old");
    {
        OutputFile cut_short(file);
        cut_short.append("new");
        EXPECT_EQ(content(file), "old");
    }
    EXPECT_EQ(content(file), "old");
    EXPECT_EQ(files_in(folder.path()), 1U);
    OutputFile whole(file);
    whole.append("new, ");
    whole.append("in two parts");
    whole.close();
    EXPECT_EQ(content(file), "new, in two parts");
    EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(OutputFile, LinksStayAndWhatTheyLeadToIsReplaced) {
    const TemporaryFolder folder;
    const fs::path there = folder.path() / "there", file = there / "file", link = folder.path() / "link",
                   second = folder.path() / "second";
    fs::create_directory(there);
    write_file(file, "old");
    fs::create_symlink("there/file", link);
    fs::create_symlink(link, second);
    {
        OutputFile cut_short(second);
        cut_short.append("new");
    }
    EXPECT_EQ(content(file), "old");
    for (const fs::path& name : {link, second}) {
        write_file(name, name.string());
        EXPECT_TRUE(fs::is_symlink(name));
        EXPECT_EQ(content(file), name.string());
    }
    fs::remove(file);
    write_file(second, "where nothing was");
    EXPECT_EQ(content(file), "where nothing was");
    EXPECT_TRUE(fs::is_symlink(link) && fs::is_symlink(second));
    EXPECT_EQ(files_in(there), 1U);
    fs::remove(file), fs::create_symlink(second, file);
    EXPECT_NE(failure(link, "round and round").find("link: cannot write: "), std::string::npos);
}

TEST(OutputFile, PipesAreWrittenInto) {
    const TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe", link = folder.path() / "link";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0666), 0);
    fs::create_symlink("pipe", link);
    for (const fs::path& name : {pipe, link}) {
        std::string read;
        std::thread reader([&] { read = content(pipe); });
        write_file(name, "through a pipe");
        reader.join();
        EXPECT_EQ(read, "through a pipe");
        EXPECT_TRUE(fs::is_fifo(pipe) && fs::is_symlink(link));
    }
    EXPECT_EQ(files_in(folder.path()), 2U);
}

TEST(OutputFile, DevicesAreWrittenIntoAndMayBeFull) {
    const TemporaryFolder folder;
    const fs::path full = folder.path() / "full", null = folder.path() / "null";
    if (::mknod(full.c_str(), S_IFCHR | 0666, makedev(1, 7)) != 0 ||
        ::mknod(null.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0 || !std::ofstream(null))
        GTEST_SKIP() << "no devices may be made here";
    EXPECT_EQ(failure(null, "something"), "none");
    EXPECT_EQ(failure(full, "something"), full.string() + ": cannot write: No space left on device");
    EXPECT_TRUE(fs::is_character_file(full) && fs::is_character_file(null));
    EXPECT_EQ(files_in(folder.path()), 2U);
}

TEST(OutputFile, IsKnownToBeWritableWithoutAChange) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "file", left = folder.path() / "file.tmp", pipe = folder.path() / "pipe";
    io::check_writable(file);
    EXPECT_EQ(files_in(folder.path()), 0U);
    write_file(left, "of a process that was killed");
    io::check_writable(file);
    EXPECT_EQ(content(left), "of a process that was killed");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    io::check_writable(pipe); // and does not wait for its reader
    io::check_writable("/dev/null");
    for (const fs::path& bad : {folder.path(), folder.path() / "none" / "file", fs::path("/proc/file")})
        EXPECT_THROW(io::check_writable(bad), IoError) << bad;
}

TEST(OutputFile, WhatCannotBeWrittenIsNamed) {
    const TemporaryFolder folder;
    EXPECT_EQ(failure(folder.path(), "text"), folder.path().string() + ": cannot write: Is a directory");
    const fs::path nowhere = folder.path() / "none" / "file";
    EXPECT_EQ(failure(nowhere, "text"), nowhere.string() + ": cannot write: No such file or directory");
    EXPECT_EQ(files_in(folder.path()), 0U);
}

} // namespace
} // namespace flotilla::test
