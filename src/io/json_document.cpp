// SPDX-License-Identifier: MIT
#include "io/json_document.hpp"

#include <algorithm>
#include <vector>

#include "base/text.hpp"

namespace flotilla::io {

namespace {

constexpr std::size_t kMaxDepth = 64; // a scene needs 6

std::string escaped(std::string_view key) {
    std::string text;
    for (const char c : key) {
        if (c == '~')
            text += "~0";
        else if (c == '/')
            text += "~1";
        else
            text += c;
    }
    return text;
}

// The line and column, counted from 1, of a byte counted from 1.
std::string line_and_column(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t start = before.rfind('\n');
    const std::size_t column = start == std::string_view::npos ? before.size() + 1 : before.size() - start;
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

// nlohmann's "[json.exception...] parse error at line 1, column 2: syntax error while parsing value - unexpected ..."
// without the parts that are ours or nobody's.
std::string bare_reason(const std::string& what) {
    const std::size_t colon = what.find(": ");
    return what.starts_with("[json.exception.parse_error") && colon != std::string::npos ? what.substr(colon + 2)
                                                                                         : what;
}

// Builds the document and looks at every key on its way.
class Builder : public nlohmann::json_sax<Json> {
  public:
    Builder(std::string_view text, ErrorList& errors) : text_(text), errors_(errors) {}

    [[nodiscard]] Json take() { return std::move(root_); }

    bool null() override { return put(nullptr); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(std::int64_t value) override { return put(value); }
    bool number_unsigned(std::uint64_t value) override { return put(value); }
    bool number_float(double value, const std::string&) override { return put(value); }
    bool string(std::string& value) override { return put(std::move(value)); }
    bool binary(Json::binary_t&) override { return false; } // not a thing of JSON text
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(std::string& name) override {
        Level& level = levels_.back();
        if (level.value->contains(name)) errors_.add(place() + "/" + escaped(name), "key given twice in one object");
        level.key = name;
        return true;
    }

    bool parse_error(std::size_t byte, const std::string& token, const Json::exception& error) override {
        const bool overflow = dynamic_cast<const Json::out_of_range*>(&error) != nullptr;
        errors_.add(
            "", line_and_column(text_, overflow ? byte - std::min(byte, token.size()) + 1 : byte) + ": " +
                    (overflow ? "number " + token + " is beyond the range of a double" : bare_reason(error.what())));
        root_ = Json(Json::value_t::discarded);
        return false;
    }

  private:
    struct Level {
        Json* value; // stays valid: its parent gets no further element while this level is open
        std::string key;
    };

    [[nodiscard]] std::string place() const {
        std::string path;
        for (std::size_t i = 0; i + 1 < levels_.size(); ++i) {
            const Level& level = levels_[i];
            path += '/';
            path += level.value->is_array() ? std::to_string(level.value->size() - 1) : escaped(level.key);
        }
        return path;
    }

    Json* insert(Json value) {
        if (levels_.empty()) return &(root_ = std::move(value));
        Level& level = levels_.back();
        if (level.value->is_array()) {
            level.value->push_back(std::move(value));
            return &level.value->back();
        }
        return &((*level.value)[level.key] = std::move(value));
    }

    bool put(Json value) {
        insert(std::move(value));
        return true;
    }

    bool open(Json container) {
        if (levels_.size() >= kMaxDepth) {
            errors_.add(place(), "nested deeper than " + std::to_string(kMaxDepth) + " levels");
            root_ = Json(Json::value_t::discarded);
            return false;
        }
        Json* inserted = insert(std::move(container));
        levels_.push_back({inserted, {}});
        return true;
    }

    bool close() {
        levels_.pop_back();
        return true;
    }

    std::string_view text_;
    ErrorList& errors_;
    Json root_;
    std::vector<Level> levels_;
};

} // namespace

std::string JsonPlace::text() const {
    if (parent == nullptr) return "";
    std::string path = parent->text() += '/';
    return path += key.empty() ? std::to_string(index) : escaped(key);
}

Json parse_json(std::string_view text, ErrorList& errors) {
    Builder builder(text, errors);
    Json::sax_parse(text, &builder);
    return builder.take();
}

std::string kind_of(const Json& value) {
    switch (value.type()) {
    case Json::value_t::null: return "null";
    case Json::value_t::boolean: return value.get<bool>() ? "true" : "false";
    case Json::value_t::object: return "an object";
    case Json::value_t::array: return "an array of " + std::to_string(value.size());
    case Json::value_t::string: return "the string " + in_quotes(value.get_ref<const std::string&>());
    case Json::value_t::number_integer: return std::to_string(value.get<std::int64_t>());
    case Json::value_t::number_unsigned: return std::to_string(value.get<std::uint64_t>());
    case Json::value_t::number_float: return to_text(value.get<double>());
    case Json::value_t::binary:
    case Json::value_t::discarded: break;
    }
    return "nothing";
}

} // namespace flotilla::io
