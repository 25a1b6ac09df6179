// SPDX-License-Identifier: MIT
// Values of a JSON document as C++ values. One of the wrong type is reported at its place and leaves what was there, so
// that reading goes on and all problems of a file are seen at once.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <flotilla/types.hpp>

#include "io/json_document.hpp"

namespace flotilla::io {

class JsonReader {
  public:
    explicit JsonReader(ErrorList& errors) : errors_(errors) {}

  protected:
    void problem(const JsonPlace& at, std::string reason) const { errors_.add(at.text(), std::move(reason)); }
    [[nodiscard]] ErrorList& errors() const { return errors_; }
    [[nodiscard]] bool is_object(const Json& value, const JsonPlace& at) const;
    [[nodiscard]] bool is_array(const Json& value, const JsonPlace& at, std::string_view what) const;
    /// The member, or null where there is none (a problem if `required`).
    [[nodiscard]] const Json* member(const Json& object, const JsonPlace& at, std::string_view key,
                                     bool required = false) const;

    bool to(bool& out, const Json& value, const JsonPlace& at) const;
    bool to(double& out, const Json& value, const JsonPlace& at) const;
    bool to(std::string& out, const Json& value, const JsonPlace& at) const;
    bool to(Vec3& out, const Json& value, const JsonPlace& at) const;
    bool to(Triangle& out, const Json& value, const JsonPlace& at) const;
    template <std::size_t N>
    bool numbers(std::array<double, N>& out, const Json& value, const JsonPlace& at, std::string_view what) const;

  private:
    ErrorList& errors_;
};

template <std::size_t N>
bool JsonReader::numbers(std::array<double, N>& out, const Json& value, const JsonPlace& at,
                         std::string_view what) const {
    if (!value.is_array() || value.size() != N) {
        problem(at, "must be " + std::string(what) + ", got " + kind_of(value));
        return false;
    }
    std::array<double, N> read{};
    bool good = true;
    for (std::size_t i = 0; i < N; ++i) good &= to(read[i], value[i], at.element(i));
    if (good) out = read;
    return good;
}

} // namespace flotilla::io
