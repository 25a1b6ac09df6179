// SPDX-License-Identifier: MIT
// Edits of every kind, drawn at random: some possible, some that must be refused.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <flotilla/world.hpp>

#include "support/random.hpp"

namespace flotilla::test {

/// Of a World in a box of +- `extent` m around the origin, whose shapes are all of about 1 m, with masses.
class RandomEdits {
  public:
    /// `with_work`: scripts and forces too, after which nothing bounds the energy.
    RandomEdits(std::uint64_t seed, double extent, std::int32_t shapes, std::size_t most_bodies, bool with_work = true)
        : random_(seed), extent_(extent), shapes_(shapes), most_(most_bodies), with_work_(with_work) {}

    Edit draw(const World& world) {
        const std::vector<BodyId> bodies = present(world);
        std::uint64_t kind = random_.below(17);
        if (!with_work_ && (kind == 8 || kind == 14 || kind == 15)) kind = 5;
        if (bodies.empty() || (kind < 3 && bodies.size() < most_)) return {0, add()};
        const BodyId body = bodies[random_.below(bodies.size())], other = bodies[random_.below(bodies.size())];
        switch (kind) {
        case 0:
        case 1:
        case 2: return {0, edits::RemoveBody{body}};
        case 3: return {0, edits::SetPose{body, random_.vec(extent_), random_.rotation()}};
        case 4: return {0, edits::SetVelocity{body, random_.vec(5), random_.vec(5)}};
        case 5: return {0, edits::ApplyImpulse{body, random_.vec(200), random_.vec(50)}};
        case 6: return {0, edits::SetMaterial{body, random_.uniform(0, 1), random_.uniform(0, 1)}};
        case 7: return {0, edits::SetType{body, random_.below(2) == 0 ? BodyType::fixed : BodyType::dynamic}};
        case 8: {
            const double time = world.time() + random_.uniform(0.1, 1);
            return {0, edits::SetScript{body, {{time, random_.vec(extent_), random_.rotation()}}}};
        }
        case 9: return {0, edits::SetGravity{random_.vec(10)}};
        case 10: return {0, edits::SetGroup{body, group()}};
        case 11: return {0, edits::IgnoreGroups{"a", random_.below(2) == 0 ? "a" : "b", random_.below(3) == 0}};
        case 12: return {0, edits::IgnorePair{body, other, random_.below(2) == 0}};
        case 13: return {0, edits::Wake{body}};
        case 14: return {0, edits::SetForce{body, random_.vec(30), random_.vec(5)}};
        case 15: return {0, edits::ApplyForce{body, random_.vec(300), random_.vec(30)}};
        default: return {0, edits::RemoveBody{{body.index, body.generation + 1}}}; // never there
        }
    }

  private:
    static std::vector<BodyId> present(const World& world) {
        std::vector<BodyId> out;
        for (std::size_t i = 0; i < world.size(); ++i)
            if (const BodyId id{static_cast<std::int32_t>(i), world.generation(i)}; world.contains(id))
                out.push_back(id);
        return out;
    }
    std::string group() { return std::array{"", "a", "b"}[random_.below(3)]; }
    edits::AddBody add() {
        BodyDescription body;
        body.shape = static_cast<std::int32_t>(random_.below(static_cast<std::uint64_t>(shapes_)));
        body.position = random_.vec(extent_);
        body.rotation = random_.rotation();
        body.velocity = random_.vec(3);
        body.angular_velocity = random_.vec(3);
        body.friction = random_.uniform(0, 1);
        body.group = group();
        return {body};
    }

    Random random_;
    double extent_;
    std::int32_t shapes_;
    std::size_t most_;
    bool with_work_;
};

/// What may pass through what, as the World's own descriptions and the edits made so far say.
class Ignored {
  public:
    void note(const World& world, const Edit& edit) {
        if (const auto* e = std::get_if<edits::IgnoreGroups>(&edit.change)) set(groups_, e->a, e->b, e->ignored);
        if (const auto* e = std::get_if<edits::IgnorePair>(&edit.change))
            set(names_, world.name(e->a), world.name(e->b), e->ignored);
    }
    /// Before a body goes: a later one may have its name.
    void forget(const std::string& name) {
        std::erase_if(names_, [&](const auto& p) { return p.first == name || p.second == name; });
    }
    [[nodiscard]] bool operator()(const World& world, const std::string& a, const std::string& b) const {
        const auto group = [&](const std::string& name) { return world.description(world.find(name)).group; };
        return has(names_, a, b) || has(groups_, group(a), group(b));
    }

  private:
    using Pairs = std::vector<std::pair<std::string, std::string>>;
    static bool has(const Pairs& list, const std::string& a, const std::string& b) {
        const auto pair = std::minmax(a, b);
        return std::find(list.begin(), list.end(), std::pair<std::string, std::string>(pair)) != list.end();
    }
    static void set(Pairs& list, const std::string& a, const std::string& b, bool ignored) {
        const std::pair<std::string, std::string> pair(std::minmax(a, b));
        std::erase(list, pair);
        if (ignored) list.push_back(pair);
    }
    Pairs groups_, names_;
};

} // namespace flotilla::test
