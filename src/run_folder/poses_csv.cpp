// SPDX-License-Identifier: MIT
#include "run_folder/poses_csv.hpp"

#include <cerrno>
#include <system_error>

#include <flotilla/error.hpp>

#include "io/number.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla::io {
namespace {

constexpr std::size_t kColumns = 17;

/// A CSV field; quoted only where it must be.
std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
    std::string text = "\"";
    for (const char c : field) text.append(c == '"' ? 2 : 1, c);
    return text + '"';
}

/// The fields of a line. False where a quote does not end.
bool split(const std::string& line, std::vector<std::string>& fields) {
    fields.assign(1, "");
    bool inside = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (inside && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            fields.back() += line[++i];
        } else if (c == '"') {
            inside = !inside;
        } else if (c == ',' && !inside) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return !inside;
}

} // namespace

std::string poses_csv_rows(const Frame& frame, std::span<const std::string> names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        append_number(text, frame.index);
        text += ',';
        append_number_17(text, frame.time);
        text += ',';
        append_number(text, i);
        text.append(",").append(quoted(names[i]));
        const Vec3 &p = frame.position[i], &v = frame.velocity[i], &w = frame.angular_velocity[i];
        const Quat& q = frame.rotation[i];
        for (const double value : {p.x, p.y, p.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z}) {
            text += ',';
            append_number_17(text, value);
        }
        text += '\n';
    }
    return text;
}

PosesCsvReader::PosesCsvReader(const std::filesystem::path& path, std::vector<std::string> names)
    : path_(path), file_(path, std::ios::binary), names_(std::move(names)) {
    if (!file_)
        throw IoError(path.string() + ": cannot open: " + std::error_code(errno, std::generic_category()).message());
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
    std::string line;
    if (!read_line(line) || line != kPosesHeader) fail("the header must be \"" + std::string(kPosesHeader) + "\"");
    has_row_ = read_row();
}

void PosesCsvReader::fail(const std::string& reason) const {
    throw InputError(path_.string() + ":" + std::to_string(line_) + ": " + reason);
}

bool PosesCsvReader::read_line(std::string& line) {
    ++line_;
    if (!std::getline(file_, line)) {
        if (file_.bad()) throw IoError(path_.string() + ": cannot read");
        return false;
    }
    position_ += line.size() + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
}

bool PosesCsvReader::read_row() {
    std::string line;
    if (!read_line(line)) return false;
    std::vector<std::string> fields;
    if (!split(line, fields)) fail("a quote does not end");
    if (fields.size() != kColumns)
        fail(std::to_string(fields.size()) + " columns instead of " + std::to_string(kColumns));
    const auto number = [&](std::size_t column, auto& value) {
        if (!parse_number(fields[column], value)) fail("\"" + fields[column] + "\" is not a number");
    };
    number(0, row_.frame);
    number(1, row_.time);
    number(2, row_.body);
    if (row_.body < 0 || row_.body >= static_cast<std::int64_t>(names_.size()))
        fail("body " + fields[2] + " is not in the scene, which has " + std::to_string(names_.size()));
    if (const auto& name = names_[static_cast<std::size_t>(row_.body)]; fields[3] != name)
        fail("body " + fields[2] + " is called \"" + fields[3] + "\" here and \"" + name + "\" in the scene");
    for (std::size_t k = 0; k < row_.values.size(); ++k) number(k + 4, row_.values[k]);
    return true;
}

bool PosesCsvReader::next(Frame& frame) {
    if (!has_row_) return false;
    const std::size_t n = names_.size();
    frame = Frame{row_.frame, 0, row_.time, {}, {}, {}, {}, {}, {}};
    frame.position.resize(n), frame.rotation.resize(n), frame.velocity.resize(n), frame.angular_velocity.resize(n);
    std::vector<bool> seen(n, false);
    while (has_row_ && row_.frame == frame.index) {
        const auto body = static_cast<std::size_t>(row_.body);
        if (seen[body])
            fail("body " + std::to_string(row_.body) + " stands twice in frame " + std::to_string(row_.frame));
        if (row_.time != frame.time) fail("two times in frame " + std::to_string(row_.frame));
        seen[body] = true;
        const auto& v = row_.values;
        frame.position[body] = {v[0], v[1], v[2]};
        frame.rotation[body] = {v[3], v[4], v[5], v[6]};
        frame.velocity[body] = {v[7], v[8], v[9]};
        frame.angular_velocity[body] = {v[10], v[11], v[12]};
        has_row_ = read_row();
    }
    if (has_row_ && row_.frame < frame.index) fail("frames must be in ascending order");
    check_complete(frame, seen);
    return true;
}

void PosesCsvReader::check_complete(const Frame& frame, const std::vector<bool>& seen) const {
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (!seen[i])
            throw InputError(path_.string() + ": frame " + std::to_string(frame.index) + " has no row for body " +
                             std::to_string(i) + " (\"" + names_[i] + "\")");
}

} // namespace flotilla::io
