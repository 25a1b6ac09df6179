// SPDX-License-Identifier: MIT
// Feeds files to a fuzz target: replay PATH..., a file or a folder of files each. What any of them breaks ends the
// process.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <vector>

#include "fuzz/checks.hpp"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const fs::path& path) {
    if (!fs::is_directory(path)) return {path};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::uint8_t> bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

int main(int argc, char** argv) {
    int count = 0;
    for (int i = 1; i < argc; ++i)
        for (const fs::path& file : files_of(argv[i])) {
            std::printf("%s\n", file.c_str());
            std::fflush(stdout); // the last one is to blame
            const std::vector<std::uint8_t> bytes = bytes_of(file);
            try {
                LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
            } catch (const std::exception& error) {
                std::printf("an exception that is no refusal: %s\n", error.what());
                return 1;
            }
            ++count;
        }
    std::printf("%d inputs\n", count);
    return count > 0 ? 0 : 1;
}
