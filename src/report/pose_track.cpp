// SPDX-License-Identifier: MIT
#include "report/pose_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <variant>

#include <zlib.h>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "parallel/in_order.hpp"

namespace flotilla::report {
namespace {

constexpr std::size_t kWords = 8;
constexpr double kPositionSteps = 65535, kSpeedSteps = 65535, kRotationSteps = 32767;
using Words = std::array<std::uint16_t, kWords>;

/// A zlib stream that grows in memory.
class Deflate {
  public:
    Deflate() {
        if (deflateInit(&stream_, Z_DEFAULT_COMPRESSION) != Z_OK) throw IoError("zlib: cannot start");
    }
    ~Deflate() { deflateEnd(&stream_); }
    Deflate(const Deflate&) = delete;
    Deflate& operator=(const Deflate&) = delete;

    void add(std::span<const std::uint8_t> bytes) { run(bytes, Z_NO_FLUSH); }
    [[nodiscard]] std::vector<std::byte> finish() {
        run({}, Z_FINISH);
        return std::move(out_);
    }

  private:
    void run(std::span<const std::uint8_t> bytes, int flush) {
        std::array<std::byte, 1u << 16> chunk;
        // zlib's interface is older than const; it does not write to its input.
        stream_.next_in = const_cast<Bytef*>(bytes.data());
        stream_.avail_in = static_cast<uInt>(bytes.size());
        do {
            stream_.next_out = reinterpret_cast<Bytef*>(chunk.data());
            stream_.avail_out = static_cast<uInt>(chunk.size());
            if (deflate(&stream_, flush) == Z_STREAM_ERROR) throw IoError("zlib: cannot compress");
            out_.insert(out_.end(), chunk.begin(), chunk.end() - stream_.avail_out);
        } while (stream_.avail_out == 0);
    }

    z_stream stream_{};
    std::vector<std::byte> out_;
};

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
    Vec3 high = -low;
    void add(const Vec3& p) { low = min(low, p), high = max(high, p); }
    [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
};

bool is_finite(const Quat& q) { return std::isfinite(q.w + q.x + q.y + q.z); }

/// The placement of one body in one frame.
struct Placement {
    Vec3 middle; ///< r, m, world
    Quat rotation;
    double speed = 0; ///< m/s
    bool finite = true;
    bool there = true;
};

/// Reads frames and hands out what the page shows of them.
class Source {
  public:
    Source(io::RunReader& run, const DrawOrder& order) : order_(order) {
        const io::RunScene& scene = run.scene();
        std::vector<Vec3> middles;
        for (const io::RunShape& shape : scene.shapes) middles.push_back(middle(shape.mesh));
        for (const std::int32_t body : order.bodies)
            middles_.push_back(
                middles.at(static_cast<std::size_t>(scene.bodies.at(static_cast<std::size_t>(body)).shape)));
    }
    [[nodiscard]] Placement at(const io::Frame& frame, std::size_t i) const {
        const auto body = static_cast<std::size_t>(order_.bodies[i]);
        if (frame.absent(body)) return {{}, {}, 0, true, false};
        Placement placement{frame.position[body], frame.rotation[body], length(frame.velocity[body])};
        placement.finite = flotilla::is_finite(placement.middle) && is_finite(placement.rotation);
        placement.rotation = placement.finite ? normalized(placement.rotation) : Quat{};
        if (!std::isfinite(placement.speed)) placement.speed = 0;
        placement.middle += rotate(placement.rotation, middles_[i]);
        return placement;
    }
    [[nodiscard]] std::size_t bodies() const { return middles_.size(); }

  private:
    const DrawOrder& order_;
    std::vector<Vec3> middles_; ///< c by body
};

/// A frame of the run with its placements, none where it is not shown; or what keeps it from being read.
struct PlacedFrame {
    double time = 0; ///< s
    std::vector<Placement> placements;
    std::string problem;
};

/// Every `frame_every`-th, and the last.
bool is_shown(const PoseTrack& track, std::int64_t k) {
    return k % track.frame_every == 0 || k + 1 == track.frames_in_run;
}

/// use(placed frame, k) for the given frames in order; they are read in order, and those that are shown placed side by
/// side.
template <class Use>
void placed_in_order(io::RunReader& run, const Source& source, const PoseTrack& track,
                     std::span<const std::int64_t> frames, int threads, Use&& use) {
    using Read = std::variant<io::Frame, std::string>;
    const auto read = [&](std::size_t k) -> Read {
        try {
            return run.frame(frames[k]);
        } catch (const IoError& error) {
            return error.what();
        }
    };
    const auto place = [&](const Read& item) {
        PlacedFrame placed;
        if (const auto* problem = std::get_if<std::string>(&item)) {
            placed.problem = *problem;
            return placed;
        }
        const auto& frame = std::get<io::Frame>(item);
        placed.time = frame.time;
        if (!is_shown(track, frame.index)) return placed;
        for (std::size_t i = 0; i < source.bodies(); ++i) placed.placements.push_back(source.at(frame, i));
        return placed;
    };
    in_order(frames.size(), threads, read, place,
             [&](const PlacedFrame& placed, std::size_t k) { use(placed, frames[k]); });
}

/// First pass: which frames can be read, and what they span.
std::vector<Box> survey(io::RunReader& run, const Source& source, int threads, PoseTrack& track) {
    std::vector<Box> boxes(source.bodies());
    std::int64_t not_finite = 0;
    std::vector<std::int64_t> all(static_cast<std::size_t>(track.frames_in_run)); // every loss is named
    std::iota(all.begin(), all.end(), 0);
    placed_in_order(run, source, track, all, threads, [&](const PlacedFrame& placed, std::int64_t k) {
        if (!placed.problem.empty()) {
            // A damaged segment gives the same message for each of its frames.
            if (track.problems.empty() || track.problems.back() != placed.problem)
                track.problems.push_back(placed.problem);
            return;
        }
        if (!is_shown(track, k)) return;
        track.frames.push_back(k);
        track.times.push_back(placed.time);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Placement& placement = placed.placements[i];
            not_finite += placement.finite ? 0 : 1;
            if (placement.finite && placement.there) boxes[i].add(placement.middle);
            track.top_speed = std::max(track.top_speed, placement.speed);
        }
    });
    if (not_finite > 0)
        track.problems.push_back(std::to_string(not_finite) + " poses are not finite; they are drawn at a wrong place");
    return boxes;
}

/// Float bounds that contain the box, about the middle of all of them.
void set_boxes(PoseTrack& track, std::span<Box> boxes) {
    Box all;
    for (const Box& box : boxes)
        if (!box.empty()) all.add(box.low), all.add(box.high);
    if (all.empty()) all.add({});
    track.origin = 0.5 * all.low + 0.5 * all.high;
    for (Box& box : boxes)
        if (box.empty()) box.add(track.origin);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const Box& box : boxes) {
        std::array<float, 3> low{}, extent{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int a = static_cast<int>(axis);
            const double from = component(box.low - track.origin, a), to = component(box.high - track.origin, a);
            low[axis] = static_cast<float>(from);
            if (static_cast<double>(low[axis]) > from) low[axis] = std::nextafter(low[axis], -kInfinity);
            extent[axis] = static_cast<float>(to - static_cast<double>(low[axis]));
            if (static_cast<double>(extent[axis]) < to - static_cast<double>(low[axis]))
                extent[axis] = std::nextafter(extent[axis], kInfinity);
        }
        track.boxes.insert(track.boxes.end(), low.begin(), low.end());
        track.boxes.insert(track.boxes.end(), extent.begin(), extent.end());
    }
}

std::uint16_t quantise(double part, double steps) {
    return static_cast<std::uint16_t>(std::lround(steps * std::clamp(part, 0.0, 1.0)));
}
std::uint16_t quantise_signed(double value) {
    return static_cast<std::uint16_t>(std::lround(kRotationSteps * std::clamp(value, -1.0, 1.0)));
}

/// As the shader does it, in single precision.
Vec3 decoded_middle(const Words& words, const float* box, const Vec3& origin) {
    std::array<double, 3> r{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        r[axis] = static_cast<double>(box[axis] + box[axis + 3] * (static_cast<float>(words[axis]) / 65535.0F));
    return origin + Vec3{r[0], r[1], r[2]};
}

Quat decoded_rotation(const Words& words) {
    const auto part = [&](std::size_t k) { return static_cast<double>(static_cast<std::int16_t>(words[k])); };
    return normalized({part(7), part(4), part(5), part(6)});
}

double angle_between(const Quat& a, const Quat& b) {
    const double chord = norm({a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z});
    return 4 * std::asin(std::min(1.0, chord / 2));
}

/// Second pass: words, differences, stream.
class Encoder {
  public:
    Encoder(std::size_t bodies, PoseTrack& track)
        : track_(track), last_words_(bodies), last_rotation_(bodies), bytes_(2 * kWords * bodies) {}

    void add(std::span<const Placement> placements) {
        const std::size_t n = placements.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Words words = words_of(placements[i], i);
            for (std::size_t w = 0; w < kWords; ++w) {
                const auto difference = static_cast<std::int16_t>(words[w] - last_words_[i][w]);
                const auto zigzag = static_cast<std::uint16_t>((difference * 2) ^ (difference >> 15));
                bytes_[2 * w * n + i] = static_cast<std::uint8_t>(zigzag & 255);
                bytes_[(2 * w + 1) * n + i] = static_cast<std::uint8_t>(zigzag >> 8);
            }
            last_words_[i] = words;
        }
        deflate_.add(bytes_);
    }
    [[nodiscard]] std::vector<std::byte> finish() { return deflate_.finish(); }

  private:
    Words words_of(const Placement& placement, std::size_t i) {
        if (!placement.there) return not_there(i);
        const float* box = &track_.boxes[6 * i];
        const Vec3 r = placement.middle - track_.origin;
        Words words{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto low = static_cast<double>(box[axis]), extent = static_cast<double>(box[axis + 3]);
            const double part = extent > 0 ? (component(r, static_cast<int>(axis)) - low) / extent : 0;
            words[axis] = quantise(part, kPositionSteps);
        }
        words[3] = quantise(track_.top_speed > 0 ? std::sqrt(placement.speed / track_.top_speed) : 0, kSpeedSteps);
        const Quat q = near_last(placement.rotation, i);
        words[4] = quantise_signed(q.x), words[5] = quantise_signed(q.y);
        words[6] = quantise_signed(q.z), words[7] = quantise_signed(q.w);
        if (placement.finite) {
            const double distance = length(decoded_middle(words, box, track_.origin) - placement.middle);
            track_.position_error = std::max(track_.position_error, distance);
            track_.rotation_error = std::max(track_.rotation_error, angle_between(decoded_rotation(words), q));
        }
        return words;
    }

    [[nodiscard]] Words not_there(std::size_t i) const {
        Words words = last_words_[i];
        std::fill(words.begin() + 4, words.end(), std::uint16_t{0});
        return words;
    }

    /// q and -q are the same rotation; the one nearer to the frame before keeps differences small.
    Quat near_last(Quat q, std::size_t i) {
        const Quat& last = last_rotation_[i];
        if (q.w * last.w + q.x * last.x + q.y * last.y + q.z * last.z < 0) q = {-q.w, -q.x, -q.y, -q.z};
        return last_rotation_[i] = q;
    }

    PoseTrack& track_;
    Deflate deflate_;
    std::vector<Words> last_words_;
    std::vector<Quat> last_rotation_;
    std::vector<std::uint8_t> bytes_;
};

std::int64_t automatic_frame_every(std::int64_t frames, std::size_t bodies) {
    const double bytes = static_cast<double>(frames) * static_cast<double>(bodies) * sizeof(Words);
    return std::max(std::int64_t{1}, static_cast<std::int64_t>(std::ceil(bytes / static_cast<double>(kPoseBytes))));
}

} // namespace

DrawOrder draw_order(const io::RunScene& scene) {
    DrawOrder order;
    order.bodies.resize(scene.bodies.size());
    std::iota(order.bodies.begin(), order.bodies.end(), 0);
    const auto key = [&](std::int32_t i) {
        const io::RunBody& body = scene.bodies[static_cast<std::size_t>(i)];
        return std::tuple(body.type != BodyType::dynamic, body.shape, i);
    };
    std::ranges::sort(order.bodies, {}, key);
    for (std::size_t i = 0; i < order.bodies.size(); ++i) {
        const auto [fixed, shape, body] = key(order.bodies[i]);
        if (order.groups.empty() || order.groups.back().shape != shape || order.groups.back().fixed != fixed)
            order.groups.push_back({shape, fixed, i, 0});
        ++order.groups.back().count;
    }
    return order;
}

Vec3 middle(const TriangleMesh& mesh) {
    Box box;
    for (const Vec3& v : mesh.vertices) box.add(v);
    return box.empty() ? Vec3{} : 0.5 * box.low + 0.5 * box.high;
}

PoseTrack encode_poses(io::RunReader& run, const DrawOrder& order, std::int64_t frame_every, int threads) {
    const Source source(run, order);
    PoseTrack track;
    track.frames_in_run = run.frames();
    track.frame_every = frame_every > 0 ? frame_every : automatic_frame_every(run.frames(), source.bodies());
    std::vector<Box> boxes = survey(run, source, threads, track);
    set_boxes(track, boxes);
    if (track.frames.empty() || boxes.empty()) return track;
    Encoder encoder(source.bodies(), track);
    placed_in_order(run, source, track, track.frames, threads, [&](const PlacedFrame& placed, std::int64_t) {
        if (!placed.problem.empty()) throw IoError(placed.problem);
        encoder.add(placed.placements);
    });
    track.stream = encoder.finish();
    return track;
}

} // namespace flotilla::report
