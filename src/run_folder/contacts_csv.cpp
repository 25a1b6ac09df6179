// SPDX-License-Identifier: MIT
#include "run_folder/contacts_csv.hpp"

#include <initializer_list>
#include <string>

#include "base/vec3.hpp"
#include "io/number.hpp"

namespace flotilla::io {

namespace {

/// "first,second" and then ",x" for each value.
template <class First, class Second>
void append_row(std::string& text, First first, Second second, std::initializer_list<double> values) {
    append_number(text, first);
    text += ',';
    append_number(text, second);
    for (const double value : values) {
        text += ',';
        append_number(text, value);
    }
}

/// What is under temporary names is put in place, as the names are used again: a process that ends while it copies
/// loses nothing. The path.
const std::filesystem::path& in_place(const std::filesystem::path& path, const EarlierContacts& earlier) {
    const auto put = [](const std::filesystem::path& file, const std::filesystem::path& found) {
        if (!found.empty() && found == temporary_name(file)) take_temporary(file);
    };
    put(path, earlier.contacts);
    put(contact_totals_path(path), earlier.totals);
    return path;
}

void copy_rows(const std::filesystem::path& from, std::int64_t last_step, OutputStream& out) {
    WholeLines lines(from);
    (void)lines.next(); // the header
    for (std::string_view line; !(line = lines.next()).empty();) {
        std::int64_t step = 0;
        if (!parse_number(line.substr(0, line.find(',')), step) || step > last_step) return;
        out.write(line);
    }
}

} // namespace

std::filesystem::path contact_totals_path(const std::filesystem::path& contacts) {
    std::string name = contacts.filename().string(), end;
    for (const std::string_view extension : {".gz", ".csv"})
        if (name.ends_with(extension)) {
            end.insert(0, extension);
            name.resize(name.size() - extension.size());
        }
    return contacts.parent_path() / (name + "-bodies" + end);
}

ContactsCsv::ContactsCsv(const std::filesystem::path& path) : out_(path), totals_out_(contact_totals_path(path)) {
    out_.write(std::string(kContactsHeader) + "\n");
    totals_out_.write(std::string(kContactTotalsHeader) + "\n");
}

ContactsCsv::ContactsCsv(const std::filesystem::path& path, const EarlierContacts& earlier)
    : ContactsCsv(in_place(path, earlier)) {
    if (!earlier.contacts.empty()) copy_rows(path, earlier.step, out_);
    if (!earlier.totals.empty()) copy_rows(contact_totals_path(path), earlier.step, totals_out_);
    rows_ = earlier.rows;
}

void ContactsCsv::add(std::int64_t step, double time, std::span<const ContactState> contacts) {
    std::string text;
    totals_.clear();
    for (const ContactState& c : contacts) {
        const double along = dot(c.impulse, c.normal), across = length(c.impulse - along * c.normal);
        text.clear();
        append_row(text, step, time, {});
        text += ',';
        append_row(text, c.body_a, c.body_b,
                   {c.point.x, c.point.y, c.point.z, c.normal.x, c.normal.y, c.normal.z, c.distance, along, across});
        text += c.asleep ? ",1\n" : ",0\n";
        out_.write(text);
        ++rows_.contacts;
        for (const std::int32_t body : {c.body_a, c.body_b}) {
            Total& total = totals_[body];
            ++total.contacts;
            total.normal += along;
            total.tangential += across;
            total.impulse += body == c.body_b ? c.impulse : -c.impulse;
        }
    }
    add_totals(step, time);
}

void ContactsCsv::add_totals(std::int64_t step, double time) {
    std::string text;
    for (const auto& [body, total] : totals_) {
        text.clear();
        append_row(text, step, time, {});
        text += ',';
        append_row(text, body, total.contacts,
                   {total.normal, total.tangential, total.impulse.x, total.impulse.y, total.impulse.z});
        totals_out_.write(text += '\n');
        ++rows_.totals;
    }
}

ContactRows ContactsCsv::flush() {
    out_.flush();
    totals_out_.flush();
    return rows_;
}

void ContactsCsv::sync() {
    out_.sync();
    totals_out_.sync();
}

void ContactsCsv::close() {
    out_.close();
    totals_out_.close();
}

} // namespace flotilla::io
