// SPDX-License-Identifier: MIT
#include "io/contacts_csv.hpp"

#include "base/vec3.hpp"
#include "io/number.hpp"

namespace flotilla::io {

ContactsCsv::ContactsCsv(const std::filesystem::path& path) : out_(path) {
    out_.write(kContactsHeader);
    out_.write("\n");
}

void ContactsCsv::add(std::int64_t step, double time, std::span<const ContactState> contacts) {
    std::string text;
    for (const ContactState& c : contacts) {
        const double along = dot(c.impulse, c.normal);
        text.clear();
        append_number(text, step);
        text += ',';
        append_number(text, time);
        for (const std::int32_t body : {c.body_a, c.body_b}) {
            text += ',';
            append_number(text, body);
        }
        for (const double value : {c.point.x, c.point.y, c.point.z, c.normal.x, c.normal.y, c.normal.z, c.distance,
                                   along, length(c.impulse - along * c.normal)}) {
            text += ',';
            append_number(text, value);
        }
        out_.write(text += '\n');
    }
}

} // namespace flotilla::io
