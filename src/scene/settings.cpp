// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <flotilla/error.hpp>

#include "base/text.hpp"
#include "scene/settings_table.hpp"

namespace flotilla {

namespace {

using std::string_view_literals::operator""sv;

constexpr std::array kTrajectories{"linear"sv, "rigid"sv};
constexpr std::array kCollisions{"sequential"sv, "accumulated"sv};
constexpr std::array kCcdMethods{"conservative"sv, "cubic"sv};
constexpr std::array kTangents{"random"sv, "aligned"sv, "cone"sv};
constexpr std::array kVelocityUpdates{"trapezoidal"sv, "end"sv};
constexpr std::array kContactSolvers{"pgs"sv, "exact"sv, "exact_few"sv};
constexpr std::array kRigidifications{"kinematic"sv, "rigid"sv};
constexpr std::array kUnsatisfiableScripts{"hold"sv, "follow"sv, "error"sv};
constexpr std::array kInitialOverlaps{"error"sv, "separate"sv};

template <auto Member>
ChoiceField choice(std::span<const std::string_view> names) {
    using Enum = std::remove_cvref_t<decltype(std::declval<Settings&>().*Member)>;
    return {[](const Settings& s) { return static_cast<std::size_t>(s.*Member); },
            [](Settings& s, std::size_t i) { s.*Member = static_cast<Enum>(i); }, names};
}

constexpr double kMaxSweeps = 1e6; // beyond it a step could take days; every loop keeps a bound
constexpr double kMinLength = 1e-9, kMaxLength = 1e6;

const std::vector<SettingRow>& table() {
    static const std::vector<SettingRow> rows{
        {"time_step",
         &Settings::time_step,
         "s",
         1e-9,
         10,
         {},
         "length of a step",
         "shorter: more steps, smaller linearisation errors of rotation; the guarantees hold at any length"},
        {"substeps",
         &Settings::substeps,
         "",
         1,
         1000,
         {},
         "inner steps that make a step; frames, steps.csv and checkpoints keep the step",
         "more: slower, smaller errors of the time step: the motion is that of time_step / substeps"},
        {"friction",
         &Settings::friction,
         "",
         0,
         1e3,
         {},
         "Coulomb coefficient of bodies that give none",
         "0 everywhere: one row per contact instead of three"},
        {"restitution",
         &Settings::restitution,
         "",
         0,
         1,
         {},
         "coefficient of bodies that give none",
         "near 1 a pile takes long to come to rest"},
        {"seed",
         &Settings::seed,
         "",
         0,
         0x1p64,
         {},
         "of the generator of friction directions (tangents: random)",
         "none"},
        {"rest_distance", &Settings::rest_distance, "m", kMinLength, kMaxLength, 0,
         "gap at which contacts rest; 0: body size / 330, less for thin solids",
         "smaller: closer contact, less room for the rounding and tolerance of a step"},
        {"proximity_distance", &Settings::proximity_distance, "m", kMinLength, kMaxLength, 0,
         "gap below which contacts are found; 0: twice the rest distance",
         "larger: more contacts, slower, fewer late collisions"},
        {"separation", &Settings::separation, "m", kMinLength, kMaxLength, 0,
         "least gap that the continuous collision detection certifies; 0: rest distance / 50",
         "larger: more hits in the last step before contact; smaller: nearer to rounding"},
        {"proximity_angle",
         &Settings::proximity_angle,
         "degrees",
         1e-3,
         89.999,
         {},
         "largest angle between a contact's normal and the direction to the nearest point",
         "larger: more contacts, less exact normals"},
        {"approach_threshold", &Settings::approach_threshold, "m/s", 0, 1e9, -1,
         "end proximities that approach slower are left to static contact; -1: |gravity| time_step / 2",
         "0: every proximity is a collision: twice the time of a settling pile, nothing visible gained"},
        {"collisions",
         choice<&Settings::collisions>(kCollisions),
         "",
         0,
         0,
         {},
         "stage 1: pair by pair, each as those before left it, or all hits met so far in the step solved together "
         "before "
         "pairs are looked at again",
         "accumulated: a fraction of the rounds; a blow goes through touching bodies at once, and each hit rebounds "
         "once "
         "a step"},
        {"collision_iterations",
         &Settings::collision_iterations,
         "",
         0,
         kMaxSweeps,
         {},
         "limit of sweeps of Algorithm 1, or of rounds over all pairs where collisions are accumulated",
         "sweeps end by themselves when quiet, or when they gain nothing; a limit below about 30 leaves work to the "
         "failsafe, which freezes piles"},
        {"collision_pair_iterations",
         &Settings::collision_pair_iterations,
         "",
         0,
         kMaxSweeps,
         {},
         "limit of impulses per pair and sweep of Algorithm 1",
         "1: more sweeps"},
        {"dynamic_iterations",
         &Settings::dynamic_iterations,
         "",
         0,
         kMaxSweeps,
         {},
         "sweeps of Algorithm 2 after which it is given up, unless fewer pairs hit than up to it or those left get "
         "fewer; before, when sweeps gain nothing",
         "a limit below about 50 leaves work to the failsafe"},
        {"dynamic_pair_iterations",
         &Settings::dynamic_pair_iterations,
         "",
         0,
         kMaxSweeps,
         {},
         "limit of impulses per pair and sweep of Algorithm 2",
         "lower: more rigidified pairs"},
        {"static_iterations",
         &Settings::static_iterations,
         "",
         0,
         kMaxSweeps,
         {},
         "limit of sweeps of projected Gauss-Seidel",
         "lower: faster, resting piles creep; about 100 warm sweeps equal 1000 cold ones"},
        {"static_tolerance", &Settings::static_tolerance, "m/s", 0, 1e3, -1,
         "largest constraint violation at which the sweeps stop; -1: |gravity| time_step / 4096, and for small bodies "
         "rest_distance / time_step / 2048",
         "lower: slower, less creep, down to the rounding of what contacts carry; the residual reached is reported in "
         "any case"},
        {"tolerance_share",
         &Settings::tolerance_share,
         "",
         0,
         1e6,
         {},
         "where static_tolerance is -1: the tolerance is this share of it; below 1 only static_iterations ends a solve "
         "above it",
         "lower: slower, less creep"},
        {"contact_reuse",
         &Settings::contact_reuse,
         "",
         0,
         0.25,
         {},
         "share of the rest distance that a pair may move before the features in contact are searched for anew",
         "0: in every step, which takes most of the time of a pile at rest"},
        {"warm_start",
         &Settings::warm_start,
         "",
         0,
         1,
         {},
         "start from the impulses of the last solve",
         "false: about ten times the sweeps in a pile"},
        {"shock_propagation",
         &Settings::shock_propagation,
         "",
         0,
         1,
         {},
         "bottom-up pass after the sweeps reached their limit",
         "false: tall stacks need more sweeps"},
        {"sleeping",
         &Settings::sleeping,
         "",
         0,
         1,
         {},
         "resting islands sleep until touched",
         "false: resting bodies cost time every step"},
        {"trajectory",
         choice<&Settings::trajectory>(kTrajectories),
         "",
         0,
         0,
         {},
         "path of a step that is certified: straight lines of the vertices, or the bodies' own turning motion",
         "rigid: exact for fast spins, cut into up to 64 segments a step, and that many times slower there"},
        {"ccd",
         choice<&Settings::ccd>(kCcdMethods),
         "",
         0,
         0,
         {},
         "continuous collision detection of stage 1: proved, or the paper's cubic with a tolerance (separation where "
         "given, else 1e-4 m)",
         "cubic: a baseline for comparison; what it overlooks, the proved one of stage 5 finds and resolves without "
         "rebound"},
        {"velocity_update",
         choice<&Settings::velocity_update>(kVelocityUpdates),
         "",
         0,
         0,
         {},
         "contact forces of a step act half at its start and half at its end, or all at the end as in the paper",
         "end: of first order; a ring that swings on an edge loses a quarter of its amplitude in 7 periods at 1/120 s"},
        {"contact_solver",
         choice<&Settings::contact_solver>(kContactSolvers),
         "",
         0,
         0,
         {},
         "static contact: projected Gauss-Seidel, or the same with small islands that it leaves unsolved, or only "
         "those of up to eight bodies and columns and chains at rest, solved exactly",
         "pgs: stacks of uneven masses, chains and thin bodies end above the tolerance; exact_few: the larger of them"},
        {"tangents",
         choice<&Settings::tangents>(kTangents),
         "",
         0,
         0,
         {},
         "friction: Coulomb's cone (aligned: the same, an older name), or the paper's pyramid of random direction",
         "random: sliding friction too large by 27 % in the mean and by up to 41 %"},
        {"rigidification",
         choice<&Settings::rigidification>(kRigidifications),
         "",
         0,
         0,
         {},
         "first rung of the failsafe's clusters",
         "rigid: stacks hit while the failsafe acts move as one body"},
        {"unsatisfiable_script",
         choice<&Settings::unsatisfiable_script>(kUnsatisfiableScripts),
         "",
         0,
         0,
         {},
         "scripted motion that would crush a body: hold the body back and its script with it, or follow: let the "
         "script go on and catch up with it at most twice as fast as it ever is, or stop with an error (exit code 7)",
         "hold: jaws that jammed while closing stay shut; follow: they open when their script says so"},
        {"initial_overlap",
         choice<&Settings::initial_overlap>(kInitialOverlaps),
         "",
         0,
         0,
         {},
         "bodies that intersect at the start: refuse the scene, or move them apart first",
         "none"},
    };
    return rows;
}

std::string join(std::span<const std::string_view> names, std::string_view separator) {
    std::string text;
    for (const std::string_view name : names) (text += text.empty() ? ""sv : separator) += name;
    return text;
}

std::string range_text(const SettingRow& row) {
    if (std::holds_alternative<bool Settings::*>(row.field) || std::holds_alternative<ChoiceField>(row.field))
        return "";
    if (row.key == "seed") return "0 .. 2^64 - 1";
    std::string text = to_text(row.low) + " .. " + to_text(row.high);
    if (row.derived) text += " or " + to_text(*row.derived);
    return text;
}

std::string type_text(const SettingRow& row) {
    if (std::holds_alternative<double Settings::*>(row.field)) return "number";
    if (std::holds_alternative<bool Settings::*>(row.field)) return "boolean";
    if (const auto* c = std::get_if<ChoiceField>(&row.field)) return join(c->names, " | ");
    return "integer";
}

std::string value_text(const Settings& settings, const SettingRow& row) {
    return std::visit(
        [&](const auto& field) -> std::string {
            using Field = std::remove_cvref_t<decltype(field)>;
            if constexpr (std::is_same_v<Field, ChoiceField>)
                return std::string(field.names[field.get(settings)]);
            else if constexpr (std::is_same_v<Field, bool Settings::*>)
                return settings.*field ? "true" : "false";
            else if constexpr (std::is_same_v<Field, double Settings::*>)
                return to_text(settings.*field);
            else
                return std::to_string(settings.*field);
        },
        row.field);
}

bool in_range(const SettingRow& row, double value) {
    return (value >= row.low && value <= row.high) || (row.derived && value == *row.derived);
}

std::string out_of_range(const SettingRow& row, std::string_view value) {
    std::string text = "must be in " + range_text(row);
    if (!row.unit.empty()) (text += ' ') += row.unit;
    return (text += ", got ") += value;
}

std::string describe(const SettingValue& value) {
    return std::visit(
        [](const auto& v) -> std::string {
            using V = std::remove_cvref_t<decltype(v)>;
            if constexpr (std::is_same_v<V, bool>)
                return v ? "true" : "false";
            else if constexpr (std::is_same_v<V, double>)
                return to_text(v);
            else if constexpr (std::is_same_v<V, std::string>)
                return in_quotes(v);
            else
                return std::to_string(v);
        },
        value);
}

std::optional<double> as_number(const SettingValue& value) {
    if (const auto* d = std::get_if<double>(&value)) return *d;
    if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
    if (const auto* u = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*u);
    return {};
}

std::optional<std::string> assign_number(Settings& s, const SettingRow& row, double Settings::*field,
                                         const SettingValue& value) {
    const std::optional<double> number = as_number(value);
    if (!number) return "must be a number, got " + describe(value);
    if (!in_range(row, *number)) return out_of_range(row, describe(value));
    s.*field = *number;
    return {};
}

std::optional<std::string> assign_integer(Settings& s, const SettingRow& row, int Settings::*field,
                                          const SettingValue& value) {
    const std::optional<double> number = as_number(value);
    if (!number || *number != std::floor(*number)) return "must be an integer, got " + describe(value);
    if (!in_range(row, *number)) return out_of_range(row, describe(value));
    s.*field = static_cast<int>(*number);
    return {};
}

std::optional<std::string> assign_word(Settings& s, const SettingRow& row, std::uint64_t Settings::*field,
                                       const SettingValue& value) {
    if (const auto* u = std::get_if<std::uint64_t>(&value))
        s.*field = *u;
    else if (const auto* i = std::get_if<std::int64_t>(&value); i != nullptr && *i >= 0)
        s.*field = static_cast<std::uint64_t>(*i);
    else
        return "must be an integer in " + range_text(row) + ", got " + describe(value);
    return {};
}

std::optional<std::string> assign_flag(Settings& s, const SettingRow&, bool Settings::*field,
                                       const SettingValue& value) {
    const auto* flag = std::get_if<bool>(&value);
    if (flag == nullptr) return "must be true or false, got " + describe(value);
    s.*field = *flag;
    return {};
}

std::optional<std::string> assign_choice(Settings& s, const ChoiceField& field, const SettingValue& value) {
    const auto* name = std::get_if<std::string>(&value);
    const auto found = name == nullptr ? field.names.end() : std::find(field.names.begin(), field.names.end(), *name);
    if (found == field.names.end()) return "must be one of " + join(field.names, ", ") + "; got " + describe(value);
    field.set(s, static_cast<std::size_t>(found - field.names.begin()));
    return {};
}

template <class Number>
std::optional<Number> parse_whole(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return {};
    return number;
}

// The value that an option's text stands for, as far as the text says; what does not fit is refused by assign_setting.
SettingValue parse_value(const SettingRow& row, std::string_view text) {
    if (std::holds_alternative<ChoiceField>(row.field)) return std::string(text);
    if (std::holds_alternative<bool Settings::*>(row.field)) {
        for (const std::string_view yes : {"true"sv, "on"sv, "yes"sv, "1"sv})
            if (text == yes) return true;
        for (const std::string_view no : {"false"sv, "off"sv, "no"sv, "0"sv})
            if (text == no) return false;
        return std::string(text);
    }
    if (const auto whole = parse_whole<std::uint64_t>(text)) return *whole;
    if (const auto number = parse_whole<double>(text)) return *number;
    return std::string(text);
}

const SettingRow& require_setting(std::string_view key) {
    if (const SettingRow* row = find_setting(key)) return *row;
    throw InputError(unknown_name("setting", key, setting_keys()));
}

struct Preset {
    std::string_view name;
    void (*apply)(Settings&);
};

/// Contact solves of either end below a speed that does not go by the number of inner steps: what bodies creep by in a
/// second.
void set_substeps(Settings& s, int substeps, double tolerance_share) {
    s.substeps = substeps;
    s.tolerance_share = substeps * tolerance_share;
}

void apply_accurate(Settings& s) {
    set_substeps(s, 4, 0.005); // 5e-7 m/s of boats at 1/24 s
    s.static_iterations = 5000;
    s.contact_reuse = 0;
    s.trajectory = Trajectory::rigid;
    s.sleeping = false;
}

constexpr std::array kPresets{
    Preset{"paper",
           [](Settings& s) {
               s.static_tolerance = 1e-6;
               s.contact_reuse = 0;
               s.tangents = Tangents::random;
               s.warm_start = false;
               s.velocity_update = VelocityUpdate::end;
               s.contact_solver = ContactSolver::pgs;
           }},
    Preset{"preview",
           [](Settings& s) {
               // The first round's hits carry most of an impact, the second's what those made of it; one more costs as
               // much as stage 5 saves. With one pair after the other the failsafe would take over below 30 sweeps.
               s.collisions = Collisions::accumulated;
               s.collision_iterations = 2;
               s.dynamic_iterations = 50; // below, the failsafe takes over
               s.static_iterations = 50;
               s.contact_solver = ContactSolver::exact_few;
               s.tolerance_share = 8; // with 16 or more some piles of 252 boats creep on and never sleep
               s.contact_reuse = 0.25;
           }},
    Preset{"balanced", [](Settings&) {}},
    Preset{"accurate", apply_accurate},
    Preset{"reference",
           [](Settings& s) {
               apply_accurate(s);
               s.collision_iterations = 1000;
               s.dynamic_iterations = 1000;
               s.static_iterations = 10000;
               set_substeps(s, 8, 5e-6);
           }},
};

} // namespace

std::span<const SettingRow> settings_table() { return table(); }

const SettingRow* find_setting(std::string_view key) {
    const auto found =
        std::find_if(table().begin(), table().end(), [&](const SettingRow& row) { return row.key == key; });
    return found == table().end() ? nullptr : &*found;
}

std::vector<std::string_view> setting_keys() {
    std::vector<std::string_view> keys;
    for (const SettingRow& row : table()) keys.push_back(row.key);
    return keys;
}

std::optional<std::string> assign_setting(Settings& settings, const SettingRow& row, const SettingValue& value) {
    return std::visit(
        [&](const auto& field) -> std::optional<std::string> {
            using Field = std::remove_cvref_t<decltype(field)>;
            if constexpr (std::is_same_v<Field, ChoiceField>)
                return assign_choice(settings, field, value);
            else if constexpr (std::is_same_v<Field, bool Settings::*>)
                return assign_flag(settings, row, field, value);
            else if constexpr (std::is_same_v<Field, double Settings::*>)
                return assign_number(settings, row, field, value);
            else if constexpr (std::is_same_v<Field, int Settings::*>)
                return assign_integer(settings, row, field, value);
            else
                return assign_word(settings, row, field, value);
        },
        row.field);
}

void check_settings(const Settings& settings, const std::string& where, ErrorList& errors) {
    const auto problem = [&](std::string_view key, std::string reason) {
        const std::string at = where + "/" + std::string(key);
        if (!errors.any_under(at)) errors.add(at, std::move(reason));
    };
    for (const SettingRow& row : table()) {
        if (const auto* d = std::get_if<double Settings::*>(&row.field); d != nullptr && !in_range(row, settings.**d))
            problem(row.key, out_of_range(row, value_text(settings, row)));
        if (const auto* i = std::get_if<int Settings::*>(&row.field); i != nullptr && !in_range(row, settings.**i))
            problem(row.key, out_of_range(row, value_text(settings, row)));
        if (const auto* c = std::get_if<ChoiceField>(&row.field); c != nullptr && c->get(settings) >= c->names.size())
            problem(row.key, "must be one of " + join(c->names, ", "));
    }
    const double rest = settings.rest_distance;
    if (rest > 0 && settings.proximity_distance > 0 && settings.proximity_distance <= rest)
        problem("proximity_distance",
                "must exceed rest_distance (" + to_text(rest) + " m), got " + to_text(settings.proximity_distance));
    if (rest > 0 && settings.separation >= rest)
        problem("separation",
                "must be below rest_distance (" + to_text(rest) + " m), got " + to_text(settings.separation));
}

std::vector<SettingInfo> list_settings() {
    std::vector<SettingInfo> infos;
    for (const SettingRow& row : table())
        infos.push_back({row.key, type_text(row), std::string(row.unit), range_text(row), value_text(Settings{}, row),
                         std::string(row.description), std::string(row.effect)});
    return infos;
}

std::string setting_value(const Settings& settings, std::string_view key) {
    return value_text(settings, require_setting(key));
}

void set_setting(Settings& settings, std::string_view key, std::string_view value) {
    const SettingRow& row = require_setting(key);
    if (const auto reason = assign_setting(settings, row, parse_value(row, value)))
        throw InputError("setting " + std::string(key) + ": " + *reason);
}

std::vector<std::string> validate_settings(const Settings& settings) {
    ErrorList errors("settings");
    check_settings(settings, "", errors);
    std::vector<std::string> lines;
    for (const InputProblem& p : errors.problems()) lines.push_back(p.where.substr(1) + ": " + p.reason);
    return lines;
}

std::vector<std::string_view> preset_names() {
    std::vector<std::string_view> names;
    for (const Preset& p : kPresets) names.push_back(p.name);
    return names;
}

Settings preset(std::string_view name) {
    for (const Preset& p : kPresets) {
        if (p.name != name) continue;
        Settings settings;
        p.apply(settings);
        return settings;
    }
    throw InputError(unknown_name("preset", name, preset_names()) + " (presets: " + join(preset_names(), ", ") + ")");
}

} // namespace flotilla
