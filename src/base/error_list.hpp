// SPDX-License-Identifier: MIT
// Collects every problem of one input before refusing it, so that a user mends a file once and not once per mistake.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include <flotilla/error.hpp>

namespace flotilla {

class ErrorList {
  public:
    /// `source` names the input in messages: a file name, or "scene" for one built in memory.
    explicit ErrorList(std::string source) : source_(std::move(source)) {}

    void add(std::string where, std::string reason);

    [[nodiscard]] bool empty() const { return problems_.empty(); }
    [[nodiscard]] const std::vector<InputProblem>& problems() const { return problems_; }
    [[nodiscard]] const std::string& source() const { return source_; }
    /// Whether a problem was recorded at `where` or below it: what follows from a broken value is not reported again.
    [[nodiscard]] bool any_under(const std::string& where) const { return places_.contains(where); }

    /// Whether `where` itself, not only a part of it, has a problem.
    [[nodiscard]] bool any_at(const std::string& where) const { return exact_places_.contains(where); }

    /// One line per problem, "source: where: reason", in the order found; at most kMaxLines of them and then a count.
    [[nodiscard]] std::string message() const;
    /// Throws InputError with message() unless the list is empty.
    void throw_if_any() const;

    /// A mesh with a million bad indices must not drown the other problems.
    static constexpr std::size_t kMaxLines = 1000;

  private:
    std::string source_;
    std::vector<InputProblem> problems_;
    std::unordered_set<std::string> exact_places_;
    std::unordered_set<std::string> places_; ///< of every problem and everything above it
};

} // namespace flotilla
