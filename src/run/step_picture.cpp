// SPDX-License-Identifier: MIT
#include <flotilla/step_picture.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <flotilla/edit_file.hpp>
#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "api/edited_bodies.hpp"
#include "api/world_access.hpp"
#include "base/floating_point.hpp"
#include "base/rotation.hpp"
#include "geometry/box.hpp"
#include "picture/render.hpp"
#include "run_folder/checkpoint.hpp"
#include "run_folder/recorded_scene.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/run_folder.hpp"
#include "run_folder/step_csv.hpp"

namespace flotilla {
namespace {

constexpr OverlayColour kLoaded{214, 39, 40}, kTouching{240, 160, 20}, kSleeping{120, 110, 150}, kNear{40, 120, 220},
    kArrow{25, 25, 35};
/// By ProofWay.
constexpr std::array<OverlayColour, 5> kProofColours{
    {{150, 150, 150}, {40, 160, 70}, {40, 120, 220}, {214, 39, 40}, {120, 110, 150}}};
constexpr float kFade = 0.45F;        // of the bodies
constexpr float kLongestArrow = 0.2F; // in radii of the picture, for the largest impulse
constexpr float kSmallestDot = 2, kLargestDot = 6;
constexpr float kPairLine = 1.6F, kNearLine = 1;

/// A present body: where it is, and what of it is drawn.
struct DrawnBody {
    std::size_t place;
    Vec3 center; ///< of mass, m
    Box box;     ///< m, world
    bool dynamic;
};

Box box_of(const TriangleMesh& mesh, const BodyState& state) {
    Box box;
    for (const Vec3& v : mesh.vertices) box = extended(box, state.position + rotate(state.rotation, v));
    return box;
}

/// The kinds of pairs, by how much there is to see: the first that holds counts.
enum class PairKind : std::uint8_t { loaded, sleeping, touching, near };

PairKind kind_of(const ContactState& contact) {
    if (contact.asleep) return PairKind::sleeping;
    return length(contact.impulse) > 0 ? PairKind::loaded : PairKind::touching;
}

struct SeenPair {
    PairKind kind = PairKind::near;
    Vec3 point; ///< m, of a contact
};
using Pairs = std::map<std::pair<std::size_t, std::size_t>, SeenPair>;

class StepPicture {
  public:
    StepPicture(const World& world, PairLines lines) : world_(world), lines_(lines) {
        for (std::size_t i = 0; i < world.size(); ++i) add_body(i);
        report_.step = world.steps();
        report_.time = world.time();
        report_.bodies = bodies_.size();
        add_contacts();
        add_near_pairs();
        draw_pairs();
    }

    [[nodiscard]] StepPictureReport write(const std::filesystem::path& output, const PictureOptions& options) const {
        write_png(output, render(drawn_, options, overlay_));
        return report_;
    }

  private:
    void add_body(std::size_t place) {
        if (!world_.contains({static_cast<std::int32_t>(place), world_.generation(place)})) return;
        const BodyState state = world_.body(place);
        const TriangleMesh& mesh = WorldAccess::mesh(world_, place);
        const bool dynamic = world_.description(world_.id(place)).type == BodyType::dynamic;
        drawn_.push_back({.mesh = &mesh,
                          .position = state.position,
                          .rotation = state.rotation,
                          .fixed = !dynamic,
                          .colour = static_cast<std::uint32_t>(place)});
        bodies_.push_back({place, state.center_of_mass, box_of(mesh, state), dynamic});
    }

    void add_contacts() {
        const std::vector<ContactState> contacts = world_.contacts();
        report_.contacts = contacts.size();
        for (const ContactState& c : contacts)
            report_.largest_impulse = std::max(report_.largest_impulse, length(c.impulse));
        for (const ContactState& c : contacts) {
            const PairKind kind = kind_of(c);
            // The length goes with the root: small impulses of a heap are seen beside those of an impact.
            const double size =
                report_.largest_impulse > 0 ? std::sqrt(length(c.impulse) / report_.largest_impulse) : 0;
            const OverlayColour& colour = colour_of(kind);
            const auto share = static_cast<float>(size);
            if (size > 0) overlay_.arrows.push_back({c.point, c.normal, kLongestArrow * share, 1.5F, kArrow});
            overlay_.dots.push_back({c.point, kSmallestDot + share * (kLargestDot - kSmallestDot), colour});
            SeenPair& pair = pairs_[{static_cast<std::size_t>(c.body_a), static_cast<std::size_t>(c.body_b)}];
            if (kind < pair.kind) pair = {kind, c.point};
        }
    }

    /// Pairs of boxes that meet, found along x.
    void add_near_pairs() {
        std::vector<const DrawnBody*> sorted;
        for (const DrawnBody& body : bodies_) sorted.push_back(&body);
        std::ranges::stable_sort(sorted, {}, [](const DrawnBody* b) { return b->box.lower.x; });
        for (std::size_t i = 0; i < sorted.size(); ++i)
            for (std::size_t j = i + 1; j < sorted.size() && sorted[j]->box.lower.x <= sorted[i]->box.upper.x; ++j) {
                const DrawnBody &a = *sorted[i], &b = *sorted[j];
                if ((a.dynamic || b.dynamic) && boxes_overlap(a.box, b.box, 0))
                    pairs_.try_emplace(std::minmax(a.place, b.place));
            }
    }

    void draw_pairs() {
        std::vector<const DrawnBody*> at(world_.size(), nullptr);
        for (const DrawnBody& body : bodies_) at[body.place] = &body;
        // Those with more to see are drawn later, over the others.
        for (const PairKind kind : {PairKind::near, PairKind::touching, PairKind::sleeping, PairKind::loaded})
            for (const auto& [places, pair] : pairs_) {
                if (pair.kind != kind) continue;
                const ProofWay way = WorldAccess::proved_by(world_, places.first, places.second);
                count(kind), count(way);
                const DrawnBody &a = *at[places.first], &b = *at[places.second];
                overlay_.lines.push_back({end_of(a, b, pair), end_of(b, a, pair),
                                          kind == PairKind::near ? kNearLine : kPairLine,
                                          lines_ == PairLines::proofs ? colour_of(way) : colour_of(kind)});
            }
    }

    /// Where a pair's line ends at `body`: at its centre; or, as that of a floor says nothing, at a contact point, and
    /// without one at the nearest point.
    [[nodiscard]] Vec3 end_of(const DrawnBody& body, const DrawnBody& other, const SeenPair& pair) const {
        if (body.dynamic || !other.dynamic) return body.center;
        if (pair.kind != PairKind::near) return pair.point;
        return world_.closest(world_.id(body.place), world_.id(other.place)).point_a;
    }

    void count(PairKind kind) {
        std::size_t* const counts[]{&report_.loaded_pairs, &report_.sleeping_pairs, &report_.touching_pairs,
                                    &report_.near_pairs};
        ++*counts[static_cast<std::size_t>(kind)];
    }
    void count(ProofWay way) {
        std::size_t* const counts[]{&report_.not_proved, &report_.proved_by_boxes, &report_.proved_by_query,
                                    &report_.proved_by_cluster, &report_.proved_by_rest};
        ++*counts[static_cast<std::size_t>(way)];
    }
    [[nodiscard]] static const OverlayColour& colour_of(ProofWay way) {
        return kProofColours[static_cast<std::size_t>(way)];
    }
    [[nodiscard]] static const OverlayColour& colour_of(PairKind kind) {
        static constexpr const OverlayColour* kColours[]{&kLoaded, &kSleeping, &kTouching, &kNear};
        return *kColours[static_cast<std::size_t>(kind)];
    }

    const World& world_;
    PairLines lines_;
    StepPictureReport report_;
    std::vector<DrawnBody> bodies_;
    std::vector<PictureBody> drawn_;
    Pairs pairs_; ///< sorted by places
    Overlay overlay_{.fade = kFade, .lines = {}, .arrows = {}, .dots = {}};
};

using Progress = std::function<void(std::int64_t, std::int64_t)>;

/// Makes the edits that come before each step on the way to `step`.
StepReport advance(World& world, std::int64_t step, const std::vector<Edit>& edits, const Progress& progress) {
    StepReport last;
    const std::int64_t first = world.steps();
    auto next = std::ranges::lower_bound(edits, world.steps(), {}, &Edit::step);
    while (world.steps() < step) {
        for (; next != edits.end() && next->step <= world.steps(); ++next) world.apply(*next);
        last = world.step();
        if (progress) progress(world.steps() - first, step - first);
    }
    return last;
}

World start_of(const io::RunReader& run, const SceneDescription& scene, std::int64_t step) {
    const std::string source = run.folder().string();
    const std::optional<io::Checkpoint> checkpoint = io::read_last_checkpoint(run.folder());
    if (checkpoint && checkpoint->step <= step) return World(scene, checkpoint->state, source);
    return World(scene, source);
}

/// Refuses a World that is not where the run was after this step.
void check_same_step(const io::RunReader& run, const StepReport& report) {
    const io::StepTable table = io::read_step_table(io::read_text(run.folder() / io::kStepsCsv));
    const auto row = std::ranges::find(table.rows, report.step, &std::pair<std::int64_t, std::string>::first);
    const auto column = std::ranges::find(table.columns, "state_hash");
    if (row == table.rows.end() || column == table.columns.end()) return; // the run did not get there
    const std::string_view recorded =
        io::step_csv_fields(row->second)[static_cast<std::size_t>(column - table.columns.begin())];
    const std::string row_now = io::step_csv_row(report);
    const std::string_view now = io::step_csv_fields(row_now)[static_cast<std::size_t>(column - table.columns.begin())];
    if (now != recorded)
        throw InputError(run.folder().string() + ": step " + std::to_string(report.step) +
                         " made again ends elsewhere than in the run (state hash " + std::string(now) + ", not " +
                         std::string(recorded) + "): version " + run.info().record.version + " (" +
                         run.info().record.commit + ") made that");
}

StepPictureReport write_of_run(const std::filesystem::path& folder, std::int64_t step,
                               const std::filesystem::path& output, const PictureOptions& options,
                               const StepPictureOptions& step_options) {
    const io::RunReader run(folder);
    const SceneDescription scene = io::recorded_scene(run);
    std::vector<Edit> edits;
    if (!run.info().edits_json.empty())
        edits = parse_edits(run.info().edits_json, (folder / io::kEditsJson).string(), folder, scene);
    World world = start_of(run, scene, step);
    std::uint64_t hash = world.scene_hash();
    for (const Edit& edit : edits) hash = chained(hash, edit, edit.step);
    if (hash != run.info().scene_hash)
        throw InputError(folder.string() + ": its scene and settings are not what the run was made of");
    const StepReport last = advance(world, step, edits, step_options.progress);
    if (last.step > 0) check_same_step(run, last);
    return write_step_picture(world, output, options, step_options.lines);
}

} // namespace

StepPictureReport write_step_picture(const World& world, const std::filesystem::path& output,
                                     const PictureOptions& options, PairLines lines) {
    const DefaultFloatingPoint environment;
    return StepPicture(world, lines).write(output, options);
}

StepPictureReport write_step_picture(const std::filesystem::path& source, std::int64_t step,
                                     const std::filesystem::path& output, const PictureOptions& options,
                                     const StepPictureOptions& step_options) {
    const DefaultFloatingPoint environment;
    if (step < 0) throw InputError("picture: step is " + std::to_string(step) + ", must be at least 0");
    std::error_code error; // reading names it
    if (std::filesystem::is_directory(source, error)) return write_of_run(source, step, output, options, step_options);
    World world(read_scene(source), source.string());
    advance(world, step, {}, step_options.progress);
    return write_step_picture(world, output, options, step_options.lines);
}

} // namespace flotilla
