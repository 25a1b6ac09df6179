// SPDX-License-Identifier: MIT
// Settings: one property per setting that the library lists, so that a new one is there without a word here.
#include <flotilla/settings.hpp>

#include "python/bind.hpp"
#include "python/settings_values.hpp"

namespace flotilla::python {

std::string setting_text(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    if (py::isinstance<py::str>(value)) return value.cast<std::string>();
    // repr of a float reads back to the same bits; numpy's numbers are made Python's first.
    const py::object plain =
        py::hasattr(value, "item") ? value.attr("item")() : py::reinterpret_borrow<py::object>(value);
    return py::repr(plain).cast<std::string>();
}

Overrides overrides_of(const py::object& settings) {
    Overrides out;
    if (settings.is_none()) return out;
    for (const auto& [key, value] : settings.cast<py::dict>())
        out.emplace_back(key.cast<std::string>(), setting_text(value));
    return out;
}

namespace {

py::object setting_object(const Settings& settings, std::string_view key, std::string_view type) {
    const std::string text = setting_value(settings, key);
    if (type == "boolean") return py::bool_(text == "true");
    if (type == "number") return py::float_(py::str(text));
    if (type == "integer") return py::int_(py::str(text));
    return py::str(text);
}

std::string doc_of(const SettingInfo& info) {
    return info.description + " (" + info.type + (info.unit.empty() ? "" : ", " + info.unit) + ", " + info.range +
           "; default " + info.default_value + ")\n\n" + info.effect;
}

void add_properties(py::class_<Settings>& type) {
    for (const SettingInfo& info : list_settings()) {
        const std::string key(info.key), kind = info.type;
        type.def_property(
            key.c_str(), [key, kind](const Settings& s) { return setting_object(s, key, kind); },
            [key](Settings& s, const py::object& value) { set_setting(s, key, setting_text(value)); },
            doc_of(info).c_str());
    }
}

py::dict dict_of(const Settings& settings) {
    py::dict out;
    for (const SettingInfo& info : list_settings())
        out[py::str(std::string(info.key))] = setting_object(settings, info.key, info.type);
    return out;
}

Settings make_settings(const std::string& name, const py::kwargs& changes) {
    Settings settings = preset(name);
    for (const auto& [key, value] : overrides_of(changes)) set_setting(settings, key, value);
    return settings;
}

void bind_info(py::module_& m) {
    auto type = value_class<SettingInfo>(m, "SettingInfo", "What there is to know about one setting.");
    type.def_readonly("key", &SettingInfo::key);
    type.def_readonly("type", &SettingInfo::type, "number, integer, boolean or the choices \"a | b\"");
    type.def_readonly("unit", &SettingInfo::unit);
    type.def_readonly("range", &SettingInfo::range);
    type.def_readonly("default_value", &SettingInfo::default_value);
    type.def_readonly("description", &SettingInfo::description);
    type.def_readonly("effect", &SettingInfo::effect, "what a change costs or gains in speed and accuracy");
}

} // namespace

void bind_settings(py::module_& m) {
    bind_info(m);
    py::class_<Settings> type(
        m, "Settings",
        "Every setting of a run; SI units. Choices are their names. A setting that is out of range "
        "is refused with InputError.");
    type.def(py::init(&make_settings), py::arg("preset") = "balanced",
             "The settings of a preset, with changes by keyword: Settings(\"accurate\", friction=0.3).");
    add_properties(type);
    type.def("validate", &validate_settings,
             "Every problem, \"key: reason\" each; empty where the settings can be run.");
    type.def("to_dict", &dict_of, "All settings by key.");
    type.def(
        "__eq__", [](const Settings& a, const Settings& b) { return a == b; }, py::is_operator());
    type.def("__repr__", [](const py::object& self) { return represent(self); });
    type.def("__copy__", [](const Settings& s) { return Settings(s); });
    type.def(
        "__deepcopy__", [](const Settings& s, const py::dict&) { return Settings(s); }, py::arg("memo"));
    m.def("list_settings", &list_settings, "Every setting with its unit, range, default and effect.");
    m.def("preset_names", &preset_names, "The names of the presets.");
}

} // namespace flotilla::python
