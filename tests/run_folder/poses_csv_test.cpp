// SPDX-License-Identifier: MIT
#include "run_folder/poses_csv.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <flotilla/error.hpp>

#include "run_folder/run_folder.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

using io::Frame;
using io::PosesCsvReader;

const std::vector<std::string> kNames{"floor", "boat, \"red\""};
const std::string kHeader = std::string(io::kPosesHeader) + "\n";

Frame frame_of(std::int64_t k) {
    Frame frame;
    frame.index = frame.step = k;
    frame.time = static_cast<double>(k) / 24;
    frame.position = {{0, 0, 0}, {0.1, 1.0 / 3, -2e-300}};
    frame.rotation = {{1, 0, 0, 0}, {0.5, -0.5, 0.5, std::sqrt(0.25)}};
    frame.velocity = {{}, {1, 2, 3}};
    frame.angular_velocity = {{}, {-0.0, 5e-324, 1.7976931348623157e308}};
    return frame;
}

TEST(PosesCsv, HasTheContractsHeaderAndSeventeenDigits) {
    EXPECT_EQ(io::kPosesHeader, "frame,time,body,name,px,py,pz,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz");
    const std::string rows = io::poses_csv_rows(frame_of(2), kNames);
    EXPECT_TRUE(rows.starts_with("2,0.083333333333333329,0,floor,0,0,0,1,0,0,0,"));
    EXPECT_NE(rows.find("\n2,0.083333333333333329,1,\"boat, \"\"red\"\"\",0.10000000000000001,0.33333333333333331,"),
              std::string::npos)
        << rows;
}

TEST(PosesCsv, ReadsBackTheSameBits) {
    const test::TemporaryFolder folder;
    std::string text = kHeader;
    for (std::int64_t k = 0; k < 3; ++k) text += io::poses_csv_rows(frame_of(k), kNames);
    PosesCsvReader reader(folder.write("poses.csv", text), kNames);
    Frame frame;
    for (std::int64_t k = 0; k < 3; ++k) {
        ASSERT_TRUE(reader.next(frame));
        EXPECT_EQ(frame.index, k);
        EXPECT_EQ(frame.time, frame_of(k).time);
        EXPECT_EQ(frame.position, frame_of(k).position);
        EXPECT_EQ(frame.rotation, frame_of(k).rotation);
        EXPECT_EQ(frame.velocity, frame_of(k).velocity);
        EXPECT_EQ(frame.angular_velocity, frame_of(k).angular_velocity);
    }
    EXPECT_FALSE(reader.next(frame));
    EXPECT_EQ(reader.position(), reader.size());
}

TEST(PosesCsv, TakesValuesThatAreNoNumbersForTheAuditToJudge) {
    const test::TemporaryFolder folder;
    const std::string row = "0,0,0,floor,nan,inf,-inf,1,0,0,0,0,0,0,0,0,0\r\n";
    PosesCsvReader reader(folder.write("poses.csv", kHeader + row), {"floor"});
    Frame frame;
    ASSERT_TRUE(reader.next(frame));
    EXPECT_TRUE(std::isnan(frame.position[0].x));
    EXPECT_EQ(frame.position[0].y, std::numeric_limits<double>::infinity());
}

TEST(PosesCsv, NamesTheLineOfEveryProblem) {
    const std::string rest = ",0,0,0,1,0,0,0,0,0,0,0,0,0\n";
    const std::string good = "0,0,0,floor" + rest + "0,0,1,lid" + rest;
    const struct {
        std::string text;
        const char* message;
    } cases[] = {
        {"frame,time\n", ":1: the header must be"},
        {"", ":1: the header must be"},
        {kHeader + good + "1,0,0,floor,1\n", ":4: 5 columns instead of 17"},
        {kHeader + "0,0,0,lid" + rest, ":2: body 0 is called \"lid\" here and \"floor\" in the scene"},
        {kHeader + "0,0,7,lid" + rest, ":2: body 7 is not in the scene, which has 2"},
        {kHeader + "0,0,-1,lid" + rest, ":2: body -1 is not in the scene"},
        {kHeader + "0,zero,0,floor" + rest, ":2: \"zero\" is not a number"},
        {kHeader + "0,0,0,\"floor" + rest, ":2: a quote does not end"},
        {kHeader + "0,0,0,floor" + rest, ": frame 0 has no row for body 1 (\"lid\")"},
        {kHeader + "0,0,0,floor" + rest + "0,0,0,floor" + rest, "body 0 stands twice in frame 0"},
        {kHeader + "0,0,0,floor" + rest + "0,1,1,lid" + rest, "two times in frame 0"},
        {kHeader + "1,0,0,floor" + rest + "1,0,1,lid" + rest + good, "frames must be in ascending order"},
    };
    const test::TemporaryFolder folder;
    for (const auto& c : cases) {
        try {
            PosesCsvReader reader(folder.write("poses.csv", c.text), {"floor", "lid"});
            for (Frame frame; reader.next(frame);) {
            }
            ADD_FAILURE() << "accepted: " << c.message;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(c.message), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(PosesCsvReader(folder.path() / "none.csv", {}), IoError);
}

} // namespace
} // namespace flotilla
