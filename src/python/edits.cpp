// SPDX-License-Identifier: MIT
// Edits as values, and their files.
#include <fstream>
#include <sstream>

#include <flotilla/edit_file.hpp>

#include "python/bind.hpp"
#include "python/edits.hpp"
#include "python/world_class.hpp"

namespace flotilla::python {
namespace {

/// As files of edits have them, in the order of Edit::change.
constexpr std::array<std::string_view, 17> kKinds{
    "add_shape",  "add_body",      "remove_body", "set_pose",    "set_velocity",  "set_type",
    "set_script", "set_material",  "set_force",   "apply_force", "apply_impulse", "set_gravity",
    "set_group",  "ignore_groups", "ignore_pair", "wake",        "remove_shape"};
static_assert(kKinds.size() == std::variant_size_v<decltype(Edit::change)>);

void write(const py::object& edits, const py::object& scene, const std::filesystem::path& path) {
    const NamedScene named = scene_argument(scene, py::none(), py::none());
    std::ostringstream text;
    flotilla::write_edits(text, edits_argument(edits, *named.scene), *named.scene);
    std::ofstream out(path, std::ios::binary);
    out << text.str();
    if (!out.flush()) throw IoError(path.string() + ": cannot be written");
}

/// The body, the number of an added shape, or None.
py::object apply(PythonWorld& w, const Edit& edit) {
    const BodyId body = w.edit().apply(edit);
    if (std::holds_alternative<edits::AddShape>(edit.change)) return py::int_(body.index);
    return body.index < 0 ? py::none() : py::cast(body);
}

} // namespace

std::vector<Edit> edits_argument(const py::object& edits, const SceneDescription& scene) {
    if (edits.is_none()) return {};
    if (py::isinstance<py::list>(edits) || py::isinstance<py::tuple>(edits)) {
        std::vector<Edit> out;
        for (const py::handle edit : edits) {
            if (!py::isinstance<Edit>(edit)) throw py::type_error("edits: every item of the list must be an Edit");
            out.push_back(edit.cast<Edit>());
        }
        return out;
    }
    if (const std::optional<std::string> text = json_argument(edits)) return parse_edits(*text, "edits", ".", scene);
    if (!py::isinstance<py::str>(edits) && !py::hasattr(edits, "__fspath__"))
        throw py::type_error("edits are a list of flotilla.Edit, the path of a file, JSON text or a dict, not " +
                             py::type::of(edits).attr("__name__").cast<std::string>());
    return flotilla::read_edits(edits.cast<std::filesystem::path>(), scene);
}

void bind_edit_files(py::module_& m) {
    auto edit = value_class<Edit>(
        m, "Edit", "A change of a World between steps, as World.recorded_edits has it; World.apply makes it again.");
    edit.def_readwrite("step", &Edit::step, "after so many steps of a run; World.apply does not look at it");
    edit.def_property_readonly(
        "kind", [](const Edit& e) { return kKinds[e.change.index()]; }, "its name in files of edits, such as add_body");
    m.def(
        "read_edits",
        [](const py::object& edits, const py::object& scene) {
            return edits_argument(edits, *scene_argument(scene, py::none(), py::none()).scene);
        },
        py::arg("edits"), py::arg("scene"),
        "A list of Edit from the path of a file, JSON text or a dict as `flotilla run --edits` takes them, sorted by "
        "step. scene: whose bodies and shapes they name.");
    m.def("write_edits", &write, py::arg("edits"), py::arg("scene"), py::arg("path"),
          "Writes edits that were made of a World of the scene, such as World.recorded_edits, as a file for `flotilla "
          "run --edits` and read_edits, which reads them back to the same bits.");
}

void bind_recorded_edits(WorldClass& type) {
    type.def(
        "apply", &apply, py::arg("edit"),
        "Makes an Edit: what all functions that change the World do. Returns the BodyId of the body, the number of "
        "an added shape, or None.");
    type.def(
        "record_edits", [](PythonWorld& w, bool record) { w.edit().record_edits(record); }, py::arg("record") = true,
        "Keeps the edits from now on, or no longer.");
    type.def_property_readonly(
        "recorded_edits", [](const PythonWorld& w) { return w.world().recorded_edits(); },
        "a list of Edit in the order in which they were made; write_edits makes a file of them");
}

} // namespace flotilla::python
