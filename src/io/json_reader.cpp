// SPDX-License-Identifier: MIT
#include "io/json_reader.hpp"

namespace flotilla::io {

bool JsonReader::is_object(const Json& value, const JsonPlace& at) const {
    if (value.is_object()) return true;
    problem(at, "must be an object, got " + kind_of(value));
    return false;
}

bool JsonReader::is_array(const Json& value, const JsonPlace& at, std::string_view what) const {
    if (value.is_array()) return true;
    problem(at, "must be " + std::string(what) + ", got " + kind_of(value));
    return false;
}

const Json* JsonReader::member(const Json& object, const JsonPlace& at, std::string_view key, bool required) const {
    const auto found = object.find(key);
    if (found != object.end()) return &*found;
    if (required) problem(at.member(key), "is missing");
    return nullptr;
}

bool JsonReader::to(bool& out, const Json& value, const JsonPlace& at) const {
    if (value.is_boolean()) {
        out = value.get<bool>();
        return true;
    }
    problem(at, "must be true or false, got " + kind_of(value));
    return false;
}

bool JsonReader::to(double& out, const Json& value, const JsonPlace& at) const {
    if (value.is_number()) {
        out = value.get<double>();
        return true;
    }
    problem(at, "must be a number, got " + kind_of(value));
    return false;
}

bool JsonReader::to(std::string& out, const Json& value, const JsonPlace& at) const {
    if (value.is_string()) {
        out = value.get_ref<const std::string&>();
        return true;
    }
    problem(at, "must be a string, got " + kind_of(value));
    return false;
}

bool JsonReader::to(Vec3& out, const Json& value, const JsonPlace& at) const {
    std::array<double, 3> v{};
    if (!numbers(v, value, at, "an array of 3 numbers")) return false;
    out = {v[0], v[1], v[2]};
    return true;
}

bool JsonReader::to(Triangle& out, const Json& value, const JsonPlace& at) const {
    const auto is_index = [](const Json& v) {
        return v.is_number_integer() && (v.is_number_unsigned() ? v.get<std::uint64_t>() <= 0x7fffffffU : false);
    };
    if (!value.is_array() || value.size() != 3 || !is_index(value[0]) || !is_index(value[1]) || !is_index(value[2])) {
        problem(at,
                "must be an array of 3 vertex numbers counted from 0, got " +
                    (value.is_array() && value.size() == 3 ? value.dump(-1, ' ', false, Json::error_handler_t::replace)
                                                           : kind_of(value)));
        return false;
    }
    for (std::size_t i = 0; i < 3; ++i) out[i] = value[i].get<std::int32_t>();
    return true;
}

} // namespace flotilla::io
