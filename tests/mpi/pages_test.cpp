// SPDX-License-Identifier: MIT
// The commands that src/mpi/README.md shows, on small scenes.
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "io/file.hpp"
#include "mpi/ranks.hpp"

namespace flotilla::test {
namespace {

/// Lines of the page's blocks of commands, with options that make them small.
std::vector<std::string> commands_of_page() {
    std::istringstream page(io::read_text(FLOTILLA_SOURCE_DIR "/src/mpi/README.md"));
    std::vector<std::string> out;
    bool inside = false;
    for (std::string line; std::getline(page, line);) {
        if (line.starts_with("```")) inside = line == "```sh";
        if (!inside || line.starts_with("```")) continue;
        line = std::regex_replace(line.substr(0, line.find('#')), std::regex("--bodies 102"), "--bodies 4");
        line = std::regex_replace(line, std::regex("(--seeds 1-)16"), "$013");
        line = std::regex_replace(line, std::regex("--steps 240"), "--steps 3");
        if (line.find("--steps") == std::string::npos) line += " --steps 3";
        out.push_back(line);
    }
    return out;
}

TEST(PageOfRanks, ItsCommandsRun) {
    const TemporaryFolder folder;
    const std::string in_folder = "cd " + folder.path().string() + "; mpirun() { shift 2; " + FLOTILLA_MPIRUN +
                                  " --oversubscribe --bind-to none -np 2 \"$@\"; }; export OMPI_ALLOW_RUN_AS_ROOT=1 "
                                  "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 PATH=" +
                                  std::filesystem::path(FLOTILLA_COMMAND).parent_path().string() + ":$PATH; ";
    ASSERT_EQ(std::system((in_folder + "flotilla scene stack --bodies 4 > pile.json").c_str()), 0);
    const std::vector<std::string> commands = commands_of_page();
    EXPECT_EQ(commands.size(), 6U);
    for (const std::string& command : commands) {
        // An ensemble that the page shows twice is gone on with, or begun anew.
        const bool anew = command.find("--resume") == std::string::npos && command.find("model") == std::string::npos;
        const std::string line = in_folder + command + (anew ? " --overwrite" : "") + " >out 2>&1";
        EXPECT_EQ(std::system(line.c_str()), 0) << command << '\n' << io::read_text(folder.path() / "out");
    }
}

} // namespace
} // namespace flotilla::test
