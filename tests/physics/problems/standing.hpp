// SPDX-License-Identifier: MIT
// What stands: stacks, arches, leaning cards, card houses, the pinched block.
#pragma once

#include "physics/problems/history.hpp"

namespace flotilla::physics {

/// Boxes of `edge` with `gap` below each on the ground, which is the last body.
[[nodiscard]] SceneDescription stack(const Settings& settings, const std::vector<double>& masses, double edge,
                                     double gap);
[[nodiscard]] SceneDescription resting_stack(const Start& start, const std::vector<double>& masses, double edge = 1);

/// A semicircle of equal wedges of mean radius R and thickness t stands from a least t / R on, by linear programming
/// over all statically possible forces: 0.0962 for 7 stones, 0.1049 for 11, 0.1070 for 25. With t / R = 0.15 it needs
/// friction of 0.352. The gaps between stones are 2e-5 of the radius, so that their closing does not change the form.
[[nodiscard]] SceneDescription arch(const Start& start, int stones, double thickness, double friction);
inline constexpr double kArchRadius = 10, kArchGap = 2e-4; ///< m
/// From 5 % inside the safe range an arch that falls takes about 3 s = 3 sqrt(R / g) to move by a centimetre.
inline constexpr double kArchTime = 8, kArchMoves = 0.02;

/// Two cards of length l lean on each other at the angle phi from vertical: they stand from friction tan(phi) / 2 on,
/// of which they have `share`. The cards have a hundredth of their length in thickness, feet cut level and tops cut
/// upright, which changes that by as much.
[[nodiscard]] SceneDescription leaning_cards(const Start& start, double share);
inline constexpr double kCardGap = 1e-4; ///< m

/// `levels` of leaning pairs, a floor card between each two pairs' tops: 15 cards for 3 levels, 26 for 4. Cards have no
/// thickness.
[[nodiscard]] SceneDescription card_house(const Start& start, int levels, double friction);
inline constexpr double kCardLength = 0.09, kCardWidth = 0.06; ///< m
[[nodiscard]] double house_gap();                              ///< m, between its cards

/// The block between two cylinders between two planes: friction in shares of the least coefficients from the balance of
/// forces and torques.
[[nodiscard]] SceneDescription pinched_block(const Start& start, double block_share, double plane_share);
/// m, by which the block came down.
[[nodiscard]] double sunk(const History& history);

} // namespace flotilla::physics
