// SPDX-License-Identifier: MIT
// Strict JSON text: nlohmann's parser with what it leaves out, that is duplicate keys, line and column of numbers
// beyond double's range, and a bound on nesting.
#pragma once

#include <new>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "base/error_list.hpp"

namespace flotilla::io {

using Json = nlohmann::json;

/// The place of a value inside a document, kept as a chain of parents because most places are never written out.
struct JsonPlace {
    const JsonPlace* parent = nullptr;
    std::string_view key;  ///< of the parent object, or empty
    std::size_t index = 0; ///< in the parent array, where key is empty

    [[nodiscard]] JsonPlace member(std::string_view name) const { return {this, name, 0}; }
    [[nodiscard]] JsonPlace element(std::size_t i) const { return {this, {}, i}; }
    /// The JSON pointer (RFC 6901): "/bodies/3/position".
    [[nodiscard]] std::string text() const;
};

/// Parses `text`. Syntax errors end the reading ("line 3, column 7: ..."); every duplicate key up to there is reported
/// too. Returns a discarded value after a syntax error.
[[nodiscard]] Json parse_json(std::string_view text, ErrorList& errors);

/// Memory for the end of a document, whose destructor lists what it destroys and ends the process where it gets none.
/// Declared after the document, so that it is free when that goes; never touched before.
class MemoryForTheEnd {
  public:
    /// Of a document of so many characters: of what it holds, siblings along one path wait in the list at most.
    explicit MemoryForTheEnd(std::size_t characters) : block_(::operator new(4 * characters + 65536)) {}
    ~MemoryForTheEnd() { ::operator delete(block_); }
    MemoryForTheEnd(const MemoryForTheEnd&) = delete;
    MemoryForTheEnd& operator=(const MemoryForTheEnd&) = delete;

  private:
    void* block_;
};

/// "a string", "an array", ... for messages.
[[nodiscard]] std::string kind_of(const Json& value);

} // namespace flotilla::io
