// SPDX-License-Identifier: MIT
// The exceptions that leave the library. Numerical outcomes are values, never exceptions.
#pragma once

#include <stdexcept>
#include <string>

namespace flotilla {

/// Input that the caller must correct: a file, an option, a scene. The message names file, object and reason.
/// The command exits with 2.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A file or folder that cannot be read or written. The command exits with 5.
class IoError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace flotilla
