// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace flotilla {

/// std::lower_bound that begins at a guess and doubles its reach: cheap where the place is near it, right in any case.
template <class Item, class Value, class Less>
[[nodiscard]] std::size_t lower_bound_near(std::span<const Item> items, std::size_t guess, const Value& value,
                                           Less less) {
    std::size_t low = 0, high = items.size();
    guess = std::min(guess, high);
    if (guess < high && less(items[guess], value)) {
        low = guess + 1;
        for (std::size_t reach = 1; low + reach < high; reach *= 2) {
            if (!less(items[low + reach], value)) {
                high = low + reach;
                break;
            }
            low += reach + 1;
        }
    } else {
        high = guess;
        for (std::size_t reach = 1; low + reach < high; reach *= 2) {
            if (less(items[high - reach], value)) {
                low = high - reach + 1;
                break;
            }
            high -= reach;
        }
    }
    const auto begin = items.begin();
    return static_cast<std::size_t>(std::lower_bound(begin + static_cast<std::ptrdiff_t>(low),
                                                     begin + static_cast<std::ptrdiff_t>(high), value, less) -
                                    begin);
}

} // namespace flotilla
