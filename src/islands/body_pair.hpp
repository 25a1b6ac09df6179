// SPDX-License-Identifier: MIT
// The contact graph in its barest form: bodies are nodes, touching pairs are edges. Everything in this module is a pure
// function of the list of pairs in its given order.
#pragma once

#include <compare>
#include <cstdint>

namespace flotilla {

/// Indices into an array of bodies, a < b. Pairs are handed over sorted, each once.
struct BodyPair {
    std::int32_t a = 0, b = 0;
    friend constexpr auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// Before, in a list that is sorted by bodies.
template <class PairOfBodies>
constexpr bool by_bodies(const PairOfBodies& x, const PairOfBodies& y) {
    return BodyPair{x.a, x.b} < BodyPair{y.a, y.b};
}

} // namespace flotilla
