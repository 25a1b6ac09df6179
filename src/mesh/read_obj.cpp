// SPDX-License-Identifier: MIT
// Wavefront OBJ: v and f are read; texture, normal, grouping, material, line and point statements are skipped; anything
// else is refused.
#include <algorithm>
#include <array>
#include <limits>

#include "mesh/text_input.hpp"

namespace flotilla {
namespace {

constexpr std::array<std::string_view, 17> kSkipped{"vt",     "vn",     "vp",     "g",        "o",       "s",
                                                    "mg",     "usemtl", "mtllib", "l",        "p",       "lod",
                                                    "usemap", "maplib", "bevel",  "c_interp", "d_interp"};

/// A face may name a vertex that only follows later in the file: such indices are checked at the end.
struct ForwardReference {
    std::int64_t index; ///< counted from 1, as in the file
    std::size_t line;
};

struct ObjReader {
    TextInput in;
    TriangleMesh mesh;
    std::vector<ForwardReference> forward;

    void read() {
        while (const auto line = in.next_line()) {
            std::string_view rest = line->substr(0, line->find('#'));
            statement(take_word(rest), rest);
        }
        for (const ForwardReference& f : forward)
            if (f.index > static_cast<std::int64_t>(mesh.vertices.size()))
                in.fail_at(f.line, out_of_range_text(f.index, mesh.vertices.size()));
        if (mesh.triangles.empty()) in.fail("the file has no faces");
    }

    void statement(std::string_view keyword, std::string_view rest) {
        if (keyword == "v") return vertex(rest);
        if (keyword == "f") return face(rest);
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
            mesh.triangles.push_back({first, previous, next});
            previous = next;
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
        for (int part = 1; slash < word.size(); ++part) {
            const std::size_t next = std::min(word.find('/', slash + 1), word.size());
            const std::string_view attribute = word.substr(slash + 1, next - slash - 1);
            const bool may_be_empty = part == 1 && next < word.size();
            if (part > 2 || (attribute.empty() ? !may_be_empty : !parse_integer(attribute)))
                in.fail("malformed corner '" + std::string(word) + "'");
            slash = next;
        }
    }
};

} // namespace

TriangleMesh read_obj(const std::filesystem::path& path, const std::string& data) {
    ObjReader reader{TextInput(path, data), {}, {}};
    reader.read();
    return std::move(reader.mesh);
}

} // namespace flotilla
