// SPDX-License-Identifier: MIT
#include <thread>
#include <utility>

#include "parallel/beside.hpp"

namespace flotilla {

struct Beside::Impl {
    std::jthread thread;
};

Beside::Beside() : impl_(std::make_unique<Impl>()) {}
Beside::~Beside() = default;

void Beside::start(std::function<void()> work) { impl_->thread = std::jthread(std::move(work)); }

} // namespace flotilla
