// SPDX-License-Identifier: MIT
// What a World is made of.
#pragma once

#include <unordered_map>

#include <flotilla/world.hpp>

#include "api/edited_bodies.hpp"
#include "query/body_queries.hpp"
#include "scene/scene.hpp"
#include "step/stepper.hpp"

namespace flotilla {

struct CheckedStart;
class ErrorList;

/// Edits since record_edits().
struct EditRecord {
    bool on = false, broken = false; ///< broken: the World went to a state to which they do not lead
    std::uint64_t start = 0;         ///< EditedBodies::hash before all of them
    std::vector<Edit> edits;
    std::vector<std::uint64_t> hashes; ///< after each

    void begin(std::uint64_t hash);
    [[nodiscard]] bool leads_to(std::uint64_t hash) const;
    void add(const Edit& edit, std::uint64_t hash);
    /// Forgets edits that a snapshot is before.
    void go_to(std::uint64_t hash);
};

/// The scene as it is now, and the solver on it.
struct World::Impl {
    Impl(const CheckedStart& start, const WorldOptions& options);
    Impl(const SceneDescription& description, const Scene& scene, std::span<const std::byte> snapshot,
         const WorldOptions& options);
    /// A clone.
    Impl(const Impl& other, const WorldOptions& options);

    // World::apply() and what it takes, one function for each edit. Nothing has changed where one throws.
    BodyId operator()(const edits::AddShape& edit);
    BodyId operator()(const edits::AddBody& edit);
    BodyId operator()(const edits::RemoveBody& edit);
    BodyId operator()(const edits::SetPose& edit);
    BodyId operator()(const edits::SetVelocity& edit);
    BodyId operator()(const edits::SetType& edit);
    BodyId operator()(const edits::SetScript& edit);
    BodyId operator()(const edits::SetMaterial& edit);
    BodyId operator()(const edits::SetForce& edit);
    BodyId operator()(const edits::ApplyForce& edit);
    BodyId operator()(const edits::ApplyImpulse& edit);
    BodyId operator()(const edits::SetGravity& edit);
    BodyId operator()(const edits::SetGroup& edit);
    BodyId operator()(const edits::IgnoreGroups& edit);
    BodyId operator()(const edits::IgnorePair& edit);
    BodyId operator()(const edits::Wake& edit);
    BodyId operator()(const edits::RemoveShape& edit);

    void check(std::size_t body) const;
    /// The place of a body that is there; InputError with its number and what became of it.
    [[nodiscard]] std::size_t place(BodyId body) const;
    [[nodiscard]] BodyId id(std::size_t place) const {
        return {static_cast<std::int32_t>(place), now.generation[place]};
    }
    /// The shape with a number, or InputError that says what became of it.
    [[nodiscard]] const ShapeDescription& shape(std::int32_t number) const;
    [[nodiscard]] BodyNames pair(std::int32_t a, std::int32_t b) const;
    [[nodiscard]] PlacedShape placed(std::size_t body) const;
    void say(const std::string& line) const {
        if (log) log(line);
    }

    /// Of a body as it would be at `place`: those of others that would not be apart from it.
    [[nodiscard]] std::vector<std::int32_t> overlapping(std::size_t place, const BodyDescription& body,
                                                        const FilteredBodies& filtered) const;
    void refuse_overlaps(const BodyDescription& body, std::size_t place, const FilteredBodies& filtered) const;
    /// Checks a body's description, as if it were alone in the scene, with the lengths of all.
    void check_description(BodyDescription& body, const char* doing) const;
    [[nodiscard]] FilteredBodies filtered() const;
    /// The filter as it would be with another body at a place.
    [[nodiscard]] FilteredBodies filter_with(std::size_t place, const BodyDescription& body) const;
    void describe(std::size_t place, BodyDescription body);
    /// Gives a body another description, where it stays.
    void change(std::size_t body, BodyDescription description);
    /// A body's description where it stands, for checks.
    [[nodiscard]] BodyDescription as_it_stands(std::size_t body) const;
    void check_filter(const FilteredBodies& filter, const std::string& doing, std::optional<std::size_t> body) const;
    /// `whose`: as Stepper::set_filter() has it.
    void take_filter(const FilteredBodies& filter, std::span<const std::int32_t> whose = {});
    void keep(std::int32_t body, const BodyDescription& changed);
    /// What a step adds by them has a meaning, as in a scene's file.
    void check_loads(const BodyDescription& body, const RigidShape& shape, ErrorList& errors) const;
    void require_dynamic(std::size_t body) const;
    void push(std::int32_t body);
    void clear_pushes();
    void go_to(Model model, std::span<const std::byte> snapshot);
    void take_edits(const EditedBodies& edited, std::vector<std::int32_t>& shapes, Model& model) const;
    void undo_edits(Model& model) const;
    void name_places();
    void say_warnings(const StepReport& report);
    /// What follows from edits, before it is read.
    void refresh() const;
    [[nodiscard]] std::uint64_t state_hash() const;
    [[nodiscard]] const std::shared_ptr<std::vector<ContactState>>& contacts();
    /// Places in contacts(), ascending. The first call after a step goes over all of them.
    [[nodiscard]] std::span<const std::size_t> contacts_of(std::size_t body);
    void refuse_where_pinned(const std::string& doing) const;

    Settings settings;                  ///< of the whole step
    std::vector<std::int32_t> shape_of; ///< by shape of the description: the model's
    EditedBodies start, now;            ///< what edits change: as the scene describes it, and as it is
    std::uint64_t scene_hash = 0;       ///< of the scene as it was described
    std::vector<MovedBody> moved;
    WorldOptions options;
    std::unique_ptr<Stepper> stepper;
    bool whole = true;                                      ///< no step ended half-way
    std::unordered_map<std::string, std::int32_t> place_of; ///< by name, of present bodies
    std::shared_ptr<std::vector<ContactState>> contact_list = std::make_shared<std::vector<ContactState>>();
    std::int64_t contacts_of_step = -1; ///< that contact_list is of; -1: it is not up to date
    bool contacts_by_body = false;      ///< whether the next two are of contact_list
    std::vector<std::size_t> contact_places, end_of_body;

    std::shared_ptr<const void> pin = std::make_shared<char>(); ///< who else holds it has pinned the places

    std::uint32_t last_warnings = 0;

    std::function<void(World&)> force_callback;
    std::function<bool(Phase)> observer;
    std::function<void(const std::string&)> log;
    EditRecord record;
};

} // namespace flotilla
