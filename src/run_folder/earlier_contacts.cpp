// SPDX-License-Identifier: MIT
#include "run_folder/earlier_contacts.hpp"

#include <string>
#include <string_view>
#include <system_error>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "io/number.hpp"
#include "run_folder/contacts_csv.hpp"
#include "run_folder/file_stream.hpp"

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNoRows = -1; // of that kind

/// Rows up to a step. What a process that was killed left may end before the header, or within a row of a later step.
std::int64_t count_rows(const fs::path& file, std::string_view header, std::int64_t last_step) {
    WholeLines lines(file);
    std::string_view line = lines.next();
    if (line.empty()) return 0;
    if (line.substr(0, line.size() - 1) != header) return kNoRows;
    std::int64_t count = 0;
    for (; !(line = lines.next()).empty(); ++count) {
        std::int64_t step = 0;
        if (!parse_number(line.substr(0, line.find(',')), step)) return kNoRows;
        if (step > last_step) break;
    }
    return count;
}

/// The file that has so many rows; empty: there is none at all. A run that was killed while it copied an earlier part
/// left less than that under the temporary name, and one killed later less under the other.
fs::path find_rows(const fs::path& path, std::string_view header, std::int64_t rows, std::int64_t step) {
    const fs::path temporary = temporary_name(path);
    if (temporary.empty()) return {}; // a pipe or a device
    bool other = false;
    std::error_code error;
    for (const fs::path& file : {path, temporary}) {
        if (!fs::exists(file, error)) continue;
        if (count_rows(file, header, step) == rows) return file;
        other = true;
    }
    if (other)
        throw InputError(path.string() + ": is not what the run wrote of its contacts up to step " +
                         std::to_string(step) + ", and would be lost; another file gets those of later steps");
    return {};
}

} // namespace

EarlierContacts find_earlier_contacts(const fs::path& contacts, const Checkpoint& checkpoint) {
    EarlierContacts earlier;
    earlier.step = checkpoint.step;
    earlier.rows = checkpoint.contacts.value_or(ContactRows{checkpoint.step + 1, 0, 0});
    const fs::path totals = contact_totals_path(contacts);
    earlier.contacts = find_rows(contacts, kContactsHeader, earlier.rows.contacts, earlier.step);
    earlier.totals = find_rows(totals, kContactTotalsHeader, earlier.rows.totals, earlier.step);
    if (earlier.contacts.empty() != earlier.totals.empty() && earlier.rows.contacts > 0)
        throw InputError((earlier.contacts.empty() ? contacts : totals).string() + ": is missing, and " +
                         (earlier.contacts.empty() ? totals : contacts).string() +
                         " is there: they are continued together, or begun under another name");
    if (earlier.contacts.empty()) earlier.rows = {checkpoint.step + 1, 0, 0};
    return earlier;
}

} // namespace flotilla::io
