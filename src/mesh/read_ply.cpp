// SPDX-License-Identifier: MIT
// PLY, ASCII and binary of both byte orders. The elements `vertex` (x, y, z) and `face` (vertex_indices or
// vertex_index) are read wherever they stand; other properties and elements are walked over.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "mesh/binary_input.hpp"
#include "mesh/text_input.hpp"

namespace flotilla {
namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Scalar> scalar_type(std::string_view name) {
    static constexpr std::array<std::pair<std::string_view, Scalar>, 16> kNames{{
        {"char", Scalar::int8},
        {"int8", Scalar::int8},
        {"uchar", Scalar::uint8},
        {"uint8", Scalar::uint8},
        {"short", Scalar::int16},
        {"int16", Scalar::int16},
        {"ushort", Scalar::uint16},
        {"uint16", Scalar::uint16},
        {"int", Scalar::int32},
        {"int32", Scalar::int32},
        {"uint", Scalar::uint32},
        {"uint32", Scalar::uint32},
        {"float", Scalar::float32},
        {"float32", Scalar::float32},
        {"double", Scalar::float64},
        {"float64", Scalar::float64},
    }};
    for (const auto& [text, type] : kNames)
        if (text == name) return type;
    return std::nullopt;
}

bool is_integer(Scalar type) { return type != Scalar::float32 && type != Scalar::float64; }

enum class Role { skip, x, y, z, corners };

struct Property {
    Scalar type{};
    std::optional<Scalar> count_type; ///< set for a list
    Role role = Role::skip;
};

struct Element {
    std::string name;
    std::int64_t count = 0;
    std::size_t line = 0;
    std::vector<Property> properties;
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
    Format format = Format::ascii;
    std::vector<Element> elements;
};

Format read_format(const TextInput& in, std::string_view rest) {
    const std::string_view name = take_word(rest);
    if (take_word(rest) != "1.0") in.fail("unknown format version, only 1.0 is known");
    if (name == "ascii") return Format::ascii;
    if (name == "binary_little_endian") return Format::little_endian;
    if (name == "binary_big_endian") return Format::big_endian;
    in.fail("unknown format '" + std::string(name) + "'");
}

Element read_element(const TextInput& in, std::string_view rest) {
    Element e;
    e.name = take_word(rest);
    if (e.name.empty()) in.fail("an element needs a name");
    e.count = in.integer(take_word(rest));
    e.line = in.line();
    if (e.count < 0 || e.count > std::numeric_limits<std::int32_t>::max())
        in.fail("element count " + std::to_string(e.count) + " is out of range");
    return e;
}

Role role_of(const std::string& element, std::string_view property, bool list) {
    if (element == "vertex" && !list) {
        if (property == "x") return Role::x;
        if (property == "y") return Role::y;
        if (property == "z") return Role::z;
    }
    const bool corners = property == "vertex_indices" || property == "vertex_index";
    return element == "face" && list && corners ? Role::corners : Role::skip;
}

Scalar read_type(const TextInput& in, std::string_view word) {
    const auto type = scalar_type(word);
    if (!type) in.fail("unknown property type '" + std::string(word) + "'");
    return *type;
}

Property read_property(const TextInput& in, const std::string& element, std::string_view rest) {
    Property p;
    std::string_view word = take_word(rest);
    if (word == "list") {
        p.count_type = read_type(in, take_word(rest));
        if (!is_integer(*p.count_type)) in.fail("the count of a list must be an integer type");
        word = take_word(rest);
    }
    p.type = read_type(in, word);
    const std::string_view name = take_word(rest);
    if (name.empty()) in.fail("a property needs a name");
    p.role = role_of(element, name, p.count_type.has_value());
    if (p.role == Role::corners && !is_integer(p.type)) in.fail("vertex indices must be of an integer type");
    return p;
}

void require_roles(const TextInput& in, const Header& header, const std::string& name,
                   std::initializer_list<Role> roles) {
    const auto e =
        std::find_if(header.elements.begin(), header.elements.end(), [&](const Element& x) { return x.name == name; });
    if (e == header.elements.end()) in.fail("the header has no element '" + name + "'");
    for (Role role : roles)
        if (std::count_if(e->properties.begin(), e->properties.end(),
                          [&](const Property& p) { return p.role == role; }) != 1)
            in.fail_at(e->line, name == "face" ? "a face needs one list property vertex_indices"
                                               : "a vertex needs the properties x, y and z, each once");
    const auto same =
        std::count_if(header.elements.begin(), header.elements.end(), [&](const Element& x) { return x.name == name; });
    if (same != 1) in.fail("the header has element '" + name + "' more than once");
}

Header read_header(TextInput& in) {
    Header h;
    bool has_format = false;
    if (in.next_line().value_or("") != "ply") in.fail("not a PLY file: the first line must be 'ply'");
    for (;;) {
        const auto line = in.next_line();
        if (!line) in.fail("the file ends early, 'end_header' is missing");
        std::string_view rest = *line;
        const std::string_view keyword = take_word(rest);
        if (keyword == "end_header") break;
        if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) continue;
        if (keyword == "format") {
            h.format = read_format(in, rest);
            has_format = true;
        } else if (keyword == "element") {
            h.elements.push_back(read_element(in, rest));
        } else if (keyword == "property") {
            if (h.elements.empty()) in.fail("a property must follow an element");
            h.elements.back().properties.push_back(read_property(in, h.elements.back().name, rest));
        } else {
            in.fail("unknown header line '" + std::string(keyword) + "'");
        }
    }
    if (!has_format) in.fail("the header has no format");
    // Such rows take no bytes, so the length of the file would not bound their number.
    for (const Element& e : h.elements)
        if (e.properties.empty()) in.fail_at(e.line, "element '" + e.name + "' has no properties");
    require_roles(in, h, "vertex", {Role::x, Role::y, Role::z});
    require_roles(in, h, "face", {Role::corners});
    return h;
}

/// Values of an ASCII body: one element per line.
class AsciiValues {
  public:
    explicit AsciiValues(TextInput& in) : in_(in) {}
    void begin_row() {
        std::optional<std::string_view> line;
        do line = in_.next_line();
        while (line && line->find_first_not_of(" \t\r\v\f") == std::string_view::npos);
        if (!line) in_.fail("the file ends early");
        rest_ = *line;
    }
    void end_row() {
        if (const auto word = take_word(rest_); !word.empty())
            in_.fail("unexpected '" + std::string(word) + "' at the end of the line");
    }
    std::int64_t integer(Scalar) { return in_.integer(take_word(rest_)); }
    double number(Scalar) { return in_.number(take_word(rest_)); }
    void end_file() {
        while (const auto line = in_.next_line())
            if (line->find_first_not_of(" \t\r\v\f") != std::string_view::npos)
                in_.fail("the file goes on after its last element");
    }
    [[nodiscard]] std::size_t place() const { return in_.line(); }
    [[noreturn]] void fail_at(std::size_t line, const std::string& reason) const { in_.fail_at(line, reason); }
    [[noreturn]] void fail(const std::string& reason) const { in_.fail(reason); }

  private:
    TextInput& in_;
    std::string_view rest_;
};

/// Values of a binary body. place() is the byte at which the row begins.
class BinaryValues {
  public:
    explicit BinaryValues(BinaryInput& in) : in_(in) {}
    void begin_row() { place_ = in_.position(); }
    void end_row() {}
    std::int64_t integer(Scalar type) { return value<std::int64_t>(type); }
    double number(Scalar type) { return value<double>(type); }
    void end_file() {
        if (in_.remaining() > 0) in_.fail("the file goes on after its last element");
    }
    [[nodiscard]] std::size_t place() const { return place_; }
    [[noreturn]] void fail_at(std::size_t byte, const std::string& reason) const { in_.fail_at(byte, reason); }
    [[noreturn]] void fail(const std::string& reason) const { in_.fail_at(place_, reason); }

  private:
    template <class Result>
    Result value(Scalar type) {
        switch (type) {
        case Scalar::int8: return static_cast<Result>(in_.take<std::int8_t>());
        case Scalar::uint8: return static_cast<Result>(in_.take<std::uint8_t>());
        case Scalar::int16: return static_cast<Result>(in_.take<std::int16_t>());
        case Scalar::uint16: return static_cast<Result>(in_.take<std::uint16_t>());
        case Scalar::int32: return static_cast<Result>(in_.take<std::int32_t>());
        case Scalar::uint32: return static_cast<Result>(in_.take<std::uint32_t>());
        case Scalar::float32: return static_cast<Result>(in_.take<float>());
        case Scalar::float64: break;
        }
        return static_cast<Result>(in_.take<double>());
    }
    BinaryInput& in_;
    std::size_t place_ = 0;
};

template <class Values>
class BodyReader {
  public:
    explicit BodyReader(Values values) : values_(std::move(values)) {}

    TriangleMesh read(const Header& header) {
        for (const Element& e : header.elements)
            for (std::int64_t i = 0; i < e.count; ++i) read_row(e);
        values_.end_file();
        if (mesh_.triangles.empty()) values_.fail("the file has no faces");
        // Faces may stand before the vertices: only now is the number of vertices known.
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            for (std::int32_t v : mesh_.triangles[t])
                if (v < 0 || static_cast<std::size_t>(v) >= mesh_.vertices.size())
                    values_.fail_at(places_[t], out_of_range_text(v, mesh_.vertices.size()));
        return std::move(mesh_);
    }

  private:
    void read_row(const Element& e) {
        values_.begin_row();
        Vec3 v;
        for (const Property& p : e.properties) {
            if (p.count_type)
                read_list(p);
            else if (p.role == Role::skip)
                skip(p.type);
            else
                (p.role == Role::x ? v.x : p.role == Role::y ? v.y : v.z) = coordinate(p.type);
        }
        values_.end_row();
        if (e.name == "vertex") mesh_.vertices.push_back(v);
    }

    void skip(Scalar type) { values_.number(type); }

    double coordinate(Scalar type) {
        const double x = values_.number(type);
        if (!std::isfinite(x)) values_.fail("a coordinate is not finite");
        return x;
    }

    void read_list(const Property& p) {
        const std::int64_t count = values_.integer(*p.count_type);
        if (count < 0) values_.fail("a list has a negative length");
        if (p.role != Role::corners) {
            for (std::int64_t i = 0; i < count; ++i) skip(p.type);
            return;
        }
        if (count < 3) values_.fail("a face needs at least 3 corners");
        const std::int32_t first = corner(p.type);
        std::int32_t previous = corner(p.type);
        for (std::int64_t i = 2; i < count; ++i) {
            const std::int32_t next = corner(p.type);
            mesh_.triangles.push_back({first, previous, next});
            places_.push_back(values_.place());
            previous = next;
        }
    }

    std::int32_t corner(Scalar type) {
        const std::int64_t v = values_.integer(type);
        if (v < 0 || v > std::numeric_limits<std::int32_t>::max())
            values_.fail("index " + std::to_string(v) + " is out of range");
        return static_cast<std::int32_t>(v);
    }

    Values values_;
    TriangleMesh mesh_;
    std::vector<std::size_t> places_; ///< of each triangle, for messages
};

} // namespace

TriangleMesh read_ply(const std::filesystem::path& path, const std::string& data) {
    TextInput text(path, data);
    const Header header = read_header(text);
    if (header.format == Format::ascii) return BodyReader(AsciiValues(text)).read(header);
    const std::endian order = header.format == Format::little_endian ? std::endian::little : std::endian::big;
    BinaryInput binary(path, data, text.position(), order);
    return BodyReader(BinaryValues(binary)).read(header);
}

} // namespace flotilla
