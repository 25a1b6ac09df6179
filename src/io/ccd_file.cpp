// SPDX-License-Identifier: MIT
#include "io/ccd_file.hpp"

#include <flotilla/error.hpp>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace flotilla {
namespace {

constexpr std::size_t kCoordinates = 24;
constexpr std::size_t kCsvFields = kCoordinates + 4; // kind, coordinates, expected, toi, source
constexpr std::size_t kBinFields = kCoordinates + 3; // without source

/// Where in a file something is wrong.
struct Place {
    const std::filesystem::path& path;
    const char* unit; ///< "line" or "row"
    std::size_t number;

    [[noreturn]] void fail(const std::string& reason) const {
        throw InputError(path.string() + ":" + std::to_string(number) + ": " + unit + " " + std::to_string(number) +
                         ": " + reason);
    }
};

std::string read_all(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in || std::filesystem::is_directory(path)) throw IoError("cannot open " + path.string());
    std::string content{std::istreambuf_iterator<char>(in), {}};
    if (in.bad()) throw IoError("cannot read " + path.string());
    return content;
}

std::vector<std::string_view> split_fields(std::string_view line) {
    std::vector<std::string_view> fields;
    for (std::size_t start = 0;;) {
        const std::size_t comma = line.find(',', start);
        fields.push_back(line.substr(start, comma == std::string_view::npos ? comma : comma - start));
        if (comma == std::string_view::npos) return fields;
        start = comma + 1;
    }
}

double parse_number(std::string_view text, const Place& place, const char* what) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // from_chars refuses numbers beyond the range of double, at both ends, instead of rounding them to infinity or
    // zero.
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
        place.fail(std::string(what) + " is not a finite number: '" + std::string(text) + "'");
    return value;
}

void set_coordinate(CcdQuery& query, std::size_t index, double value) {
    Vec3& point = index < kCoordinates / 2 ? query.x0[index / 3] : query.x1[index / 3 - 4];
    (index % 3 == 0 ? point.x : index % 3 == 1 ? point.y : point.z) = value;
}

void set_toi(CcdFileRow& row, double toi, const Place& place) {
    if (!(toi >= 0 && toi <= 1)) place.fail("toi is not in [0, 1]");
    if (!row.expected) place.fail("toi is given, but no hit is expected");
    row.toi = toi;
}

CcdFileRow parse_csv_row(std::string_view line, const Place& place) {
    const auto fields = split_fields(line);
    if (fields.size() != kCsvFields)
        place.fail("expected " + std::to_string(kCsvFields) + " columns, found " + std::to_string(fields.size()));
    CcdFileRow row;
    if (fields[0] != "VF" && fields[0] != "EE") place.fail("kind is not VF or EE: '" + std::string(fields[0]) + "'");
    row.kind = fields[0] == "VF" ? CcdKind::vertex_face : CcdKind::edge_edge;
    for (std::size_t i = 0; i < kCoordinates; ++i)
        set_coordinate(row.query, i, parse_number(fields[i + 1], place, "coordinate"));
    const std::string_view expected = fields[kCoordinates + 1], toi = fields[kCoordinates + 2];
    if (expected != "0" && expected != "1") place.fail("expected is not 0 or 1: '" + std::string(expected) + "'");
    row.expected = expected == "1";
    if (!toi.empty()) set_toi(row, parse_number(toi, place, "toi"), place);
    return row;
}

std::vector<CcdFileRow> parse_csv(const std::string& content, const std::filesystem::path& path) {
    std::vector<CcdFileRow> rows;
    std::string_view rest = content;
    for (std::size_t number = 1; !rest.empty(); ++number) {
        const std::size_t end = rest.find('\n');
        std::string_view line = rest.substr(0, end);
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        const Place place{path, "line", number};
        if (number > 1) {
            rows.push_back(parse_csv_row(line, place));
        } else if (!line.starts_with("kind,") || split_fields(line).size() != kCsvFields) {
            place.fail("header is not 'kind,<24 coordinates>,expected,toi,source'");
        }
    }
    if (content.empty()) Place{path, "line", 1}.fail("the file is empty");
    return rows;
}

double little_endian_double(const char* bytes) {
    std::uint64_t bits = 0;
    for (std::size_t i = 8; i-- > 0;) bits = (bits << 8) | static_cast<unsigned char>(bytes[i]);
    return std::bit_cast<double>(bits);
}

CcdFileRow parse_bin_row(const char* bytes, const Place& place) {
    std::array<double, kBinFields> value{};
    for (std::size_t i = 0; i < kBinFields; ++i) value[i] = little_endian_double(bytes + 8 * i);
    CcdFileRow row;
    if (value[0] != 0 && value[0] != 1) place.fail("kind is not 0 (VF) or 1 (EE)");
    row.kind = value[0] == 0 ? CcdKind::vertex_face : CcdKind::edge_edge;
    for (std::size_t i = 0; i < kCoordinates; ++i) {
        if (!std::isfinite(value[i + 1])) place.fail("coordinate is not a finite number");
        set_coordinate(row.query, i, value[i + 1]);
    }
    const double expected = value[kCoordinates + 1], toi = value[kCoordinates + 2];
    if (expected != 0 && expected != 1) place.fail("expected is not 0 or 1");
    row.expected = expected == 1;
    if (toi != -1) set_toi(row, toi, place);
    return row;
}

std::vector<CcdFileRow> parse_bin(const std::string& content, const std::filesystem::path& path) {
    constexpr std::size_t kRowBytes = 8 * kBinFields;
    const std::size_t count = content.size() / kRowBytes;
    if (content.size() % kRowBytes != 0)
        Place{path, "row", count + 1}.fail("the file ends inside a row of " + std::to_string(kRowBytes) + " bytes");
    std::vector<CcdFileRow> rows;
    rows.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        rows.push_back(parse_bin_row(content.data() + i * kRowBytes, {path, "row", i + 1}));
    return rows;
}

} // namespace

std::vector<CcdFileRow> read_ccd_file(const std::filesystem::path& path) {
    const std::string content = read_all(path);
    if (path.extension() == ".bin") return parse_bin(content, path);
    if (path.extension() == ".csv") return parse_csv(content, path);
    throw InputError(path.string() + ": the name must end in .csv or .bin");
}

} // namespace flotilla
