// SPDX-License-Identifier: MIT
// The exceptions that leave the library; all are Errors. Numerical outcomes are values, never exceptions.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace flotilla {

/// The message names what is concerned and why, one line each.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// One thing that is wrong with an input.
struct InputProblem {
    std::string where; ///< a JSON pointer such as "/bodies/3/position"; empty: the input as a whole
    std::string reason;
};

/// Input that the caller must correct: a file, an option, a scene, an index. The command exits with 2.
class InputError : public Error {
  public:
    using Error::Error;
    InputError(const std::string& message, std::vector<InputProblem> problems)
        : Error(message), problems_(std::move(problems)) {}
    /// All of them, where the input has places: a scene. Otherwise the message says everything.
    [[nodiscard]] const std::vector<InputProblem>& problems() const { return problems_; }

  private:
    std::vector<InputProblem> problems_;
};

/// A file or folder that cannot be read or written. The command exits with 5.
class IoError : public Error {
  public:
    using Error::Error;
};

/// Two bodies of a scene, by index and name.
struct BodyNames {
    std::int32_t a = -1, b = -1;
    std::string name_a, name_b;
};

/// Bodies intersect at the start. The command exits with 4.
class OverlapError : public Error {
  public:
    struct Pair : BodyNames {
        std::int64_t triangle_pairs = 0; ///< that intersect
    };
    OverlapError(const std::string& message, std::vector<Pair> pairs) : Error(message), pairs_(std::move(pairs)) {}
    /// Sorted by bodies; a < b.
    [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }

  private:
    std::vector<Pair> pairs_;
};

/// A script cannot make a step in full, because a body in its way cannot give way, and the scene asks for an error then
/// (`unsatisfiable_script: error`). The World stands where the step began. The command exits with 7.
class ScriptError : public Error {
  public:
    /// a: the scripted body, b: one that it would crush.
    ScriptError(const std::string& message, std::int64_t step, std::vector<BodyNames> pairs)
        : Error(message), step_(step), pairs_(std::move(pairs)) {}
    [[nodiscard]] std::int64_t step() const { return step_; } ///< that could not be made, 1 for the first
    /// Sorted by scripted body; each is there once.
    [[nodiscard]] const std::vector<BodyNames>& pairs() const { return pairs_; }

  private:
    std::int64_t step_;
    std::vector<BodyNames> pairs_;
};

/// An observer ended the step (World::set_observer()). The World stands where the step began.
class StepCancelled : public Error {
  public:
    using Error::Error;
};

/// The end of a step could not be proved free of intersections: a fault of the library. Thrown instead of leaving such
/// a state. The command exits with 3.
class BrokenPromise : public Error {
  public:
    BrokenPromise(const std::string& message, std::int64_t step, BodyNames pair)
        : Error(message), step_(step), pair_(std::move(pair)) {}
    [[nodiscard]] std::int64_t step() const { return step_; }
    [[nodiscard]] const BodyNames& pair() const { return pair_; } ///< without a proof

  private:
    std::int64_t step_;
    BodyNames pair_;
};

} // namespace flotilla
