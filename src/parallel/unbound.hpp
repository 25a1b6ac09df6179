// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

namespace flotilla {

/// Where OpenMP bound the first thread of the process to a place (OMP_PROC_BIND), other runtimes see one core and put
/// all their threads there. Lets the calling thread use all places: while this lives, or from stay() on.
class Unbound {
  public:
    Unbound();
    ~Unbound();
    void stay();
    Unbound(const Unbound&) = delete;
    Unbound& operator=(const Unbound&) = delete;

  private:
    struct Cores;
    std::unique_ptr<Cores> bound_; ///< null: nothing was changed
};

} // namespace flotilla
