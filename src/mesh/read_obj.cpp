// SPDX-License-Identifier: MIT
// Wavefront OBJ: v, f, l (segments) and p (points) are read, o and g where one object or group is asked for; texture,
// normal and material statements are skipped; anything else is refused.
#include <algorithm>
#include <array>
#include <limits>

#include "base/text.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/text_input.hpp"

namespace flotilla {
namespace {

constexpr std::array<std::string_view, 13> kSkipped{"vt",  "vn",     "vp",     "s",     "mg",       "usemtl",  "mtllib",
                                                    "lod", "usemap", "maplib", "bevel", "c_interp", "d_interp"};

/// A face may name a vertex that only follows later in the file: such indices are checked at the end.
struct ForwardReference {
    std::int64_t index; ///< counted from 1, as in the file
    std::size_t line;
};

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// Which faces are taken: all, or those of one object or group.
class PartChoice {
  public:
    explicit PartChoice(std::string_view wanted) : wanted_(wanted), taken_(wanted.empty()) {}

    [[nodiscard]] bool taken() const { return taken_; }
    [[nodiscard]] bool found() const { return found_ || wanted_.empty(); }
    [[nodiscard]] std::string_view wanted() const { return wanted_; }
    [[nodiscard]] std::string refusal() const { return unknown_name("object or group", wanted_, names_); }

    /// Names may hold blanks.
    void object(std::string_view name) {
        in_object_ = is_wanted(trimmed(name));
        in_group_ = false; // groups of the object before
        choose();
    }
    /// A face may belong to several groups; a name with blanks is taken whole as well.
    void groups(std::string_view names) {
        in_group_ = is_wanted(trimmed(names));
        for (std::string_view name = take_word(names); !name.empty(); name = take_word(names))
            in_group_ |= is_wanted(name);
        choose();
    }

  private:
    bool is_wanted(std::string_view name) {
        if (wanted_.empty() || name.empty()) return false;
        names_.push_back(name);
        return name == wanted_;
    }
    void choose() {
        taken_ = wanted_.empty() || in_object_ || in_group_;
        found_ |= taken_;
    }

    std::string_view wanted_;
    bool taken_, found_ = false, in_object_ = false, in_group_ = false;
    std::vector<std::string_view> names_; ///< that the file has, for the message about one that it has not
};

struct ObjReader {
    TextInput in;
    PartChoice part;
    TriangleMesh mesh{};
    std::vector<ForwardReference> forward{};

    void read(bool may_be_cloud = false) {
        while (const auto line = in.next_line()) {
            std::string_view rest = line->substr(0, line->find('#'));
            statement(take_word(rest), rest);
        }
        for (const ForwardReference& f : forward)
            if (f.index > static_cast<std::int64_t>(mesh.vertices.size()))
                in.fail_at(f.line, out_of_range_text(f.index, mesh.vertices.size()));
        if (!part.found()) in.fail(part.refusal());
        if (mesh.triangles.empty() && !(may_be_cloud && !mesh.vertices.empty()))
            in.fail((part.wanted().empty() ? "the file" : in_quotes(part.wanted())) + " has no faces, lines or points");
    }

    void statement(std::string_view keyword, std::string_view rest) {
        if (keyword == "v") return vertex(rest);
        if (keyword == "f") return face(rest);
        if (keyword == "l") return line(rest);
        if (keyword == "p") return points(rest);
        if (keyword == "o") return part.object(rest);
        if (keyword == "g") return part.groups(rest);
        if (keyword.empty() || std::find(kSkipped.begin(), kSkipped.end(), keyword) != kSkipped.end()) return;
        in.fail("unknown statement '" + std::string(keyword) + "'");
    }

    /// x y z, then nothing, a weight, a colour, or both.
    void vertex(std::string_view rest) {
        Vec3 v;
        for (double* x : {&v.x, &v.y, &v.z}) *x = in.coordinate(take_word(rest));
        int extra = 0;
        for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest), ++extra) in.number(word);
        if (extra == 2 || extra > 4) in.fail("a vertex has 3 coordinates, this one " + std::to_string(3 + extra));
        mesh.vertices.push_back(v);
    }

    void face(std::string_view rest) {
        const std::string_view w0 = take_word(rest), w1 = take_word(rest);
        std::string_view w2 = take_word(rest);
        if (w2.empty()) in.fail("a face needs at least 3 corners");
        const std::int32_t first = corner(w0);
        std::int32_t previous = corner(w1);
        for (; !w2.empty(); w2 = take_word(rest)) {
            const std::int32_t next = corner(w2);
            if (part.taken()) mesh.triangles.push_back({first, previous, next});
            previous = next;
        }
    }

    void line(std::string_view rest) {
        std::int32_t previous = corner(take_word(rest));
        std::string_view word = take_word(rest);
        if (word.empty()) in.fail("a line needs at least 2 ends");
        for (; !word.empty(); word = take_word(rest)) {
            const std::int32_t next = corner(word);
            if (next == previous) in.fail("a line from a vertex to itself");
            if (part.taken()) mesh.triangles.push_back(segment_element(previous, next));
            previous = next;
        }
    }

    void points(std::string_view rest) {
        std::string_view word = take_word(rest);
        if (word.empty()) in.fail("needs at least 1 vertex");
        for (; !word.empty(); word = take_word(rest)) {
            const std::int32_t at = corner(word);
            if (part.taken()) mesh.triangles.push_back(point_element(at));
        }
    }

    /// i, i/j, i//k or i/j/k: the vertex index i counts from 1, or backwards from the latest vertex where negative.
    std::int32_t corner(std::string_view word) {
        const std::size_t slash = std::min(word.find('/'), word.size());
        std::int64_t index = in.integer(word.substr(0, slash));
        check_attributes(word, slash);
        const auto count = static_cast<std::int64_t>(mesh.vertices.size());
        if (index == 0) in.fail("index 0 is out of range, indices count from 1");
        if (index < -count || index > std::numeric_limits<std::int32_t>::max())
            in.fail(out_of_range_text(index, mesh.vertices.size()));
        if (index < 0) index += count + 1;
        if (index > count) forward.push_back({index, in.line()});
        return static_cast<std::int32_t>(index - 1);
    }

    void check_attributes(std::string_view word, std::size_t slash) const {
        for (int field = 1; slash < word.size(); ++field) {
            const std::size_t next = std::min(word.find('/', slash + 1), word.size());
            const std::string_view attribute = word.substr(slash + 1, next - slash - 1);
            const bool may_be_empty = field == 1 && next < word.size();
            if (field > 2 || (attribute.empty() ? !may_be_empty : !parse_integer(attribute)))
                in.fail("malformed corner '" + std::string(word) + "'");
            slash = next;
        }
    }
};

} // namespace

TriangleMesh read_obj(const std::filesystem::path& path, const std::string& data) {
    ObjReader reader{TextInput(path, data), PartChoice({})};
    reader.read();
    return std::move(reader.mesh);
}

TriangleMesh read_obj_cloud(const std::filesystem::path& path, const std::string& data) {
    ObjReader reader{TextInput(path, data), PartChoice({})};
    reader.read(true);
    return std::move(reader.mesh);
}

TriangleMesh read_obj_part(const std::filesystem::path& path, const std::string& data, std::string_view part) {
    ObjReader reader{TextInput(path, data), PartChoice(part)};
    reader.read();
    return without_unused_vertices(reader.mesh);
}

} // namespace flotilla
