// SPDX-License-Identifier: MIT
// Stage 1 alone, in both of its ways.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "collision/collisions.hpp"
#include "support/stage_world.hpp"

namespace flotilla::test {

/// `joint`: may be null.
inline StageCounters collide(StageWorld& world, JointSolve* joint = nullptr) {
    CollisionScratch scratch;
    return handle_collisions(world.view(), world.movers(), world.book(), world.workers(), {}, joint, scratch);
}

/// Tests of each way.
class BothWays : public testing::TestWithParam<Collisions> {
  protected:
    [[nodiscard]] static SceneDescription scene() {
        SceneDescription out = weightless_scene();
        out.settings.collisions = GetParam();
        return out;
    }
};

inline std::string name_of_way(const testing::TestParamInfo<Collisions>& way) {
    return way.param == Collisions::sequential ? "sequential" : "accumulated";
}

} // namespace flotilla::test
