// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <flotilla/world.hpp>

#include "python/bind.hpp"

namespace flotilla::python {

inline constexpr std::array<std::string_view, 2> kExecutors{"parallel", "serial"};

[[nodiscard]] inline WorldOptions world_options(int threads, const std::string& executor) {
    WorldOptions options;
    options.threads = threads;
    options.executor = choice<Executor>("executor", executor, kExecutors);
    return options;
}

} // namespace flotilla::python
