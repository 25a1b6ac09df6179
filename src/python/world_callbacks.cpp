// SPDX-License-Identifier: MIT
// Whom a World calls. Python's objects stay in the PythonWorld, which the World's own callbacks look them up in with
// the lock held.
#include "python/bind.hpp"
#include "python/world_class.hpp"

namespace flotilla::python {
namespace {

int traverse(PyObject* self, visitproc visit, void* arg) {
#if PY_VERSION_HEX >= 0x03090000
    Py_VISIT(Py_TYPE(self));
#endif
    auto* const instance = reinterpret_cast<py::detail::instance*>(self);
    if (!instance->get_value_and_holder().holder_constructed()) return 0;
    const WorldCallbacks& callbacks = py::cast<PythonWorld&>(py::handle(self)).callbacks();
    for (const py::object* object : {&callbacks.force, &callbacks.observer, &callbacks.log}) Py_VISIT(object->ptr());
    return 0;
}

int clear(PyObject* self) {
    auto* const instance = reinterpret_cast<py::detail::instance*>(self);
    if (!instance->get_value_and_holder().holder_constructed()) return 0;
    const WorldCallbacks gone = std::exchange(py::cast<PythonWorld&>(py::handle(self)).callbacks(), WorldCallbacks{});
    return 0;
}

void check_callable(const char* what, const py::object& object) {
    if (!object.is_none() && PyCallable_Check(object.ptr()) == 0)
        throw py::type_error(std::string(what) + ": must be callable, or None");
}
bool is_set(const py::object& object) { return object && !object.is_none(); }

} // namespace

py::custom_type_setup collected_with_callbacks() {
    return py::custom_type_setup([](PyHeapTypeObject* type) {
        type->ht_type.tp_flags |= Py_TPFLAGS_HAVE_GC;
        type->ht_type.tp_traverse = &traverse;
        type->ht_type.tp_clear = &clear;
    });
}

void PythonWorld::call_force() {
    const py::gil_scoped_acquire locked;
    const py::object callback = callbacks_.force; // it may set another one
    if (!is_set(callback)) return;
    struct Guest {
        explicit Guest(bool& flag) : in(flag) { in = true; }
        ~Guest() { in = false; }
        Guest(const Guest&) = delete;
        Guest& operator=(const Guest&) = delete;
        bool& in;
    } const guest(in_force_callback_);
    callback(py::cast(this, py::return_value_policy::reference));
}

bool PythonWorld::call_observer(Phase phase) {
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    const py::object observer = callbacks_.observer;
    if (!is_set(observer)) return true;
    const py::object answer = observer(kPhaseNames[static_cast<std::size_t>(phase)]);
    return answer.is_none() || answer.cast<bool>();
}

void PythonWorld::call_log(const std::string& line) {
    const py::gil_scoped_acquire locked;
    const py::object log = callbacks_.log;
    if (is_set(log)) log(line);
}

void PythonWorld::set_force_callback(const py::object& callback) {
    check_callable("set_force_callback", callback);
    edit().set_force_callback(callback.is_none() ? std::function<void(World&)>() : [this](World&) { call_force(); });
    callbacks_.force = callback;
}

void PythonWorld::set_observer(const py::object& observer) {
    check_callable("set_observer", observer);
    edit().set_observer(observer.is_none() ? std::function<bool(Phase)>()
                                           : [this](Phase phase) { return call_observer(phase); });
    callbacks_.observer = observer;
}

void PythonWorld::set_log(const py::object& log) {
    check_callable("set_log", log);
    edit().set_log(log.is_none() ? std::function<void(const std::string&)>()
                                 : [this](const std::string& line) { call_log(line); });
    callbacks_.log = log;
}

void bind_callbacks(WorldClass& type) {
    type.def(
        "set_force_callback", &PythonWorld::set_force_callback, py::arg("callback"),
        "callback(world) is called at the start of every step, when it may edit the World and ask it; None: nobody. "
        "What it throws comes out of step(), and leaves nothing done but its edits.");
    type.def("set_observer", &PythonWorld::set_observer, py::arg("observer"),
             "observer(phase) is called with a name of StepReport.phase_ms after stages 1, 3, 5 and 7 of a step, or of "
             "each inner one; None: nobody. Where it returns False, step() throws StepCancelled; what it throws comes "
             "out of step(); in both cases everything is as it was before the step. It may not use the World. Costs a "
             "copy of the state in every step.");
    type.def("set_log", &PythonWorld::set_log, py::arg("log"),
             "log(line) is called with what is worth a look: warnings of a step that the step before did not have, and "
             "edits that were refused; None: nobody. What it throws comes out of the call, whose work is done.");
}

} // namespace flotilla::python
