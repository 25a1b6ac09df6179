// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

#include "base/floating_point.hpp"
#include "parallel/first_error.hpp"

namespace flotilla {

/// The items of a loop; none is begun after an exception of one before it.
class Items {
  public:
    explicit Items(const std::function<void(std::size_t)>& work) : work_(work) {}

    void run(std::size_t i) {
        if (error_.before(i)) return;
        try {
            const DefaultFloatingPoint environment; // TBB's threads may have another one
            work_(i);
        } catch (...) {
            error_.keep(i);
        }
    }
    void rethrow() const { error_.rethrow(); }

  private:
    const std::function<void(std::size_t)>& work_;
    FirstError error_;
};

} // namespace flotilla
