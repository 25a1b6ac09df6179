// SPDX-License-Identifier: MIT
#include "picture/render.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <flotilla/error.hpp>

namespace flotilla {
namespace {

using Pixel = std::array<int, 3>;

TriangleMesh square(double half) {
    return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

PictureOptions small(double elevation = 89.9) {
    PictureOptions options;
    options.width = 96;
    options.height = 64;
    options.elevation = elevation;
    options.azimuth = -90;
    options.sun_samples = 4;
    options.sky_samples = 8;
    options.outlines = 0;
    return options;
}

Pixel pixel(const Image& image, int x, int y) {
    const auto i = 3 * static_cast<std::size_t>(y * image.width + x);
    return {image.rgb.at(i), image.rgb.at(i + 1), image.rgb.at(i + 2)};
}
Pixel middle(const Image& image) { return pixel(image, image.width / 2, image.height / 2); }
int brightness(const Pixel& p) { return p[0] + p[1] + p[2]; }
/// Colour regardless of brightness.
std::array<double, 3> hue(const Pixel& p) {
    const double sum = std::max(1, brightness(p));
    return {p[0] / sum, p[1] / sum, p[2] / sum};
}
double hue_distance(const Pixel& a, const Pixel& b) {
    const auto x = hue(a), y = hue(b);
    return std::abs(x[0] - y[0]) + std::abs(x[1] - y[1]) + std::abs(x[2] - y[2]);
}

/// Colour numbers of a reddish and of a bluish body, found by looking at them.
struct Colours {
    std::uint32_t red = 0, blue = 0;
    Colours() {
        const TriangleMesh mesh = square(1);
        int reddest = -1000, bluest = -1000;
        for (std::uint32_t seed = 0; seed < 24; ++seed) {
            const PictureBody body{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = seed};
            const Pixel p = middle(render({&body, 1}, small()));
            if (p[0] - p[2] > reddest) reddest = p[0] - p[2], red = seed;
            if (p[2] - p[0] > bluest) bluest = p[2] - p[0], blue = seed;
        }
    }
};
const Colours& colours() {
    static const Colours found;
    return found;
}

std::filesystem::path scratch(const std::string& name) {
    return std::filesystem::temp_directory_path() / ("flotilla_picture_" + std::to_string(getpid()) + "_" + name);
}

TEST(Picture, HasTheSizeAskedForAndShowsTheTriangleInTheMiddle) {
    const TriangleMesh mesh{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const PictureBody body{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = colours().red};
    const Image image = render({&body, 1}, small());
    EXPECT_EQ(image.width, 96);
    EXPECT_EQ(image.height, 64);
    ASSERT_EQ(image.rgb.size(), 96U * 64U * 3U);
    EXPECT_GT(middle(image)[0], middle(image)[2] + 40);
    EXPECT_GT(hue_distance(middle(image), pixel(image, 1, 1)), 0.1);
}

TEST(Picture, SegmentsAndPointsAreSeen) {
    const TriangleMesh cross{{{-1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}},
                             {segment_element(0, 1), segment_element(2, 3)}};
    const TriangleMesh cloud{{{-1, 0, -1}, {0, 0, 0}, {1, 0, 1}},
                             {point_element(0), point_element(1), point_element(2)}};
    for (const auto& [mesh, least] : {std::pair{cross, 40}, std::pair{cloud, 3}}) {
        const PictureBody body{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = colours().red};
        const Image image = render({&body, 1}, small());
        const Image empty = render({}, small());
        int drawn = 0;
        for (std::size_t i = 0; i < image.rgb.size(); i += 3) drawn += image.rgb[i] != empty.rgb[i] ? 1 : 0;
        EXPECT_GE(drawn, least);
        EXPECT_LT(drawn, 96 * 64 / 4) << "lines and dots, no more";
    }
}

TEST(Picture, NearerBodyHidesTheFartherWhateverTheOrder) {
    const TriangleMesh mesh = square(1);
    const PictureBody low{
        .mesh = &mesh, .position = {0, 0, 0}, .rotation = {}, .fixed = false, .colour = colours().blue};
    const PictureBody high{
        .mesh = &mesh, .position = {0, 0, 1}, .rotation = {}, .fixed = false, .colour = colours().red};
    const std::array lower_first{low, high}, upper_first{high, low};
    const Image a = render(lower_first, small()), b = render(upper_first, small());
    EXPECT_GT(middle(a)[0], middle(a)[2] + 40);
    EXPECT_EQ(middle(a), middle(b));
    PictureOptions below = small(-89.9);
    EXPECT_GT(middle(render(lower_first, below))[2], middle(render(lower_first, below))[0]);
}

TEST(Picture, ABodyAboveDarkensTheFloor) {
    const TriangleMesh floor = square(4), roof = square(1.5);
    PictureBody ground{.mesh = &floor, .position = {}, .rotation = {}, .fixed = true, .colour = 0};
    PictureBody cover{.mesh = &roof, .position = {0, 0, 1}, .rotation = {}, .fixed = false, .colour = 1};
    PictureOptions options = small(30);
    options.target = Vec3{0, 0, 0}; // the ray passes below the roof
    options.zoom = 3;
    const std::array open{ground};
    const std::array covered{ground, cover};
    const int bright = brightness(middle(render(open, options))), dark = brightness(middle(render(covered, options)));
    EXPECT_LT(dark, bright * 3 / 4);
    EXPECT_GT(dark, 0);
}

TEST(Picture, AnOpenFlatSurfaceIsEvenlyLit) {
    // A surface in its own shadow would show as spots.
    const TriangleMesh mesh = square(1);
    const PictureBody body{.mesh = &mesh, .position = {3e4, 2, 1}, .rotation = {}, .fixed = true, .colour = 0};
    const Image image = render({&body, 1}, small(60));
    int low = 1000, high = 0;
    for (int y = 24; y < 40; ++y)
        for (int x = 36; x < 60; ++x) {
            low = std::min(low, brightness(pixel(image, x, y)));
            high = std::max(high, brightness(pixel(image, x, y)));
        }
    EXPECT_LE(high - low, 3);
}

TEST(Picture, SidesOfAnEnclosureInFrontOfTheBodiesAreGlass) {
    // A box without a lid around a small square: seen from the side, the square shows through the near wall.
    TriangleMesh box;
    for (double z : {-2.0, 2.0})
        for (auto [x, y] : {std::array{-2.0, -2.0}, {2.0, -2.0}, {2.0, 2.0}, {-2.0, 2.0}})
            box.vertices.push_back({x, y, z});
    for (std::int32_t i = 0; i < 4; ++i) {
        const std::int32_t j = (i + 1) % 4;
        box.triangles.push_back({i, j, j + 4});
        box.triangles.push_back({i, j + 4, i + 4});
    }
    const TriangleMesh mesh = square(1.2);
    const Quat upright{std::sqrt(0.5), std::sqrt(0.5), 0, 0};
    const std::array bodies{
        PictureBody{.mesh = &box, .position = {}, .rotation = {}, .fixed = true, .colour = 0},
        PictureBody{.mesh = &mesh, .position = {}, .rotation = upright, .fixed = false, .colour = colours().red}};
    const Pixel p = middle(render(bodies, small(5)));
    EXPECT_GT(p[0], p[2] + 25);
}

TEST(Picture, IsTheSameEveryTime) {
    const TriangleMesh mesh = square(1);
    std::vector<PictureBody> bodies;
    for (std::uint32_t i = 0; i < 20; ++i)
        bodies.push_back({.mesh = &mesh,
                          .position = {0.3 * i, 0.1 * i * i, 0.2 * i},
                          .rotation = {1, 0.1 * i, 0, 0},
                          .fixed = false,
                          .colour = i});
    PictureOptions options = small(40);
    options.outlines = 1;
    EXPECT_EQ(render(bodies, options).rgb, render(bodies, options).rgb);
}

TEST(Picture, DoesNotDependOnPlaceOrScale) {
    const TriangleMesh mesh = square(1), tiny = square(std::ldexp(1.0, -30));
    const PictureBody at_origin{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = 5};
    const PictureBody far_away{
        .mesh = &mesh, .position = {1 << 20, -(1 << 21), 1 << 10}, .rotation = {}, .fixed = false, .colour = 5};
    const PictureBody shrunk{.mesh = &tiny, .position = {}, .rotation = {}, .fixed = false, .colour = 5};
    const Image image = render({&at_origin, 1}, small(40));
    EXPECT_EQ(render({&far_away, 1}, small(40)).rgb, image.rgb);
    EXPECT_EQ(render({&shrunk, 1}, small(40)).rgb, image.rgb);
}

TEST(Picture, ABodyThatFlewAwayDoesNotShrinkTheRest) {
    const TriangleMesh mesh = square(1);
    std::vector<PictureBody> bodies(
        12, {.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = colours().red});
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].position.z = 0.1 * static_cast<double>(i);
    bodies.back().position = {1e6, 0, 0};
    const Image image = render(bodies, small());
    EXPECT_GT(pixel(image, image.width / 2 - 15, image.height / 2)[0],
              pixel(image, image.width / 2 - 15, image.height / 2)[2] + 30);
}

TEST(Picture, EmptyAndDegenerateScenesAreBackdrop) {
    const Image nothing = render({}, small());
    EXPECT_EQ(nothing.rgb.size(), 96U * 64U * 3U);
    const TriangleMesh empty, point{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}};
    const std::array bodies{PictureBody{.mesh = &empty, .position = {}, .rotation = {}},
                            PictureBody{.mesh = &point, .position = {}, .rotation = {}}};
    EXPECT_EQ(render(bodies, small()).rgb, nothing.rgb);
}

TEST(Picture, RefusesBadPosesMeshesAndOptions) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    const TriangleMesh good = square(1), broken{{{0, 0, 0}}, {{0, 0, 1}}},
                       infinite{{{inf, 0, 0}, {0, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const auto refused = [](const PictureBody& body, const PictureOptions& options = small()) {
        EXPECT_THROW(static_cast<void>(render({&body, 1}, options)), InputError);
    };
    refused({.mesh = &good, .position = {0, nan, 0}, .rotation = {}});
    refused({.mesh = &good, .position = {0, inf, 0}, .rotation = {}});
    refused({.mesh = &good, .position = {0, 1e200, 0}, .rotation = {}});
    refused({.mesh = &good, .position = {}, .rotation = {nan, 0, 0, 0}});
    refused({.mesh = &good, .position = {}, .rotation = {0, 0, 0, 0}});
    refused({.mesh = nullptr, .position = {}, .rotation = {}});
    refused({.mesh = &broken, .position = {}, .rotation = {}});
    refused({.mesh = &infinite, .position = {}, .rotation = {}});
    PictureOptions options = small();
    options.width = 0;
    options.zoom = nan;
    try {
        static_cast<void>(render({}, options));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("width"), std::string::npos);
        EXPECT_NE(std::string(e.what()).find("zoom"), std::string::npos);
    }
}

constexpr OverlayColour kGreen{0, 200, 0};

int green(const Pixel& p) { return p[1] - std::max(p[0], p[2]); }

TEST(Overlay, MarksAreWhereTheCameraSeesTheirPlaces) {
    const TriangleMesh mesh = square(1);
    const PictureBody body{.mesh = &mesh, .position = {5, 6, 7}, .rotation = {}, .fixed = false, .colour = 0};
    const Image plain = render({&body, 1}, small());
    Overlay overlay;
    EXPECT_EQ(render({&body, 1}, small(), overlay).rgb, plain.rgb) << "an empty one";

    overlay.dots.push_back({{5, 6, 7}, 4, kGreen});
    const Image dot = render({&body, 1}, small(), overlay);
    EXPECT_EQ(middle(dot), (Pixel{0, 200, 0}));
    EXPECT_EQ(pixel(dot, 48 - 7, 32), pixel(plain, 48 - 7, 32));

    overlay.dots.clear();
    overlay.lines.push_back({{4.2, 6, 7}, {5.8, 6, 7}, 2, kGreen}); // along x, which is to the right here
    const Image line = render({&body, 1}, small(), overlay);
    for (const int x : {-12, 0, 12}) EXPECT_GT(green(pixel(line, 48 + x, 32)), 150) << x;
    EXPECT_EQ(pixel(line, 48, 32 - 4), pixel(plain, 48, 32 - 4));

    overlay.lines.clear();
    overlay.arrows.push_back({{5, 6, 7}, {1, 0, 0}, 0.5F, 2, kGreen});
    const Image arrow = render({&body, 1}, small(), overlay);
    EXPECT_GT(green(pixel(arrow, 48 + 5, 32)), 150);
    EXPECT_EQ(pixel(arrow, 48 - 5, 32), pixel(plain, 48 - 5, 32)) << "it points to the right";
}

TEST(Overlay, WhatASurfaceHidesIsFainter) {
    const TriangleMesh mesh = square(1);
    const PictureBody body{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = colours().red};
    const auto with_dot = [&](double z) {
        Overlay overlay;
        overlay.dots.push_back({{0, 0, z}, 4, kGreen});
        return green(middle(render({&body, 1}, small(), overlay)));
    };
    const int plain = green(middle(render({&body, 1}, small())));
    EXPECT_EQ(with_dot(0.1), 200);
    EXPECT_EQ(with_dot(0), 200) << "on the surface";
    EXPECT_LT(with_dot(-0.1), 120);
    EXPECT_GT(with_dot(-0.1), plain + 40);
    EXPECT_EQ(with_dot(1e4), plain) << "behind the camera";
}

TEST(Overlay, FadesThePictureBelowAndNeedsNoBodies) {
    const TriangleMesh mesh = square(1);
    const PictureBody body{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = colours().red};
    Overlay overlay;
    overlay.fade = 0.5F;
    const Pixel plain = middle(render({&body, 1}, small())), faded = middle(render({&body, 1}, small(), overlay));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(faded[k], (plain[k] + 255) / 2.0, 1);
    overlay.dots.push_back({{0, 0, 0}, 4, kGreen});
    EXPECT_EQ(render({}, small(), overlay).rgb.size(), 96U * 64U * 3U);
}

TEST(WritePng, IsReadBackByLibpng) {
    const TriangleMesh mesh = square(1);
    const PictureBody body{.mesh = &mesh, .position = {}, .rotation = {}, .fixed = false, .colour = 3};
    const Image image = render({&body, 1}, small(30));
    const auto path = scratch("image.png");
    write_png(path, image);
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_file(&header, path.c_str()), 0);
    header.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(header));
    ASSERT_NE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr), 0);
    EXPECT_EQ(header.width, 96U);
    EXPECT_EQ(header.height, 64U);
    EXPECT_EQ(rgb, image.rgb);
    std::filesystem::remove(path);
}

TEST(WritePng, NamesTheFileItCannotWrite) {
    const auto path = scratch("no_such_folder") / "image.png";
    try {
        write_png(path, render({}, small()));
        FAIL();
    } catch (const IoError& e) {
        EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos);
    }
}

} // namespace
} // namespace flotilla
