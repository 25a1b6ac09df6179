// SPDX-License-Identifier: MIT
#include <utility>

#include "parallel/arena.hpp"
#include "parallel/beside.hpp"

namespace flotilla {

struct Beside::Impl {
    Arena arena{1, 0}; ///< one place, of a worker
};

Beside::Beside() : impl_(std::make_unique<Impl>()) {}
Beside::~Beside() = default;

void Beside::start(std::function<void()> work) { impl_->arena->enqueue(std::move(work)); }

} // namespace flotilla
