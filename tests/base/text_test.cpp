// SPDX-License-Identifier: MIT
#include "base/text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <flotilla/error.hpp>

#include "base/error_list.hpp"
#include "base/random.hpp"

namespace flotilla {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::array kNames{"position"sv, "rotation"sv, "velocity"sv, "angular_velocity"sv, "type"sv};

TEST(Text, FindsTheNearestName) {
    EXPECT_EQ(nearest_name("positon", kNames), "position");
    EXPECT_EQ(nearest_name("poistion", kNames), "position"); // neighbours swapped
    EXPECT_EQ(nearest_name("angular_velocty", kNames), "angular_velocity");
    EXPECT_EQ(nearest_name("tpye", kNames), "type");
    EXPECT_EQ(nearest_name("angular", kNames), "angular_velocity");
    EXPECT_EQ(nearest_name("loci", kNames), "velocity") << "the shortest that contains it";
}

TEST(Text, OffersNothingForNamesThatResembleNone) {
    EXPECT_EQ(nearest_name("colour", kNames), "");
    EXPECT_EQ(nearest_name("", kNames), "");
    EXPECT_EQ(nearest_name("on", kNames), "");
    EXPECT_EQ(nearest_name("xy", std::array{"ab"sv}), "");
}

TEST(Text, QuotesMakeControlCharactersVisible) { EXPECT_EQ(in_quotes("a\"\n\x7f"), "\"a\\\"\\x0a\\x7f\""); }

TEST(Text, NumbersReadBackExactly) {
    for (const double x :
         {0.1, 1.0 / 24.0, 1e-300, -123456789.123456789, 0x1p-1074, std::numeric_limits<double>::max()})
        EXPECT_EQ(std::strtod(to_text(x).c_str(), nullptr), x) << to_text(x);
    EXPECT_EQ(to_text(0.1), "0.1");
}

TEST(ErrorList, KnowsWhatIsBrokenBelowAPlace) {
    ErrorList errors("scene.json");
    errors.add("/bodies/31/position", "x");
    EXPECT_TRUE(errors.any_under("/bodies/31/position"));
    EXPECT_TRUE(errors.any_under("/bodies/31"));
    EXPECT_TRUE(errors.any_under(""));
    EXPECT_FALSE(errors.any_under("/bodies/3"));
    EXPECT_FALSE(errors.any_under("/bodies/31/position/0"));
}

TEST(ErrorList, ThrowsOneLinePerProblem) {
    ErrorList errors("scene.json");
    EXPECT_NO_THROW(errors.throw_if_any());
    errors.add("/gravity", "must be finite");
    errors.add("", "is empty");
    try {
        errors.throw_if_any();
        FAIL() << "nothing thrown";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "scene.json: /gravity: must be finite\nscene.json: is empty");
    }
}

TEST(ErrorList, CountsWhatItDoesNotShow) {
    ErrorList errors("a");
    for (std::size_t i = 0; i < ErrorList::kMaxLines + 7; ++i) errors.add("/x", "y");
    EXPECT_TRUE(errors.message().ends_with("a: and 7 more problems"));
}

TEST(Random, IsAPureFunctionOfItsKey) {
    EXPECT_EQ(random_bits(1, 2, 3), random_bits(1, 2, 3));
    EXPECT_NE(random_bits(1, 2, 3), random_bits(1, 3, 2));
    EXPECT_NE(random_bits(1, 2), random_bits(2, 1));
    EXPECT_EQ(mix_bits(0x9e3779b97f4a7c15U), 0xe220a8397b1dcdafU); // SplitMix64, seed 0, first output
}

TEST(Random, FillsTheUnitIntervalEvenly) {
    constexpr int kSamples = 100000, kBins = 10;
    std::array<int, kBins> bins{};
    for (int i = 0; i < kSamples; ++i) {
        const double x = unit_interval(random_bits(42, i));
        ASSERT_GE(x, 0);
        ASSERT_LT(x, 1);
        ++bins[static_cast<std::size_t>(x * kBins)];
    }
    // Five standard deviations of a binomial count.
    for (const int count : bins) EXPECT_NEAR(count, kSamples / kBins, 5 * std::sqrt(kSamples * 0.1 * 0.9));
}

} // namespace
} // namespace flotilla
