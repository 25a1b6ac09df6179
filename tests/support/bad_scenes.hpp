// SPDX-License-Identifier: MIT
// Every kind of bad scene, each with the exact lines that a user sees.
#pragma once

#include <string>
#include <vector>

namespace flotilla::test {

struct BadScene {
    std::string kind;
    std::string text;
    std::vector<std::string> problems; ///< without the leading "FILE: "
};

[[nodiscard]] std::vector<BadScene> bad_scenes();
/// Scenes that the bad ones are made from.
[[nodiscard]] std::vector<std::string> good_scenes();

} // namespace flotilla::test
