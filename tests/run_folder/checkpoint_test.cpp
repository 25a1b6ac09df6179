// SPDX-License-Identifier: MIT
#include "run_folder/checkpoint.hpp"

#include <gtest/gtest.h>

#include <flotilla/error.hpp>

#include "run_folder/damage.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> state_of(std::int64_t step) {
    return std::vector<std::byte>(static_cast<std::size_t>(100 + step), static_cast<std::byte>(step));
}

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(Checkpoint, TheNewestIsReadAndTwoAreKept) {
    const test::TemporaryFolder temporary;
    EXPECT_FALSE(io::read_last_checkpoint(temporary.path()).has_value());
    const std::vector<io::CheckpointArray> arrays{{"position", {1, 2, 3}}};
    for (const std::int64_t step : {9, 10, 100}) io::write_checkpoint(temporary.path(), step, state_of(step), arrays);
    EXPECT_EQ(files_in(temporary.path()), 2u);
    const auto checkpoint = io::read_last_checkpoint(temporary.path());
    ASSERT_TRUE(checkpoint.has_value());
    EXPECT_EQ(checkpoint->step, 100);
    EXPECT_EQ(checkpoint->state, state_of(100));
    EXPECT_TRUE(checkpoint->warnings.empty());
}

TEST(Checkpoint, DamageToTheNewestFallsBackToTheOneBefore) {
    const test::TemporaryFolder temporary;
    io::write_checkpoint(temporary.path(), 10, state_of(10));
    io::write_checkpoint(temporary.path(), 20, state_of(20));
    const fs::path newest = temporary.path() / "checkpoint-00000020.h5";
    const auto size = static_cast<std::streamoff>(fs::file_size(newest));
    for (std::streamoff byte = 0; byte < size; byte += 5) {
        flip_bit(newest, byte);
        const auto checkpoint = io::read_last_checkpoint(temporary.path());
        ASSERT_TRUE(checkpoint.has_value());
        EXPECT_EQ(checkpoint->state, state_of(checkpoint->step));
        EXPECT_EQ(checkpoint->step, 10);
        ASSERT_EQ(checkpoint->warnings.size(), 1u);
        EXPECT_NE(checkpoint->warnings[0].find("checkpoint-00000020.h5"), std::string::npos);
        flip_bit(newest, byte);
    }
    fs::resize_file(newest, static_cast<std::uintmax_t>(size / 2));
    EXPECT_EQ(io::read_last_checkpoint(temporary.path())->step, 10);
    fs::resize_file(temporary.path() / "checkpoint-00000010.h5", 0);
    EXPECT_THROW((void)io::read_last_checkpoint(temporary.path()), IoError);
}

} // namespace
} // namespace flotilla
