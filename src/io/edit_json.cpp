// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <map>
#include <ostream>
#include <utility>

#include <flotilla/edit_file.hpp>
#include <flotilla/error.hpp>

#include "base/floating_point.hpp"
#include "base/text.hpp"
#include "io/file.hpp"
#include "io/json_reader.hpp"
#include "io/scene_parts.hpp"
#include "scene/description_checks.hpp"

namespace flotilla {
namespace {

using io::Json;
using io::JsonPlace;
using std::string_view_literals::operator""sv;

/// Who is where, as a World of the scene would have it after the edits so far.
class Places {
  public:
    explicit Places(const SceneDescription& scene) {
        names_.settings = scene.settings;
        for (const ShapeDescription& shape : scene.shapes) add_shape(shape);
        scene_shapes_ = names_.shapes.size();
        for (const BodyDescription& body : scene.bodies) bodies_.push_back({body.name, 0, true});
    }

    void note(const Edit& edit) {
        if (const auto* e = std::get_if<edits::AddShape>(&edit.change)) add_shape(e->shape);
        if (const auto* e = std::get_if<edits::RemoveShape>(&edit.change)) {
            static_cast<void>(shape_name(e->shape));
            names_.shapes[static_cast<std::size_t>(e->shape)].name.clear();
        }
        if (const auto* e = std::get_if<edits::AddBody>(&edit.change)) add_body(e->body.name);
        if (const auto* e = std::get_if<edits::RemoveBody>(&edit.change)) {
            Place& place = bodies_[static_cast<std::size_t>(e->body.index)];
            place.present = false;
            ++place.generation;
        }
    }
    /// Shapes by name, and the settings.
    [[nodiscard]] const SceneDescription& names() const { return names_; }
    [[nodiscard]] std::optional<BodyId> find(const std::string& name) const {
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            if (bodies_[i].present && bodies_[i].name == name)
                return BodyId{static_cast<std::int32_t>(i), bodies_[i].generation};
        return {};
    }
    [[nodiscard]] const std::string& name(BodyId body) const {
        const auto i = static_cast<std::size_t>(body.index);
        if (body.index < 0 || i >= bodies_.size() || !bodies_[i].present || bodies_[i].generation != body.generation)
            throw InputError("edits: there is no body " + std::to_string(body.index) + " of generation " +
                             std::to_string(body.generation));
        return bodies_[i].name;
    }
    [[nodiscard]] std::vector<std::string_view> body_names() const {
        std::vector<std::string_view> out;
        for (const Place& place : bodies_)
            if (place.present) out.push_back(place.name);
        return out;
    }
    /// That a World gives a body without one.
    [[nodiscard]] std::string next_name() const {
        const std::size_t i = free_place();
        return default_body_name(i, i == bodies_.size() ? 0 : bodies_[i].generation);
    }
    [[nodiscard]] std::string next_shape_name() const { return default_shape_name(names_.shapes); }
    [[nodiscard]] const std::string& shape_name(std::int32_t shape) const {
        const auto k = static_cast<std::size_t>(shape);
        if (shape < 0 || k >= names_.shapes.size() || names_.shapes[k].name.empty())
            throw InputError("edits: there is no shape " + std::to_string(shape));
        return names_.shapes[k].name;
    }
    [[nodiscard]] std::optional<std::int32_t> find_shape(const std::string& name) const {
        for (std::size_t k = 0; k < names_.shapes.size() && !name.empty(); ++k)
            if (names_.shapes[k].name == name) return static_cast<std::int32_t>(k);
        return {};
    }
    [[nodiscard]] std::vector<std::string_view> shape_names() const {
        std::vector<std::string_view> out;
        for (const ShapeDescription& shape : names_.shapes)
            if (!shape.name.empty()) out.push_back(shape.name);
        return out;
    }

  private:
    struct Place {
        std::string name;
        std::uint32_t generation = 0;
        bool present = false;
    };
    void add_shape(const ShapeDescription& shape) {
        std::string given = shape.name.empty() ? next_shape_name() : shape.name;
        std::size_t k = scene_shapes_;
        while (k < names_.shapes.size() && !names_.shapes[k].name.empty()) ++k; // removed ones give their numbers
        if (k == names_.shapes.size()) names_.shapes.emplace_back();
        names_.shapes[k].name = std::move(given);
    }
    [[nodiscard]] std::size_t free_place() const {
        const auto free = std::find_if(bodies_.begin(), bodies_.end(), [](const Place& p) { return !p.present; });
        return static_cast<std::size_t>(free - bodies_.begin());
    }
    void add_body(const std::string& name) {
        const std::string given = name.empty() ? next_name() : name;
        const std::size_t i = free_place();
        if (i == bodies_.size()) bodies_.emplace_back();
        bodies_[i].name = given;
        bodies_[i].present = true;
    }

    SceneDescription names_;
    std::size_t scene_shapes_ = 0;
    std::vector<Place> bodies_;
};

class EditReader : io::JsonReader {
  public:
    EditReader(std::filesystem::path folder, const SceneDescription& scene, ErrorList& errors)
        : JsonReader(errors), folder_(std::move(folder)), places_(scene) {}

    std::vector<Edit> read(const Json& document) {
        const JsonPlace top;
        if (!is_object(document, top)) return {};
        check_keys(document, top, std::array{"flotilla_edits"sv, "edits"sv});
        const Json* version = member(document, top, "flotilla_edits", true);
        if (version != nullptr && !(version->is_number() && version->get<double>() == 1))
            problem(top.member("flotilla_edits"), "must be 1, the version of the format, got " + io::kind_of(*version));
        const Json* list = member(document, top, "edits", true);
        const JsonPlace at = top.member("edits");
        if (list == nullptr || !is_array(*list, at, "an array of edits")) return {};
        read_list(*list, at);
        return std::move(edits_);
    }

  private:
    void read_list(const Json& list, const JsonPlace& at) {
        std::vector<std::pair<std::int64_t, std::size_t>> order; // an edit speaks of what those before it left
        for (std::size_t i = 0; i < list.size(); ++i) order.emplace_back(step_of(list[i], at.element(i)), i);
        std::stable_sort(order.begin(), order.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        for (const auto& [step, i] : order) {
            std::optional<decltype(Edit::change)> change = read_edit(list[i], at.element(i));
            if (!change) {
                note_refused(list[i]);
                continue;
            }
            edits_.push_back({step, std::move(*change), errors().source() + ": " + at.element(i).text()});
            places_.note(edits_.back());
        }
    }

    /// What a faulty edit would have brought has its name all the same, so that later ones are not blamed as well.
    void note_refused(const Json& value) {
        const auto name_in = [&](const char* kind) {
            const Json* added = value.is_object() && value.contains(kind) ? &value[kind] : nullptr;
            const bool named = added != nullptr && added->is_object() && added->contains("name");
            return named && (*added)["name"].is_string() ? (*added)["name"].get<std::string>() : std::string();
        };
        edits::AddShape shape;
        edits::AddBody body;
        shape.shape.name = name_in("add_shape"), body.body.name = name_in("add_body");
        if (!shape.shape.name.empty()) places_.note({0, std::move(shape)});
        if (!body.body.name.empty()) places_.note({0, std::move(body)});
    }

    std::int64_t step_of(const Json& value, const JsonPlace& at) {
        if (!is_object(value, at)) return 0;
        const Json* step = member(value, at, "step", true);
        if (step == nullptr) return 0;
        if (step->is_number_unsigned() && step->get<std::uint64_t>() <= std::uint64_t{1} << 62)
            return step->get<std::int64_t>();
        problem(at.member("step"), "must be a whole number of steps, 0 or more, got " + io::kind_of(*step));
        return 0;
    }

    using Change = decltype(Edit::change);

    std::optional<Change> read_edit(const Json& value, const JsonPlace& at) {
        if (!value.is_object()) return {};
        std::optional<Change> change;
        int kinds = 0;
        for (const auto& item : value.items()) {
            if (item.key() == "step") continue;
            const auto kind =
                std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) { return k.name == item.key(); });
            if (kind == kKinds.end()) {
                std::vector<std::string_view> known{"step"};
                for (const Kind& k : kKinds) known.push_back(k.name);
                problem(at.member(item.key()), unknown_name("key", item.key(), known));
                continue;
            }
            if (++kinds > 1) {
                problem(at, "must hold one edit beside its step");
                return {};
            }
            change = (this->*kind->read)(item.value(), at.member(kind->name));
        }
        if (kinds == 0 && !errors().any_under(at.text())) problem(at, "holds no edit");
        return errors().any_under(at.text()) ? std::nullopt : std::move(change);
    }

    std::optional<Change> add_shape(const Json& v, const JsonPlace& at) {
        return edits::AddShape{io::read_shape(v, at, folder_, errors())};
    }
    std::optional<Change> add_body(const Json& v, const JsonPlace& at) {
        return edits::AddBody{io::read_body(v, at, places_.names(), errors())};
    }
    std::optional<Change> remove_shape(const Json& v, const JsonPlace& at) {
        std::string name;
        if (!to(name, v, at)) return {};
        const auto found = places_.find_shape(name);
        if (!found) problem(at, unknown_name("shape", name, places_.shape_names()));
        return edits::RemoveShape{found.value_or(-1)};
    }
    std::optional<Change> remove_body(const Json& v, const JsonPlace& at) {
        edits::RemoveBody e;
        name(e.body, v, at);
        return e;
    }
    std::optional<Change> set_pose(const Json& v, const JsonPlace& at) {
        edits::SetPose e;
        if (!body(e.body, v, at, {"position", "rotation"})) return {};
        get(e.position, v, at, "position", true);
        get(e.rotation, v, at, "rotation");
        return e;
    }
    std::optional<Change> set_velocity(const Json& v, const JsonPlace& at) {
        edits::SetVelocity e;
        if (!body(e.body, v, at, {"velocity", "angular_velocity"})) return {};
        get(e.velocity, v, at, "velocity");
        get(e.angular_velocity, v, at, "angular_velocity");
        return e;
    }
    std::optional<Change> set_type(const Json& v, const JsonPlace& at) {
        edits::SetType e;
        if (!body(e.body, v, at, {"type"})) return {};
        std::string type;
        if (!get(type, v, at, "type", true)) return {};
        if (type != "dynamic" && type != "static")
            problem(at.member("type"),
                    "must be dynamic or static (set_script makes a body kinematic), got " + in_quotes(type));
        e.type = type == "static" ? BodyType::fixed : BodyType::dynamic;
        return e;
    }
    std::optional<Change> set_script(const Json& v, const JsonPlace& at) {
        edits::SetScript e;
        if (!body(e.body, v, at, {"keyframes"})) return {};
        const Json* list = member(v, at, "keyframes", true);
        const JsonPlace place = at.member("keyframes");
        if (list == nullptr || !is_array(*list, place, "an array of keyframes")) return {};
        for (std::size_t i = 0; i < list->size(); ++i) {
            const JsonPlace frame = place.element(i);
            if (!is_object((*list)[i], frame)) continue;
            check_keys((*list)[i], frame, std::array{"time"sv, "position"sv, "rotation"sv});
            Keyframe k;
            get(k.time, (*list)[i], frame, "time", true);
            get(k.position, (*list)[i], frame, "position", true);
            get(k.rotation, (*list)[i], frame, "rotation");
            e.keyframes.push_back(k);
        }
        return e;
    }
    std::optional<Change> set_material(const Json& v, const JsonPlace& at) {
        edits::SetMaterial e;
        if (!body(e.body, v, at, {"friction", "restitution"})) return {};
        get(e.friction, v, at, "friction", true);
        get(e.restitution, v, at, "restitution", true);
        return e;
    }
    std::optional<Change> set_force(const Json& v, const JsonPlace& at) {
        edits::SetForce e;
        if (!body(e.body, v, at, {"force", "torque"})) return {};
        get(e.force, v, at, "force");
        get(e.torque, v, at, "torque");
        return e;
    }
    std::optional<Change> apply_force(const Json& v, const JsonPlace& at) {
        edits::ApplyForce e;
        if (!body(e.body, v, at, {"force", "torque"})) return {};
        get(e.force, v, at, "force");
        get(e.torque, v, at, "torque");
        return e;
    }
    std::optional<Change> apply_impulse(const Json& v, const JsonPlace& at) {
        edits::ApplyImpulse e;
        if (!body(e.body, v, at, {"impulse", "angular_impulse"})) return {};
        get(e.impulse, v, at, "impulse");
        get(e.angular_impulse, v, at, "angular_impulse");
        return e;
    }
    std::optional<Change> set_gravity(const Json& v, const JsonPlace& at) {
        edits::SetGravity e;
        to(e.gravity, v, at);
        return e;
    }
    std::optional<Change> set_group(const Json& v, const JsonPlace& at) {
        edits::SetGroup e;
        if (!body(e.body, v, at, {"group"})) return {};
        get(e.group, v, at, "group", true);
        return e;
    }
    std::optional<Change> ignore_groups(const Json& v, const JsonPlace& at) {
        edits::IgnoreGroups e;
        if (!is_object(v, at)) return {};
        check_keys(v, at, std::array{"groups"sv, "ignored"sv});
        pair(v, at, "groups",
             [&](const Json& a, const JsonPlace& place, bool first) { to(first ? e.a : e.b, a, place); });
        get(e.ignored, v, at, "ignored");
        return e;
    }
    std::optional<Change> ignore_pair(const Json& v, const JsonPlace& at) {
        edits::IgnorePair e;
        if (!is_object(v, at)) return {};
        check_keys(v, at, std::array{"bodies"sv, "ignored"sv});
        pair(v, at, "bodies",
             [&](const Json& a, const JsonPlace& place, bool first) { name(first ? e.a : e.b, a, place); });
        get(e.ignored, v, at, "ignored");
        return e;
    }
    std::optional<Change> wake(const Json& v, const JsonPlace& at) {
        edits::Wake e;
        name(e.body, v, at);
        return e;
    }

    template <class Known>
    void check_keys(const Json& value, const JsonPlace& at, const Known& known) {
        for (const auto& item : value.items())
            if (std::find(known.begin(), known.end(), item.key()) == known.end())
                problem(at.member(item.key()), unknown_name("key", item.key(), known));
    }
    template <class Value>
    bool get(Value& out, const Json& object, const JsonPlace& at, std::string_view key, bool required = false) {
        const Json* value = member(object, at, key, required);
        return value != nullptr && to(out, *value, at.member(key));
    }
    using JsonReader::to;
    bool to(Quat& out, const Json& value, const JsonPlace& at) {
        std::array<double, 4> q{};
        if (!numbers(q, value, at, "an array of 4 numbers [w, x, y, z]")) return false;
        out = {q[0], q[1], q[2], q[3]};
        return true;
    }
    /// The body that a name means now.
    void name(BodyId& out, const Json& value, const JsonPlace& at) {
        std::string text;
        if (!to(text, value, at)) return;
        if (const auto found = places_.find(text))
            out = *found;
        else
            problem(at, unknown_name("body", text, places_.body_names()));
    }
    /// The member "body" of an object with no other keys than these.
    bool body(BodyId& out, const Json& value, const JsonPlace& at, std::vector<std::string_view> keys) {
        if (!is_object(value, at)) return false;
        keys.emplace_back("body");
        check_keys(value, at, keys);
        if (const Json* named = member(value, at, "body", true)) name(out, *named, at.member("body"));
        return true;
    }
    template <class Each>
    void pair(const Json& value, const JsonPlace& at, std::string_view key, Each&& each) {
        const Json* names = member(value, at, key, true);
        if (names == nullptr) return;
        const JsonPlace place = at.member(key);
        if (!names->is_array() || names->size() != 2)
            return problem(place, "must be an array of 2 names, got " + io::kind_of(*names));
        each((*names)[0], place.element(0), true);
        each((*names)[1], place.element(1), false);
    }

    struct Kind {
        std::string_view name;
        std::optional<Change> (EditReader::*read)(const Json&, const JsonPlace&);
    };
    static const std::array<Kind, 17> kKinds;

    std::filesystem::path folder_;
    Places places_;
    std::vector<Edit> edits_;
};

const std::array<EditReader::Kind, 17> EditReader::kKinds{{{"add_shape", &EditReader::add_shape},
                                                           {"add_body", &EditReader::add_body},
                                                           {"remove_body", &EditReader::remove_body},
                                                           {"set_pose", &EditReader::set_pose},
                                                           {"set_velocity", &EditReader::set_velocity},
                                                           {"set_type", &EditReader::set_type},
                                                           {"set_script", &EditReader::set_script},
                                                           {"set_material", &EditReader::set_material},
                                                           {"set_force", &EditReader::set_force},
                                                           {"apply_force", &EditReader::apply_force},
                                                           {"apply_impulse", &EditReader::apply_impulse},
                                                           {"set_gravity", &EditReader::set_gravity},
                                                           {"set_group", &EditReader::set_group},
                                                           {"ignore_groups", &EditReader::ignore_groups},
                                                           {"ignore_pair", &EditReader::ignore_pair},
                                                           {"wake", &EditReader::wake},
                                                           {"remove_shape", &EditReader::remove_shape}}};

/// One edit as its line of a file.
class EditWriter {
  public:
    explicit EditWriter(const Places& places) : places_(places) {}

    std::string operator()(const edits::AddShape& e) const {
        ShapeDescription shape = e.shape;
        if (shape.name.empty()) shape.name = places_.next_shape_name();
        return line("add_shape", io::shape_json(shape));
    }
    std::string operator()(const edits::AddBody& e) const {
        BodyDescription body = e.body;
        if (body.name.empty()) body.name = places_.next_name();
        return line("add_body", io::body_json(body, places_.names()));
    }
    std::string operator()(const edits::RemoveBody& e) const { return line("remove_body", Json(places_.name(e.body))); }
    std::string operator()(const edits::SetPose& e) const {
        return line("set_pose",
                    {{"body", places_.name(e.body)}, {"position", array(e.position)}, {"rotation", array(e.rotation)}});
    }
    std::string operator()(const edits::SetVelocity& e) const {
        return line("set_velocity", {{"body", places_.name(e.body)},
                                     {"velocity", array(e.velocity)},
                                     {"angular_velocity", array(e.angular_velocity)}});
    }
    std::string operator()(const edits::SetType& e) const {
        return line("set_type",
                    {{"body", places_.name(e.body)}, {"type", e.type == BodyType::fixed ? "static" : "dynamic"}});
    }
    std::string operator()(const edits::SetScript& e) const {
        Json frames = Json::array();
        for (const Keyframe& k : e.keyframes)
            frames.push_back({{"time", k.time}, {"position", array(k.position)}, {"rotation", array(k.rotation)}});
        return line("set_script", {{"body", places_.name(e.body)}, {"keyframes", frames}});
    }
    std::string operator()(const edits::SetMaterial& e) const {
        return line("set_material",
                    {{"body", places_.name(e.body)}, {"friction", e.friction}, {"restitution", e.restitution}});
    }
    std::string operator()(const edits::SetForce& e) const { return pushed("set_force", e); }
    std::string operator()(const edits::ApplyForce& e) const { return pushed("apply_force", e); }
    std::string operator()(const edits::ApplyImpulse& e) const {
        return line("apply_impulse", {{"body", places_.name(e.body)},
                                      {"impulse", array(e.impulse)},
                                      {"angular_impulse", array(e.angular_impulse)}});
    }
    std::string operator()(const edits::SetGravity& e) const { return line("set_gravity", array(e.gravity)); }
    std::string operator()(const edits::SetGroup& e) const {
        return line("set_group", {{"body", places_.name(e.body)}, {"group", e.group}});
    }
    std::string operator()(const edits::IgnoreGroups& e) const {
        return line("ignore_groups", {{"groups", Json::array({e.a, e.b})}, {"ignored", e.ignored}});
    }
    std::string operator()(const edits::IgnorePair& e) const {
        return line("ignore_pair",
                    {{"bodies", Json::array({places_.name(e.a), places_.name(e.b)})}, {"ignored", e.ignored}});
    }
    std::string operator()(const edits::Wake& e) const { return line("wake", Json(places_.name(e.body))); }
    std::string operator()(const edits::RemoveShape& e) const {
        return line("remove_shape", Json(places_.shape_name(e.shape)));
    }

  private:
    static Json array(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }
    static Json array(const Quat& q) { return Json::array({q.w, q.x, q.y, q.z}); }
    template <class Push>
    std::string pushed(const char* kind, const Push& e) const {
        return line(kind, {{"body", places_.name(e.body)}, {"force", array(e.force)}, {"torque", array(e.torque)}});
    }
    static std::string line(const char* kind, const std::string& value) {
        std::string text = "\"";
        return text.append(kind).append("\": ").append(value);
    }
    static std::string line(const char* kind, const Json& value) {
        return line(kind, value.dump(-1, ' ', false, Json::error_handler_t::replace));
    }

    const Places& places_;
};

} // namespace

std::vector<Edit> parse_edits(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                              const SceneDescription& scene) {
    const DefaultFloatingPoint environment;
    ErrorList errors(source);
    std::vector<Edit> edits;
    const Json document = io::parse_json(text, errors);
    const io::MemoryForTheEnd memory(text.size());
    if (!document.is_discarded()) edits = EditReader(folder, scene, errors).read(document);
    errors.throw_if_any();
    return edits;
}

std::vector<Edit> read_edits(const std::filesystem::path& file, const SceneDescription& scene) {
    return parse_edits(io::read_text(file), file.string(), file.parent_path(), scene);
}

void write_edits(std::ostream& out, std::span<const Edit> edits, const SceneDescription& scene) {
    const DefaultFloatingPoint environment;
    Places places(scene);
    out << "{\n  \"flotilla_edits\": 1,\n  \"edits\": [";
    for (std::size_t i = 0; i < edits.size(); ++i) {
        out << (i > 0 ? ",\n" : "\n") << "    {\"step\": " << edits[i].step << ", "
            << std::visit(EditWriter(places), edits[i].change) << '}';
        places.note(edits[i]);
    }
    out << "\n  ]\n}\n";
}

} // namespace flotilla
