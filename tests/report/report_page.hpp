// SPDX-License-Identifier: MIT
// Reads a report as its own script does: the data, and the poses from the differences. Written from the description of
// the format, not from the encoder.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "base/rotation.hpp"

namespace flotilla::test {

/// The text of the script element with this id.
inline std::string element_text(const std::string& html, const std::string& id) {
    const std::size_t at = html.find("id=\"" + id + "\">");
    if (at == std::string::npos) throw std::runtime_error("no element " + id);
    const std::size_t begin = html.find('>', at) + 1;
    return html.substr(begin, html.find("</script", begin) - begin);
}

inline std::vector<std::uint8_t> from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') break;
        bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
        count += 6;
        if (count >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
    }
    return bytes;
}

inline std::vector<float> floats_of(const std::string& text) {
    const auto bytes = from_base64(text);
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
    return values;
}

inline std::vector<std::uint8_t> inflated(const std::vector<std::uint8_t>& stream, std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    uLongf written = size;
    if (uncompress(bytes.data(), &written, stream.data(), stream.size()) != Z_OK || written != size)
        throw std::runtime_error("the poses do not inflate to their size");
    return bytes;
}

struct DecodedPose {
    Vec3 middle; ///< m
    Quat rotation;
    double speed = 0; ///< m/s
    bool there = true;
};

/// Poses as [frames][bodies], bodies in the page's order.
inline std::vector<std::vector<DecodedPose>> decode_poses(const std::vector<std::uint8_t>& stream, std::size_t frames,
                                                          const std::vector<float>& boxes, const Vec3& origin,
                                                          double top_speed) {
    const std::size_t bodies = boxes.size() / 6;
    const auto bytes = inflated(stream, frames * bodies * 16);
    std::vector<std::array<int, 8>> words(bodies); // of the frame before
    std::vector<std::vector<DecodedPose>> poses(frames, std::vector<DecodedPose>(bodies));
    const std::uint8_t* row = bytes.data();
    for (std::size_t k = 0; k < frames; ++k) {
        for (std::size_t w = 0; w < 8; ++w, row += 2 * bodies)
            for (std::size_t i = 0; i < bodies; ++i) {
                const int zigzag = row[i] + 256 * row[bodies + i];
                words[i][w] = (words[i][w] + (zigzag % 2 == 0 ? zigzag / 2 : -(zigzag + 1) / 2) + 65536) % 65536;
            }
        for (std::size_t i = 0; i < bodies; ++i) {
            const auto coordinate = [&](std::size_t axis) {
                return static_cast<double>(boxes[6 * i + axis]) +
                       static_cast<double>(boxes[6 * i + 3 + axis]) * words[i][axis] / 65535;
            };
            const auto part = [&](std::size_t w) { return words[i][w] < 32768 ? words[i][w] : words[i][w] - 65536; };
            poses[k][i].there = part(4) != 0 || part(5) != 0 || part(6) != 0 || part(7) != 0;
            poses[k][i].middle = origin + Vec3{coordinate(0), coordinate(1), coordinate(2)};
            poses[k][i].rotation = normalized({static_cast<double>(part(7)), static_cast<double>(part(4)),
                                               static_cast<double>(part(5)), static_cast<double>(part(6))});
            poses[k][i].speed = top_speed * words[i][3] / 65535 * words[i][3] / 65535;
        }
    }
    return poses;
}

} // namespace flotilla::test
