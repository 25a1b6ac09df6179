// SPDX-License-Identifier: MIT
#include "run_folder/frame_way.hpp"

#include <array>

#include <flotilla/error.hpp>

#include "base/vec3.hpp"
#include "io/file.hpp"
#include "io/flat.hpp"

namespace flotilla::io {
namespace {

/// Below this angle (rad) the shortest arc between two rounded rotations is the turn; nearer to pi it could be its
/// complement.
constexpr double kLargestShortArc = 3.0;

void append(std::vector<double>& to, std::span<const double> values) {
    to.insert(to.end(), values.begin(), values.end());
}

std::uint64_t way_checksum(const Way& way) {
    const auto of = [](auto span) { return checksum(std::as_bytes(span)); };
    std::vector<double> turns;
    for (const PathRotation& turn : way.turns) {
        turns.push_back(turn.body);
        append(turns, flat(std::span(&turn.rotation, 1)));
    }
    const std::array<std::uint64_t, 3> parts{of(std::span(way.position)), of(std::span(way.rotation)),
                                             of(std::span<const double>(turns))};
    return of(std::span(parts));
}

} // namespace

void append_long_turn(std::int32_t body, const Vec3& turn, std::vector<PathRotation>& to) {
    if (!(length(turn) <= kLargestShortArc)) to.push_back({body, turn});
}

void Way::append(const Vec3& at, const Quat& orientation, const Vec3& turn) {
    append_long_turn(static_cast<std::int32_t>(position.size()), turn, turns);
    position.push_back(at);
    rotation.push_back(orientation);
}

void WayWriter::append(std::size_t frame, const Way& way) {
    io::append(position_, flat(std::span(way.position)));
    io::append(rotation_, flat(std::span(way.rotation)));
    for (const PathRotation& turn : way.turns) {
        index_.insert(index_.end(), {static_cast<std::int32_t>(frame), turn.body});
        io::append(turn_, flat(std::span(&turn.rotation, 1)));
    }
    checksums_.push_back(way_checksum(way));
}

void WayWriter::write(Hdf5Writer& file, std::size_t inner_steps, std::size_t bodies) const {
    if (checksums_.empty()) return;
    const std::size_t frames = checksums_.size();
    const auto checked = Hdf5Writer::Checked::by_owner;
    file.write<double>("/way_position", position_, {frames, inner_steps, bodies, 3}, checked);
    file.write<double>("/way_rotation", rotation_, {frames, inner_steps, bodies, 4}, checked);
    file.write<std::uint64_t>("/way_checksum", checksums_, {frames});
    file.write<std::int32_t>("/way_index", index_, {index_.size() / 2, 2});
    file.write<double>("/way_turn", turn_, {turn_.size() / 3, 3});
}

void WayWriter::clear() {
    for (auto* values : {&position_, &rotation_, &turn_}) values->clear();
    index_.clear();
    checksums_.clear();
}

void WayReader::open(const Hdf5Reader& file, std::size_t frames, std::size_t inner_steps, std::size_t bodies) {
    *this = {};
    if (!file.has("/way_checksum")) return;
    checksums_ = file.read<std::uint64_t>("/way_checksum");
    index_ = file.read<std::int32_t>("/way_index");
    turn_ = file.read<double>("/way_turn");
    const std::vector<std::size_t> shape = file.shape("/way_position");
    if (shape != std::vector<std::size_t>{frames, inner_steps, bodies, 3} || checksums_.size() != frames ||
        index_.size() * 3 != turn_.size() * 2)
        throw IoError(file.path().string() + ": damaged: its inner steps are not those of its frames");
    places_ = inner_steps * bodies;
}

Way WayReader::read(const Hdf5Reader& file, std::size_t frame) const {
    Way way;
    if (places_ == 0) return way;
    way.position.resize(places_), way.rotation.resize(places_);
    file.read_row<double>("/way_position", frame, {reinterpret_cast<double*>(way.position.data()), 3 * places_});
    file.read_row<double>("/way_rotation", frame, {reinterpret_cast<double*>(way.rotation.data()), 4 * places_});
    for (std::size_t i = 0; 2 * i < index_.size(); ++i)
        if (index_[2 * i] == static_cast<std::int32_t>(frame))
            way.turns.push_back({index_[2 * i + 1], {turn_[3 * i], turn_[3 * i + 1], turn_[3 * i + 2]}});
    if (way_checksum(way) != checksums_[frame])
        throw IoError(file.path().string() + ": damaged: inner steps do not match their checksum");
    return way;
}

} // namespace flotilla::io
