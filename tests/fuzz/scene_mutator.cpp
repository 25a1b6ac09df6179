// SPDX-License-Identifier: MIT
// Mutates scene files as trees of JSON: bytes alone rarely get past a parser that refuses every unknown key. A
// seventh of the mutants are of bytes all the same.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <flotilla/settings.hpp>

#include "io/json_document.hpp"
#include "io/scene_keys.hpp"
#include "scene/settings_table.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed);
extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* a, std::size_t size_a, const std::uint8_t* b,
                                                 std::size_t size_b, std::uint8_t* out, std::size_t max_size,
                                                 unsigned seed);

namespace {

using flotilla::io::Json;

/// Limits of settings and descriptions, what lies beyond them, and doubles at the ends of their range.
constexpr std::array kNumbers{0.0,    -0.0,   1.0,  -1.0,   0.5,   2.0,       1e-3,           1e3,      1e-6,
                              1e6,    1e-9,   1e9,  1.1e9,  1e-12, 1e-15,     1e15,           1e16,     1e300,
                              5e-324, 1e-300, -1e9, 1e-308, 3.0,   1 + 1e-15, 1.000001,       0.999999, 2147483647.0,
                              9e18,   1.8e19, 1e4,  1e5,    -1e-9, 0x1p-52,   0x1.fffffep+52, 89.999,   1.0 / 3};
constexpr std::array kWords{"dynamic", "static",   "kinematic",   "hold",      "follow",    "error", "separate",
                            "rigid",   "linear",   "cubic",       "kinematic", "random",    "cone",  "pgs",
                            "exact",   "boat.obj", "accumulated", "",          "exact_few", "a/b~c", "\u00e9",
                            "a",       "b",        "plate",       "box"};

class TreeMutator {
  public:
    explicit TreeMutator(unsigned seed) : random_(seed) {}

    void mutate(Json& document, const Json* other) {
        collect(document);
        if (other != nullptr) collect_sources(*other);
        const std::size_t edits = 1 + below(3);
        for (std::size_t i = 0; i < edits; ++i) {
            nodes_.clear();
            collect(document);
            edit(*nodes_[below(nodes_.size())], document);
        }
    }

  private:
    std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
    bool chance(std::size_t one_in) { return below(one_in) == 0; }

    void collect(Json& node) {
        nodes_.push_back(&node);
        if (node.is_structured())
            for (Json& child : node) collect(child);
    }
    void collect_sources(const Json& node) {
        sources_.push_back(&node);
        if (node.is_structured())
            for (const Json& child : node) collect_sources(child);
    }

    void edit(Json& node, const Json& document) {
        if (!sources_.empty() && chance(2)) {
            node = *sources_[below(sources_.size())];
        } else if (chance(12)) {
            const Json copy = *nodes_[below(nodes_.size())]; // by value: a node may be put into itself
            node = copy;
        } else if (chance(40)) {
            node = any_value();
        } else if (node.is_number()) {
            node = number(node);
        } else if (node.is_string()) {
            node = chance(4) ? std::string(kWords[below(kWords.size())]) : name_in(document);
        } else if (node.is_boolean()) {
            node = !node.get<bool>();
        } else if (node.is_array()) {
            edit_array(node);
        } else if (node.is_object()) {
            edit_object(node);
        }
    }

    Json number(const Json& old) {
        const double x = old.get<double>();
        switch (below(8)) {
        case 0:
        case 1: return kNumbers[below(kNumbers.size())];
        case 2: return -x;
        case 3: return std::ldexp(x, static_cast<int>(below(21)) - 10);
        case 4: return std::nextafter(x, chance(2) ? 1e308 : -1e308);
        case 5: return static_cast<std::int64_t>(below(12)) - 2;
        case 6: return x + 0.1 * static_cast<double>(below(200)) - 10;
        default: return static_cast<double>(below(1000)) / 1000;
        }
    }

    Json any_value() {
        switch (below(6)) {
        case 0: return nullptr;
        case 1: return chance(2);
        case 2: return kWords[below(kWords.size())];
        case 3: return Json::array();
        case 4: return Json::object();
        default: return kNumbers[below(kNumbers.size())];
        }
    }

    /// A name that a shape or body of the document has.
    std::string name_in(const Json& document) {
        std::vector<std::string> names{"plate"};
        for (const char* list : {"shapes", "bodies"})
            if (document.is_object() && document.contains(list) && document[list].is_array())
                for (const Json& item : document[list])
                    if (item.is_object() && item.contains("name") && item["name"].is_string())
                        names.push_back(item["name"]);
        return names[below(names.size())];
    }

    void edit_array(Json& node) {
        if (node.empty()) return node.push_back(any_value());
        const std::size_t at = below(node.size());
        switch (below(4)) {
        case 0: node.erase(at); break;
        case 1: std::swap(node[at], node[below(node.size())]); break;
        default: { // one more, told apart by its name where it has one
            Json copy = node[at];
            if (copy.is_object() && copy.contains("name") && copy["name"].is_string())
                copy["name"] = copy["name"].get<std::string>() + "'";
            node.insert(node.begin() + static_cast<std::ptrdiff_t>(below(node.size() + 1)), copy);
        }
        }
    }

    void edit_object(Json& node) {
        if (!node.empty() && chance(3)) {
            auto item = node.begin();
            std::advance(item, static_cast<std::ptrdiff_t>(below(node.size())));
            node.erase(item);
        } else if (chance(2)) {
            set_setting(node.contains("bodies") ? node["settings"] : node);
        } else {
            node[key()] = any_value();
        }
    }

    std::string key() {
        using namespace flotilla::io;
        std::vector<std::string_view> keys(kSceneKeys.begin(), kSceneKeys.end());
        keys.insert(keys.end(), kShapeKeys.begin(), kShapeKeys.end());
        keys.insert(keys.end(), kBodyKeys.begin(), kBodyKeys.end());
        keys.insert(keys.end(), kKeyframeKeys.begin(), kKeyframeKeys.end());
        return std::string(keys[below(keys.size())]);
    }

    void set_setting(Json& settings) {
        if (!settings.is_object()) settings = Json::object();
        const auto rows = flotilla::settings_table();
        const flotilla::SettingRow& row = rows[below(rows.size())];
        Json& value = settings[std::string(row.key)];
        if (const auto* choice = std::get_if<flotilla::ChoiceField>(&row.field))
            value = choice->names[below(choice->names.size())];
        else if (std::holds_alternative<bool flotilla::Settings::*>(row.field))
            value = chance(2);
        else
            value = chance(3) ? row.low : chance(2) ? row.high : kNumbers[below(kNumbers.size())];
        if (value.is_number_float() && value == std::floor(value.get<double>()) && std::abs(value.get<double>()) < 9e15)
            value = static_cast<std::int64_t>(value.get<double>());
    }

    std::minstd_rand random_;
    std::vector<Json*> nodes_;
    std::vector<const Json*> sources_;
};

Json parsed(const std::uint8_t* data, std::size_t size) { return Json::parse(data, data + size, nullptr, false); }

/// Zero where it does not fit.
std::size_t store(const Json& document, std::uint8_t* out, std::size_t max_size) {
    const std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > max_size) return 0;
    std::memcpy(out, text.data(), text.size());
    return text.size();
}

} // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
    Json document = parsed(data, size);
    if (document.is_discarded() || seed % 7 == 0) return LLVMFuzzerMutate(data, size, max_size);
    TreeMutator(seed).mutate(document, nullptr);
    const std::size_t stored = store(document, data, max_size);
    return stored > 0 ? stored : LLVMFuzzerMutate(data, size, max_size);
}

std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* a, std::size_t size_a, const std::uint8_t* b,
                                      std::size_t size_b, std::uint8_t* out, std::size_t max_size, unsigned seed) {
    Json document = parsed(a, size_a);
    const Json other = parsed(b, size_b);
    if (document.is_discarded() || other.is_discarded()) return 0;
    TreeMutator(seed).mutate(document, &other);
    return store(document, out, max_size);
}
